/* SPDX-License-Identifier: MIT
 * The functions behind inputs.def, and the table of them. Between inputs_judge.c and the files that judge.
 */
#ifndef AEBMC_INPUTS_CHECKS_H
#define AEBMC_INPUTS_CHECKS_H

#include "inputs.h"

/* A part of all; 0 of none. */
static inline double inputs_share(uint64_t part, uint64_t all)
{
	return all ? (double)part / (double)all : 0;
}

/** inputs_stuck - 1 if no signal of that role ever changes, in 10 s or more. */
int inputs_stuck(const struct inputs *in, enum inputs_role role);

/** inputs_still - how many messages hold a target of which nothing ever changes, though the car drives. */
int inputs_still(const struct inputs *in);

#define INPUTS_CHECK(name, doc) void inputs_check_##name(struct inputs_judge *j);
#include "inputs.def"
#undef INPUTS_CHECK

#endif
