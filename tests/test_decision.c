/* SPDX-License-Identifier: MIT
 * decision: every rule of the table at its edges, memory (warning first, hold, release), what overrides it, the
 * deterministic rule, and evidence too thin to judge by.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include "decision_run.h"
#include "fault.h"

#define EPS 1e-9

static struct config defaults(void)
{
	struct config c = {
		.mc_horizon = 10,
		.brake_accel = -6,
		.brake_accel_partial = -4,
		.brake_delay = 0.1,
		.driver_reaction = 1,
		.driver_accel = -3.92,
		.radar_confirm_scans = 4,
		.decision_period = 0.05,
		.decision_p_warn = 0.05,
		.decision_p_defer = 0.05,
		.decision_p_driver = 0.5,
		.decision_p_nobody = 0.5,
		.decision_p_release = 0.05,
		.decision_partial_share = 0.1,
		.decision_release_evals = 4,
		.decision_release_closing = 0.3,
		.decision_release_max = 2,
		.decision_release_speed = 5.6,
		.decision_samples_min = 256,
		.decision_warn_evals = 1,
		.decision_brake_evals = 1,
		.decision_hold = 0.4,
		.decision_speed_min = 2.8,
		.decision_speed_max = 70,
		.decision_standstill = 0.2,
		.decision_fallback_ttc = 0.9,
	};

	return c;
}

static struct run fresh(enum stage_level level)
{
	struct run r = {.cfg = defaults(), .scene = approach(), .now_ns = START};

	r.st.level = level;
	r.st.entered_ns = START - CLOCK_NS_PER_S;
	return r;
}

static struct decision step_p(struct run *r, double defer, double driver, double nobody)
{
	struct mc_result res = result(defer, driver, nobody);

	return step(r, &res);
}

#define expect(d, l, c)                                                     \
	do {                                                                \
		struct decision got_ = (d);                                 \
		assert_string_equal(level_name[got_.level], level_name[l]); \
		assert_string_equal(cause_name[got_.cause], cause_name[c]); \
	} while (0)

static void test_futures(void **arg)
{
	struct config cfg = defaults();
	struct model_future f[MC_FUTURES_MAX];

	(void)arg;
	decision_futures(&cfg, f);
	assert_true(f[FUTURE_NOW].accel_cmd_mps2 == -6.0f && f[FUTURE_NOW].extra_delay_s == 0);
	assert_true(f[FUTURE_DEFER].accel_cmd_mps2 == -6.0f);
	assert_true(f[FUTURE_DEFER].extra_delay_s == 0.05f);
	assert_true(f[FUTURE_DRIVER].accel_cmd_mps2 == -3.92f);
	assert_true(f[FUTURE_DRIVER].extra_delay_s == 1.0f);
	assert_true(f[FUTURE_NOBODY].accel_cmd_mps2 == 0);
	assert_true(f[FUTURE_NOBODY].extra_delay_s >= 10.0f);
}

/* Each row of the rule at and just above each of its thresholds, from each level that matters. */
static void test_rule(void **arg)
{
	static const struct {
		enum stage_level from;
		int partial;
		double defer, driver, nobody;
		enum stage_level to;
	} row[] = {
		{LEVEL_NONE, 0, 0, 0, 0, LEVEL_NONE},
		{LEVEL_NONE, 0, 0, 0.05, 0.5 + EPS, LEVEL_NONE},
		{LEVEL_NONE, 0, 0, 0.05 + EPS, 0.5, LEVEL_NONE},
		{LEVEL_NONE, 0, 0, 0.05 + EPS, 0.5 + EPS, LEVEL_WARN},
		{LEVEL_NONE, 0, 1, 1, 1, LEVEL_WARN}, /* never braking without a warning first */
		{LEVEL_NONE, 1, 1, 1, 1, LEVEL_WARN},
		{LEVEL_WARN, 0, 0.05, 1, 1, LEVEL_WARN},
		{LEVEL_WARN, 0, 0.05 + EPS, 0.5, 1, LEVEL_WARN},
		{LEVEL_WARN, 0, 0.05 + EPS, 0.5 + EPS, 0.5, LEVEL_WARN},
		{LEVEL_WARN, 0, 0.05 + EPS, 0.5 + EPS, 0.5 + EPS, LEVEL_FULL},
		{LEVEL_WARN, 1, 0.005, 1, 1, LEVEL_WARN},
		{LEVEL_WARN, 1, 0.005 + EPS, 0.5, 1, LEVEL_WARN},
		{LEVEL_WARN, 1, 0.005 + EPS, 0.5 + EPS, 0.5, LEVEL_WARN},
		{LEVEL_WARN, 1, 0.005 + EPS, 0.5 + EPS, 0.5 + EPS, LEVEL_PARTIAL},
		{LEVEL_WARN, 0, 0.005 + EPS, 0.5 + EPS, 0.5 + EPS, LEVEL_WARN},
		{LEVEL_WARN, 1, 0.05 + EPS, 0.5 + EPS, 0.5 + EPS, LEVEL_FULL},
		{LEVEL_PARTIAL, 1, 0.05 + EPS, 0.5 + EPS, 0.5 + EPS, LEVEL_FULL},
		{LEVEL_PARTIAL, 1, 0, 0.1, 1, LEVEL_PARTIAL}, /* the rule alone never lowers */
		{LEVEL_FULL, 0, 0, 0.1, 1, LEVEL_FULL},
		{LEVEL_FULL, 1, 0.01, 1, 1, LEVEL_FULL},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct run r = fresh(row[i].from);
		struct decision d;

		r.cfg.decision_partial = row[i].partial;
		d = step_p(&r, row[i].defer, row[i].driver, row[i].nobody);
		if (d.level != row[i].to) {
			fail_msg("row %zu: %s, not %s", i, level_name[d.level],
				 level_name[row[i].to]);
		}
		assert_int_equal(d.changed, row[i].to != row[i].from);
		assert_int_equal(r.st.level, d.level);
		assert_int_equal(r.st.entered[d.level], d.changed);
	}
}

