/* SPDX-License-Identifier: MIT
 * Which backend a subcommand computes on and how it is opened: the options --backend, --threads, --variant, --draws,
 * --seed and --json, shared through an argp child.
 */
#ifndef AEBMC_COMPUTE_H
#define AEBMC_COMPUTE_H

#include <argp.h>
#include "json.h"
#include "mc_ops.h"

struct compute_args {
	const char *backend; /* a name of the table */
	struct mc_params params;
	int json;
};

/* Child parser; its input is a struct compute_args that compute_defaults filled. */
extern const struct argp compute_argp;

/** compute_defaults - CPU, all processors, Sobol draws, seed 1. */
struct compute_args compute_defaults(void);

/**
 * compute_open - open what was asked for
 * @name: "aebmc SUB", for messages
 * Returns 0, or an exit code after one line: CLI_SKIPPED if the backend is not part of this binary or finds no device,
 * or the processor lacks the variant; CLI_USAGE for an unknown name; CLI_FAILED otherwise.
 */
int compute_open(const char *name, const struct compute_args *a, const struct mc_ops **ops,
		 struct mc_backend **ret);

/** compute_json - the machine and how the backend was opened: cpu, backend, variant, threads, draws, seed. */
void compute_json(struct json *j, const struct compute_args *a, const char *variant);

#endif
