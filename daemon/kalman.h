/* SPDX-License-Identifier: MIT
 * The filter: five states of two vehicles in one lane, each with constant acceleration disturbed by white jerk.
 * Only + - * / and sqrt, so the same bits on every machine. Knows no frame, object or configuration.
 */
#ifndef AEBMC_KALMAN_H
#define AEBMC_KALMAN_H

#include <stdint.h>
#include "scene.h"

struct kalman {
	int64_t t_ns;                   /* time the state is valid for */
	double x[SCENE_DIM];            /* [m], [m/s], [m/s2], [m/s], [m/s2] */
	double p[SCENE_DIM][SCENE_DIM]; /* covariance, symmetric to the bit, positive definite */
};

/* What can be measured. */
enum kalman_input {
	KALMAN_EGO_SPEED, /* [m/s] */
	KALMAN_DISTANCE,  /* [m] */
	KALMAN_RATE,      /* lead speed minus ego speed [m/s] */
	KALMAN_INPUTS
};

/** kalman_open_ego - start with an ego speed alone and no acceleration, +- @accel_sigma. */
void kalman_open_ego(struct kalman *k, int64_t t_ns, double speed_mps, double speed_sigma,
		     double accel_sigma);

/** kalman_forget_lead - the lead's part to 0 +- 1, uncorrelated: a filter of the ego alone does not drift with it. */
void kalman_forget_lead(struct kalman *k);

/**
 * kalman_open_lead - begin to follow an object
 * @k: an ego filter, predicted to the time of the measurement
 * The object starts at the measured place and speed with no acceleration, +- @accel_sigma [m/s2].
 */
void kalman_open_lead(struct kalman *k, double distance_m, double distance_sigma, double rate_mps,
		      double rate_sigma, double accel_sigma);

/** kalman_set_lead_accel - put it at @accel +- @sigma [m/s2], uncorrelated; the other states keep their values. */
void kalman_set_lead_accel(struct kalman *k, double accel, double sigma);

/**
 * kalman_predict - to @t_ns; a time that has passed changes nothing
 * A lead that brakes to standstill on the way stands; one that moves backwards already goes on.
 * @q_ego, @q_lead: spectral density of the jerk [m2/s5], > 0
 */
void kalman_predict(struct kalman *k, int64_t t_ns, double q_ego, double q_lead);

/** kalman_innovation - measured minus expected; @variance receives its variance, @sigma the measurement's noise, > 0. */
double kalman_innovation(const struct kalman *k, enum kalman_input in, double z, double sigma,
			 double *variance);

/** kalman_update - take one measurement. */
void kalman_update(struct kalman *k, enum kalman_input in, double z, double sigma);

#endif
