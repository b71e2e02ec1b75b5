/* SPDX-License-Identifier: MIT
 * The rules that the daemon is compared with: their distances by hand, their memory.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../tools/rules.c"
#include "mc_ops.h"
#include "pipeline.h"

#define MS CLOCK_NS_PER_MS

static struct config defaults(void)
{
	struct config c;

	config_defaults(&c);
	return c;
}

static struct scene scene(double headway_m, double ego_mps, double lead_mps)
{
	struct scene s = {.ego_valid = 1,
			  .lead_valid = 1,
			  .lead_scans = 100,
			  .existence = 1,
			  .x = {headway_m, ego_mps, 0, lead_mps, 0}};

	for (int i = 0; i < SCENE_DIM; i++) {
		s.cov[i][i] = 0.01;
	}
	return s;
}

static void close_to(double got, double wanted)
{
	if (fabs(got - wanted) > 1e-9 * fabs(wanted)) {
		fail_msg("%.12g, not %.12g", got, wanted);
	}
}

/* Standing object: both stop, v t + v^2 / (2 3) + 1. Moving: at equal speed, here after 1 + (20 - 9) / 2 s. */
static void autoware_by_hand(void **state)
{
	(void)state;
	close_to(rule_distance_autoware(20, 0), 20 + 400 / 6.0 + 1);
	close_to(rule_distance_autoware(10, 0), 10 + 100 / 6.0 + 1);
	/* gap closes by 20 - 10 + t at 1 s to equal speeds: ego 20 - 3 (t - 1) = 10 - t at t = 6.5 */
	close_to(rule_distance_autoware(20, 10),
		 20 + 20 * 5.5 - 1.5 * 5.5 * 5.5 - (10 * 6.5 - 0.5 * 6.5 * 6.5) + 1);
	/* an object that is faster is nearest at the start, or never comes nearer than it is */
	close_to(rule_distance_autoware(10, 30), 1);
}

static void ad_rss_by_hand(void **state)
{
	(void)state;
	close_to(rule_distance_ad_rss(20, 20), 20 + 1.75 + 23.5 * 23.5 / 8 - 400 / 16.0);
	close_to(rule_distance_ad_rss(0, 0), 1.75 + 3.5 * 3.5 / 8);
	assert_true(rule_distance_ad_rss(5, 50) == 0);
}

static void names_are_found(void **state)
{
	(void)state;
	for (const struct rule *r = rule_table; r->name; r++) {
		assert_ptr_equal(rule_find(r->name), r);
	}
	assert_null(rule_find("nosuch"));
}

static void each_fires_below_its_distance(void **state)
{
	static const struct {
		const char *name;
		double fires_m, quiet_m;
	} row[] = {
		{"ttc", 13.99, 14.01},
		{"autoware", 41.7, 41.8},
		{"ad-rss", 84.5, 84.6},
	};
	const struct config c = defaults();

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		const struct rule *r = rule_find(row[i].name);
		const struct scene near = scene(row[i].fires_m, 20, 10);
		const struct scene far = scene(row[i].quiet_m, 20, 10);

		assert_true(r->fires(&c, &near, NULL, NULL));
		assert_false(r->fires(&c, &far, NULL, NULL));
	}
}

static void brakes_holds_and_releases(void **state)
{
	const struct rule *r = rule_find("ttc");
	const struct config c = defaults();
	const struct scene near = scene(10, 20, 10), far = scene(100, 20, 10);
	struct rule_state st = {0};

	(void)state;
	assert_true(rule_step(r, &st, &c, &far, NULL, NULL, 0) == 0);
	assert_true(rule_step(r, &st, &c, &near, NULL, NULL, 50 * MS) == c.brake_accel);
	for (int i = 1; i < 8; i++) { /* decision.hold is 0.4 s, decision.release_evals 4 */
		assert_true(rule_step(r, &st, &c, &far, NULL, NULL, (50 + 50 * i) * MS) < 0);
	}
	assert_true(rule_step(r, &st, &c, &far, NULL, NULL, 450 * MS) == 0);
}

static void stays_within_the_limits(void **state)
{
	const struct rule *r = rule_find("ttc");
	const struct config c = defaults();
	struct scene s = scene(0.5, 1.9, 0);
	struct rule_state st = {0};

	(void)state;
	assert_true(rule_step(r, &st, &c, &s, NULL, NULL, 0) == 0); /* too slow */
	s = scene(5, 75, 0);
	assert_true(rule_step(r, &st, &c, &s, NULL, NULL, 0) == 0); /* too fast */
	s = scene(5, 20, 0);
	s.lead_scans = 3;
	assert_true(rule_step(r, &st, &c, &s, NULL, NULL, 0) == 0); /* too new */
	s.lead_scans = 4;
	s.lead_valid = 0;
	assert_true(rule_step(r, &st, &c, &s, NULL, NULL, 0) == 0); /* none */
	s.lead_valid = 1;
	assert_true(rule_step(r, &st, &c, &s, NULL, NULL, 0) < 0);
	s.x[SCENE_EGO_SPEED] = 1;
	assert_true(rule_step(r, &st, &c, &s, NULL, NULL, MS) < 0); /* to standstill */
	s.x[SCENE_EGO_SPEED] = 0.1;
	assert_true(rule_step(r, &st, &c, &s, NULL, NULL, MS) == 0);
}

/* The paper's safe headway at 5 % is 100.6 m at 30 m/s; the lead's own speed is nothing to it. */
static void paper_is_the_papers(void **state)
{
	const struct rule *r = rule_find("paper");
	struct config c = defaults();
	const struct mc_params p = {.seed = 1, .n_resident = 16384, .threads = 1};
	struct mc *mc;
	struct mc_request req;

	(void)state;
	c.decision_p_defer = 0.05;
	c.brake_delay = 0;
	assert_int_equal(mc_open(&mc_cpu_ops, &p, MC_INLINE, &mc), 0);
	for (int lead_mps = 0; lead_mps <= 30; lead_mps += 15) {
		for (int m = 98; m <= 103; m += 5) {
			struct scene s = scene(m, 30, lead_mps);

			s.cov[SCENE_HEADWAY][SCENE_HEADWAY] = 0;
			s.cov[SCENE_EGO_SPEED][SCENE_EGO_SPEED] = 4;
			assert_int_equal(pipeline_request(&c, &s, 1, &req), 0);
			assert_int_equal(r->fires(&c, &s, mc, &req), m == 98);
		}
	}
	mc_close(mc);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(autoware_by_hand),
		cmocka_unit_test(ad_rss_by_hand),
		cmocka_unit_test(names_are_found),
		cmocka_unit_test(each_fires_below_its_distance),
		cmocka_unit_test(brakes_holds_and_releases),
		cmocka_unit_test(stays_within_the_limits),
		cmocka_unit_test(paper_is_the_papers),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
