/* SPDX-License-Identifier: MIT
 * The options --config FILE and --set SECTION.KEY=VALUE of the subcommands that need a car, through an argp child.
 */
#ifndef AEBMC_SETUP_H
#define AEBMC_SETUP_H

#include <argp.h>
#include <limits.h>
#include "config.h"
#include "mapping.h"

#define SETUP_SETS_MAX 64

struct setup {
	const char *path;       /* NULL: defaults */
	char bundled[PATH_MAX]; /* what setup_bundled found */
	const char *set[SETUP_SETS_MAX];
	int n_set;
};

/* Child parser; its input is a struct setup, zeroed or after setup_bundled. */
extern const struct argp setup_argp;

/**
 * setup_bundled - without --config it is one of the bundled vehicles: @file, "generic.conf"
 * From the source tree where that is the working folder or the program was built there, otherwise from where it is
 * installed, which setup_load says if it is not there. Call it before the arguments are parsed; @s stays where it is.
 */
void setup_bundled(struct setup *s, const char *file);

/**
 * setup_load - configuration and, where @map is not NULL, the car's mapping
 * @name: "aebmc SUB", for messages
 * Returns 0, or CLI_CONFIG after one line. The mapping is freed by config_mapping_free(); NULL without a file.
 */
int setup_load(const char *name, const struct setup *s, struct config *cfg, struct mapping **map);

#endif
