/* SPDX-License-Identifier: MIT
 * Frames in, scene out: the end of a scan, staleness of each input alone, the ego speed, what the scene says, and frames
 * that must leave no trace.
 */
#include "rig.h"

#include <malloc.h>

static int calloc_fails;

static void *scarce_calloc(size_t n, size_t size)
{
	return calloc_fails ? NULL : calloc(n, size);
}
#define calloc scarce_calloc
#include "../daemon/estimator.c"
#undef calloc

static const char *const cars[] = {"generic", "toyota-tss-p"};

/* A car whose speed is in four messages, one of each wheel. */
static void open_wheels(struct rig *b)
{
#define WHEEL_SPEED " SG_ SPEED : 0|16@1+ (0.01,0) [0|163] \"m/s\" X\n"
	static const char dbc[] =
		"VERSION \"\"\n"
		"BO_ 256 FL: 2 CAR\n" WHEEL_SPEED "BO_ 257 FR: 2 CAR\n" WHEEL_SPEED
		"BO_ 258 RL: 2 CAR\n" WHEEL_SPEED "BO_ 259 RR: 2 CAR\n" WHEEL_SPEED
		"BO_ 260 LEAD: 4 CAR\n"
		" SG_ DIST : 0|16@1+ (0.01,0) [0|600] \"m\" X\n"
		" SG_ RATE : 16|16@1- (0.01,0) [-90|90] \"m/s\" X\n"
		"BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 10000;\n"
		"BA_DEF_DEF_ \"GenMsgCycleTime\" 20;\n";
	static const char conf[] =
		"[dbc]\nfile = test.dbc\n"
		"[bus]\ninterfaces = can0\n"
		"[signal ego_speed]\nfrom = FL.SPEED FR.SPEED RL.SPEED RR.SPEED\n"
		"[signal distance]\nfrom = LEAD.DIST\n"
		"[signal rel_speed]\nfrom = LEAD.RATE\n";

	rig_begin(b);
	b->map = drives_load_text(dbc, conf, &b->cfg);
	rig_start(b);
}

/* ---- the end of a scan ---------------------------------------------------------------------- */

static void the_last_slot_ends_a_scan(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	rig_cycles(&b, 4); /* the counters' start takes two */
	assert_int_equal(b.ended, 2);
	for (int i = 15; i >= 0; i--) {
		const struct bus_frame f = rig_slot(&b, i);

		assert_int_equal(rig_give(&b, &f), i == 0);
		assert_true(estimator_deadline(b.e) == (i == 0 ? CLOCK_NEVER : b.t_ns + 12 * MS));
	}
	assert_int_equal(rig_look(&b).scan, 3);
	assert_true(rig_look(&b).scan_ns == b.t_ns);
	rig_close(&b);
}

static void silence_ends_a_scan(void **state)
{
	struct rig b;

	(void)state;
	rig_open_in_scan(&b);
	const int64_t end = b.t_ns + 12 * MS;

	assert_int_equal(b.ended, 2);
	assert_true(estimator_deadline(b.e) == end);
	assert_int_equal(estimator_tick(b.e, end - 1), 0);
	assert_int_equal(estimator_tick(b.e, end), 1);
	assert_int_equal(estimator_tick(b.e, end + 1), 0);
	assert_int_equal(rig_look(&b).scan, 3);
	assert_true(rig_look(&b).scan_ns == end);

	/* the same, noticed by the next frame only */
	b.t_ns += 50 * MS;
	rig_say_scan(&b);
	b.t_ns += 30 * MS;
	const struct bus_frame f = rig_ego(&b, b.map->role[MAP_EGO_SPEED].message[0]);

	assert_int_equal(estimator_frame(b.e, &f), 1);
	assert_true(rig_look(&b).scan_ns == b.t_ns - 18 * MS);
	rig_close(&b);
}

static void a_slot_seen_twice_ends_a_scan(void **state)
{
	struct rig b;

	(void)state;
	rig_open_in_scan(&b);
	assert_int_equal(b.ended, 2);
	b.t_ns += 5 * MS;
	const struct bus_frame f = rig_slot(&b, 0);

	assert_int_equal(rig_give(&b, &f), 1);
	assert_true(rig_look(&b).scan_ns == b.t_ns);
	assert_true(estimator_deadline(b.e) == b.t_ns + 12 * MS); /* the next one has begun */
	/* the same frame once more is no third scan */
	assert_int_equal(rig_give(&b, &f), 0);
	assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_COUNTER], 1);
	rig_close(&b);
}