/* Entering looks at the lower ends, releasing at the upper end; the estimate itself decides nothing. */
static void test_interval_ends(void **arg)
{
	struct run r = fresh(LEVEL_WARN);
	struct mc_result res = result(0.06, 1, 1);

	(void)arg;
	res.risk[FUTURE_DEFER].lo = 0.05;
	expect(step(&r, &res), LEVEL_WARN, CAUSE_RISK);
	res.risk[FUTURE_DEFER].lo = 0.05 + EPS;
	res.risk[FUTURE_DEFER].p = 0;
	expect(step(&r, &res), LEVEL_FULL, CAUSE_RISK);

	r = fresh(LEVEL_FULL);
	r.scene.x[SCENE_LEAD_SPEED] = 20;
	res = result(0, 0, 0);
	res.risk[FUTURE_DRIVER].hi = res.risk[FUTURE_NOBODY].hi = 0.05;
	for (int i = 0; i < 20; i++) {
		expect(step(&r, &res), LEVEL_FULL, CAUSE_HOLD);
	}
	res.risk[FUTURE_NOBODY].hi = 0.05 - EPS;
	res.risk[FUTURE_NOBODY].p = 1;
	for (int i = 0; i < 3; i++) {
		expect(step(&r, &res), LEVEL_FULL, CAUSE_HOLD);
	}
	expect(step(&r, &res), LEVEL_NONE, CAUSE_RELEASED);
}

/* Either future that is safe again releases; neither does alone above the threshold. */
static void test_release_by_either_future(void **arg)
{
	static const struct {
		double driver, nobody;
		int releases;
	} row[] = {
		{0.05, 0.05, 0},
		{0.05 - EPS, 0.4, 1},
		{1, 0.05 - EPS, 1},
		{0.05, 0.4, 0},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct run r = fresh(LEVEL_WARN);
		struct decision d = {0};

		r.scene.x[SCENE_LEAD_SPEED] = 20;
		for (int k = 0; k < 4; k++) {
			d = step_p(&r, 0, row[i].driver, row[i].nobody);
		}
		expect(d, row[i].releases ? LEVEL_NONE : LEVEL_WARN,
		       row[i].releases ? CAUSE_RELEASED : CAUSE_HOLD);
	}
}

