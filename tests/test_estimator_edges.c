/* SPDX-License-Identifier: MIT
 * The estimator at its limits, to the nanosecond and the last bit: where staleness, plausibility, standing and pressing
 * begin and end, and what it must know from its first moment on.
 */
#include "rig.h"
#include "../daemon/estimator.c"

static struct scene scene_at(struct rig *b, int64_t t_ns)
{
	struct scene s;

	estimator_scene(b->e, t_ns, &s);
	return s;
}

/* The first message that carries an ego signal. */
static void say_speed(struct rig *b, double mps)
{
	b->speed_mps = mps;
	const struct bus_frame f = rig_ego(b, b->map->role[MAP_EGO_SPEED].message[0]);

	rig_give(b, &f);
}

/* ---- life ----------------------------------------------------------------------------------- */

/* A log may count from its own beginning: nothing was heard at 0. */
static void a_clock_may_begin_at_0(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "generic");
	b.t_ns = 0;
	s = rig_look(&b);
	assert_int_equal(s.fault, FAULT_BIT(STARTING));
	assert_true(!s.ego_valid && s.driver_brake == -1 && s.driver_accel == -1);
	assert_int_equal(rig_cycle(&b).fault, FAULT_BIT(STARTING));
	s = rig_cycles(&b, 9);
	assert_int_equal(s.fault, 0);
	assert_true(s.ego_valid && s.lead_valid);
	assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_IMPLAUSIBLE], 0);
	rig_close(&b);
}

static void distrust_is_of_the_open_scan_too(void **state)
{
	struct rig b;

	(void)state;
	rig_open_in_scan(&b);
	assert_true(estimator_deadline(b.e) == b.t_ns + 12 * MS);
	estimator_distrust(b.e);
	assert_true(estimator_deadline(b.e) == CLOCK_NEVER);
	rig_close(&b);
}

static void each_message_must_pass_its_check(void **state)
{
	(void)state;
	for (int i = 0; i < 3; i++) {
		struct rig b;

		rig_open(&b, "generic");
		assert_int_equal(b.map->n_messages, 3);
		rig_cycles(&b, 10);
		for (int bad = 1; bad <= 3; bad++) {
			struct bus_frame f =
				b.map->message[i].ego ? rig_ego(&b, i) : rig_slot(&b, 0);

			f.data[7] ^= 1;
			rig_give(&b, &f);
			assert_int_equal(rig_look(&b).fault, bad < 3 ? 0 : FAULT_BIT(INPUT_CHECK));
		}
		rig_close(&b);
	}
}

/* ---- the ego speed -------------------------------------------------------------------------- */

/* Three periods of 20 ms without a speed are bridged, no nanosecond more. */
static void a_long_silence_of_the_speed_makes_a_new_start(void **state)
{
	(void)state;
	for (int late = 0; late < 2; late++) {
		struct rig b;

		rig_open(&b, "generic");
		rig_cycles(&b, 10);
		b.t_ns += 60 * MS + late;
		say_speed(&b, 20);
		assert_int_equal(rig_look(&b).ego_valid, !late);
		rig_close(&b);
	}
}

/* In 20 ms 12 m/s2 are 0.24 m/s, and two values of 0.05 m/s noise may be four of them apart each: 0.64 m/s. */
static void a_speed_is_plausible_up_to_a_step(void **state)
{
	static const double step_mps[] = {0.63, -0.63, 0.65, -0.65};

	(void)state;
	for (int i = 0; i < 4; i++) {
		struct rig b;

		rig_open(&b, "generic");
		rig_cycles(&b, 10);
		b.t_ns += 20 * MS;
		say_speed(&b, 20 + step_mps[i]);
		assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_IMPLAUSIBLE], i / 2);
		rig_close(&b);
	}
}

static void a_jump_is_a_fault_for_one_scan(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	rig_cycles(&b, 10);
	for (int i = 0; i < 3; i++) {
		assert_int_equal(rig_look(&b).fault, 0);
		b.t_ns += 20 * MS;
		say_speed(&b, 25);
	}
	assert_int_equal(scene_at(&b, b.t_ns + 50 * MS - 1).fault, FAULT_BIT(IMPLAUSIBLE));
	assert_int_equal(scene_at(&b, b.t_ns + 50 * MS).fault, 0);
	rig_close(&b);
}