static void one_frame_is_a_scan_of_one_slot(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	rig_cycles(&b, 10);
	assert_int_equal(b.ended, 8);
	assert_true(estimator_deadline(b.e) == CLOCK_NEVER);
	assert_int_equal(estimator_tick(b.e, CLOCK_NEVER), 0);
	rig_close(&b);
}

/* ---- what is missing ------------------------------------------------------------------------ */

static void it_starts_when_everything_was_seen(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	s = rig_look(&b);
	assert_int_equal(s.fault, FAULT_BIT(STARTING));
	assert_true(!s.ego_valid && !s.lead_valid && s.scan == 0);
	b.silent = 1 << 15;
	assert_int_equal(rig_cycles(&b, 20).fault, FAULT_BIT(STARTING));
	b.silent = 0;
	s = rig_cycles(&b, 3);
	assert_int_equal(s.fault, 0);
	assert_true(s.ego_valid && s.lead_valid);
	rig_close(&b);

	rig_open(&b, "toyota-tss-p");
	b.deaf = 1;
	s = rig_cycles(&b, 20);
	assert_int_equal(s.fault, FAULT_BIT(STARTING));
	assert_true(!s.ego_valid && !s.lead_valid && s.scan == 18);
	rig_close(&b);
}

static void no_target_is_no_fault(void **state)
{
	struct rig b;

	(void)state;
	for (int i = 0; i < 2; i++) {
		rig_open(&b, cars[i]);
		b.lead = 0;
		const struct scene s = rig_cycles(&b, 50);

		assert_int_equal(s.fault, 0);
		assert_true(s.ego_valid && !s.lead_valid && s.lead_id == 0);
		assert_true(fabs(s.x[SCENE_EGO_SPEED] - 20) < 0.05);
		rig_close(&b);
	}
}

static void a_silent_car_is_stale(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	s = rig_cycles(&b, 20);
	const int64_t heard = b.t_ns;

	assert_int_equal(s.fault, 0);
	estimator_scene(b.e, heard + 72 * MS, &s); /* three periods of 24 ms */
	assert_int_equal(s.fault & FAULT_BIT(EGO_STALE), 0);
	assert_true(s.lead_valid);
	assert_int_equal(estimator_stale_ns(b.e, heard), heard + 72 * MS + 1);
	assert_int_equal(estimator_stale_ns(b.e, heard + 72 * MS), heard + 72 * MS + 1);
	assert_true(estimator_stale_ns(b.e, heard + 72 * MS + 1) > heard + 72 * MS + 1);
	estimator_scene(b.e, heard + 72 * MS + 1, &s);
	assert_int_equal(s.fault, FAULT_BIT(EGO_STALE));
	assert_true(!s.ego_valid && !s.lead_valid);
	b.deaf = 1;
	assert_int_equal(rig_cycles(&b, 20).fault, FAULT_BIT(EGO_STALE));
	b.deaf = 0;
	assert_int_equal(rig_cycle(&b).fault, 0);
	s = rig_cycles(&b, 8);
	assert_true(s.ego_valid && s.lead_valid && s.lead_id > 1);
	rig_close(&b);
}

/* When both fall silent each goes stale at the instant announced, not a nanosecond before. */
static void what_goes_stale_was_announced(void **state)
{
	static const char *const car[] = {"toyota-tss-p", "generic"};

	(void)state;
	for (size_t i = 0; i < sizeof(car) / sizeof(car[0]); i++) {
		uint32_t fault = 0;
		int64_t t_ns;
		struct rig b;
		struct scene s;

		rig_open(&b, car[i]);
		assert_int_equal(rig_cycles(&b, 20).fault, 0);
		while ((t_ns = estimator_stale_ns(b.e, b.t_ns)) != CLOCK_NEVER) {
			estimator_scene(b.e, t_ns - 1, &s);
			assert_int_equal(s.fault, fault);
			estimator_scene(b.e, t_ns, &s);
			assert_true(s.fault != fault && (s.fault & fault) == fault);
			fault = s.fault;
			b.t_ns = t_ns;
		}
		assert_int_equal(fault, FAULT_BIT(EGO_STALE) | FAULT_BIT(RADAR_STALE));
		rig_close(&b);
	}
}

