/* SPDX-License-Identifier: MIT
 * One decision after another: a scene, its results and faults, 50 ms apart.
 */
#ifndef AEBMC_TESTS_DECISION_RUN_H
#define AEBMC_TESTS_DECISION_RUN_H

#include "clock.h"
#include "decision.h"

#define MS    CLOCK_NS_PER_MS
#define START (100 * CLOCK_NS_PER_S)

struct run {
	struct config cfg;
	struct scene scene;
	struct decision_state st;
	uint32_t fault;
	int64_t now_ns;
};

/* 20 m/s behind a lead at 15 m/s, 30 m ahead. */
static inline struct scene approach(void)
{
	struct scene s = {
		.ego_valid = 1, .lead_valid = 1, .lead_scans = 10, .x = {30, 20, 0, 15, 0}};

	s.driver_brake = s.driver_accel = -1;
	return s;
}

/* A result whose intervals are points, so that lower and upper ends are the figures given. */
static inline struct mc_result result(double defer, double driver, double nobody)
{
	const double p[FUTURES] = {[FUTURE_DEFER] = defer,
				   [FUTURE_NOW] = defer,
				   [FUTURE_DRIVER] = driver,
				   [FUTURE_NOBODY] = nobody};
	struct mc_result r = {.n = 16384, .n_futures = FUTURES};

	for (int i = 0; i < FUTURES; i++) {
		r.risk[i] = (struct mc_risk){.p = p[i], .lo = p[i], .hi = p[i]};
	}
	return r;
}

static inline struct decision step(struct run *r, const struct mc_result *res)
{
	struct decision d = decision_step(&r->cfg, res, &r->scene, r->fault, r->now_ns, &r->st);

	r->now_ns += 50 * MS;
	return d;
}

#endif