/* Below decision.release_speed a request waits for P(nobody) alone; a warning does not. */
static void test_slow_cars_are_held(void **arg)
{
	static const struct {
		enum stage_level level;
		double speed, nobody;
		int releases;
	} row[] = {
		{LEVEL_FULL, 5.59, 0.4, 0},   {LEVEL_FULL, 5.6, 0.4, 1},
		{LEVEL_FULL, 5.59, 0.04, 1},  {LEVEL_PARTIAL, 5.59, 0.4, 0},
		{LEVEL_PARTIAL, 5.6, 0.4, 1}, {LEVEL_WARN, 5.59, 0.4, 1},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct run r = fresh(row[i].level);
		struct decision d = {0};

		r.scene.x[SCENE_EGO_SPEED] = r.scene.x[SCENE_LEAD_SPEED] = row[i].speed;
		for (int k = 0; k < 20 && d.cause != CAUSE_RELEASED; k++) {
			d = step_p(&r, 0, 0, row[i].nobody);
		}
		expect(d, row[i].releases ? LEVEL_NONE : row[i].level,
		       row[i].releases ? CAUSE_RELEASED : CAUSE_HOLD);
	}
}

/* A risk that is not a number enters nothing and releases nothing. */
static void test_nan_is_no_risk_and_no_safety(void **arg)
{
	struct run r = fresh(LEVEL_FULL);

	(void)arg;
	r.scene.x[SCENE_LEAD_SPEED] = 20;
	for (int i = 0; i < 20; i++) {
		expect(step_p(&r, NAN, NAN, NAN), LEVEL_FULL, CAUSE_HOLD);
	}
	r = fresh(LEVEL_NONE);
	expect(step_p(&r, NAN, NAN, NAN), LEVEL_NONE, CAUSE_NO_EVIDENCE);
}

static void test_warning_then_full_then_release(void **arg)
{
	struct run r = fresh(LEVEL_NONE);
	struct decision d;

	(void)arg;
	expect(step_p(&r, 0, 0, 0.2), LEVEL_NONE, CAUSE_NONE);
	d = step_p(&r, 1, 1, 1);
	expect(d, LEVEL_WARN, CAUSE_RISK);
	assert_true(d.changed && d.accel_mps2 == 0);
	assert_int_equal(r.st.warned_ns, START + 50 * MS);
	d = step_p(&r, 1, 1, 1); /* the next evaluation at the earliest */
	expect(d, LEVEL_FULL, CAUSE_RISK);
	assert_true(d.changed && d.accel_mps2 == -6);
	assert_int_equal(r.st.entered_ns, START + 100 * MS);
	assert_int_equal(r.st.warned_ns, START + 50 * MS);
	d = step_p(&r, 1, 1, 1);
	assert_false(d.changed);
	r.scene.x[SCENE_LEAD_SPEED] = 20;
	for (int i = 0; i < 6;
	     i++) { /* calm at once, but 0.4 s after entry is the 8th evaluation */
		expect(step_p(&r, 0, 0, 0), LEVEL_FULL, CAUSE_HOLD);
	}
	d = step_p(&r, 0, 0, 0);
	expect(d, LEVEL_NONE, CAUSE_RELEASED);
	assert_true(d.changed && d.accel_mps2 == 0);
	expect(step_p(&r, 0, 0, 0), LEVEL_NONE, CAUSE_NONE);
	assert_int_equal(r.st.entered[LEVEL_WARN], 1);
	assert_int_equal(r.st.entered[LEVEL_FULL], 1);
	assert_int_equal(r.st.entered[LEVEL_NONE], 1);
	expect(step_p(&r, 1, 1, 1), LEVEL_WARN, CAUSE_RISK); /* a new danger warns first again */
}

static void test_partial_accel(void **arg)
{
	struct run r = fresh(LEVEL_WARN);
	struct decision d;

	(void)arg;
	r.cfg.decision_partial = 1;
	d = step_p(&r, 0.01, 1, 1);
	expect(d, LEVEL_PARTIAL, CAUSE_RISK);
	assert_true(d.accel_mps2 == -4);
}