static void a_silent_radar_is_stale(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	rig_cycles(&b, 20);
	b.silent = 0xFFFF;
	s = rig_cycles(&b, 3);
	assert_int_equal(s.fault, 0);
	assert_true(s.lead_valid);
	s = rig_cycle(&b);
	assert_int_equal(s.fault, FAULT_BIT(RADAR_STALE));
	assert_true(s.ego_valid && !s.lead_valid);
	b.silent = 0;
	s = rig_cycle(&b);
	assert_int_equal(s.fault, 0);
	assert_true(!s.lead_valid);
	s = rig_cycles(&b, 3);
	assert_true(s.lead_valid && s.lead_id == 2);
	rig_close(&b);
}

static void a_silent_slot_is_stale(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	rig_cycles(&b, 20);
	b.silent = 1 << 3;
	assert_int_equal(rig_cycles(&b, 3).fault, 0);
	const struct scene s = rig_cycle(&b);

	assert_int_equal(s.fault, FAULT_BIT(RADAR_STALE));
	assert_true(!s.lead_valid);
	b.silent = 0;
	assert_int_equal(rig_cycle(&b).fault, 0);
	rig_close(&b);
}

static void a_speed_of_four_messages_needs_all(void **state)
{
	struct rig b;

	(void)state;
	open_wheels(&b);
	assert_int_equal(rig_cycles(&b, 10).fault, 0);
	b.half_deaf = 1;
	assert_int_equal(rig_cycle(&b).fault, 0);
	const struct scene s = rig_cycle(&b);

	assert_int_equal(s.fault, FAULT_BIT(EGO_STALE));
	assert_false(s.ego_valid);
	b.half_deaf = 0;
	assert_int_equal(rig_cycle(&b).fault, 0);
	rig_close(&b);
}

static void frames_that_fail_their_check_are_a_fault(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	rig_cycles(&b, 20);
	for (int i = 1; i <= 3; i++) {
		struct bus_frame f = rig_slot(&b, 5);

		f.data[7] ^= 1;
		rig_give(&b, &f);
		assert_int_equal(rig_look(&b).fault, i < 3 ? 0 : FAULT_BIT(INPUT_CHECK));
	}
	assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_CRC], 3);
	assert_int_equal(rig_cycle(&b).fault, 0);
	rig_close(&b);
}

/* ---- the ego speed -------------------------------------------------------------------------- */

static void a_spike_leaves_no_trace(void **state)
{
	struct rig a, b;

	(void)state;
	rig_open(&a, "generic");
	rig_open(&b, "generic");
	for (int i = 0; i < 60; i++) {
		if (i == 40) { /* the same counters, but one value is not to be believed */
			const int m = b.map->role[MAP_EGO_SPEED].message[0];
			struct bus_frame f;

			a.t_ns += 1 * MS;
			b.t_ns += 1 * MS;
			rig_ego(&a, m);
			b.speed_mps = 22;
			f = rig_ego(&b, m);
			b.speed_mps = 20;
			rig_give(&b, &f);
		}
		const struct scene sa = rig_cycle(&a), sb = rig_cycle(&b);

		assert_memory_equal(&sa, &sb, sizeof(sa));
	}
	assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_IMPLAUSIBLE], 1);
	rig_close(&a);
	rig_close(&b);
}

static void a_jump_that_stays_is_believed_after_a_fault(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "generic");
	s = rig_cycles(&b, 20);
	assert_true(s.lead_valid);
	b.speed_mps = 25;
	s = rig_cycle(&b); /* three of them in here */
	assert_int_equal(s.fault, FAULT_BIT(IMPLAUSIBLE));
	assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_IMPLAUSIBLE], 3);
	s = rig_cycles(&b, 10);
	assert_int_equal(s.fault, 0);
	assert_true(fabs(s.x[SCENE_EGO_SPEED] - 25) < 0.05);
	assert_true(s.lead_valid && s.lead_id == 2);
	rig_close(&b);
}

