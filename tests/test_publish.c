/* SPDX-License-Identifier: MIT
 * publish: what is packed comes out again through the contract and passes its check; what is unknown is "not available",
 * never "no risk"; figures saturate, round to the careful side, expire; and the words say the same.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <math.h>
#include <string.h>
#include "clock.h"
#include "codec.h"
#include "e2e.h"
#include "publish.h"

#define MS  CLOCK_NS_PER_MS
#define NOW (50 * CLOCK_NS_PER_S)

static struct publish *opened(const char *key, const char *value)
{
	char assignment[64], err[200];
	struct publish *p = NULL;
	struct config cfg;

	config_defaults(&cfg);
	if (key) {
		snprintf(assignment, sizeof(assignment), "bus.%s=%s", key, value);
		assert_int_equal(config_set(&cfg, assignment, err, sizeof(err)), 0);
	}
	assert_int_equal(publish_open(&cfg, &p), 0);
	return p;
}

/* Braking fully on an evaluation whose scan was 30 ms ago. */
static struct publish_in braking(void)
{
	struct publish_in in = {
		.state = STATE_BRAKE,
		.dec = {.level = LEVEL_FULL, .cause = CAUSE_RISK, .accel_mps2 = -6},
		.have_scan = 1,
		.scan_ns = NOW - 30 * MS,
		.have_result = 1,
		.scene = {.ego_valid = 1, .lead_valid = 1, .x = {30, 20, 0, 15, 0}},
		.eval_id = 300,
		.input_age_ns = 20 * MS,
		.mc_ns = 12 * MS,
		.decision_ns = 3 * MS,
		.total_ns = 41 * MS,
		.hash = 0xBEEF,
		.samples = 16384,
		.backend = PUBLISH_BACKEND_CPU,
	};

	in.res.n = 16384;
	for (int i = 0; i < FUTURES; i++) {
		in.res.risk[i] = (struct mc_risk){.hits = 1, .impact_mps = NAN};
	}
	in.res.risk[FUTURE_DEFER] =
		(struct mc_risk){.hits = 1638, .p = 0.1, .lo = 0.095, .hi = 0.105, .impact_mps = 3};
	in.res.risk[FUTURE_DRIVER] = (struct mc_risk){.hits = 9830, .p = 0.6};
	in.res.risk[FUTURE_NOBODY] = (struct mc_risk){.hits = 16000, .p = 0.98};
	in.res.headway_m[0] = 41.23;
	return in;
}

static struct bus_frame pack(struct publish *p, enum publish_msg which, const struct publish_in *in)
{
	struct bus_frame f;

	publish_pack(p, which, in, NOW, &f);
	return f;
}

static uint64_t raw(const struct bus_frame *f, enum contract_signal which)
{
	return codec_raw(&contract_signal[which], f->data);
}

static double phys(const struct bus_frame *f, enum contract_signal which)
{
	return codec_phys(&contract_signal[which], raw(f, which));
}

#define near(a, b) assert_true(fabs((a) - (b)) < 1e-9)

static void test_request(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();
	struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);

	(void)arg;
	assert_int_equal(f.id, 0x2A0);
	assert_int_equal(f.len, 8);
	assert_int_equal(f.t_ns, NOW);
	assert_int_equal(f.flags, 0);
	assert_int_equal(raw(&f, AEB_REQUEST_REQUEST), AEB_REQUEST_REQUEST_BRAKE);
	assert_int_equal(raw(&f, AEB_REQUEST_STAGE), AEB_REQUEST_STAGE_FULL);
	assert_int_equal(raw(&f, AEB_REQUEST_STATE), AEB_REQUEST_STATE_BRAKE);
	near(phys(&f, AEB_REQUEST_DECEL), -6);
	near(phys(&f, AEB_REQUEST_P_COLLISION), 0.1);
	assert_int_equal(raw(&f, AEB_REQUEST_P_IS_BOUND), 0);
	assert_int_equal(raw(&f, AEB_REQUEST_TTL), 120);
	assert_int_equal(raw(&f, AEB_REQUEST_EVAL_ID), 45);
	publish_close(p);
}