static void test_hold_edge(void **arg)
{
	struct run r = fresh(LEVEL_FULL);

	(void)arg;
	r.scene.x[SCENE_LEAD_SPEED] = 20;
	r.cfg.decision_release_evals = 1;
	r.st.entered_ns = START - 400 * MS + 1;
	expect(step_p(&r, 0, 0, 0), LEVEL_FULL, CAUSE_HOLD);
	r = fresh(LEVEL_FULL);
	r.scene.x[SCENE_LEAD_SPEED] = 20;
	r.cfg.decision_release_evals = 1;
	r.st.entered_ns = START - 400 * MS;
	expect(step_p(&r, 0, 0, 0), LEVEL_NONE, CAUSE_RELEASED);
}

static void test_one_alarm_restarts_the_count(void **arg)
{
	struct run r = fresh(LEVEL_WARN);

	(void)arg;
	r.scene.x[SCENE_LEAD_SPEED] = 20;
	for (int i = 0; i < 3; i++) {
		expect(step_p(&r, 0, 0, 0), LEVEL_WARN, CAUSE_HOLD);
	}
	expect(step_p(&r, 0, 0.05, 0.05), LEVEL_WARN, CAUSE_HOLD);
	for (int i = 0; i < 3; i++) {
		expect(step_p(&r, 0, 0, 0), LEVEL_WARN, CAUSE_HOLD);
	}
	expect(step_p(&r, 0, 0, 0), LEVEL_NONE, CAUSE_RELEASED);
}

static void test_no_release_while_closing(void **arg)
{
	struct run r = fresh(LEVEL_FULL);

	(void)arg;
	r.cfg.decision_release_closing = 0.25;
	r.scene.x[SCENE_LEAD_SPEED] = 19.5;
	for (int i = 0; i < 10; i++) {
		expect(step_p(&r, 0, 0, 0), LEVEL_FULL, CAUSE_HOLD);
	}
	r.scene.x[SCENE_LEAD_SPEED] = 19.75; /* at the limit */
	expect(step_p(&r, 0, 0, 0), LEVEL_NONE, CAUSE_RELEASED);
}

static void test_standstill(void **arg)
{
	struct run r = fresh(LEVEL_FULL);

	(void)arg;
	r.scene.x[SCENE_EGO_SPEED] = 0.2;
	expect(step_p(&r, 1, 1, 1), LEVEL_FULL, CAUSE_RISK); /* below speed_min: goes on */
	r.scene.x[SCENE_EGO_SPEED] = 0.2 - EPS;
	expect(step_p(&r, 1, 1, 1), LEVEL_NONE, CAUSE_STANDSTILL);
	expect(step_p(&r, 1, 1, 1), LEVEL_NONE, CAUSE_STANDSTILL);
}

static void test_driver_override(void **arg)
{
	struct run r = fresh(LEVEL_FULL);

	(void)arg;
	r.scene.driver_accel = 1;
	expect(step_p(&r, 1, 1, 1), LEVEL_WARN, CAUSE_DRIVER);
	expect(step_p(&r, 1, 1, 1), LEVEL_WARN, CAUSE_DRIVER);
	r.scene.driver_accel = 0;
	expect(step_p(&r, 1, 1, 1), LEVEL_FULL, CAUSE_RISK);
	r.scene.driver_accel = 1;
	expect(step_p(&r, 0, 0, 0), LEVEL_WARN, CAUSE_DRIVER); /* whatever the risk */
	r = fresh(LEVEL_NONE);
	r.scene.driver_accel = 1;
	expect(step_p(&r, 0, 1, 1), LEVEL_WARN, CAUSE_RISK); /* a warning stays possible */
	r = fresh(LEVEL_WARN);
	r.scene.driver_accel = 1;
	expect(step_p(&r, 0, 1, 1), LEVEL_WARN, CAUSE_RISK); /* there is nothing to override */
	r = fresh(LEVEL_FULL);
	r.scene.driver_accel = 0;
	r.scene.driver_brake = 1; /* a braking driver is supported, not obeyed */
	expect(step_p(&r, 1, 1, 1), LEVEL_FULL, CAUSE_RISK);
}