/* The third jump comes later than the last plausible speed may be old: no reason to forget what was known. */
static void a_jump_in_late_frames_is_a_fault_too(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "generic");
	rig_cycles(&b, 20);
	b.speed_mps = 60;
	for (int i = 0; i < 3; i++) {
		b.t_ns += 25 * MS;
		const struct bus_frame f = rig_ego(&b, b.map->role[MAP_EGO_SPEED].message[0]);

		rig_give(&b, &f);
	}
	estimator_scene(b.e, b.t_ns, &s);
	assert_true(s.fault & FAULT_BIT(IMPLAUSIBLE));
	assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_IMPLAUSIBLE], 3);
	rig_close(&b);
}

static void hard_braking_is_plausible(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	rig_cycles(&b, 20);
	for (int i = 0; i < 30; i++) {
		b.speed_mps = 20 - 10 * 0.05 * i > 0 ? 20 - 10 * 0.05 * i : 0;
		b.rate_mps = 20 - b.speed_mps;
		assert_int_equal(rig_cycle(&b).fault, 0);
	}
	assert_int_equal(estimator_rejected(b.e)[SCENE_REJECT_IMPLAUSIBLE], 0);
	rig_close(&b);
}

/* The filter overshoots when the car stops; the scene does not. */
static void a_car_that_stopped_stands(void **state)
{
	struct rig b;
	int overshot = 0;

	(void)state;
	rig_open(&b, "generic");
	rig_cycles(&b, 20);
	while (b.speed_mps > 0) {
		b.speed_mps = b.speed_mps > 0.5 ? b.speed_mps - 0.5 : 0;
		rig_cycle(&b);
	}
	for (int i = 0; i < 40; i++) {
		const struct scene s = rig_cycle(&b);

		overshot += s.x[SCENE_EGO_SPEED] == 0 && s.x[SCENE_EGO_ACCEL] > 0;
		assert_true(s.x[SCENE_EGO_SPEED] > 0 || s.x[SCENE_EGO_ACCEL] >= 0);
	}
	assert_true(overshot > 0);
	rig_close(&b);
}

/* More ego speeds than wait for a scan. */
static void the_ego_is_followed_without_a_radar(void **state)
{
	struct rig b;
	struct scene s = {0};

	(void)state;
	rig_open(&b, "toyota-tss-p");
	b.silent = 0xFFFF;
	for (int i = 0; i < 60; i++) {
		b.speed_mps += 1 * 0.05;
		s = rig_cycle(&b);
	}
	assert_true(s.ego_valid && !s.lead_valid);
	assert_true(fabs(s.x[SCENE_EGO_SPEED] - b.speed_mps) < 0.1);
	assert_true(fabs(s.x[SCENE_EGO_ACCEL] - 1) < 0.3);
	assert_true(sqrt(s.cov[SCENE_EGO_SPEED][SCENE_EGO_SPEED]) < 0.06);
	rig_close(&b);
}

/* ---- the scene ------------------------------------------------------------------------------ */

static void the_scene_is_the_present(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "generic");
	b.rate_mps = -5;
	b.gap_m = 100;
	for (int i = 0; i < 40; i++) {
		s = rig_cycle(&b);
	}
	/* the frame says where the lead was 75 ms ago, and gap_m has moved on by 50 */
	assert_true(fabs(s.x[SCENE_HEADWAY] - (b.gap_m + 5 * 0.05 - 5 * 0.075)) < 0.05);
	assert_true(s.t_ns == b.t_ns && s.scan_ns == b.t_ns);
	assert_true(s.oldest_input_ns == 0);
	assert_true(s.lead_scans == 38 && s.existence > 0.85);
	estimator_scene(b.e, b.t_ns + 40 * MS, &s);
	assert_true(fabs(s.x[SCENE_HEADWAY] - (b.gap_m + 5 * 0.05 - 5 * 0.115)) < 0.05);
	assert_true(s.oldest_input_ns == 40 * MS);
	/* the ego speed of this moment is in it, not that of the scan's */
	assert_true(sqrt(s.cov[SCENE_EGO_SPEED][SCENE_EGO_SPEED]) < 0.06);
	b.lead = 0; /* seen no more: the object coasts, its last sight grows old */
	s = rig_cycle(&b);
	assert_true(s.lead_valid && s.oldest_input_ns == 50 * MS);
	rig_close(&b);

	/* a scan is as old as its first frame, the ego as its last */
	rig_open(&b, "toyota-tss-p");
	rig_cycles(&b, 10);
	for (int i = 0; i < 16; i++) {
		const struct bus_frame f = rig_slot(&b, i);

		rig_give(&b, &f);
		b.t_ns += 1 * MS;
	}
	rig_say_ego(&b);
	assert_true(rig_look(&b).oldest_input_ns == 16 * MS);
	b.t_ns += 1 * MS;
	rig_say_ego(&b);
	rig_say_scan(&b);
	b.t_ns += 20 * MS;
	rig_say_scan(&b);
	assert_true(rig_look(&b).oldest_input_ns == 20 * MS);
	rig_close(&b);
}