static void test_levels_and_states(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	for (int level = 0; level < LEVELS; level++) {
		in.dec = (struct decision){.level = (enum stage_level)level,
					   .accel_mps2 = level < LEVEL_PARTIAL ? 0 : -4};
		struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);

		assert_string_equal(dbc_value_text(&contract_signal[AEB_REQUEST_STAGE],
						   raw(&f, AEB_REQUEST_STAGE)),
				    level_name[level]);
		assert_int_equal(raw(&f, AEB_REQUEST_REQUEST), level < LEVEL_PARTIAL ? 1 : 2);
		near(phys(&f, AEB_REQUEST_DECEL), level < LEVEL_PARTIAL ? 0 : -4);
	}
	for (int state = 0; state < STATES; state++) {
		in.state = (enum state)state;
		struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);
		struct bus_frame g = pack(p, PUBLISH_STATUS, &in);

		assert_string_equal(dbc_value_text(&contract_signal[AEB_REQUEST_STATE],
						   raw(&f, AEB_REQUEST_STATE)),
				    state_name[state]);
		assert_int_equal(raw(&g, AEB_STATUS_STATE), raw(&f, AEB_REQUEST_STATE));
	}
	publish_close(p);
}

static void test_shadow_never_asks(void **arg)
{
	struct publish *p = opened("transmit", "shadow");
	struct publish_in in = braking();
	struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);
	struct bus_frame g = pack(p, PUBLISH_STATUS, &in);

	(void)arg;
	assert_int_equal(raw(&f, AEB_REQUEST_REQUEST), AEB_REQUEST_REQUEST_NONE);
	assert_int_equal(raw(&f, AEB_REQUEST_STAGE), AEB_REQUEST_STAGE_FULL);
	near(phys(&f, AEB_REQUEST_DECEL), 0);
	assert_int_equal(raw(&g, AEB_STATUS_TRANSMIT), AEB_STATUS_TRANSMIT_SHADOW);
	publish_close(p);
}

/* The contract's words for the causes are ours, one for each. */
static void test_causes(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	for (int i = 0; i < CAUSES; i++) {
		in.dec.cause = (enum decision_cause)i;
		const struct bus_frame f = pack(p, PUBLISH_RISK, &in);

		assert_int_equal(raw(&f, AEB_RISK_CAUSE), i);
		assert_string_equal(dbc_value_text(&contract_signal[AEB_RISK_CAUSE], (uint64_t)i),
				    cause_name[i]);
	}
	assert_true(contract_signal[AEB_RISK_CAUSE].max == CAUSES - 1);
	publish_close(p);
}

/* 0 would read as safe: without a result, past its TTL, and without a hit something else must stand. */
static void test_no_data_is_not_no_risk(void **arg)
{
	static const struct {
		int have_scan, have_result;
		int64_t age_ns;
	} row[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 150 * MS}, {1, 1, 151 * MS}};
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		in.have_scan = row[i].have_scan;
		in.have_result = row[i].have_result;
		in.scan_ns = NOW - row[i].age_ns;
		struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);

		assert_int_equal(raw(&f, AEB_REQUEST_P_COLLISION),
				 AEB_REQUEST_P_COLLISION_NOT_AVAILABLE);
		assert_int_equal(raw(&f, AEB_REQUEST_P_IS_BOUND), 0);
		f = pack(p, PUBLISH_RISK, &in);
		assert_int_equal(raw(&f, AEB_RISK_P_LOW), AEB_RISK_P_LOW_NOT_AVAILABLE);
		assert_int_equal(raw(&f, AEB_RISK_P_HIGH), AEB_RISK_P_HIGH_NOT_AVAILABLE);
		assert_int_equal(raw(&f, AEB_RISK_IMPACT_SPEED),
				 AEB_RISK_IMPACT_SPEED_NOT_AVAILABLE);
		f = pack(p, PUBLISH_MARGIN, &in);
		assert_int_equal(raw(&f, AEB_MARGIN_SAFE_HEADWAY), 4095);
		assert_int_equal(raw(&f, AEB_MARGIN_P_DRIVER), AEB_MARGIN_P_DRIVER_NOT_AVAILABLE);
		assert_int_equal(raw(&f, AEB_MARGIN_P_NOBODY), AEB_MARGIN_P_NOBODY_NOT_AVAILABLE);
	}
	publish_close(p);
}

static void test_below_three_over_n(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	in.res.risk[FUTURE_DEFER] = (struct mc_risk){
		.p = 0, .lo = 0, .hi = 3.0 / 16384, .impact_mps = NAN, .p_is_bound = 1};
	struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);

	assert_int_equal(raw(&f, AEB_REQUEST_P_IS_BOUND), 1);
	assert_int_equal(raw(&f, AEB_REQUEST_P_COLLISION), 12); /* 11.72 steps, rounded up */
	f = pack(p, PUBLISH_RISK, &in);
	assert_int_equal(raw(&f, AEB_RISK_P_LOW), 0);
	assert_int_equal(raw(&f, AEB_RISK_P_HIGH), 12);
	assert_int_equal(raw(&f, AEB_RISK_IMPACT_SPEED), 255); /* none collides */
	publish_close(p);
}

