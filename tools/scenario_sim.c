/* SPDX-License-Identifier: MIT
 * One closed loop in virtual time: a bus whose frames are made as the pipeline asks for them, and whose sender is heard by
 * the plant. The pipeline is the daemon's own.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include "clock.h"
#include "pipeline.h"
#include "rules.h"
#include "scenario_loop.h"

#define LINE_SIZE 256

struct sim {
	struct bus bus;
	struct bus_stats stats;
	const struct scenario_bench *bench;
	struct scenario_loop loop;
	struct rule_state rule;
	struct pipeline *pipe;
	struct bus_frame frame[MAP_MESSAGES_MAX + MAP_TRACKS_MAX]; /* of the present millisecond */
	int n, next;
	int error;
};

/* ---- the bus -------------------------------------------------------------------------------- */

static int on_frame(void *arg, const struct bus_frame *f, const struct drive_truth *now)
{
	struct sim *s = arg;
	char line[LINE_SIZE];

	(void)now;
	s->frame[s->n++] = *f;
	if (!s->bench->log) {
		return 0;
	}
	bus_log_format(f, s->bench->map->iface[f->iface], line, sizeof(line));
	return fprintf(s->bench->log, "%s\n", line) < 0 ? -EIO : 0;
}

static int take(struct sim *s, struct bus_frame *f, int max, int64_t *now_ns)
{
	int n = 0;

	*now_ns = s->frame[s->next].t_ns;
	while (n < max && s->next < s->n) {
		f[n++] = s->frame[s->next++];
	}
	s->stats.received += (uint64_t)n;
	return n;
}

/* As a log is replayed (bus.h): the first frame comes whatever the deadline, then the frames of one stamp at a time. */
static int recv_frames(struct bus *b, struct bus_frame *f, int max, int64_t until_ns,
		       int64_t *now_ns)
{
	struct sim *s = (struct sim *)b;

	while (s->next == s->n) {
		if (s->stats.received && s->loop.sensors.t_ns > until_ns) {
			*now_ns = until_ns;
			return 0;
		}
		s->n = s->next = 0;
		s->error = scenario_loop_step(&s->loop, on_frame, s);
		if (s->error) {
			return s->error;
		}
	}
	return take(s, f, max, now_ns);
}

static int send_frame(struct bus *b, const struct bus_frame *f)
{
	struct sim *s = (struct sim *)b;

	scenario_loop_hear(&s->loop, f, s->loop.sensors.t_ns);
	s->stats.sent++;
	return 0;
}

static const struct bus_stats *bus_stats(const struct bus *b)
{
	return &((const struct sim *)b)->stats;
}

static const struct bus_ops ops = {
	.name = "closed loop",
	.recv = recv_frames,
	.send = send_frame,
	.stats = bus_stats,
};

/* ---- another rule in the daemon's place ------------------------------------------------------ */

static void on_cycle(void *arg, const struct cycle *c, enum state state)
{
	struct sim *s = arg;
	const struct scenario_bench *b = s->bench;

	(void)state;
	scenario_loop_ask(&s->loop, rule_step(b->rule, &s->rule, b->cfg, &c->scene, b->mc, &c->req,
					      c->t_ns[STAGE_DECIDE]));
}

/* ---- a run ----------------------------------------------------------------------------------- */

static int open_pipeline(struct sim *s)
{
	const struct scenario_bench *b = s->bench;
	const struct pipeline_open o = {
		.cfg = b->cfg,
		.map = b->map,
		.bus = &s->bus,
		.mc = b->mc,
		.backend = PUBLISH_BACKEND_CPU,
		.on_cycle = b->rule ? on_cycle : NULL,
		.arg = s,
	};

	return pipeline_open(&o, &s->pipe);
}

int scenario_run(const struct scenario_bench *b, const struct scenario *row,
		 const struct scenario_draw *d, struct scenario_result *r)
{
	struct sim *s = calloc(1, sizeof(*s));
	int ret;

	if (!s) {
		return -ENOMEM;
	}
	s->bus.ops = &ops;
	s->bench = b;
	scenario_loop_open(&s->loop, b->cfg, b->map, row, d);
	s->loop.deaf = b->rule != NULL;
	ret = open_pipeline(s);
	while (!ret) {
		ret = pipeline_step(s->pipe);
	}
	if (ret == -ENODATA) {
		*r = s->loop.result;
		r->evaluations = pipeline_stats(s->pipe)->evaluations;
		ret = 0;
	}
	pipeline_close(s->pipe);
	free(s);
	return ret;
}