static void a_lead_that_comes_to_a_stop_goes_on_braking(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	b.gap_m = 100;
	rig_cycles(&b, 20);
	double lead_mps = 20;

	while (lead_mps > 0.6) {
		lead_mps -= 4 * 0.05;
		b.rate_mps = lead_mps - 20;
		b.gap_m = 100 + (lead_mps * lead_mps - 400) / -8 - (20 - lead_mps) / 4 * 20;
		rig_cycle(&b);
	}
	const struct scene s = rig_look(&b);

	assert_true(s.lead_valid && s.x[SCENE_LEAD_SPEED] < 0.5);
	assert_true(s.x[SCENE_LEAD_ACCEL] < -2);
	rig_close(&b);
}

static void the_far_future_is_no_scene(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "generic");
	rig_cycles(&b, 40);
	estimator_scene(b.e, b.t_ns + 1000000 * MS, &s);
	assert_true(!s.ego_valid && !s.lead_valid);
	assert_int_equal(s.fault, FAULT_BIT(EGO_STALE) | FAULT_BIT(RADAR_STALE));
	drives_assert_sound(&s);
	rig_close(&b);
}

static void the_driver_is_heard(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "generic");
	s = rig_look(&b);
	assert_true(s.driver_brake == -1 && s.driver_accel == -1);
	s = rig_cycles(&b, 10);
	assert_true(s.driver_brake == 0 && s.driver_accel == 0 && s.yaw_rate_radps == 0);
	b.value[MAP_DRIVER_BRAKE] = 1;
	b.value[MAP_YAW_RATE] = 0.1;
	s = rig_cycle(&b);
	assert_true(s.driver_brake == 1 && s.driver_accel == 0);
	assert_true(fabs(s.yaw_rate_radps - 0.1) < 1e-3);
	b.value[MAP_DRIVER_BRAKE] = 0;
	b.value[MAP_DRIVER_ACCEL] = 0.4; /* of its travel: following, not overriding */
	s = rig_cycle(&b);
	assert_true(s.driver_brake == 0 && s.driver_accel == 0);
	b.value[MAP_DRIVER_ACCEL] = 0.95;
	s = rig_cycle(&b);
	assert_true(s.driver_brake == 0 && s.driver_accel == 1);
	b.roles = 1u << MAP_EGO_SPEED; /* the rest is not available, which is no fault */
	s = rig_cycles(&b, 3);
	assert_true(s.driver_brake == -1 && s.driver_accel == -1 && s.yaw_rate_radps == 0);
	assert_int_equal(s.fault, 0);
	rig_close(&b);

	rig_open(&b, "toyota-tss-p");
	s = rig_cycles(&b, 10);
	assert_true(s.driver_brake == -1 && s.driver_accel == -1);
	rig_close(&b);
}

static void a_curve_shows_in_the_lateral_offset(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	b.value[MAP_YAW_RATE] = 0.05; /* 1/400 m: 1.1 m at 30 m */
	const struct scene s = rig_cycles(&b, 20);

	assert_true(s.lead_valid && fabs(s.lateral_m + 30.0 * 30 / 800) < 0.05);
	rig_close(&b);
}

