/* SPDX-License-Identifier: MIT
 * What aebmc map (map.c) and its decisions (map_decide.c) share.
 */
#ifndef AEBMC_MAP_H
#define AEBMC_MAP_H

#include <stdio.h>
#include "mapper.h"

#define MAP_DECIDED_MAX 32 /* --role */

struct map_args {
	const char *dbc, *log, *out, *iface;
	const char *role[MAP_DECIDED_MAX]; /* NAME=MESSAGE.SIGNAL[:UNIT] */
	int n_roles, force;
};

struct map {
	const char *name; /* "aebmc map", for messages */
	const struct map_args *args;
	struct mapper *m;
	struct mapper_choice choice[MAPPER_ROLES];
	FILE *words; /* where what is found is told */
	int open;    /* roles that wait for a decision */
};

/** map_check_roles - are there roles of the names in --role? 0, or CLI_USAGE after one line. */
int map_check_roles(const struct map *p);

/**
 * map_decide - for every role the candidate that was told, or is clear, or is chosen on a terminal
 * Roles that stay undecided are counted in @p->open. 0, or an exit code after one line.
 */
int map_decide(struct map *p);

#endif
