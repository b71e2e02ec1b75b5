/* SPDX-License-Identifier: MIT
 * A recorded drive as a row: nobody hears the requests, but none may come.
 */
#include <errno.h>
#include <math.h>
#include "clock.h"
#include "pipeline.h"
#include "scenario.h"
#include "stamped.h"

struct replayed {
	struct stamped bus;
	enum stage_level level;
	struct scenario_result *result;
};

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

	if (to != l->level && to > LEVEL_NONE) {
		*of[to].first_s = isnan(*of[to].first_s)
					  ? (double)(t_ns - l->bus.first_ns) / CLOCK_NS_PER_S
					  : *of[to].first_s;
		++*of[to].n;
	}
	l->level = to;
}

static int run(const struct scenario_bench *b, struct replayed *l)
{
	const struct pipeline_open o = {
		.cfg = b->cfg,
		.map = b->map,
		.bus = &l->bus.bus,
		.mc = b->mc,
		.backend = PUBLISH_BACKEND_CPU,
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
	struct replayed l = {.result = r};
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
	ret = run(b, &l);
	log->ops->close(log);
	return ret ? ret : r->evaluations ? 0 : -ENOMSG;
}
