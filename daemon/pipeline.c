/* SPDX-License-Identifier: MIT
 * The event loop: three kinds of event (frames, a finished batch, a deadline), each handled to its end before the next
 * is waited for. All time is the bus's; a clock only stamps edges within a step.
 */
#include "pipeline_priv.h"
#include <errno.h>
#include <stdlib.h>
#include "clock.h"
#include "engine.h"
#include "recorder.h"

#define FRAMES_MAX 32
#define POLL_NS \
	CLOCK_NS_PER_MS /* how long a result may lie unread where the bus cannot watch for it */

/* ---- decision ---------------------------------------------------------------------------------- */

/* On @s, with its result or without one; what follows goes out at once where it is news. */
static void decide(struct pipeline *p, const struct scene *s, const struct mc_result *res)
{
	struct decision dec = decision_step(p->o.cfg, res, s, p->faults.active, p->now_ns, &p->dec);

	p->in.have_scan = pipeline_trusted(p);
	p->in.scan_ns = s->scan_ns;
	p->in.scene = *s;
	p->in.have_result = res != NULL;
	if (res) {
		p->in.res = *res;
		p->in.eval_id = res->id;
		p->in.samples = (uint32_t)res->n;
		p->cycle.dec = dec;
		pipeline_decided(p);
	}
	if (pipeline_state(p, dec)) {
		pipeline_send(p, PUBLISH_REQUEST);
	}
	pipeline_send(p, PUBLISH_RISK);
	pipeline_send(p, PUBLISH_MARGIN);
}

/* ---- evaluation -------------------------------------------------------------------------------- */

/* With a spare the backend is given up for good: what it does from now on is of no interest. A request that no backend
 * would take is not the backend's failure; wrong bits without another backend to turn to are wrong memory. */
static void fail(struct pipeline *p, int err)
{
	struct mc *spare =
		err == -EINVAL ? NULL : __atomic_exchange_n(&p->spare, NULL, __ATOMIC_ACQ_REL);

	p->once |= spare             ? engine_fault(err)
		   : err == -EBADMSG ? FAULT_BIT(MEMORY)
				     : FAULT_BIT(MC_ERROR);
	if (spare) {
		pipeline_set_mc(p, spare, PUBLISH_BACKEND_CPU, p->spare_samples);
		pipeline_take_offers(p);
	}
	pipeline_faults(p);
	decide(p, &p->scene, NULL);
}

static void take_result(struct pipeline *p)
{
	struct cycle *c = &p->cycle;
	int old = p->now_ns - c->scene.scan_ns > p->ttl_ns;
	int late = old || c->res.flags & MC_RES_CUT;

	pipeline_miss(p, MISS_LATE, c->id, "", (uint64_t)late, 0);
	p->lasting = late ? p->lasting | FAULT_BIT(MC_LATE) : p->lasting & ~FAULT_BIT(MC_LATE);
	pipeline_faults(p);
	if (old || !pipeline_trusted(p)) {
		decide(p, &p->scene, NULL);
		return;
	}
	p->stats.evaluations++;
	if (c->res.risk[FUTURE_DEFER].p > p->stats.risk_max) {
		p->stats.risk_max = c->res.risk[FUTURE_DEFER].p;
	}
	if (p->o.recorder) {
		recorder_evaluation(p->o.recorder, p->now_ns, &c->req, &c->res);
	}
	decide(p, &c->scene, &c->res);
	pipeline_tell_evaluation(p);
	if (p->o.on_cycle) {
		p->o.on_cycle(p->o.arg, c, p->in.state);
	}
}

/* A result of another request than ours is an error of the backend. */
static void collect(struct pipeline *p)
{
	struct cycle *c = &p->cycle;
	int got = p->running ? mc_poll(p->mc, &c->res) : 0;

	if (!got) {
		return;
	}
	p->running = 0;
	pipeline_edge(p, EDGE_RESULT, pipeline_stamp(p));
	if (got < 0 || c->res.id != c->id || c->res.req_hash != mc_request_hash(&c->req)) {
		fail(p, got < 0 ? got : -EBADMSG);
	} else {
		take_result(p);
	}
}

/* Every future begins with what the ego does without us. While we ask for braking its deceleration is ours: nobody brakes
 * means that ours ends, and a danger is over only when it would not come back then. */
static struct scene without_us(const struct scene *s, enum stage_level level)
{
	struct scene own = *s;

	if (level < LEVEL_PARTIAL) {
		return own;
	}
	own.x[SCENE_EGO_ACCEL] = 0;
	for (int i = 0; i < SCENE_DIM; i++) {
		own.cov[SCENE_EGO_ACCEL][i] = own.cov[i][SCENE_EGO_ACCEL] = 0;
	}
	return own;
}