/* With no patience at all the first jump is believed, and a fault all the same. */
static void one_jump_may_be_enough(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	rig_cycles(&b, 10);
	b.cfg.bus_stale_periods = 1;
	b.t_ns += 20 * MS;
	say_speed(&b, 25);
	assert_int_equal(rig_look(&b).fault, FAULT_BIT(IMPLAUSIBLE));
	assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_IMPLAUSIBLE], 1);
	assert_int_equal(b.e->speeds.n, 1); /* begun anew with it */
	rig_close(&b);
}

/* Speeds that no filter has seen yet, each of them, are part of the scene. */
static void every_speed_that_waits_counts(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	const double before = rig_cycles(&b, 20).x[SCENE_EGO_SPEED];

	assert_in_range(b.e->speeds.n, 3, 5); /* 75 ms of them */
	for (int i = 0; i < b.e->speeds.n; i++) {
		double *mps = &b.e->speeds.queue[(b.e->speeds.head + i) % SPEEDS_MAX].mps;

		*mps += 0.1;
		assert_true(rig_look(&b).x[SCENE_EGO_SPEED] > before + 0.001);
		*mps -= 0.1;
	}
	rig_close(&b);
}

/* ---- what is compared with a limit ---------------------------------------------------------- */

static void the_path_bends_from_a_speed_on(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	b.value[MAP_YAW_RATE] = 0.05;
	rig_cycles(&b, 10);
	b.cfg.decision_speed_min = b.e->tracker.ego.x[SCENE_EGO_SPEED]; /* which is constant */
	assert_true(fabs(rig_cycle(&b).lateral_m + 30.0 * 30 / 800) < 0.05);
	b.cfg.decision_speed_min = nextafter(b.cfg.decision_speed_min, 100);
	assert_true(rig_cycle(&b).lateral_m == 0);
	rig_close(&b);
}

static void the_driver_overrides_from_a_share_on(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	b.value[MAP_DRIVER_ACCEL] = 0.8;
	rig_cycles(&b, 10);
	b.cfg.driver_override = b.e->role[MAP_DRIVER_ACCEL].value;
	assert_true(fabs(b.cfg.driver_override - 0.8) < 0.01);
	assert_int_equal(rig_look(&b).driver_accel, 1);
	b.cfg.driver_override = nextafter(b.cfg.driver_override, 1);
	assert_int_equal(rig_look(&b).driver_accel, 0);
	rig_close(&b);
}

/* ---- standing ------------------------------------------------------------------------------- */

static void assert_clamped(const double x[SCENE_DIM], const double want[SCENE_DIM])
{
	double got[SCENE_DIM];

	memcpy(got, x, sizeof(got));
	clamp_at_standstill(got);
	assert_memory_equal(got, want, sizeof(got));
}

/* Headway, then speed and acceleration of the ego and of the lead. A zero has one form, so that replays agree bit for bit. */
static void nobody_drives_backwards(void **state)
{
	static const double x[][2][SCENE_DIM] = {
		{{30, 20, -3, 15, -4}, {30, 20, -3, 15, -4}},
		{{0.5, 20, 3, 15, 4}, {0.5, 20, 3, 15, 4}},
		{{-1, 20, 3, 15, 4}, {0, 20, 3, 15, 4}},
		{{30, -0.1, -3, 15, -4}, {30, 0, 0, 15, -4}},
		{{30, 20, -3, -0.1, -4}, {30, 20, -3, 0, 0}},
		{{30, 0, -3, 0, -4}, {30, 0, 0, 0, 0}}, /* stands: no further braking */
		{{30, 0, 3, -0.1, 4}, {30, 0, 3, 0, 4}},
		{{-0.0, -0.0, -0.0, -0.0, -0.0}, {0, 0, 0, 0, 0}},
	};

	(void)state;
	for (size_t i = 0; i < sizeof(x) / sizeof(x[0]); i++) {
		assert_clamped(x[i][0], x[i][1]);
	}
}

