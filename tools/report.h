/* SPDX-License-Identifier: MIT
 * What a trace of aebmcd tells: its cycles, misses and evaluations, and the figures drawn from them. report_take.c reads
 * events, report_figures.c counts, report_show.c, report_json.c and
 * report_html.c with report_pictures.c tell.
 */
#ifndef AEBMC_REPORT_H
#define AEBMC_REPORT_H

#include <stdio.h>
#include "ctf.h"
#include "mc.h"
#include "stage.h"

#define REPORT_WORST 10

/* Times are the daemon's own, CLOCK_MONOTONIC [ns]; 0: not passed. */
struct report_cycle {
	uint64_t id;
	int64_t t_ns[EDGES];
	int64_t seen_ns[EDGES];     /* when the tracer took it, on its own clock */
	int64_t batch_ns[MC_EDGES]; /* the first time each was passed */
	int64_t gpu_ns, verify_ns;  /* sums over the chunks of a GPU */
	int64_t chunk_ns;           /* when the last of these edges was passed */
	uint32_t missed;            /* bit per stage over its budget */
	int late;                   /* its result came late */
};

struct report_miss {
	enum miss kind;
	int stage; /* -1: none, or one this program does not know */
	uint64_t cycle, count;
	int64_t t_ns, late_ns; /* t_ns: of the tracer's clock */
};

struct report_evaluation {
	double t_s; /* since the first event, on the daemon's clock */
	double speed_mps, headway_m, lead_speed_mps, safe_m, lead, p, lo, hi, accel_mps2;
	int level, state;
};

/* One that fired events; times of the tracer's clock. */
struct report_process {
	int64_t pid; /* 0: the session did not record it */
	int64_t first_ns, last_ns;
	uint64_t evaluations;
};

/* A yes or no for each evaluation, period or scan: how often yes, and how it clusters. */
struct report_runs {
	uint64_t n, misses, runs, longest;
	uint64_t after, again; /* units that followed a miss, and those of them that missed too */
	uint64_t length;       /* of the run under way */
};

struct report_stage {
	uint64_t n, over;
	int64_t p50_ns, p95_ns, p99_ns, p99_9_ns, max_ns; /* -1 without a value */
	int64_t *sorted_ns;                               /* [n] */
};

/* What happens within a batch; names in report_sub_name. */
enum report_sub { SUB_WAKE, SUB_BATCH, SUB_GPU, SUB_VERIFY, SUB_BACK, SUBS };
extern const char *const report_sub_name[SUBS], *const report_sub_doc[SUBS];

struct report {
	int64_t pid; /* whose events to take; 0: all */

	/* as read */
	struct report_cycle *cycle;
	struct report_miss *miss;
	struct report_evaluation *evaluation;
	struct report_process *process;
	size_t n_cycles, n_misses, n_evaluations, n_processes;
	size_t cycles_room, misses_room, evaluations_room, processes_room;
	int64_t taken_pid; /* of the event before */
	size_t run_start; /* first cycle of the daemon's present run: numbers begin anew with each */
	uint64_t events, foreign, faults, states;
	int64_t first_ns, last_ns; /* tracer's clock, which is the wall's */
	int64_t first_mono_ns, real_minus_mono_ns, period_ns;
	int clocks, replay; /* clocks: events with both seen; replay: a log's time */
	struct ctf_lost lost;
	/* request frames: on the period, of them late; due times of the present run */
	uint64_t published, published_late, published_n, ticks_before;
	int64_t due_first_ns, due_last_ns;
	struct report_runs runs[MISSES];

	/* figures */
	uint64_t missed[MISSES];
	struct report_stage stage[STAGES], sub[SUBS];
	const struct report_cycle *worst[REPORT_WORST];
	int n_worst;
};

/** report_event - take one event: a ctf_event with the report as @arg. 0 or -ENOMEM. Allocates. */
int report_event(void *arg, const struct ctf_record *r);

/** report_mixed - whether processes of this trace cannot be told as one: two at a time, or of replays any two. Pure. */
int report_mixed(const struct report *r);

/** report_figures - count, once all events are taken. 0 or -ENOMEM. Allocates. */
int report_figures(struct report *r);

/** report_stage_ns - how long a stage took; -1 if it is not known. Of a replay: what was computed, by the tracer's clock,
 * and the age of the inputs. Pure. */
int64_t report_stage_ns(const struct report *r, const struct report_cycle *c, enum stage s);

/** report_cycle_ns - from a cycle's oldest input to the last edge it passed; -1 if it passed none after. Of a replay: all
 * stages that are known. Pure. */
int64_t report_cycle_ns(const struct report *r, const struct report_cycle *c);

/** report_sub_ns - a part of the batch; -1 if it is not known. Pure. */
int64_t report_sub_ns(const struct report_cycle *c, enum report_sub s);

/** report_seconds - of the recording. Pure. */
double report_seconds(const struct report *r);

/** report_runs_add - @n units in a row, all missed or none. */
void report_runs_add(struct report_runs *runs, uint64_t n, int missed);

/** report_chance, report_chance_again - that a unit misses, and that one does after a miss; NaN: no such unit. Pure. */
double report_chance(const struct report_runs *runs);
double report_chance_again(const struct report_runs *runs);

/** report_ticks - request frames that were due between the first and the last that was sent. Pure. */
uint64_t report_ticks(const struct report *r);

/** report_adds_up - frames on time and missed ones are all that were due. Pure. */
int report_adds_up(const struct report *r);

/** report_when - a time of the daemon's clock as UTC, "2026-11-22 16:46:55.072". @size >= 32. */
void report_when(const struct report *r, int64_t mono_ns, char *text, size_t size);

void report_show(const struct report *r, const char *dir, FILE *out);
void report_json(const struct report *r, const char *dir, FILE *out);
void report_html(const struct report *r, const char *dir, FILE *out);

/** report_draw_* - a heading and a picture for the page: how the stages' times are spread, the worst cycles as bars, speed,
 * distance and risk over time. Nothing where there is nothing to draw. */
void report_draw_stages(const struct report *r, FILE *out);
void report_draw_worst(const struct report *r, FILE *out);
void report_draw_risk(const struct report *r, FILE *out);

void report_free(struct report *r);

#endif