static void submit(struct pipeline *p)
{
	struct cycle *c = &p->cycle;
	int err;

	*c = (struct cycle){.id = ++p->last_id, .scene = p->scene};
	pipeline_edge(p, EDGE_INPUT, p->now_ns - c->scene.oldest_input_ns);
	pipeline_edge(p, EDGE_SCAN, c->scene.scan_ns);
	pipeline_edge(p, EDGE_SCENE, pipeline_stamp(p));

	const struct scene own = without_us(&c->scene, p->dec.level);

	err = pipeline_request(p->o.cfg, &own, c->id, &c->req);
	c->req.n = p->stats.samples;
	pipeline_edge(p, EDGE_SUBMIT, pipeline_stamp(p));
	err = err ? err : mc_submit(p->mc, &c->req);
	if (err < 0) {
		fail(p, err);
		return;
	}
	p->running = 1;
	p->cut_ns = p->now_ns + p->budget_ns;
	p->stuck_ns = p->cut_ns + p->ttl_ns;
	collect(p);
}

static void evaluate(struct pipeline *p)
{
	p->waiting = 0;
	if (pipeline_trusted(p) && p->scene.ego_valid && p->scene.lead_valid) {
		submit(p);
	} else {
		p->lasting &= ~FAULT_BIT(MC_LATE); /* nothing runs that could be late */
		decide(p, &p->scene, NULL);
	}
}

/* While a batch runs the newest scan waits, and what is decided meanwhile is decided without it. */
static void on_scan(struct pipeline *p)
{
	p->stats.scans++;
	estimator_scene(p->est, p->now_ns, &p->scene);
	if (p->running && p->now_ns - p->cycle.scene.scan_ns > p->ttl_ns) {
		p->lasting |= FAULT_BIT(MC_LATE);
	}
	pipeline_faults(p);
	if (!p->running) {
		evaluate(p);
		return;
	}
	pipeline_miss(p, MISS_SKIPPED, p->cycle.id, "", (uint64_t)p->waiting, 0);
	p->waiting = 1;
	if (fault_state(p->faults.active) != STATE_ARMED) {
		decide(p, &p->scene, NULL);
	}
}

static void on_result(struct pipeline *p)
{
	collect(p);
	if (p->running && p->now_ns >= p->stuck_ns &&
	    __atomic_load_n(&p->spare, __ATOMIC_ACQUIRE)) {
		fail(p, -ETIMEDOUT);
	}
	if (!p->running && p->waiting) {
		estimator_scene(p->est, p->now_ns, &p->scene);
		evaluate(p);
	}
	if (p->running && p->now_ns >= p->cut_ns) {
		mc_cut(p->mc, p->cycle.id);
		p->cut_ns = CLOCK_NEVER;
	}
}

/* ---- period ------------------------------------------------------------------------------------ */

static void start(struct pipeline *p)
{
	p->started = 1;
	p->tick_ns = p->now_ns;
	for (int i = 0; i < PUBLISH_MSGS; i++) {
		p->due_ns[i] = p->now_ns;
	}
}

/* What was queued while the loop stood still looks fresh and is not. */
static void on_stall(struct pipeline *p)
{
	p->once |= FAULT_BIT(CLOCK_STEP);
	estimator_distrust(p->est);
	if (p->o.bus->ops->drain) {
		p->o.bus->ops->drain(p->o.bus);
	}
}

static void send_if_due(struct pipeline *p, enum publish_msg which)
{
	int64_t cycle_ns = contract_message[which].cycle_ms * CLOCK_NS_PER_MS;

	if (p->now_ns < p->due_ns[which]) {
		return;
	}
	pipeline_send(p, which);
	while (p->due_ns[which] <= p->now_ns) {
		p->due_ns[which] += cycle_ns;
	}
}

/* What time alone brings, without a scan or a result. 1 if level or state is a new one. */
static int review(struct pipeline *p)
{
	struct decision dec = p->in.dec;

	estimator_scene(p->est, p->now_ns, &p->scene);
	pipeline_faults(p);
	dec.changed = 0;
	if (!pipeline_trusted(p)) {
		dec = decision_step(p->o.cfg, NULL, &p->scene, p->faults.active, p->now_ns,
				    &p->dec);
		p->in.have_scan = p->in.have_result = 0;
		p->in.scene = p->scene;
	}
	return pipeline_state(p, dec);
}

/* An input that goes stale between two periods is said at once. */
static void on_stale(struct pipeline *p)
{
	if (review(p)) {
		pipeline_send(p, PUBLISH_REQUEST);
	}
}