static void test_speed_range(void **arg)
{
	static const struct {
		double speed;
		enum stage_level from, to;
		enum decision_cause cause;
	} row[] = {
		{2.8, LEVEL_NONE, LEVEL_WARN, CAUSE_RISK},
		{2.8 - EPS, LEVEL_NONE, LEVEL_NONE, CAUSE_INHIBITED},
		{2.8 - EPS, LEVEL_WARN, LEVEL_WARN, CAUSE_INHIBITED},
		{2.8, LEVEL_WARN, LEVEL_FULL, CAUSE_RISK},
		{2.8 - EPS, LEVEL_FULL, LEVEL_FULL, CAUSE_RISK},
		{70, LEVEL_NONE, LEVEL_WARN, CAUSE_RISK},
		{70 + EPS, LEVEL_NONE, LEVEL_NONE, CAUSE_INHIBITED},
		{70 + EPS, LEVEL_WARN, LEVEL_WARN, CAUSE_INHIBITED},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct run r = fresh(row[i].from);

		r.scene.x[SCENE_EGO_SPEED] = row[i].speed;
		expect(step_p(&r, 1, 1, 1), row[i].to, row[i].cause);
	}
}

/* States that allow no request end one at once, whatever the hold says; DEGRADED does not. */
static void test_inhibited(void **arg)
{
	(void)arg;
	for (int i = 0; i < FAULTS; i++) {
		struct run r = fresh(LEVEL_FULL);
		int allowed = fault_table[i].state == STATE_DEGRADED;

		r.fault = 1u << i;
		r.st.entered_ns = START;
		expect(step_p(&r, 1, 1, 1), allowed ? LEVEL_FULL : LEVEL_NONE,
		       allowed ? CAUSE_RISK : CAUSE_INHIBITED);
	}
	struct run r = fresh(LEVEL_FULL);

	r.scene.ego_valid = 0;
	expect(step_p(&r, 1, 1, 1), LEVEL_NONE, CAUSE_INHIBITED);
}

static void test_thin_evidence(void **arg)
{
	struct mc_result res = result(1, 1, 1);
	struct run r = fresh(LEVEL_NONE);

	(void)arg;
	expect(step(&r, NULL), LEVEL_NONE, CAUSE_NO_EVIDENCE); /* no result */
	res.n = 255;
	expect(step(&r, &res), LEVEL_NONE, CAUSE_NO_EVIDENCE);
	res.n = 256;
	r.scene.lead_scans = 3;
	expect(step(&r, &res), LEVEL_NONE, CAUSE_NO_EVIDENCE);
	r.scene.lead_scans = 4;
	r.scene.lead_valid = 0;
	expect(step(&r, &res), LEVEL_NONE, CAUSE_NO_LEAD);
	r.scene.lead_valid = 1;
	r.cfg.decision_samples_min = 257;
	expect(step(&r, &res), LEVEL_NONE, CAUSE_NO_EVIDENCE);
	r.cfg.decision_samples_min = 256;
	expect(step(&r, &res), LEVEL_WARN, CAUSE_RISK);
}

/* A threshold within the interval: neither a reason to warn nor the all-clear, as long as no other condition rules the
 * warning out. */
static void test_open_interval(void **arg)
{
	static const struct {
		double driver_lo, driver_hi, nobody_lo, nobody_hi;
		enum decision_cause cause;
	} row[] = {
		{0.04, 0.05, 1, 1, CAUSE_NONE},
		{0.04, 0.05 + EPS, 1, 1, CAUSE_NO_EVIDENCE},
		{0.04, 0.06, 0, 0.5, CAUSE_NONE},
		{0.04, 0.06, 0, 0.5 + EPS, CAUSE_NO_EVIDENCE},
		{0.06, 0.07, 0, 0.5 + EPS, CAUSE_NO_EVIDENCE},
		{0.06, 0.07, 0.5 + EPS, 1, CAUSE_RISK},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct run r = fresh(LEVEL_NONE);
		struct mc_result res = result(0, 0, 0);

		res.risk[FUTURE_DRIVER].lo = row[i].driver_lo;
		res.risk[FUTURE_DRIVER].hi = row[i].driver_hi;
		res.risk[FUTURE_NOBODY].lo = row[i].nobody_lo;
		res.risk[FUTURE_NOBODY].hi = row[i].nobody_hi;
		expect(step(&r, &res), row[i].cause == CAUSE_RISK ? LEVEL_WARN : LEVEL_NONE,
		       row[i].cause);
	}
	/* what fires is not put in doubt by what might */
	struct run r = fresh(LEVEL_WARN);
	struct mc_result res = result(0, 1, 1);

	res.risk[FUTURE_DEFER].hi = 1;
	expect(step(&r, &res), LEVEL_WARN, CAUSE_RISK);
}

