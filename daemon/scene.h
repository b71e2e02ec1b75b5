/* SPDX-License-Identifier: MIT
 * What the estimator knows at one moment: the state with its covariance, the age of every input, and what is wrong.
 */
#ifndef AEBMC_SCENE_H
#define AEBMC_SCENE_H

#include <stdint.h>

enum scene_state {
	SCENE_HEADWAY,
	SCENE_EGO_SPEED,
	SCENE_EGO_ACCEL,
	SCENE_LEAD_SPEED,
	SCENE_LEAD_ACCEL,
	SCENE_DIM
};

/* Frames refused before they reach the filter, by reason. */
enum scene_reject {
	SCENE_REJECT_CRC,
	SCENE_REJECT_COUNTER,
	SCENE_REJECT_LENGTH,
	SCENE_REJECT_NOT_AVAILABLE,
	SCENE_REJECT_RANGE,       /* physical value outside the DBC's or the estimator's range */
	SCENE_REJECT_IMPLAUSIBLE, /* inconsistent with what was known a moment ago */
	SCENE_REJECTS
};
extern const char *const scene_reject_name[SCENE_REJECTS]; /* "crc", "counter", "length", ... */

/* What the ego may meet instead of the lead, nearest first. */
enum scene_other {
	SCENE_NEARER,  /* an object nearer than the lead: not confirmed yet, or about to cut in */
	SCENE_BEHIND,  /* one behind it, where the lead is none or leaves */
	SCENE_HIDDEN,  /* a standing one that nobody sees, where the lead leaves */
	SCENE_NOTHING, /* no object: the lead is none, or leaves */
	SCENE_OTHERS
};

struct scene_object {
	double p; /* that it is met first; the lead is with what the others leave of 1 */
	double headway_m, speed_mps, accel_mps2; /* 0 of SCENE_NOTHING */
};

struct scene {
	int64_t t_ns; /* time the state is valid for: the one asked for, the sensors' latency is bridged */
	int64_t scan_ns;     /* time the scan ended */
	uint64_t scan;       /* number of the scan, from 1 */
	int ego_valid;       /* ego speed is fresh and plausible */
	int lead_valid;      /* a lead is followed; without it only ego figures mean anything */
	double x[SCENE_DIM]; /* [m], [m/s], [m/s2], [m/s], [m/s2]; same order as enum model_input */
	double cov[SCENE_DIM][SCENE_DIM]; /* covariance, SI units */
	double lateral_m;                 /* of the lead, left positive */
	double existence;                 /* 0..1; 1 where the radar does not say */
	struct scene_object other[SCENE_OTHERS];
	uint32_t lead_id;        /* changes when another object becomes the lead */
	uint32_t lead_scans;     /* scans it has been followed */
	int64_t oldest_input_ns; /* age of the oldest input used [ns] */
	int driver_brake,
		driver_accel; /* 1 pressed (accelerator: past driver.override), 0 not, -1 unknown */
	double yaw_rate_radps; /* 0 when not mapped */
	uint32_t fault;        /* fault.def bits (FAULT_BIT) raised by the inputs */
};

/** scene_lead_p - probability that the lead is what the ego meets first [0..1]. Pure. */
static inline double scene_lead_p(const struct scene *s)
{
	double p = 1;

	for (int i = 0; i < SCENE_OTHERS; i++) {
		p -= s->other[i].p;
	}
	return p > 0 ? p : 0;
}

#endif