static void test_rounding_is_careful(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	in.res.risk[FUTURE_DEFER] = (struct mc_risk){
		.hits = 1, .p = 1e-8, .lo = 1.99 / 64000, .hi = 2.01 / 64000, .impact_mps = 3.1};
	in.scene.x[SCENE_EGO_SPEED] = 17.0; /* 15 s to 30 m at 2 m/s */
	in.scene.x[SCENE_HEADWAY] = 30.039;
	in.scan_ns = NOW - 30 * MS - 1;
	struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);

	assert_int_equal(raw(&f, AEB_REQUEST_P_COLLISION), 1); /* a risk above 0 never reads 0 */
	assert_int_equal(raw(&f, AEB_REQUEST_TTL), 119);
	f = pack(p, PUBLISH_RISK, &in);
	assert_int_equal(raw(&f, AEB_RISK_P_LOW), 1);
	assert_int_equal(raw(&f, AEB_RISK_P_HIGH), 3);
	near(phys(&f, AEB_RISK_IMPACT_SPEED), 3.0);
	f = pack(p, PUBLISH_MARGIN, &in);
	near(phys(&f, AEB_MARGIN_SAFE_HEADWAY), 41.3);
	near(phys(&f, AEB_MARGIN_TTC), 15.0);
	near(phys(&f, AEB_MARGIN_P_DRIVER), 0.6);
	near(phys(&f, AEB_MARGIN_P_NOBODY), 0.98);
	publish_close(p);
}

static void test_saturation(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	in.dec.accel_mps2 = -99;
	in.res.risk[FUTURE_DEFER] =
		(struct mc_risk){.hits = 16384, .p = 1, .lo = 1, .hi = 1, .impact_mps = 1000};
	in.res.headway_m[0] = 1e6;
	in.scene.x[SCENE_HEADWAY] = 1e6;
	in.input_age_ns = in.mc_ns = in.decision_ns = in.total_ns = 3600 * CLOCK_NS_PER_S;
	in.scan_ns = NOW + 3600 * CLOCK_NS_PER_S;
	struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);

	near(phys(&f, AEB_REQUEST_DECEL), -12.7);
	near(phys(&f, AEB_REQUEST_P_COLLISION), 1);
	assert_int_equal(raw(&f, AEB_REQUEST_TTL), 1023);
	f = pack(p, PUBLISH_RISK, &in);
	near(phys(&f, AEB_RISK_P_LOW), 1);
	near(phys(&f, AEB_RISK_P_HIGH), 1);
	near(phys(&f, AEB_RISK_IMPACT_SPEED), 63.5);
	f = pack(p, PUBLISH_MARGIN, &in);
	near(phys(&f, AEB_MARGIN_SAFE_HEADWAY), 409.4);
	near(phys(&f, AEB_MARGIN_TTC), 20.42);
	f = pack(p, PUBLISH_TIMING, &in);
	near(phys(&f, AEB_TIMING_INPUT_AGE), 1022);
	near(phys(&f, AEB_TIMING_MC_TIME), 818.8);
	near(phys(&f, AEB_TIMING_DECISION_TIME), 50.8);
	near(phys(&f, AEB_TIMING_TOTAL_TIME), 1022);
	publish_close(p);
}

static void test_ttc(void **arg)
{
	static const struct {
		int ego_valid, lead_valid;
		double lead_mps;
		uint64_t raw;
	} row[] = {
		{1, 1, 15, 300},
		{1, 1, 20, AEB_MARGIN_TTC_NOT_CLOSING},
		{1, 1, 25, AEB_MARGIN_TTC_NOT_CLOSING},
		{0, 1, 15, AEB_MARGIN_TTC_NOT_AVAILABLE},
		{1, 0, 15, AEB_MARGIN_TTC_NOT_AVAILABLE},
	};
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		in.scene.ego_valid = row[i].ego_valid;
		in.scene.lead_valid = row[i].lead_valid;
		in.scene.x[SCENE_LEAD_SPEED] = row[i].lead_mps;
		struct bus_frame f = pack(p, PUBLISH_MARGIN, &in);

		assert_int_equal(raw(&f, AEB_MARGIN_TTC), row[i].raw);
	}
	publish_close(p);
}