static void test_presets(void **arg)
{
	static const double level[] = {0.02, 0.05, 0.01, 0.001};

	(void)arg;
	for (int i = 0; i < 4; i++) {
		struct run r = fresh(LEVEL_WARN);

		r.cfg.decision_p_defer = 0.02;
		r.cfg.decision_preset = i;
		expect(step_p(&r, level[i], 1, 1), LEVEL_WARN, CAUSE_RISK);
		expect(step_p(&r, level[i] + EPS, 1, 1), LEVEL_FULL, CAUSE_RISK);
		r = fresh(LEVEL_WARN);
		r.cfg.decision_p_defer = 0.02;
		r.cfg.decision_preset = i;
		r.cfg.decision_partial = 1;
		expect(step_p(&r, level[i] / 10, 1, 1), LEVEL_WARN, CAUSE_RISK);
		expect(step_p(&r, level[i] / 10 + EPS, 1, 1), LEVEL_PARTIAL, CAUSE_RISK);
	}
}

static void test_debounce(void **arg)
{
	struct run r = fresh(LEVEL_NONE);

	(void)arg;
	r.cfg.decision_warn_evals = 2;
	r.cfg.decision_brake_evals = 3;
	expect(step_p(&r, 0, 1, 1), LEVEL_NONE, CAUSE_DEBOUNCE);
	expect(step_p(&r, 0, 0, 1), LEVEL_NONE, CAUSE_NONE); /* not in a row */
	expect(step_p(&r, 0, 1, 1), LEVEL_NONE, CAUSE_DEBOUNCE);
	expect(step_p(&r, 0, 1, 1), LEVEL_WARN, CAUSE_RISK);
	expect(step_p(&r, 1, 1, 1), LEVEL_WARN, CAUSE_DEBOUNCE);
	expect(step_p(&r, 1, 1, 1), LEVEL_WARN, CAUSE_DEBOUNCE);
	expect(step_p(&r, 1, 1, 1), LEVEL_FULL, CAUSE_RISK);
	expect(step_p(&r, 0, 1, 1), LEVEL_FULL, CAUSE_HOLD);
	expect(step_p(&r, 1, 1, 1), LEVEL_FULL,
	       CAUSE_RISK); /* entered, it is not asked for again */
	r = fresh(LEVEL_NONE);
	r.cfg.decision_warn_evals = 1;
	r.cfg.decision_brake_evals = 2;
	expect(step_p(&r, 1, 1, 1), LEVEL_WARN,
	       CAUSE_DEBOUNCE); /* what counts for full counts for less */
	expect(step_p(&r, 1, 1, 1), LEVEL_FULL, CAUSE_RISK);
}

/* Where nothing brakes although it should, closing does not end: neither may the request stay for ever. */
static void test_release_while_closing(void **arg)
{
	struct run r = fresh(LEVEL_FULL);

	(void)arg;
	for (int i = 0; i < 40; i++) {
		expect(step_p(&r, 0, 0, 0), LEVEL_FULL, CAUSE_HOLD);
	}
	expect(step_p(&r, 0, 0, 0), LEVEL_NONE, CAUSE_RELEASED); /* 2 s after the first */
}

/* Losing the lead while braking keeps the brakes on for the hold and the calm evaluations, no longer. */
static void test_lead_lost_while_braking(void **arg)
{
	(void)arg;
	for (enum stage_level l = LEVEL_PARTIAL; l <= LEVEL_FULL; l++) {
		struct run r = fresh(l);

		r.scene.lead_valid = 0;
		for (int i = 0; i < 40; i++) { /* 2 s, decision.release_max */
			expect(step(&r, NULL), l, CAUSE_HOLD);
		}
		expect(step(&r, NULL), LEVEL_NONE, CAUSE_RELEASED);
		expect(step(&r, NULL), LEVEL_NONE, CAUSE_NO_LEAD);
	}
}

