/* SPDX-License-Identifier: MIT
 * Units as they are written in DBC files, and what turns them into SI: the one place where units are converted.
 */
#ifndef AEBMC_UNIT_H
#define AEBMC_UNIT_H

#include <stddef.h>

/* What a quantity is; its SI unit in brackets. */
enum unit_kind {
	UNIT_FLAG,   /* yes or no: any unit will do, nothing is converted */
	UNIT_SPEED,  /* [m/s] */
	UNIT_LENGTH, /* [m] */
	UNIT_TURN,   /* [rad/s] */
	UNIT_SHARE,  /* 0..1 [1] */
	UNIT_KINDS
};

/**
 * unit_gain - factor from @name to the SI unit of @kind
 * Letter case counts. Returns 0, or -EINVAL with *@gain untouched if that kind of quantity has no such unit.
 */
int unit_gain(enum unit_kind kind, const char *name, double *gain);

/** unit_list - the names known for @kind, separated by ", ", for error lines. Returns @text. */
const char *unit_list(enum unit_kind kind, char *text, size_t size);

#endif
