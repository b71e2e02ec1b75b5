/* SPDX-License-Identifier: MIT
 * What every subcommand of aebmc needs: exit codes, one-line messages, argument parsing, Ctrl-C, the machine's name.
 */
#ifndef AEBMC_CLI_H
#define AEBMC_CLI_H

#include <argp.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum cli_exit { CLI_GOOD = 0, CLI_FAILED = 1, CLI_USAGE = 2, CLI_SKIPPED = 77, CLI_CONFIG = 78 };

/**
 * cli_parse - argp without its second line of advice
 * @input: handed to the parser of @argp as state->input
 * Returns 0, or CLI_USAGE after one line on stderr. --help prints and exits 0.
 */
int cli_parse(const struct argp *argp, int argc, char **argv, void *input);

/** cli_bad - one line about a wrong argument, for use in a parser. Returns EINVAL. */
error_t cli_bad(const struct argp_state *st, const char *fmt, ...)
	__attribute__((format(printf, 2, 3)));

/** cli_number, cli_count - a finite number in min..max, or EINVAL after one line; @name as the user wrote it. */
error_t cli_number(const struct argp_state *st, const char *name, const char *arg, double min,
		   double max, double *ret);
error_t cli_count(const struct argp_state *st, const char *name, const char *arg, int64_t min,
		  int64_t max, int64_t *ret);

/** cli_choice - index of @arg in @names[n], or EINVAL after one line with the nearest valid name. */
error_t cli_choice(const struct argp_state *st, const char *name, const char *arg,
		   const char *const *names, size_t n, size_t *ret);

/** cli_error - one line "NAME: ..." on stderr. Returns @code. */
int cli_error(int code, const char *name, const char *fmt, ...)
	__attribute__((format(printf, 3, 4)));

/**
 * cli_same_file - 1 if both paths lead to one regular file
 * @a_dash: the descriptor that "-" means as @a; as @b it is standard output. NULL is no file.
 */
int cli_same_file(const char *a, int a_dash, const char *b);

/** cli_create - open @path for writing, "-" is standard output. NULL after one line. */
FILE *cli_create(const char *name, const char *path);

/** cli_close - flush and close (standard output: flush). 0, or CLI_FAILED after one line if a write failed. */
int cli_close(const char *name, const char *path, FILE *f);

/**
 * cli_catch_interrupt - from now on the first Ctrl-C or SIGTERM only sets the word; a second one kills
 * Returns the word: 0 until then, UINT64_MAX afterwards. Also good as the `cut` of mc_ops.run.
 */
const uint64_t *cli_catch_interrupt(void);

/** cli_interrupted - 1 once the word of cli_catch_interrupt is set. */
int cli_interrupted(void);

/** cli_cpu_name - this machine's processor in words; "unknown" where the kernel does not say. */
void cli_cpu_name(char *name, int size);

/** cli_cpus - processors this process may run on, >= 1. */
uint32_t cli_cpus(void);

#endif