static void test_eval_id_wraps_past_none(void **arg)
{
	static const struct {
		uint64_t id, raw;
	} row[] = {{0, 0}, {1, 1}, {255, 255}, {256, 1}, {511, 1}, {510, 255}};
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		in.eval_id = row[i].id;
		struct bus_frame f = pack(p, PUBLISH_RISK, &in);

		assert_int_equal(raw(&f, AEB_RISK_EVAL_ID), row[i].raw);
	}
	publish_close(p);
}

static void test_status(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	in.fault = FAULT_BIT(EGO_STALE) | FAULT_BIT(CONFIG);
	struct bus_frame f = pack(p, PUBLISH_STATUS, &in);

	assert_int_equal(f.id, 0x2A3);
	assert_int_equal(raw(&f, AEB_STATUS_REASONS), in.fault);
	assert_int_equal(raw(&f, AEB_STATUS_BACKEND), AEB_STATUS_BACKEND_CPU);
	assert_int_equal(raw(&f, AEB_STATUS_HASH), 0xBEEF);
	in.backend = PUBLISH_BACKEND_GPU;
	f = pack(p, PUBLISH_STATUS, &in);
	assert_int_equal(raw(&f, AEB_STATUS_BACKEND), AEB_STATUS_BACKEND_GPU);
	publish_close(p);
}

static void test_timing_pages_take_turns(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	in.stage_miss = 4096 + 7; /* modulo 4096 */
	in.late = 8;
	in.period_miss = 9;
	in.skipped = 10;
	struct bus_frame f = pack(p, PUBLISH_TIMING, &in);

	assert_int_equal(raw(&f, AEB_TIMING_PAGE), AEB_TIMING_PAGE_TIMES);
	assert_int_equal(raw(&f, AEB_TIMING_EVAL_ID), 45);
	near(phys(&f, AEB_TIMING_INPUT_AGE), 20);
	near(phys(&f, AEB_TIMING_MC_TIME), 12);
	near(phys(&f, AEB_TIMING_DECISION_TIME), 3);
	near(phys(&f, AEB_TIMING_TOTAL_TIME), 41);
	f = pack(p, PUBLISH_TIMING, &in);
	assert_int_equal(raw(&f, AEB_TIMING_PAGE), AEB_TIMING_PAGE_MISSES);
	assert_int_equal(raw(&f, AEB_TIMING_STAGE_MISSES), 7);
	assert_int_equal(raw(&f, AEB_TIMING_LATE_RESULTS), 8);
	assert_int_equal(raw(&f, AEB_TIMING_PERIOD_MISSES), 9);
	assert_int_equal(raw(&f, AEB_TIMING_SKIPPED_SCANS), 10);
	f = pack(p, PUBLISH_TIMING, &in);
	assert_int_equal(raw(&f, AEB_TIMING_PAGE), AEB_TIMING_PAGE_SETUP);
	assert_int_equal(raw(&f, AEB_TIMING_SAMPLES), 16384);
	assert_int_equal(raw(&f, AEB_TIMING_HASH), 0xBEEF);
	in.stage[STAGE_MC] = (struct publish_stage){4097, 12300001, 530100000};
	in.stage[STAGE_TOTAL] = (struct publish_stage){3, -1, 5000000000};
	f = pack(p, PUBLISH_TIMING, &in);
	assert_int_equal(raw(&f, AEB_TIMING_PAGE), AEB_TIMING_PAGE_MISSES_BY_STAGE);
	assert_int_equal(raw(&f, AEB_TIMING_MC_MISSES), 1);
	assert_int_equal(raw(&f, AEB_TIMING_TOTAL_MISSES), 3);
	f = pack(p, PUBLISH_TIMING, &in);
	assert_int_equal(raw(&f, AEB_TIMING_PAGE), AEB_TIMING_PAGE_P99);
	near(phys(&f, AEB_TIMING_MC_P99), 12.4);
	assert_int_equal(raw(&f, AEB_TIMING_TOTAL_P99), AEB_TIMING_TOTAL_P99_NOT_AVAILABLE);
	f = pack(p, PUBLISH_TIMING, &in);
	assert_int_equal(raw(&f, AEB_TIMING_PAGE), AEB_TIMING_PAGE_LONGEST);
	near(phys(&f, AEB_TIMING_MC_MAX), 530.2);
	near(phys(&f, AEB_TIMING_TOTAL_MAX), 1022);
	in.mc_ns = in.input_age_ns = in.decision_ns = in.total_ns = -1;
	f = pack(p, PUBLISH_TIMING, &in);
	assert_int_equal(raw(&f, AEB_TIMING_PAGE), AEB_TIMING_PAGE_TIMES);
	assert_int_equal(raw(&f, AEB_TIMING_INPUT_AGE), AEB_TIMING_INPUT_AGE_NOT_AVAILABLE);
	assert_int_equal(raw(&f, AEB_TIMING_MC_TIME), AEB_TIMING_MC_TIME_NOT_AVAILABLE);
	assert_int_equal(raw(&f, AEB_TIMING_DECISION_TIME), AEB_TIMING_DECISION_TIME_NOT_AVAILABLE);
	assert_int_equal(raw(&f, AEB_TIMING_TOTAL_TIME), AEB_TIMING_TOTAL_TIME_NOT_AVAILABLE);
	publish_close(p);
}