/* Nobody is braked for a warning: it ends as usual. */
static void test_lead_lost_while_warning(void **arg)
{
	struct run r = fresh(LEVEL_WARN);

	(void)arg;
	r.scene.lead_valid = 0;
	for (int i = 0; i < 3; i++) {
		expect(step(&r, NULL), LEVEL_WARN, CAUSE_HOLD);
	}
	expect(step(&r, NULL), LEVEL_NONE, CAUSE_RELEASED);
}

/* gap, ego and lead speed, lead acceleration -> level by the deterministic rule */
static void test_fallback(void **arg)
{
	static const struct {
		double gap, ego, lead, lead_accel;
		enum stage_level from, to;
	} row[] = {
		{9.1, 20, 10, 0, LEVEL_WARN, LEVEL_WARN}, /* 0.91 s */
		{8.9, 20, 10, 0, LEVEL_WARN, LEVEL_FULL}, /* 0.89 s */
		{8.9, 20, 10, 0, LEVEL_NONE, LEVEL_WARN}, /* a warning comes first */
		{37.9, 20, 0, 0, LEVEL_NONE, LEVEL_WARN}, /* 1.895 s, 5.6 m/s2 needed */
		{38.1, 20, 0, 0, LEVEL_NONE, LEVEL_NONE}, /* 1.905 s */
		{15, 20, 10, 0, LEVEL_NONE, LEVEL_NONE},  /* 1.5 s, but 3.6 m/s2 are enough */
		{15, 20, 10, -1, LEVEL_NONE, LEVEL_WARN}, /* and no longer where the lead brakes */
		{15, 20, 10, -5, LEVEL_NONE, LEVEL_WARN}, /* as hard as no driver does */
		{15, 20, 10, 1, LEVEL_NONE, LEVEL_NONE},  /* its acceleration is not counted on */
		{0.8, 5, 4, 0, LEVEL_WARN, LEVEL_WARN},   /* 0.8 s, 0.7 m/s2: stop and go */
		{0.2, 5, 4, 0, LEVEL_WARN, LEVEL_FULL},
		{0.05, 5, 4, 0, LEVEL_WARN, LEVEL_FULL},  /* less room than the delay takes */
		{0.05, 5, 4, -5, LEVEL_WARN, LEVEL_FULL}, /* both room and reserve below zero */
		{5, 20, 20, -9, LEVEL_NONE, LEVEL_NONE},  /* not closing */
		{5, 20, 21, -9, LEVEL_NONE, LEVEL_NONE},
		{0, 20, 20, -9, LEVEL_WARN, LEVEL_WARN},
		{0.0005, 20, 19.9995, -9, LEVEL_WARN, LEVEL_FULL}, /* by 1 mm/s, at least */
		{9, 20, 10, 0, LEVEL_WARN, LEVEL_WARN},            /* at the limits, 0.9 s */
		{38, 20, 0, 0, LEVEL_NONE, LEVEL_NONE},            /* and 1.9 s */
		{12.5, 20, 10, 1, LEVEL_NONE, LEVEL_WARN},         /* 4.3 m/s2, 3.3 if it went on */
		{1.5, 20, 19, -3, LEVEL_NONE, LEVEL_NONE},         /* 0.4 of 0.9 m/s2 left */
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct run r = fresh(row[i].from);
		struct decision d;

		r.fault = FAULT_BIT(MC_ERROR);
		r.scene.x[SCENE_HEADWAY] = row[i].gap;
		r.scene.x[SCENE_EGO_SPEED] = row[i].ego;
		r.scene.x[SCENE_LEAD_SPEED] = row[i].lead;
		r.scene.x[SCENE_LEAD_ACCEL] = row[i].lead_accel;
		d = step(&r, NULL);
		if (d.level != row[i].to) {
			fail_msg("row %zu: %s, not %s", i, level_name[d.level],
				 level_name[row[i].to]);
		}
		if (d.level > row[i].from) {
			assert_int_equal(d.cause, CAUSE_FALLBACK);
		}
	}
}