/* How surely the lead is met: its existence, 0.9, times the probability that the bent path leads to it. */
static double met(struct rig *b, double yaw_sigma, double curve_sigma)
{
	b->cfg.perception_yaw_sigma = yaw_sigma;
	b->cfg.perception_curve_sigma = curve_sigma;
	const struct scene s = rig_cycles(b, 2);

	assert_true(s.lead_valid);
	return scene_lead_p(&s) / 0.9;
}

static void the_path_is_as_sure_as_what_bends_it(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "generic");
	rig_cycles(&b, 20);
	assert_true(met(&b, 0, 0.005) > 0.999);
	/* 0.005/m by the yaw rate at 20 m/s, 2.25 m at 30 m, and 0.3 m: within 1.6 m with 52 % */
	assert_true(fabs(met(&b, 0.1, 0) - 0.519) < 0.02);
	b.roles &= ~(1u << MAP_YAW_RATE); /* not available: the other figure counts */
	assert_true(met(&b, 0.1, 0) > 0.999);
	assert_true(fabs(met(&b, 0.1, 0.005) - 0.519) < 0.02);
	rig_close(&b);

	rig_open(&b, "generic"); /* at walking pace a yaw rate says little of the path */
	b.speed_mps = 1;
	rig_cycles(&b, 20);
	assert_true(met(&b, 0.1, 0) > 0.999);
	rig_close(&b);
}

/* ---- trust ---------------------------------------------------------------------------------- */

static void distrust_forgets_and_recovers(void **state)
{
	struct rig b;
	struct scene s;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	assert_true(rig_cycles(&b, 20).lead_valid);
	estimator_distrust(b.e);
	s = rig_look(&b);
	assert_int_equal(s.fault, FAULT_BIT(EGO_STALE) | FAULT_BIT(RADAR_STALE));
	assert_true(!s.ego_valid && !s.lead_valid);
	s = rig_cycles(&b, 2); /* of every message three good frames, the third is used */
	assert_int_equal(s.fault, FAULT_BIT(RADAR_STALE));
	s = rig_cycles(&b, 8);
	assert_int_equal(s.fault, 0);
	assert_true(s.lead_valid && s.lead_id == 2 && s.scan > 20);
	rig_close(&b);
}

static void spoil(struct rig *b, const struct bus_frame *good, int how)
{
	struct bus_frame f = *good;

	switch (how) {
	case 0:
		f.data[4] ^= 0x10;
		break;
	case 1:
		f.len = 7;
		break;
	case 2:
		f.flags = BUS_RTR;
		break;
	case 3:
		f.flags = BUS_ERR;
		break;
	case 4:
		f.id ^= 0x400;
		break;
	default:
		break;
	}
	assert_int_equal(estimator_frame(b->e, &f), 0);
}

/* A twin that also gets spoilt copies of every frame sees the same scene, bit for bit. */
static void spoilt_frames_leave_no_trace(void **state)
{
	struct rig a, b;
	int sent = 0;

	(void)state;
	rig_open(&a, "toyota-tss-p");
	rig_open(&b, "toyota-tss-p");
	rig_cycles(&a, 3);
	rig_cycles(&b, 3);
	for (int i = 0; i < 200; i++) {
		struct scene sa, sb;

		a.t_ns = b.t_ns += 25 * MS;
		const struct bus_frame ego = rig_ego(&a, a.map->role[MAP_EGO_SPEED].message[0]);

		spoil(&b, &ego, i % 5);
		rig_give(&a, &ego);
		rig_give(&b, &ego);
		for (int slot = 0; slot < 16 && i % 2; slot++, sent++) {
			const struct bus_frame f = rig_slot(&a, slot);

			spoil(&b, &f, i % 5);
			assert_int_equal(rig_give(&a, &f), rig_give(&b, &f));
			spoil(&b, &f, 5); /* repeated */
		}
		estimator_scene(a.e, a.t_ns, &sa);
		estimator_scene(b.e, b.t_ns, &sb);
		assert_memory_equal(&sa, &sb, sizeof(sa));
	}
	const uint64_t *r = estimator_rejected(b.e);

	assert_int_equal(r[SCENE_REJECT_COUNTER], sent);
	assert_int_equal(r[SCENE_REJECT_CRC], 20 * 17 + 20);
	assert_int_equal(r[SCENE_REJECT_LENGTH], 20 * 17 + 20);
	rig_close(&a);
	rig_close(&b);
}

