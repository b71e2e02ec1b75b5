/* SPDX-License-Identifier: MIT
 * aebmc replay --compare: the same logs under two configurations. Between compare.c, which runs the replays side by side
 * as processes of their own, compare_match.c, which says what was gained and lost, and compare_report.c and
 * compare_picture.c, which tell it.
 */
#ifndef AEBMC_COMPARE_H
#define AEBMC_COMPARE_H

#include <stddef.h>
#include <stdint.h>
#include "decision.h"
#include "replay.h"

enum compare_side { SIDE_A, SIDE_B, SIDES };
enum compare_kind {
	KIND_WARNING,
	KIND_REQUEST,
	KINDS
};                                                 /* the driver is warned; braking is asked for */
extern const char *const compare_kind_name[KINDS]; /* "warnings", "requests" */

#define COMPARE_SAID 512

/* The stage from @time_s on. */
struct compare_change {
	double time_s;
	int32_t level; /* enum stage_level */
};

/* One evaluation. */
struct compare_point {
	double time_s, p, lo, hi; /* risk of waiting one period */
	double driver;            /* risk if the driver brakes after a reaction time */
	double headway_m;         /* NaN without a lead */
};

/* What one replay left behind. */
struct compare_run {
	struct {
		int code; /* exit code of cli.h; not 0: the rest is not there */
		uint32_t n_changes, n_points;
		uint64_t evaluations, hash;
		double log_s, risk_max;
	} head;
	struct compare_change *change; /* [n_changes], in order of time */
	struct compare_point *point;   /* [n_points] */
};

/* One warning or request: how long, and the highest stage in it. */
struct compare_span {
	double from_s, to_s;
	int32_t level;
};

/* Of one kind and log. */
struct compare_diff {
	int n[SIDES];
	struct compare_span *span[SIDES]; /* [n[side]] */
	int *partner;                     /* [n[SIDE_A]]: index in B's, -1: lost */
	int lost, gained;
};

struct compare_log {
	const char *path;
	char *picture; /* where it was drawn, NULL: nowhere, or that failed */
	struct compare_run run[SIDES];
	struct compare_diff diff[KINDS];
	char said[SIDES][COMPARE_SAID]; /* what a replay that failed had to say */
};

/** compare_main - the subcommand; @a holds two configurations and at least one log. Returns an exit code. */
int compare_main(const char *name, const struct replay_args *a);

/**
 * compare_match - spans of @kind of both runs and which belong together
 * @run: [SIDES]
 * Two belong together if they overlap or begin within a second of each other; each has one partner at most: of several the
 * one it overlaps longest, else the one that begins nearest. Returns 0 or -ENOMEM with @d empty.
 */
int compare_match(const struct compare_run *run, enum compare_kind kind, struct compare_diff *d);

/** compare_match_free - what compare_match() allocated. */
void compare_match_free(struct compare_diff *d);

/** compare_is_gained - 1 if B's span @i has no partner. */
int compare_is_gained(const struct compare_diff *d, int i);

/** compare_differs - 1 if a warning or request was gained or lost, or is of another stage. */
int compare_differs(const struct compare_log *l);

/** compare_picture - both risks and stages of a log into l->picture. 0, or CLI_FAILED after one line. */
int compare_picture(const char *name, const struct replay_args *a, const struct compare_log *l);

/** compare_words, compare_json - all logs. */
void compare_words(const struct replay_args *a, const struct compare_log *log, int n, FILE *out);
void compare_json(const struct replay_args *a, const struct compare_log *log, int n, FILE *out);

#endif
