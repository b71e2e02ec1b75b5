/* SPDX-License-Identifier: MIT
 * When what happened, how long it took, what was missed: stamped once, counted here, told to the tracer with the same
 * number.
 */
#include "pipeline_priv.h"
#include <time.h>
#include "clock.h"

int64_t pipeline_stamp(const struct pipeline *p)
{
	return p->o.clock ? p->o.clock() : p->now_ns;
}

void pipeline_miss(struct pipeline *p, enum miss kind, uint64_t cycle, const char *stage,
		   uint64_t count, int64_t late_ns)
{
	uint64_t *const counter[MISSES] = {
		[MISS_STAGE] = &p->stats.stage_miss,
		[MISS_LATE] = &p->stats.late,
		[MISS_PERIOD] = &p->stats.period_miss,
		[MISS_SKIPPED] = &p->stats.skipped,
	};

	*counter[kind] += count;
	if (count) {
		TRACE(p->o.trace, miss, cycle, miss_name[kind], stage, count, late_ns);
		if (p->in.state != STATE_INIT) {
			pipeline_event(p, RECORDER_MISS);
		}
	}
}

/* The stages that end with @e. */
static void close_stages(struct pipeline *p, uint64_t cycle, const int64_t t_ns[EDGES], enum edge e)
{
	for (int s = 0; s < STAGES; s++) {
		const struct stage_row *r = &stage_table[s];
		const int64_t ns = r->to == e ? stage_ns((enum stage)s, t_ns) : -1;

		if (ns < 0) {
			continue;
		}
		hist_add(&p->hist[s], ns);
		if (r->budget_ns && ns > r->budget_ns) {
			p->stats.stage_misses[s]++;
			pipeline_miss(p, MISS_STAGE, cycle, r->name, 1, ns - r->budget_ns);
		}
	}
}

static void stamp(struct pipeline *p, uint64_t cycle, int64_t t_ns[EDGES], enum edge e,
		  int64_t at_ns)
{
	t_ns[e] = at_ns;
	TRACE(p->o.trace, edge, cycle, e, at_ns);
	close_stages(p, cycle, t_ns, e);
}

void pipeline_edge(struct pipeline *p, enum edge e, int64_t at_ns)
{
	stamp(p, p->cycle.id, p->cycle.t_ns, e, at_ns);
}

/* ---- from the decision to its confirmation ----------------------------------------------------------- */

void pipeline_decided(struct pipeline *p)
{
	pipeline_edge(p, EDGE_DECIDE, pipeline_stamp(p));
	p->sent.id = p->cycle.id;
	memcpy(p->sent.t_ns, p->cycle.t_ns, sizeof(p->sent.t_ns));
	p->sent.waits = 1;
}

static void tell_times(struct pipeline *p, enum edge last)
{
	const int64_t *t = p->sent.t_ns;

	p->in.input_age_ns = t[EDGE_SCAN] - t[EDGE_INPUT];
	if (p->o.clock) {
		p->in.mc_ns = t[EDGE_RESULT] - t[EDGE_SUBMIT];
		p->in.decision_ns = t[EDGE_SEND] - t[EDGE_RESULT];
		p->in.total_ns = t[last] - t[EDGE_INPUT];
	}
}

void pipeline_sent(struct pipeline *p, const struct bus_frame *f, int64_t at_ns)
{
	stamp(p, p->sent.id, p->sent.t_ns, EDGE_SEND, at_ns);
	if (p->cycle.id == p->sent.id) {
		p->cycle.t_ns[EDGE_SEND] = at_ns;
	}
	p->sent.waits = 0;
	tell_times(p, EDGE_SEND);
	if (!p->o.quiet && p->o.bus->ops->expect) {
		p->o.bus->ops->expect(p->o.bus, f);
	}
}

/* What a kernel stamped may lie before the call that sent it returned, never before it was made. */
void pipeline_confirm(struct pipeline *p)
{
	const struct bus_ops *ops = p->o.bus->ops;
	const int64_t seen_ns = ops->expected_ns ? ops->expected_ns(p->o.bus) : 0;
	const int64_t sent_ns = p->sent.t_ns[EDGE_SEND];

	if (!seen_ns || !sent_ns || p->sent.t_ns[EDGE_CONFIRM]) {
		return;
	}
	stamp(p, p->sent.id, p->sent.t_ns, EDGE_CONFIRM, seen_ns > sent_ns ? seen_ns : sent_ns);
	if (p->cycle.id == p->sent.id) {
		p->cycle.t_ns[EDGE_CONFIRM] = p->sent.t_ns[EDGE_CONFIRM];
	}
	tell_times(p, EDGE_CONFIRM);
}

void pipeline_stages(struct pipeline *p)
{
	for (int s = 0; s < STAGES; s++) {
		const struct hist *h = &p->hist[s];
		const int known = hist_count(h) && (p->o.clock || s == STAGE_INPUT);

		p->in.stage[s] = (struct publish_stage){p->stats.stage_misses[s],
							known ? hist_percentile(h, 0.99) : -1,
							known ? hist_max_ns(h) : -1};
	}
}

/* ---- for the tracer alone ------------------------------------------------------------------------------ */

void pipeline_tell_evaluation(const struct pipeline *p)
{
	const struct cycle *c = &p->cycle;
	const struct mc_risk *r = &c->res.risk[FUTURE_DEFER];
	const struct trace_evaluation e = {.cycle = c->id,
					   .samples = c->res.n,
					   .t_ns = c->t_ns[EDGE_DECIDE],
					   .speed_mps = c->scene.x[SCENE_EGO_SPEED],
					   .headway_m = c->scene.x[SCENE_HEADWAY],
					   .lead_speed_mps = c->scene.x[SCENE_LEAD_SPEED],
					   .safe_m = c->res.headway_m[1],
					   .lead = c->scene.lead_id,
					   .p = r->p,
					   .lo = r->lo,
					   .hi = r->hi,
					   .accel_mps2 = p->in.dec.accel_mps2,
					   .level = level_name[p->in.dec.level],
					   .state = state_name[p->in.state]};

	TRACE(p->o.trace, evaluation, &e);
}

void pipeline_tell_faults(const struct pipeline *p, uint32_t was)
{
	const uint32_t changed = p->faults.active ^ was;

	for (int i = 0; changed && i < FAULTS; i++) {
		if (changed & 1u << i) {
			TRACE(p->o.trace, fault, fault_table[i].name,
			      (int)(p->faults.active >> i & 1));
		}
	}
}

void pipeline_tell_clock(struct pipeline *p)
{
	struct trace_clock c = {.mono_ns = p->now_ns,
				.real_ns = p->now_ns,
				.period_ns = p->period_ns,
				.live = p->o.clock != NULL};
	struct timespec ts;

	if (!p->o.trace || p->now_ns < p->clock_due_ns) {
		return;
	}
	p->clock_due_ns = p->now_ns + CLOCK_NS_PER_S;
	if (c.live) {
		clock_gettime(CLOCK_REALTIME, &ts);
		c.real_ns = ts.tv_sec * CLOCK_NS_PER_S + ts.tv_nsec;
		c.mono_ns = p->o.clock();
	}
	TRACE(p->o.trace, clock, &c);
}