static void on_tick(struct pipeline *p)
{
	int64_t late_ns = p->now_ns - p->tick_ns, absent = late_ns / p->period_ns;

	const uint64_t misses = (uint64_t)(absent + (late_ns % p->period_ns > p->period_ns / 4));

	pipeline_miss(p, MISS_PERIOD, p->cycle.id, "", misses, late_ns);
	p->published++;
	TRACE(p->o.trace, published, p->published, p->tick_ns + absent * p->period_ns,
	      late_ns % p->period_ns, late_ns % p->period_ns > p->period_ns / 4);
	pipeline_tell_clock(p);
	p->tick_ns += (absent + 1) * p->period_ns;
	review(p);
	pipeline_send(p, PUBLISH_REQUEST);
	send_if_due(p, PUBLISH_STATUS);
	send_if_due(p, PUBLISH_TIMING);
}

/* ---- step ---------------------------------------------------------------------------------------- */

static void keep(struct pipeline *p, const struct bus_frame *f, int n)
{
	for (int i = 0; p->o.recorder && i < n; i++) {
		recorder_frame(p->o.recorder, &f[i]);
	}
}

static int64_t deadline(const struct pipeline *p)
{
	int64_t until_ns = clock_earlier(p->tick_ns, estimator_deadline(p->est));

	if (p->running) {
		until_ns = clock_earlier(until_ns, p->cut_ns);
		until_ns = p->watched ? until_ns : clock_earlier(until_ns, p->now_ns + POLL_NS);
	}
	return until_ns;
}

int pipeline_step(struct pipeline *p)
{
	const int64_t stale_ns = pipeline_stale_ns(p);
	struct bus_frame f[FRAMES_MAX];
	int n = p->o.bus->ops->recv(p->o.bus, f, FRAMES_MAX, clock_earlier(deadline(p), stale_ns),
				    &p->now_ns);

	if (n < 0) {
		return n;
	}
	p->stats.frames += (uint64_t)n;
	keep(p, f, n);
	pipeline_take_offers(p);
	pipeline_confirm(p);
	if (!p->started) {
		start(p);
	} else if (p->now_ns - p->tick_ns > p->period_ns) {
		on_stall(p);
		n = 0;
	}
	for (int i = 0; i < n; i++) {
		if (estimator_frame(p->est, &f[i])) {
			on_scan(p);
		}
	}
	if (estimator_tick(p->est, p->now_ns)) {
		on_scan(p);
	}
	on_result(p);
	if (p->now_ns >= p->tick_ns) {
		on_tick(p);
	} else if (p->now_ns >= stale_ns) {
		on_stale(p);
	}
	return 0;
}

/* ---- life -------------------------------------------------------------------------------------- */

static int64_t ms_to_ns(double ms)
{
	return (int64_t)(ms * (double)CLOCK_NS_PER_MS);
}

static void prepare(struct pipeline *p)
{
	const struct config *cfg = p->o.cfg;

	p->period_ns = ms_to_ns(cfg->bus_period);
	p->ttl_ns = ms_to_ns(cfg->bus_result_ttl);
	p->budget_ns = ms_to_ns(cfg->mc_budget);
	pipeline_set_config(p, cfg);
	p->in.state = STATE_INIT;
	pipeline_set_mc(p, p->o.mc, p->o.backend, (uint32_t)cfg->mc_samples);
	pipeline_take_offers(p);
	p->in.input_age_ns = p->in.mc_ns = p->in.decision_ns = p->in.total_ns = -1;
}

int pipeline_open(const struct pipeline_open *o, struct pipeline **ret)
{
	struct pipeline *p = calloc(1, sizeof(*p));
	int err;

	if (!p) {
		return -ENOMEM;
	}
	p->o = *o;
	err = estimator_open(o->cfg, o->map, &p->est);
	err = err ? err : publish_open(o->cfg, &p->pub);
	if (err) {
		pipeline_close(p);
		return err;
	}
	prepare(p);
	*ret = p;
	return 0;
}

const struct pipeline_stats *pipeline_stats(const struct pipeline *p)
{
	return &p->stats;
}

const struct hist *pipeline_hist(const struct pipeline *p)
{
	return p->hist;
}

const struct decision_state *pipeline_decision(const struct pipeline *p)
{
	return &p->dec;
}

const uint64_t *pipeline_rejected(const struct pipeline *p)
{
	return estimator_rejected(p->est);
}

const struct publish_in *pipeline_now(const struct pipeline *p)
{
	return &p->in;
}

/* The receiver's timeout would fire anyway; this says it sooner. */
void pipeline_finish(struct pipeline *p)
{
	p->in.dec = (struct decision){.cause = CAUSE_INHIBITED};
	p->in.state = STATE_INHIBIT;
	p->in.have_scan = p->in.have_result = 0;
	pipeline_send(p, PUBLISH_REQUEST);
	pipeline_send(p, PUBLISH_STATUS);
}

void pipeline_close(struct pipeline *p)
{
	if (!p) {
		return;
	}
	estimator_close(p->est);
	publish_close(p->pub);
	free(p);
}
