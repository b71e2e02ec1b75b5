/* SPDX-License-Identifier: MIT
 * decision, whatever comes: from any past of random scenes, results, faults and pedals what it says fits together, and it
 * leads back to nothing once the danger is over.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "decision_run.h"
#include "fault.h"

static struct run fresh(void)
{
	struct run r = {.now_ns = START};

	config_defaults(&r.cfg);
	return r;
}

static uint64_t rng = 88172645463325252u;

static double uniform(void)
{
	rng ^= rng << 13;
	rng ^= rng >> 7;
	rng ^= rng << 17;
	return (double)(rng >> 11) * 0x1p-53;
}

static int one_in(int n)
{
	return uniform() * n < 1;
}

/* Anything at all: risks in any order, intervals of any width, no result, faults, no lead, any speeds and pedals. */
static struct decision step_wild(struct run *r)
{
	struct mc_result res = result(uniform(), uniform(), uniform());

	for (int i = 0; i < FUTURES; i++) {
		res.risk[i].lo = one_in(50) ? NAN : res.risk[i].p * uniform();
		res.risk[i].hi = one_in(50) ? NAN : res.risk[i].p + (1 - res.risk[i].p) * uniform();
	}
	res.n = one_in(10) ? 100 : 16384;
	r->scene.lead_valid = !one_in(10);
	r->scene.lead_scans = (uint32_t)(uniform() * 10);
	r->scene.ego_valid = !one_in(20);
	r->scene.driver_accel = one_in(10) - one_in(3);
	r->scene.x[SCENE_EGO_SPEED] = one_in(5) ? uniform() : 80 * uniform();
	r->scene.x[SCENE_LEAD_SPEED] = 40 * uniform();
	r->scene.x[SCENE_HEADWAY] = 50 * uniform();
	r->fault = one_in(5) ? 1u << (int)(uniform() * FAULTS) : 0;
	return step(r, one_in(5) ? NULL : &res);
}

static void check_sane(const struct run *r, struct decision d, enum stage_level before)
{
	const double accel[LEVELS] = {0, 0, -4, -6};

	assert_true(d.accel_mps2 == accel[d.level]);
	assert_int_equal(d.level, r->st.level);
	assert_int_equal(d.changed, d.level != before);
	assert_true(before >= LEVEL_WARN || d.level <= LEVEL_WARN); /* a warning comes first */
	if (fault_state(r->fault) > STATE_DEGRADED || !r->scene.ego_valid) {
		assert_int_equal(d.level, LEVEL_NONE);
	}
	if (r->scene.driver_accel == 1) {
		assert_true(d.level <= LEVEL_WARN);
	}
}

/* Whatever happened before: when the danger is over, whichever way, everything is released within the hold, the calm
 * evaluations and decision.release_max. */
static void test_never_stuck(void **arg)
{
	(void)arg;
	for (int trial = 0; trial < 3000; trial++) {
		struct run r = fresh();
		const int way = trial % 4, n = 1 + (int)(uniform() * 40);
		struct decision d = {0};

		r.cfg.decision_partial = trial / 4 % 2;
		r.cfg.decision_brake_evals = 1 + trial / 8 % 3;
		for (int i = 0; i < n; i++) {
			const enum stage_level before = r.st.level;

			d = step_wild(&r);
			check_sane(&r, d, before);
		}
		r.scene = approach();
		r.scene.lead_valid = way != 0;
		r.scene.x[SCENE_EGO_SPEED] = way == 1 ? 0 : 20;
		r.scene.x[SCENE_LEAD_SPEED] = way == 2 ? 15 : 20; /* still closing, from far away */
		r.fault = way == 3 && one_in(2) ? FAULT_BIT(MC_ERROR) : 0;
		for (int i = 0; i < 42; i++) {
			const double p = way == 1; /* stands, whatever the risk */
			const struct mc_result res = result(p, p, p);

			d = step(&r, &res);
		}
		if (d.level != LEVEL_NONE || d.accel_mps2 != 0) {
			fail_msg("trial %d: %s", trial, level_name[d.level]);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_never_stuck),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
