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
	const char *requests;   /* NULL: a log */
	const char *compare[2]; /* two configurations, NULL: one replay */
	const char **logs;      /* [n_logs], to compare */
	int n_logs;
	const char *pictures; /* folder, NULL: none */
	int64_t jobs;         /* replays at a time, 0: one for each processor */
	int64_t threads;      /* 0: the configuration's */
	int json;
};

/* Who else wants to know what happens in a replay. Times are seconds from the log's first frame. */
struct replay_watch {
	void (*cycle)(void *arg, double time_s, const struct cycle *c);  /* after an evaluation */
	void (*level)(void *arg, double time_s, enum stage_level level); /* another stage */
	void *arg;
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
	const struct replay_watch *watch; /* NULL: nobody */
	enum stage_level level;
	enum state state;
	struct progress line;
	int64_t wall_ns; /* time the run took */
};

struct replay_figures {
	uint64_t evaluations, hash; /* of the configuration */
	double log_s, risk_max;     /* 0: no hit in any evaluation */
};

/**
 * replay_watched - one replay that prints nothing but its errors
 * @a: a configuration and a log; what else a replay can write is not looked at
 * Returns an exit code; @f is filled if it is 0.
 */
int replay_watched(const char *name, const struct replay_args *a, const struct replay_watch *watch,
		   struct replay_figures *f);

/** replay_time_s - a time of the log, from its first frame. */
double replay_time_s(const struct replay *r, int64_t t_ns);

/** replay_begin - before the first event. */
void replay_begin(struct replay *r);

/** replay_change - pipeline_open.on_change: tell what changed. */
void replay_change(void *arg, int64_t t_ns, const struct publish_in *now);

/** replay_end - the figures, after the last event. */
void replay_end(struct replay *r);

#endif
