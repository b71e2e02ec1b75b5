/* SPDX-License-Identifier: MIT
 * Closed loops: what is driven (a row of a suite), with which car and sensors (a draw), and what came of it. Between
 * scenario_suite.c, which has the rows, scenario_draw.c, scenario_sim.c, which runs one, scenario_pool.c, which runs all
 * of them, and scenario_report.c.
 */
#ifndef AEBMC_SCENARIO_H
#define AEBMC_SCENARIO_H

#include <stdio.h>
#include "config.h"
#include "drive.h"
#include "mapping.h"
#include "mc.h"
#include "plant.h"
#include "sensors.h"

#define SCENARIO_NAME_MAX 64
#define SCENARIO_SETS_MAX 3

enum scenario_driver {
	DRIVER_PATH,      /* follows drive.ego, whatever happens */
	DRIVER_WARNED,    /* brakes 1.0 s after a warning at 0.4 g (FMVSS 127 S7.5.3) */
	DRIVER_ATTENTIVE, /* follows target 0 with a reaction time, at the headway it began with */
};

enum scenario_goal {
	GOAL_NO_CONTACT,
	GOAL_NO_REQUEST, /* no partial and no full request */
	GOAL_STATED,     /* told, neither passed nor failed */
	GOAL_UNKNOWABLE, /* no request wanted, but what the sensors say is a car: told as not passed */
};

/* What is wrong with the sensors; zeros leave them as they are. */
struct scenario_fault {
	const char *name, *doc;
	double period_s, latency_s, rate_lag_s, dropout, burst;
	double noise;                       /* factor on all noise; 0: 1 */
	const char *set[SCENARIO_SETS_MAX]; /* what the daemon is told of it */
};

struct scenario {
	char name[SCENARIO_NAME_MAX];
	struct drive drive;
	enum scenario_driver driver;
	enum scenario_goal goal;
	double grade_rad;
	double onset_s; /* of the lead's braking, 0: it does not */
	int in_short;   /* one of the rows of --short */
	int number;     /* in its suite; what chance depends on */
	const struct scenario_fault *fault;
	const char *log; /* a recorded drive instead; NULL: none */
};

struct scenario_suite {
	const char *name, *doc;
	/* Fills at most @max rows; returns how many there are, or -ENOMEM. */
	int (*rows)(struct scenario *row, int max);
	int stated; /* 1: its goals are told, and missing them is no failure */
};

/** scenario_calm - the rows of false-activation, as struct scenario_suite.rows. */
int scenario_calm(struct scenario *row, int max);

/** scenario_traffic - the rows of traffic. */
int scenario_traffic(struct scenario *row, int max);

/* All suites, ended by one without a name. */
extern const struct scenario_suite scenario_suites[];

#define SCENARIO_ROWS_MAX 512

/* One car with its sensors and its driver. */
struct scenario_draw {
	struct plant_vehicle car;
	struct sensors_params sensors;
	double speed_mps;  /* added to the ego's speed, and to that of cars that keep it */
	double reaction_s; /* DRIVER_WARNED: from the warning */
};

/**
 * scenario_draw - the @k-th car for @row; the 0th is nominal
 * Chance depends on @seed, the row's number and @k alone.
 * Nominal: sensors as @cfg assumes, no dropouts, friction 1.02 (FMVSS 127 S6.2.1), half the delay that @cfg allows.
 * Drawn: see scenario_draw.c, one line each. Pure.
 */
struct scenario_draw scenario_draw(const struct config *cfg, const struct scenario *row,
				   uint64_t seed, int k);

struct scenario_result {
	int contact;
	double impact_mps; /* closing speed at contact */
	double closest_m;  /* smallest gap to a car in the corridor; NaN: none came */
	double warn_s, partial_s, full_s; /* first of each, from the start; NaN: never */
	unsigned warn, partial, full;     /* times entered */
	double peak_before_mps2,
		peak_after_mps2; /* largest deceleration before the first request and from then on */
	uint64_t evaluations;
};

struct rule;

/* What the runs of one thread share. */
struct scenario_bench {
	const struct config *cfg; /* told of the row's fault */
	const struct mapping *map;
	struct mc *mc; /* inline; its draws are those of cfg */
	const struct rule *
		rule; /* NULL: the daemon's requests; else this rule's, and the daemon's warnings */
	FILE *log;    /* the frames of the car, as a candump log; NULL: none */
};

/**
 * scenario_run - one row with one car, through the pipeline, in virtual time
 * Returns 0 or -errno. Allocates.
 */
int scenario_run(const struct scenario_bench *b, const struct scenario *row,
		 const struct scenario_draw *d, struct scenario_result *r);

/** scenario_replay - a candump log through the pipeline; times from its first frame. 0 or -errno; -ENOMSG if nothing in it
 * could be judged. Allocates; blocks. */
int scenario_replay(const struct scenario_bench *b, const char *path, struct scenario_result *r);

/**
 * scenario_latest - the last moment, from the lead's onset (or the start), at which full braking avoids contact [s]
 * By bisection on the nominal plant with brake.accel of @cfg and no delay: the physical limit. INFINITY if there is no
 * contact without braking, NaN if braking at once does not help. Pure.
 */
double scenario_latest(const struct config *cfg, const struct scenario *row);

/** scenario_first - time of the first partial or full request; NaN for none. Pure. */
double scenario_first(const struct scenario_result *r);

/** scenario_passed - does @r reach the row's goal? 1 for stated ones. Pure. */
int scenario_passed(const struct scenario *row, const struct scenario_result *r);

#endif
