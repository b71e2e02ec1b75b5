/* SPDX-License-Identifier: MIT
 * stage.def as tables. See stage.h.
 */
#include "stage.h"
#include "clock.h"

const struct stage_row stage_table[STAGES] = {
#define STAGE(name, text, from, to, budget_ms, doc) \
	{text, EDGE_##from, EDGE_##to, budget_ms * CLOCK_NS_PER_MS, doc},
#include "stage.def"
};

const char *const edge_name[EDGES] = {
#define EDGE(name, doc) #name,
#include "stage.def"
};

const char *const edge_doc[EDGES] = {
#define EDGE(name, doc) doc,
#include "stage.def"
};

const char *const miss_name[MISSES] = {
#define MISS(name, text, doc) text,
#include "stage.def"
};

int64_t stage_ns(enum stage s, const int64_t t_ns[EDGES])
{
	const int64_t from_ns = t_ns[stage_table[s].from], to_ns = t_ns[stage_table[s].to];

	return from_ns && to_ns ? to_ns - from_ns : -1;
}