/* The deterministic rule stands in for missing risk in DEGRADED alone, and never overrules a result. */
/* As much deceleration as the driver's is not more. */
static void test_fallback_leaves_to_the_driver_what_is_enough(void **arg)
{
	struct run r = fresh(LEVEL_NONE);

	(void)arg;
	r.fault = FAULT_BIT(MC_ERROR);
	r.cfg.driver_accel = -4;
	r.cfg.brake_delay = 0;
	r.scene.x[SCENE_HEADWAY] = 8;
	r.scene.x[SCENE_LEAD_SPEED] = 12;
	expect(step(&r, NULL), LEVEL_NONE, CAUSE_FALLBACK);
	r.scene.x[SCENE_HEADWAY] = 8 - EPS;
	expect(step(&r, NULL), LEVEL_WARN, CAUSE_FALLBACK);
}

static void test_fallback_only_when_degraded_and_blind(void **arg)
{
	struct mc_result thin = result(0, 0, 0);
	struct run r = fresh(LEVEL_WARN);

	(void)arg;
	r.scene.x[SCENE_HEADWAY] = 2;
	expect(step(&r, NULL), LEVEL_WARN, CAUSE_HOLD);
	r.fault = FAULT_BIT(MC_LATE);
	expect(step_p(&r, 0, 1, 1), LEVEL_WARN, CAUSE_RISK);
	thin.n = 255;
	expect(step(&r, &thin), LEVEL_FULL, CAUSE_FALLBACK);
	r = fresh(LEVEL_WARN);
	r.scene.x[SCENE_HEADWAY] = 2;
	r.fault = FAULT_BIT(MC_LATE) | FAULT_BIT(EGO_STALE);
	expect(step(&r, NULL), LEVEL_NONE, CAUSE_INHIBITED);
	r = fresh(LEVEL_WARN);
	r.scene.x[SCENE_HEADWAY] = 2;
	r.fault = FAULT_BIT(MC_LATE);
	r.scene.lead_scans = 3;
	expect(step(&r, NULL), LEVEL_WARN, CAUSE_HOLD);
}

static void test_fallback_releases(void **arg)
{
	struct run r = fresh(LEVEL_FULL);

	(void)arg;
	r.fault = FAULT_BIT(MC_ERROR);
	r.scene.x[SCENE_LEAD_SPEED] = 20;
	for (int i = 0; i < 3; i++) {
		expect(step(&r, NULL), LEVEL_FULL, CAUSE_HOLD);
	}
	expect(step(&r, NULL), LEVEL_NONE, CAUSE_RELEASED);
	expect(step(&r, NULL), LEVEL_NONE, CAUSE_FALLBACK);
}

static void test_names(void **arg)
{
	(void)arg;
	for (int i = 0; i < LEVELS; i++) {
		assert_non_null(level_name[i]);
	}
	for (int i = 0; i < CAUSES; i++) {
		assert_non_null(cause_name[i]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_futures),
		cmocka_unit_test(test_rule),
		cmocka_unit_test(test_interval_ends),
		cmocka_unit_test(test_release_by_either_future),
		cmocka_unit_test(test_slow_cars_are_held),
		cmocka_unit_test(test_nan_is_no_risk_and_no_safety),
		cmocka_unit_test(test_warning_then_full_then_release),
		cmocka_unit_test(test_partial_accel),
		cmocka_unit_test(test_hold_edge),
		cmocka_unit_test(test_one_alarm_restarts_the_count),
		cmocka_unit_test(test_no_release_while_closing),
		cmocka_unit_test(test_standstill),
		cmocka_unit_test(test_driver_override),
		cmocka_unit_test(test_speed_range),
		cmocka_unit_test(test_inhibited),
		cmocka_unit_test(test_thin_evidence),
		cmocka_unit_test(test_open_interval),
		cmocka_unit_test(test_presets),
		cmocka_unit_test(test_debounce),
		cmocka_unit_test(test_release_while_closing),
		cmocka_unit_test(test_lead_lost_while_braking),
		cmocka_unit_test(test_lead_lost_while_warning),
		cmocka_unit_test(test_fallback),
		cmocka_unit_test(test_fallback_leaves_to_the_driver_what_is_enough),
		cmocka_unit_test(test_fallback_only_when_degraded_and_blind),
		cmocka_unit_test(test_fallback_releases),
		cmocka_unit_test(test_names),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
