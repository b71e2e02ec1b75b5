/* SPDX-License-Identifier: MIT
 * A recorded drive as a row: nobody hears the requests, but none may come.
 */
#include <errno.h>
#include <math.h>
#include "clock.h"
#include "pipeline.h"
#include "rules.h"
#include "scenario.h"
#include "stamped.h"

struct replayed {
	struct stamped bus;
	enum stage_level level;
	const struct scenario_bench *bench;
	struct rule_state rule;
	struct scenario_result *result;
};

static void enter(const struct replayed *l, int64_t t_ns, double *first_s, unsigned *n)
{
	const double now_s = (double)(t_ns - l->bus.first_ns) / CLOCK_NS_PER_S;

	*first_s = isnan(*first_s) ? now_s : *first_s;
	++*n;
}

static void on_change(void *arg, int64_t t_ns, const struct publish_in *now)
{
	struct replayed *l = arg;
	struct scenario_result *r = l->result;
	const struct {
		double *first_s;
		unsigned *n;
	} of[LEVELS] = {
		[LEVEL_WARN] = {&r->warn_s, &r->warn},
		[LEVEL_PARTIAL] = {&r->partial_s, &r->partial},
		[LEVEL_FULL] = {&r->full_s, &r->full},
	};
	const enum stage_level to = now->dec.level;

	const enum stage_level most = l->bench->rule ? LEVEL_WARN : LEVEL_FULL;

	if (to != l->level && to > LEVEL_NONE && to <= most) {
		enter(l, t_ns, of[to].first_s, of[to].n);
	}
	l->level = to;
}

/* Another rule in the daemon's place. */
static void on_cycle(void *arg, const struct cycle *c, enum state state)
{
	struct replayed *l = arg;
	const struct scenario_bench *b = l->bench;
	const int64_t now_ns = c->t_ns[STAGE_DECIDE];
	const int braked = l->rule.braking;

	(void)state;
	rule_step(b->rule, &l->rule, b->cfg, &c->scene, b->mc, &c->req, now_ns);
	if (l->rule.braking && !braked) {
		enter(l, now_ns, &l->result->full_s, &l->result->full);
	}
}

static int run(struct replayed *l)
{
	const struct scenario_bench *b = l->bench;
	const struct pipeline_open o = {
		.cfg = b->cfg,
		.map = b->map,
		.bus = &l->bus.bus,
		.mc = b->mc,
		.backend = PUBLISH_BACKEND_CPU,
		.on_cycle = b->rule ? on_cycle : NULL,
		.on_change = on_change,
		.arg = l,
	};
	struct pipeline *pipe = NULL;
	int ret = pipeline_open(&o, &pipe);

	while (!ret) {
		ret = pipeline_step(pipe);
		ret = ret == -EINTR ? 0 : ret;
	}
	if (pipe) {
		l->result->evaluations = pipeline_stats(pipe)->evaluations;
	}
	pipeline_close(pipe);
	return ret == -ENODATA ? 0 : ret;
}

int scenario_replay(const struct scenario_bench *b, const char *path, struct scenario_result *r)
{
	struct replayed l = {.bench = b, .result = r};
	const char *iface[BUS_IFACES_MAX];
	struct bus *log;
	char err[256];
	int ret;

	*r = (struct scenario_result){
		.closest_m = NAN, .warn_s = NAN, .partial_s = NAN, .full_s = NAN};
	for (int i = 0; i < b->map->n_ifaces; i++) {
		iface[i] = b->map->iface[i];
	}
	ret = bus_log_open(path, NULL, iface, b->map->n_ifaces, &log, err, sizeof(err));
	if (ret) {
		return ret;
	}
	stamped_init(&l.bus, log);
	ret = run(&l);
	log->ops->close(log);
	return ret ? ret : r->evaluations ? 0 : -ENOMSG;
}