/* The lead's acceleration in the scene if its filter has this speed and that one. */
static double held(const struct config *c, double speed_mps, double accel_mps2)
{
	struct kalman k = {.x = {[SCENE_LEAD_SPEED] = speed_mps, [SCENE_LEAD_ACCEL] = accel_mps2},
			   .p = {[SCENE_LEAD_ACCEL] = {[SCENE_LEAD_ACCEL] = 4}}};

	hold_if_standing(c, &k);
	assert_true(k.x[SCENE_LEAD_SPEED] == speed_mps);
	assert_true(k.p[SCENE_LEAD_ACCEL][SCENE_LEAD_ACCEL] ==
		    (speed_mps < c->filter_standing_speed
			     ? c->filter_standing_sigma * c->filter_standing_sigma
			     : 4));
	return k.x[SCENE_LEAD_ACCEL];
}

static void a_slow_lead_does_not_drive_off(void **state)
{
	struct config c;

	(void)state;
	config_defaults(&c);
	assert_true(held(&c, c.filter_standing_speed, 1) == 1);
	assert_true(held(&c, nextafter(c.filter_standing_speed, 0), 1) == 0);
	assert_true(held(&c, nextafter(c.filter_standing_speed, 0), -1) == -1);
	assert_true(held(&c, 0, -1) == -1);
	assert_false(signbit(held(&c, 0, -0.0)));

	struct rig b;

	rig_open(&b, "generic");
	b.rate_mps = -20; /* and so it is in the scene */
	b.gap_m = 100;
	const struct scene s = rig_cycles(&b, 20);

	assert_true(s.lead_valid && s.x[SCENE_LEAD_SPEED] < 0.1);
	assert_true(s.cov[SCENE_LEAD_ACCEL][SCENE_LEAD_ACCEL] ==
		    c.filter_standing_sigma * c.filter_standing_sigma);
	rig_close(&b);
}

/* ---- latency -------------------------------------------------------------------------------- */

/* 0.1 s more or less: what the radar saw has closed in by that much, and its speed has changed by that much. */
static void an_uncertain_latency_is_in_the_covariance(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	for (int i = 0; i < 30; i++) {
		b.rate_mps -= i < 10 ? 0 : 0.15;
		rig_cycle(&b);
	}
	b.cfg.radar_latency_sigma = 0;
	const struct scene sure = rig_look(&b);

	b.cfg.radar_latency_sigma = 0.1;
	const struct scene s = rig_look(&b);
	const double moved_m = 0.1 * (s.x[SCENE_LEAD_SPEED] - s.x[SCENE_EGO_SPEED]);
	const double changed_mps = 0.1 * s.x[SCENE_LEAD_ACCEL];

	assert_true(s.lead_valid && moved_m < -0.25 && changed_mps < -0.2);
	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = 0; j < SCENE_DIM; j++) {
			const double by[SCENE_DIM] = {
				[SCENE_HEADWAY] = moved_m, [SCENE_LEAD_SPEED] = changed_mps};

			assert_true(fabs(s.cov[i][j] - sure.cov[i][j] - by[i] * by[j]) < 1e-12);
		}
	}
	rig_close(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_clock_may_begin_at_0),
		cmocka_unit_test(distrust_is_of_the_open_scan_too),
		cmocka_unit_test(each_message_must_pass_its_check),
		cmocka_unit_test(a_long_silence_of_the_speed_makes_a_new_start),
		cmocka_unit_test(a_speed_is_plausible_up_to_a_step),
		cmocka_unit_test(a_jump_is_a_fault_for_one_scan),
		cmocka_unit_test(one_jump_may_be_enough),
		cmocka_unit_test(every_speed_that_waits_counts),
		cmocka_unit_test(the_path_bends_from_a_speed_on),
		cmocka_unit_test(the_driver_overrides_from_a_share_on),
		cmocka_unit_test(nobody_drives_backwards),
		cmocka_unit_test(a_slow_lead_does_not_drive_off),
		cmocka_unit_test(an_uncertain_latency_is_in_the_covariance),
	};

	return cmocka_run_group_tests_name("estimator_edges", tests, NULL, NULL);
}
