/* SPDX-License-Identifier: MIT
 * Packing: one function per message, every figure rounded so that it never says less than is known.
 */
#include "publish_priv.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"
#include "codec.h"

#define STANDARD_ID_MAX 0x7FFu
#define MS              1e-6 /* per ns */

_Static_assert(FAULTS <= 28, "AEB_STATUS_REASONS has a bit for each");

enum rounding { DOWN, NEAREST, UP };

/* How every frame says what state we are in; the contract's numbers are not ours. */
static const uint8_t state_code[STATES] = {
	[STATE_INIT] = AEB_REQUEST_STATE_INIT,       [STATE_ARMED] = AEB_REQUEST_STATE_ARMED,
	[STATE_BRAKE] = AEB_REQUEST_STATE_BRAKE,     [STATE_DEGRADED] = AEB_REQUEST_STATE_DEGRADED,
	[STATE_INHIBIT] = AEB_REQUEST_STATE_INHIBIT, [STATE_FAULT] = AEB_REQUEST_STATE_FAULT,
};

static void put_raw(uint8_t *data, enum contract_signal which, uint64_t raw)
{
	const struct dbc_signal *sig = &contract_signal[which];

	codec_set_raw(sig, data, raw & codec_mask(sig));
}

/* Saturates at the signal's range; a figure that is not a number is "not available", all bits one. */
static void put(uint8_t *data, enum contract_signal which, double value, enum rounding how)
{
	const struct dbc_signal *sig = &contract_signal[which];
	double steps, near;

	if (isnan(value)) {
		put_raw(data, which, UINT64_MAX);
		return;
	}
	value = value < sig->min ? sig->min : value > sig->max ? sig->max : value;
	steps = (value - sig->offset) / sig->scale;
	near = floor(steps + 0.5);
	/* What is a whole step but for rounding errors is that step. */
	if (how != NEAREST && fabs(steps - near) > 1e-6) {
		near = how == UP ? ceil(steps) : floor(steps);
	}
	put_raw(data, which, (uint64_t)near);
}

static void put_time(uint8_t *data, enum contract_signal which, int64_t ns)
{
	put(data, which, ns < 0 ? NAN : (double)ns * MS, NEAREST);
}

static uint64_t short_id(uint64_t eval_id)
{
	return eval_id ? (eval_id - 1) % 255 + 1 : 0;
}

static double ttl_ms(const struct publish *p, const struct publish_in *in, int64_t now_ns)
{
	int64_t left_ns = in->have_scan ? in->scan_ns + p->ttl_ns - now_ns : 0;

	return left_ns > 0 ? (double)left_ns * MS : 0;
}

static const struct mc_risk *risk_of(const struct publish *p, const struct publish_in *in,
				     int64_t now_ns, enum future future)
{
	static const struct mc_risk unknown = {.p = NAN, .lo = NAN, .hi = NAN, .impact_mps = NAN};

	return in->have_result && ttl_ms(p, in, now_ns) > 0 ? &in->res.risk[future] : &unknown;
}

static double quoted(const struct mc_risk *r)
{
	return r->p_is_bound ? r->hi : r->p;
}

static void pack_request(struct publish *p, const struct publish_in *in, int64_t now_ns,
			 uint8_t *data)
{
	const struct mc_risk *r = risk_of(p, in, now_ns, FUTURE_DEFER);
	int brake = in->dec.level >= LEVEL_PARTIAL && !p->shadow && !in->withheld;

	put_raw(data, AEB_REQUEST_REQUEST,
		brake ? AEB_REQUEST_REQUEST_BRAKE : AEB_REQUEST_REQUEST_NONE);
	put_raw(data, AEB_REQUEST_STAGE, in->dec.level);
	put_raw(data, AEB_REQUEST_STATE, state_code[in->state]);
	put_raw(data, AEB_REQUEST_P_IS_BOUND, r->p_is_bound);
	put(data, AEB_REQUEST_TTL, ttl_ms(p, in, now_ns), DOWN);
	put_raw(data, AEB_REQUEST_EVAL_ID, short_id(in->eval_id));
	put(data, AEB_REQUEST_DECEL, brake ? in->dec.accel_mps2 : 0, NEAREST);
	put(data, AEB_REQUEST_P_COLLISION, quoted(r), UP);
}

