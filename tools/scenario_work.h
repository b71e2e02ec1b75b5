/* SPDX-License-Identifier: MIT
 * Everything that the runs of a suite need, opened as the arguments say: the car, the rows that are wanted, what the daemon
 * is told of each, room for the results.
 */
#ifndef AEBMC_SCENARIO_WORK_H
#define AEBMC_SCENARIO_WORK_H

#include "scenario_args.h"
#include "scenario_pool.h"

struct scenario_work {
	const char *name; /* "aebmc scenario", for messages */
	const struct scenario_args *args;
	struct config cfg;
	struct mapping *map;
	struct scenario *row;           /* [rows] */
	struct config *told;            /* [rows] */
	double *latest_s;               /* [rows] */
	struct scenario_result *result; /* [rows][cars] */
	struct scenario_plan plan;      /* of all these */
};

/** scenario_work_open - @w: name and args, otherwise zeroed. 0, or an exit code after one line. Allocates; blocks for files. */
int scenario_work_open(struct scenario_work *w);

/** scenario_work_close - also after a failed open. */
void scenario_work_close(struct scenario_work *w);

#endif
