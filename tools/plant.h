/* SPDX-License-Identifier: MIT
 * The ego car of a closed loop: a brake controller that acts on AEB_REQUEST frames as the contract asks of one, an actuator,
 * and the dynamics of the reference rollout (model.h: eq. 4 to 6, f64, 1 ms). Its parameters are its own, not what the
 * daemon believes. Knows no sensor and no other car.
 */
#ifndef AEBMC_PLANT_H
#define AEBMC_PLANT_H

#include "config.h"
#include "contract.h"
#include "drive.h"
#include "e2e.h"
#include "model.h"

#define PLANT_DELAY_MAX_S 0.25

struct plant_vehicle {
	double mass_kg, drag, mu, grade_rad;
	double tau_s; /* of the actuator */
	double gain;  /* deceleration achieved of what is asked for */
	double delay_s; /* from a request on the bus to the actuator, 0..PLANT_DELAY_MAX_S; the evaluation is in it too */
};

struct plant {
	const struct config *cfg;
	struct plant_vehicle car;
	struct model_sample braking; /* constants of eq. 4 to 6 */
	double brake_mps2;           /* of the actuator, <= 0 */

	struct e2e_state e2e;
	int64_t good_ns;   /* of the last good request frame; -1: none */
	int stage;         /* it carried, enum contract_value AEB_REQUEST_STAGE_* */
	double asked_mps2; /* <= 0 */
	uint64_t step;     /* milliseconds driven */
	double past[256];  /* asked_mps2 by millisecond */
};

/** plant_nominal - the car that @cfg describes, on the level, friction as @mu; the delay is half of brake.delay. */
struct plant_vehicle plant_nominal(const struct config *cfg, double mu);

/** plant_open - standing at no deceleration; the friction bound is a >= -mu g whatever vehicle.bound says. */
void plant_open(struct plant *p, const struct config *cfg, const struct plant_vehicle *v);

/**
 * plant_receive - a frame on the bus
 * Acts on request code "brake" with a TTL alone, after checking protection; what is not AEB_REQUEST is ignored.
 */
void plant_receive(struct plant *p, const struct bus_frame *f, int64_t now_ns);

/** plant_ask - ask for a deceleration [m/s2, <= 0] without a frame. */
void plant_ask(struct plant *p, double accel_mps2);

/**
 * plant_step - one millisecond on
 * @now_ns: for the timeout of requests, three periods
 * @driver_mps2: net acceleration that the driver seeks, as drive_accel() gives it; below -1 m/s2 by the brake
 * @ego: moved
 * While the brake is asked for, the throttle is closed: drag and grade act.
 */
void plant_step(struct plant *p, int64_t now_ns, double driver_mps2, struct drive_car *ego);

#endif
