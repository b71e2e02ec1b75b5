/* SPDX-License-Identifier: MIT
 * Which backend a subcommand computes on and how it is opened: the options --backend, --threads, --variant, --draws,
 * --seed and --json, shared through an argp child.
 */
#ifndef AEBMC_BACKEND_H
#define AEBMC_BACKEND_H

#include <argp.h>
#include "json.h"
#include "mc_ops.h"

struct backend_args {
	const char *backend; /* a name of the table */
	struct mc_params params;
	int json;
};

/* Child parser; its input is a struct backend_args that backend_defaults filled. */
extern const struct argp backend_argp;

/** backend_defaults - CPU, all processors, Sobol draws, seed 1. */
struct backend_args backend_defaults(void);

/**
 * backend_open - open what was asked for
 * @name: "aebmc SUB", for messages
 * Returns 0, or an exit code after one line: CLI_SKIPPED if the backend is not part of this binary or finds no device,
 * or the processor lacks the variant; CLI_USAGE for an unknown name; CLI_FAILED otherwise.
 */
int backend_open(const char *name, const struct backend_args *a, const struct mc_ops **ops,
		 struct mc_backend **ret);

/** backend_json - the machine and how the backend was opened: cpu, backend, variant, threads, draws, seed. */
void backend_json(struct json *j, const struct backend_args *a, const char *variant);

#endif
