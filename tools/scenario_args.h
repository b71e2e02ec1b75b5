/* SPDX-License-Identifier: MIT
 * What aebmc scenario was asked for.
 */
#ifndef AEBMC_SCENARIO_ARGS_H
#define AEBMC_SCENARIO_ARGS_H

#include <stddef.h>
#include <stdint.h>
#include "scenario.h"
#include "setup.h"

struct scenario_args {
	struct setup setup; /* with the preset's settings before the user's */
	const struct scenario_suite *suite;
	const char *csv, *html, *only, *log_run, *out, *log, *live; /* NULL: not given */
	const struct rule *rule;                                    /* NULL: the daemon's own */
	int64_t cars, samples, threads;                             /* 0: not given */
	int64_t seed;
	int64_t car; /* that log_run writes, 0 is the nominal one */
	size_t preset;
	char interfaces[64]; /* the setting that live stands for */
	int json, words;     /* on standard output; neither where a file goes there */
	int is_short, compare, list;
};

/** scenario_args - defaults, then the command line. 0, or CLI_USAGE after one line; @a stays where it is. */
int scenario_args(int argc, char **argv, struct scenario_args *a);

#endif
