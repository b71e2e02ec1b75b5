/* SPDX-License-Identifier: MIT
 * Command line of aebmcd. For main.c.
 */
#ifndef AEBMC_ARGS_H
#define AEBMC_ARGS_H

#define ARGS_SETS_MAX 64

/* What to do; all but the first need no hardware and end. */
enum args_action { ARGS_RUN, ARGS_CHECK_CONFIG, ARGS_PRINT_CONFIG, ARGS_PRINT_OPTIONS };

struct args {
	enum args_action action;
	const char *config; /* configuration file; NULL: defaults, for ARGS_PRINT_CONFIG alone */
	const char *log,
		*out; /* candump logs, "-" for standard input and output; out NULL: discard */
	const char *set[ARGS_SETS_MAX]; /* "section.key=value" */
	int n_set;
};

/**
 * args_parse - fill @a from the command line
 * Prints one line on standard error about a wrong one; --help and --version print and exit 0. The strings are argv's.
 * Returns 0 or -EINVAL.
 */
int args_parse(int argc, char **argv, struct args *a);

#endif
