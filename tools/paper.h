/* SPDX-License-Identifier: MIT
 * Between paper.c, which computes, and paper_write.c, which writes the figures and the table.
 */
#ifndef AEBMC_PAPER_H
#define AEBMC_PAPER_H

#include "bench_time.h"
#include "risk_curve.h"
#include "table1.h"

#define PAPER_STOPS 1024u /* most stopping distances that are compared */

/* Everything that the figures show. */
struct paper {
	const char *name; /* "aebmc paper", for messages */
	const char *dir;
	int png;
	char machine[160];
	uint32_t threads; /* of the times on this machine */
	struct mc_result res;
	struct risk_row row[RISK_CURVE_ROWS];
	double headway_m[RISK_CURVE_ROWS], p[RISK_CURVE_ROWS], lo[RISK_CURVE_ROWS],
		hi[RISK_CURVE_ROWS];
	int rows;
	struct stop_counts stops;
	double share[STOP_METRES];
	struct table1_row table1[TABLE1_ROWS];
	uint32_t n_stops;
	double cpu_m[PAPER_STOPS], gpu_m[PAPER_STOPS], max_dev_m;
	double size[BENCH_SIZES_CPU], size_ns[BENCH_SIZES_CPU], scalar_ns;
};

/** paper_write - everything into p->dir, a line on standard output for each. Returns an exit code. */
int paper_write(const struct paper *p);

#endif
