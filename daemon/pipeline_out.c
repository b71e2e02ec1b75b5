/* SPDX-License-Identifier: MIT
 * What is wrong, what state that makes, and the frames that say so.
 */
#include "pipeline_priv.h"
#include "clock.h"

void pipeline_event(struct pipeline *p, enum recorder_reason why)
{
	if (p->o.recorder) {
		recorder_trigger(p->o.recorder, why, p->now_ns);
	}
}

/* ---- faults ------------------------------------------------------------------------------------ */

static uint32_t bus_conditions(struct pipeline *p)
{
	static const struct {
		uint32_t event, fault;
	} row[] = {
		{BUS_EV_DOWN, FAULT_BIT(BUS_DOWN)},      {BUS_EV_OFF, FAULT_BIT(BUS_OFF)},
		{BUS_EV_FOREIGN, FAULT_BIT(FOREIGN_ID)}, {BUS_EV_STAMP, FAULT_BIT(CLOCK_STEP)},
		{BUS_EV_OVERFLOW, FAULT_BIT(RX_LOST)},   {BUS_EV_PASSIVE, FAULT_BIT(BUS_PASSIVE)},
	};
	uint32_t events = p->o.bus->ops->events ? p->o.bus->ops->events(p->o.bus) : 0, faults = 0;

	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		faults |= events & row[i].event ? row[i].fault : 0;
	}
	return faults;
}

/* A scan older than its result may be is stale, however patient the inputs' own limits are. */
static int64_t scan_until_ns(const struct pipeline *p)
{
	return p->stats.scans ? p->scene.scan_ns + p->ttl_ns : CLOCK_NEVER;
}

int64_t pipeline_stale_ns(const struct pipeline *p)
{
	const int64_t stale_ns = estimator_stale_ns(p->est, p->now_ns), scan_ns = scan_until_ns(p);

	return scan_ns < p->now_ns || scan_ns >= stale_ns ? stale_ns : scan_ns + 1;
}

/* Without a backend we have not started. */
static uint32_t input_conditions(const struct pipeline *p)
{
	return p->scene.fault | (p->now_ns > scan_until_ns(p) ? FAULT_BIT(RADAR_STALE) : 0) |
	       (p->mc ? 0 : FAULT_BIT(STARTING));
}

/* While starting only what makes it worse. */
static int is_news(const struct pipeline *p, uint32_t was)
{
	const uint32_t active = p->faults.active;

	return active & ~was && (p->in.state != STATE_INIT || fault_state(active) > STATE_INIT);
}

void pipeline_faults(struct pipeline *p)
{
	const uint32_t was = p->faults.active;
	uint32_t raised = p->lasting | p->once | bus_conditions(p) | input_conditions(p);

	raised |= __atomic_load_n(&p->outside, __ATOMIC_ACQUIRE);
	if (p->running && p->now_ns >= p->stuck_ns) {
		raised |= FAULT_BIT(MC_STUCK);
	}
	p->once = 0;
	fault_update(&p->faults, raised, p->now_ns);
	if (is_news(p, was)) {
		pipeline_event(p, RECORDER_FAULT);
	}
	pipeline_tell_faults(p, was);
}

int pipeline_trusted(const struct pipeline *p)
{
	return fault_state(p->faults.active) <= STATE_DEGRADED;
}

/* ---- out --------------------------------------------------------------------------------------- */

void pipeline_send(struct pipeline *p, enum publish_msg which)
{
	struct bus_frame *f = &p->cycle.out[which];
	const int64_t at_ns = pipeline_stamp(p);

	p->in.skipped = p->stats.skipped;
	p->in.late = p->stats.late;
	p->in.stage_miss = p->stats.stage_miss;
	p->in.period_miss = p->stats.period_miss;
	if (which == PUBLISH_TIMING) {
		pipeline_stages(p);
	}
	publish_pack(p->pub, which, &p->in, p->now_ns, f);
	if (!p->o.quiet && p->o.bus->ops->send(p->o.bus, f)) {
		p->once |= FAULT_BIT(TX_REFUSED);
		return;
	}
	p->stats.sent += !p->o.quiet;
	if (which == PUBLISH_REQUEST && p->sent.waits) {
		pipeline_sent(p, f, at_ns);
	}
}

int pipeline_state(struct pipeline *p, struct decision dec)
{
	enum state state = fault_state(p->faults.active), was = p->in.state;

	if (state == STATE_ARMED && dec.level >= LEVEL_PARTIAL) {
		state = STATE_BRAKE;
	}
	p->in.dec = dec;
	p->in.state = state;
	p->in.fault = p->faults.active;
	if (!dec.changed && state == was) {
		return 0;
	}
	if (state != was) {
		TRACE(p->o.trace, state, state_name[was], state_name[state]);
	}
	if (dec.changed && dec.level > LEVEL_NONE) {
		pipeline_event(p, dec.level == LEVEL_WARN ? RECORDER_WARN : RECORDER_REQUEST);
	}
	if (p->o.on_change) {
		p->o.on_change(p->o.arg, p->now_ns, &p->in);
	}
	return 1;
}
