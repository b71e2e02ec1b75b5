/* SPDX-License-Identifier: MIT
 * A replay in progress, and what it reports: events as they happen, figures at the end. Between replay.c, which runs it,
 * and replay_report.c.
 */
#ifndef AEBMC_REPLAY_H
#define AEBMC_REPLAY_H

#include "json.h"
#include "mapping.h"
#include "pipeline.h"
#include "progress.h"
#include "setup.h"
#include "stamped.h"

struct replay_args {
	struct setup setup;
	const char *log, *out, *csv;
	const char *requests; /* NULL: a log */
	int64_t threads;      /* 0: the configuration's */
	int json;
};

struct replay {
	const char *name; /* "aebmc replay", for messages */
	const struct replay_args *args;
	struct config cfg;
	struct mapping *map;
	struct bus *log;
	struct stamped bus; /* around the log */
	struct mc *mc;
	enum publish_backend backend; /* what mc runs on */
	struct pipeline *pipe;
	FILE *csv, *words; /* NULL: not wanted */
	struct json json;
	enum stage_level level;
	enum state state;
	struct progress line;
	int64_t wall_ns; /* time the run took */
};

/** replay_time_s - a time of the log, from its first frame. */
double replay_time_s(const struct replay *r, int64_t t_ns);

/** replay_begin - before the first event. */
void replay_begin(struct replay *r);

/** replay_change - pipeline_open.on_change: tell what changed. */
void replay_change(void *arg, int64_t t_ns, const struct publish_in *now);

/** replay_end - the figures, after the last event. */
void replay_end(struct replay *r);

#endif
