/* SPDX-License-Identifier: MIT
 * The world of a closed loop, stepped by 1 ms: the ego with its driver, the other cars, the sensors, and what is noted of
 * it all. Whoever decides is at the other end of frames: the pipeline in virtual time (scenario_sim.c) or a daemon on a
 * bus (scenario_live.c).
 */
#ifndef AEBMC_SCENARIO_LOOP_H
#define AEBMC_SCENARIO_LOOP_H

#include "scenario.h"

struct scenario_loop {
	const struct config *cfg;
	const struct scenario *row;
	struct drive drive; /* the row's, at the draw's speeds */
	double reaction_s;
	struct plant plant;
	struct sensors sensors;
	struct drive_truth now;
	double driver_mps2; /* net acceleration that the driver seeks */
	double asked_mps2;  /* on the bus */
	int stage;          /* on the bus, AEB_REQUEST_STAGE_* */
	int deaf;           /* requests on the bus are not acted upon, scenario_loop_ask()'s are */
	double stood_s;
	struct scenario_result result;
};

/** scenario_loop_open - at the start; @row and @d's car, @cfg and @map must outlive it. No allocation. */
void scenario_loop_open(struct scenario_loop *l, const struct config *cfg,
			const struct mapping *map, const struct scenario *row,
			const struct scenario_draw *d);

/**
 * scenario_loop_step - one millisecond: the cars move to sensors.t_ns, the sensors' frames of it go to @emit
 * Returns 0, -ENODATA at the end (contact, standstill, or the row's time is up), or what @emit returned.
 */
int scenario_loop_step(struct scenario_loop *l, sensors_emit emit, void *arg);

/** scenario_loop_hear - a frame was sent on the bus. */
void scenario_loop_hear(struct scenario_loop *l, const struct bus_frame *f, int64_t now_ns);

/** scenario_loop_ask - full braking [m/s2, < 0] or none, by another rule than the daemon's. */
void scenario_loop_ask(struct scenario_loop *l, double accel_mps2);

#endif