static void pack_risk(struct publish *p, const struct publish_in *in, int64_t now_ns, uint8_t *data)
{
	const struct mc_risk *r = risk_of(p, in, now_ns, FUTURE_DEFER);

	put_raw(data, AEB_RISK_CAUSE, in->dec.cause);
	put_raw(data, AEB_RISK_EVAL_ID, short_id(in->eval_id));
	put(data, AEB_RISK_IMPACT_SPEED, r->impact_mps, NEAREST);
	put(data, AEB_RISK_P_LOW, r->lo, DOWN);
	put(data, AEB_RISK_P_HIGH, r->hi, UP);
}

static void put_ttc(uint8_t *data, const struct scene *s)
{
	double closing_mps = s->x[SCENE_EGO_SPEED] - s->x[SCENE_LEAD_SPEED];

	if (!s->ego_valid || !s->lead_valid) {
		put(data, AEB_MARGIN_TTC, NAN, DOWN);
	} else if (closing_mps > 0) {
		put(data, AEB_MARGIN_TTC, s->x[SCENE_HEADWAY] / closing_mps, DOWN);
	} else {
		put_raw(data, AEB_MARGIN_TTC, AEB_MARGIN_TTC_NOT_CLOSING);
	}
}

static void pack_margin(struct publish *p, const struct publish_in *in, int64_t now_ns,
			uint8_t *data)
{
	int fresh = !isnan(risk_of(p, in, now_ns, FUTURE_DEFER)->hi);

	put_raw(data, AEB_MARGIN_EVAL_ID, short_id(in->eval_id));
	put(data, AEB_MARGIN_SAFE_HEADWAY, fresh ? in->res.headway_m[0] : NAN, UP);
	put_ttc(data, &in->scene);
	put(data, AEB_MARGIN_P_DRIVER, quoted(risk_of(p, in, now_ns, FUTURE_DRIVER)), UP);
	put(data, AEB_MARGIN_P_NOBODY, quoted(risk_of(p, in, now_ns, FUTURE_NOBODY)), UP);
}

static void pack_status(struct publish *p, const struct publish_in *in, int64_t now_ns,
			uint8_t *data)
{
	(void)now_ns;
	put_raw(data, AEB_STATUS_STATE, state_code[in->state]);
	put_raw(data, AEB_STATUS_BACKEND, in->backend);
	put_raw(data, AEB_STATUS_TRANSMIT, p->transmit);
	put_raw(data, AEB_STATUS_REASONS, in->fault);
	put_raw(data, AEB_STATUS_HASH, in->hash);
}

static void pack_times(const struct publish_in *in, uint8_t *data)
{
	put_raw(data, AEB_TIMING_EVAL_ID, short_id(in->eval_id));
	put_time(data, AEB_TIMING_INPUT_AGE, in->input_age_ns);
	put_time(data, AEB_TIMING_MC_TIME, in->mc_ns);
	put_time(data, AEB_TIMING_DECISION_TIME, in->decision_ns);
	put_time(data, AEB_TIMING_TOTAL_TIME, in->total_ns);
}

static void pack_misses(const struct publish_in *in, uint8_t *data)
{
	put_raw(data, AEB_TIMING_STAGE_MISSES, in->stage_miss);
	put_raw(data, AEB_TIMING_LATE_RESULTS, in->late);
	put_raw(data, AEB_TIMING_PERIOD_MISSES, in->period_miss);
	put_raw(data, AEB_TIMING_SKIPPED_SCANS, in->skipped);
}

static void pack_setup(const struct publish_in *in, uint8_t *data)
{
	put_raw(data, AEB_TIMING_SAMPLES, in->samples);
	put_raw(data, AEB_TIMING_HASH, in->hash);
}

