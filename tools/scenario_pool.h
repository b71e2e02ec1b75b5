/* SPDX-License-Identifier: MIT
 * All runs of a suite, over threads. Results are the same for any number of them.
 */
#ifndef AEBMC_SCENARIO_POOL_H
#define AEBMC_SCENARIO_POOL_H

#include "progress.h"
#include "scenario.h"

struct scenario_plan {
	const char *name; /* "aebmc scenario", for messages */
	const struct scenario_suite *suite;
	const struct scenario *row;
	int rows, of_rows;   /* those that are run, of the suite's */
	int first_car, cars; /* of each row: 0, 1 is the nominal one; 1, K are K drawn ones */
	uint64_t seed;
	const struct config *cfg; /* of the car and its sensors */
	const struct config
		*told; /* [rows]: what the daemon is told, cfg with the fault's settings */
	const struct mapping *map;
	const struct rule *rule; /* NULL: the daemon's own */
	int live; /* a daemon elsewhere decides: nothing is known of its evaluations */
	int threads;
	double *latest_s; /* [rows]: receives scenario_latest(), NaN where contact is not the question */
};

/**
 * scenario_pool - every car of every row
 * @result: [rows][cars]
 * Returns 0, or an exit code after one line. On Ctrl-C it ends early: CLI_FAILED. Allocates; blocks.
 */
int scenario_pool(const struct scenario_plan *p, struct scenario_result *result);

#endif