/* A receiver as the contract describes it takes every frame once it has its three to start. */
static void test_protection(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();

	(void)arg;
	for (int which = 0; which < PUBLISH_MSGS; which++) {
		const struct e2e_config check = {.kind = E2E_P2, .msg = &contract_message[which]};
		struct e2e_state st = {0};

		for (int i = 0; i < 40; i++) {
			struct bus_frame f = pack(p, (enum publish_msg)which, &in);
			enum e2e_status status = e2e_check(&check, &st, f.data, f.len);

			assert_int_equal(f.id, 0x2A0 + which);
			assert_int_equal(f.data[1] & 15, i % 16);
			assert_int_equal(status, i == 0 ? E2E_INITIAL : i == 1 ? E2E_SYNC : E2E_OK);
			f.data[5] ^= 1;
			assert_int_equal(e2e_check(&check, &st, f.data, f.len), E2E_WRONG_CRC);
		}
	}
	publish_close(p);
}

static void test_ids_and_interface(void **arg)
{
	struct publish *p = opened("request_id", "0x7FB");
	struct publish_in in = braking();
	struct publish *q = NULL;
	struct config cfg;
	char err[200];

	(void)arg;
	struct bus_frame f = pack(p, PUBLISH_TIMING, &in);

	assert_int_equal(f.id, 0x7FF);
	publish_close(p);
	p = opened("request_id", "0x7FC"); /* all five are extended, not the last alone */
	f = pack(p, PUBLISH_REQUEST, &in);
	assert_int_equal(f.id, 0x7FC | BUS_ID_EFF);
	publish_close(p);
	p = opened("request_id", "0x1FFFFFFB");
	f = pack(p, PUBLISH_TIMING, &in);
	assert_int_equal(f.id, 0x1FFFFFFF | BUS_ID_EFF);
	publish_close(p);
	config_defaults(&cfg);
	assert_int_equal(config_set(&cfg, "bus.interfaces=can0 can1", err, sizeof(err)), 0);
	assert_int_equal(config_set(&cfg, "bus.out_interface=can1", err, sizeof(err)), 0);
	assert_int_equal(publish_open(&cfg, &q), 0);
	f = pack(q, PUBLISH_REQUEST, &in);
	assert_int_equal(f.iface, 1);
	publish_close(q);
	q = NULL;
	snprintf(cfg.bus_out_interface, sizeof(cfg.bus_out_interface), "can7");
	assert_int_equal(publish_open(&cfg, &q), -EINVAL);
	assert_null(q);
	publish_close(NULL);
}

static void words_are(const struct publish *p, const struct bus_frame *f, const char *expected)
{
	char line[400];

	assert_int_equal(publish_words(p, f, line, sizeof(line)), 0);
	assert_string_equal(line, expected);
}