/* The stages that have a budget, and where the contract has their figures. */
static const struct {
	enum stage stage;
	enum contract_signal misses, p99, max;
} stage_rows[] = {
	{STAGE_INPUT, AEB_TIMING_INPUT_MISSES, AEB_TIMING_INPUT_P99, AEB_TIMING_INPUT_MAX},
	{STAGE_MC, AEB_TIMING_MC_MISSES, AEB_TIMING_MC_P99, AEB_TIMING_MC_MAX},
	{STAGE_DECISION, AEB_TIMING_DECISION_MISSES, AEB_TIMING_DECISION_P99,
	 AEB_TIMING_DECISION_MAX},
	{STAGE_TOTAL, AEB_TIMING_TOTAL_MISSES, AEB_TIMING_TOTAL_P99, AEB_TIMING_TOTAL_MAX},
};
#define STAGE_ROWS (sizeof(stage_rows) / sizeof(stage_rows[0]))

static void pack_stages(const struct publish_in *in, uint8_t *data)
{
	for (size_t i = 0; i < STAGE_ROWS; i++) {
		put_raw(data, stage_rows[i].misses, in->stage[stage_rows[i].stage].misses);
	}
}

static void put_longest(uint8_t *data, enum contract_signal which, int64_t ns)
{
	put(data, which, ns < 0 ? NAN : (double)ns * MS, UP);
}

static void pack_p99(const struct publish_in *in, uint8_t *data)
{
	for (size_t i = 0; i < STAGE_ROWS; i++) {
		put_longest(data, stage_rows[i].p99, in->stage[stage_rows[i].stage].p99_ns);
	}
}

static void pack_max(const struct publish_in *in, uint8_t *data)
{
	for (size_t i = 0; i < STAGE_ROWS; i++) {
		put_longest(data, stage_rows[i].max, in->stage[stage_rows[i].stage].max_ns);
	}
}

static void pack_timing(struct publish *p, const struct publish_in *in, int64_t now_ns,
			uint8_t *data)
{
	static void (*const page[])(const struct publish_in *, uint8_t *) = {
		[AEB_TIMING_PAGE_TIMES] = pack_times,
		[AEB_TIMING_PAGE_MISSES] = pack_misses,
		[AEB_TIMING_PAGE_SETUP] = pack_setup,
		[AEB_TIMING_PAGE_MISSES_BY_STAGE] = pack_stages,
		[AEB_TIMING_PAGE_P99] = pack_p99,
		[AEB_TIMING_PAGE_LONGEST] = pack_max,
	};

	(void)now_ns;
	put_raw(data, AEB_TIMING_PAGE, p->page);
	page[p->page](in, data);
	p->page = (p->page + 1) % (sizeof(page) / sizeof(page[0]));
}

static void (*const pack_table[PUBLISH_MSGS])(struct publish *, const struct publish_in *, int64_t,
					      uint8_t *) = {
	[PUBLISH_REQUEST] = pack_request, [PUBLISH_RISK] = pack_risk,
	[PUBLISH_MARGIN] = pack_margin,   [PUBLISH_STATUS] = pack_status,
	[PUBLISH_TIMING] = pack_timing,
};

int publish_open(const struct config *cfg, struct publish **ret)
{
	int iface = config_out_interface(cfg);
	uint32_t last = (uint32_t)cfg->bus_request_id + PUBLISH_MSGS - 1;
	struct publish *p;

	if (iface < 0) {
		return iface;
	}
	p = calloc(1, sizeof(*p));
	if (!p) {
		return -ENOMEM;
	}
	p->iface = (uint8_t)iface;
	p->first_id = (uint32_t)cfg->bus_request_id | (last > STANDARD_ID_MAX ? BUS_ID_EFF : 0);
	p->ttl_ns = (int64_t)(cfg->bus_result_ttl * (double)CLOCK_NS_PER_MS);
	p->transmit = (uint32_t)cfg->bus_transmit;
	p->shadow = p->transmit == AEB_STATUS_TRANSMIT_SHADOW;
	*ret = p;
	return 0;
}

void publish_pack(struct publish *p, enum publish_msg which, const struct publish_in *in,
		  int64_t now_ns, struct bus_frame *f)
{
	const struct dbc_message *msg = &contract_message[which];
	const struct e2e_config check = {.kind = E2E_P2, .msg = msg};

	*f = (struct bus_frame){
		.t_ns = now_ns, .id = p->first_id + which, .iface = p->iface, .len = msg->size};
	pack_table[which](p, in, now_ns, f->data);
	e2e_protect(&check, &p->e2e[which], f->data);
}

void publish_close(struct publish *p)
{
	free(p);
}