static void any_frame_is_survived(void **state)
{
	struct rig b;
	struct noise r = {.seed = 9};
	struct scene s;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	rig_cycles(&b, 10);
	for (int i = 0; i < 300000; i++) {
		const int m = (int)(noise_uniform(&r) * b.map->n_messages);
		struct bus_frame f;

		b.t_ns += (int64_t)(noise_uniform(&r) * 5) * MS;
		encode_message(&b.encode, m, 0, b.value, NULL, b.t_ns, &f);
		for (int k = 1; k < 7; k++) { /* any content, as if the sender meant it */
			f.data[k] = (uint8_t)noise_bits(&r);
		}
		e2e_protect(
			&(struct e2e_config){b.map->message[m].check, b.map->message[m].msg, NULL},
			&b.encode.e2e[m], f.data);
		estimator_frame(b.e, &f);
		estimator_scene(b.e, b.t_ns, &s);
		drives_assert_sound(&s);
	}
	assert_true(estimator_rejected(b.e)[SCENE_REJECT_IMPLAUSIBLE] > 0);
	rig_close(&b);
}

static void memory_may_be_short(void **state)
{
	struct rig b;
	struct estimator *e;

	(void)state;
	rig_open(&b, "generic");
	calloc_fails = 1;
	assert_int_equal(estimator_open(&b.cfg, b.map, &e), -ENOMEM);
	calloc_fails = 0;
	rig_close(&b);
}

static void nothing_is_allocated_after_open(void **state)
{
	struct rig b;

	(void)state;
	rig_open(&b, "toyota-tss-p");
	const struct mallinfo2 before = mallinfo2();

	rig_cycles(&b, 100);
	estimator_distrust(b.e);
	const struct mallinfo2 after = mallinfo2();

	assert_int_equal(after.uordblks, before.uordblks);
	assert_int_equal(after.hblkhd, before.hblkhd);
	rig_close(&b);
	estimator_close(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_last_slot_ends_a_scan),
		cmocka_unit_test(silence_ends_a_scan),
		cmocka_unit_test(a_slot_seen_twice_ends_a_scan),
		cmocka_unit_test(one_frame_is_a_scan_of_one_slot),
		cmocka_unit_test(it_starts_when_everything_was_seen),
		cmocka_unit_test(no_target_is_no_fault),
		cmocka_unit_test(a_silent_car_is_stale),
		cmocka_unit_test(what_goes_stale_was_announced),
		cmocka_unit_test(a_silent_radar_is_stale),
		cmocka_unit_test(a_silent_slot_is_stale),
		cmocka_unit_test(a_speed_of_four_messages_needs_all),
		cmocka_unit_test(frames_that_fail_their_check_are_a_fault),
		cmocka_unit_test(a_spike_leaves_no_trace),
		cmocka_unit_test(a_jump_that_stays_is_believed_after_a_fault),
		cmocka_unit_test(a_jump_in_late_frames_is_a_fault_too),
		cmocka_unit_test(hard_braking_is_plausible),
		cmocka_unit_test(a_car_that_stopped_stands),
		cmocka_unit_test(the_ego_is_followed_without_a_radar),
		cmocka_unit_test(the_scene_is_the_present),
		cmocka_unit_test(a_lead_that_comes_to_a_stop_goes_on_braking),
		cmocka_unit_test(the_far_future_is_no_scene),
		cmocka_unit_test(the_driver_is_heard),
		cmocka_unit_test(a_curve_shows_in_the_lateral_offset),
		cmocka_unit_test(the_path_is_as_sure_as_what_bends_it),
		cmocka_unit_test(distrust_forgets_and_recovers),
		cmocka_unit_test(spoilt_frames_leave_no_trace),
		cmocka_unit_test(any_frame_is_survived),
		cmocka_unit_test(memory_may_be_short),
		cmocka_unit_test(nothing_is_allocated_after_open),
	};

	return cmocka_run_group_tests_name("estimator", tests, NULL, NULL);
}