static void test_words(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();
	struct bus_frame f = pack(p, PUBLISH_REQUEST, &in);

	(void)arg;
	words_are(p, &f,
		  "AEB_REQUEST: state BRAKE, stage full, request brake, acceleration -6 m/s2, risk "
		  "if "
		  "braking waits 10 %, valid for 120 ms, evaluation 45");
	in.res.risk[FUTURE_DEFER] =
		(struct mc_risk){.hi = 3.0 / 16384, .impact_mps = NAN, .p_is_bound = 1};
	f = pack(p, PUBLISH_REQUEST, &in);
	words_are(p, &f,
		  "AEB_REQUEST: state BRAKE, stage full, request brake, acceleration -6 m/s2, risk "
		  "if "
		  "braking waits below 0.01875 %, valid for 120 ms, evaluation 45");
	f = pack(p, PUBLISH_RISK, &in);
	words_are(p, &f,
		  "AEB_RISK: cause risk, risk if braking waits at least 0 %, at most 0.01875 %, "
		  "impact speed not "
		  "available, evaluation 45");
	f = pack(p, PUBLISH_MARGIN, &in);
	words_are(p, &f,
		  "AEB_MARGIN: risk if the driver brakes at most 60 %, if nobody does at most 98 "
		  "%, headway for 5 % "
		  "risk 41.3 m, time to collision 6 s, evaluation 45");
	in.fault = FAULT_BIT(EGO_STALE) | FAULT_BIT(MC_LATE);
	f = pack(p, PUBLISH_STATUS, &in);
	words_are(p, &f,
		  "AEB_STATUS: state BRAKE, reasons EGO_STALE MC_LATE, backend CPU, transmit none, "
		  "hash beef");
	in.fault = 1u << FAULTS;
	f = pack(p, PUBLISH_STATUS, &in);
	words_are(
		p, &f,
		"AEB_STATUS: state BRAKE, reasons unknown, backend CPU, transmit none, hash beef");
	in.fault = 0;
	f = pack(p, PUBLISH_STATUS, &in);
	words_are(p, &f,
		  "AEB_STATUS: state BRAKE, reasons none, backend CPU, transmit none, hash beef");
	f = pack(p, PUBLISH_TIMING, &in);
	words_are(
		p, &f,
		"AEB_TIMING: input age 20 ms, batch 12 ms, decision 3 ms, total 41 ms, evaluation "
		"45");
	f = pack(p, PUBLISH_TIMING, &in);
	words_are(p, &f,
		  "AEB_TIMING: stage misses 0, late results 0, period misses 0, skipped scans 0");
	f = pack(p, PUBLISH_TIMING, &in);
	words_are(p, &f, "AEB_TIMING: samples 16384, hash beef");
	in = (struct publish_in){.state = STATE_INIT};
	f = pack(p, PUBLISH_REQUEST, &in);
	words_are(p, &f,
		  "AEB_REQUEST: state INIT, stage none, request none, acceleration 0 m/s2, risk if "
		  "braking waits not available, valid for 0 ms, evaluation none");
	publish_close(p);
}

static void test_words_refuse(void **arg)
{
	struct publish *p = opened(NULL, NULL);
	struct publish_in in = braking();
	struct bus_frame f = pack(p, PUBLISH_REQUEST, &in), g = f;
	char line[400];

	(void)arg;
	g.id--;
	assert_int_equal(publish_words(p, &g, line, sizeof(line)), -ENOMSG);
	g.id = 0x2A0 + PUBLISH_MSGS;
	assert_int_equal(publish_words(p, &g, line, sizeof(line)), -ENOMSG);
	g.id = 0x2A0 | BUS_ID_EFF;
	assert_int_equal(publish_words(p, &g, line, sizeof(line)), -ENOMSG);
	g = f;
	g.flags = BUS_RTR;
	assert_int_equal(publish_words(p, &g, line, sizeof(line)), -ENOMSG);
	g = f;
	g.data[7] ^= 0x10;
	assert_int_equal(publish_words(p, &g, line, sizeof(line)), -EBADMSG);
	assert_string_equal(line, "AEB_REQUEST: not usable, wrong-crc");
	g = f;
	g.len = 7;
	assert_int_equal(publish_words(p, &g, line, sizeof(line)), -EBADMSG);
	assert_string_equal(line, "AEB_REQUEST: not usable, wrong-length");
	assert_int_equal(publish_words(p, &f, line, 12), 0); /* cut off, never beyond the end */
	assert_string_equal(line, "AEB_REQUEST");
	publish_close(p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_request),
		cmocka_unit_test(test_levels_and_states),
		cmocka_unit_test(test_shadow_never_asks),
		cmocka_unit_test(test_causes),
		cmocka_unit_test(test_no_data_is_not_no_risk),
		cmocka_unit_test(test_below_three_over_n),
		cmocka_unit_test(test_rounding_is_careful),
		cmocka_unit_test(test_saturation),
		cmocka_unit_test(test_ttc),
		cmocka_unit_test(test_eval_id_wraps_past_none),
		cmocka_unit_test(test_status),
		cmocka_unit_test(test_timing_pages_take_turns),
		cmocka_unit_test(test_protection),
		cmocka_unit_test(test_ids_and_interface),
		cmocka_unit_test(test_words),
		cmocka_unit_test(test_words_refuse),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
