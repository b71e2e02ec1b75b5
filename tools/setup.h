/* SPDX-License-Identifier: MIT
 * The options --config FILE and --set SECTION.KEY=VALUE of the subcommands that need a car, through an argp child.
 */
#ifndef AEBMC_SETUP_H
#define AEBMC_SETUP_H

#include <argp.h>
#include "config.h"
#include "mapping.h"

#define SETUP_SETS_MAX 64

struct setup {
	const char *path; /* NULL: defaults */
	const char *set[SETUP_SETS_MAX];
	int n_set;
};

/* Child parser; its input is a zeroed struct setup. */
extern const struct argp setup_argp;

/**
 * setup_load - configuration and, where @map is not NULL, the car's mapping
 * @name: "aebmc SUB", for messages
 * Returns 0, or CLI_CONFIG after one line. The mapping is freed by config_mapping_free(); NULL without a file.
 */
int setup_load(const char *name, const struct setup *s, struct config *cfg, struct mapping **map);

#endif
