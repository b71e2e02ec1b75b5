/* SPDX-License-Identifier: MIT
 * The moments of an evaluation, the stages between them with their budgets, and what can be missed: stage.def as types
 * and tables. For the pipeline, the tracer and the report alike.
 */
#ifndef AEBMC_STAGE_H
#define AEBMC_STAGE_H

#include <stdint.h>

enum edge {
#define EDGE(name, doc) EDGE_##name,
#include "stage.def"
	EDGES
};

enum stage {
#define STAGE(name, text, from, to, budget_ms, doc) STAGE_##name,
#include "stage.def"
	STAGES
};

enum miss {
#define MISS(name, text, doc) MISS_##name,
#include "stage.def"
	MISSES
};

struct stage_row {
	const char *name; /* "mc" */
	enum edge from, to;
	int64_t budget_ns; /* 0: none */
	const char *doc;
};

extern const struct stage_row stage_table[STAGES];
extern const char *const edge_name[EDGES]; /* "INPUT", ... */
extern const char *const edge_doc[EDGES];
extern const char *const miss_name[MISSES]; /* "stage", "late", "period", "skipped" */

/** stage_ns - how long @s took in a cycle stamped so; -1 if one of its edges was not passed. Pure. */
int64_t stage_ns(enum stage s, const int64_t t_ns[EDGES]);

#endif
