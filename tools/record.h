/* SPDX-License-Identifier: MIT
 * What was measured on a GPU and kept, for machines without one: the committed log of make check-gpu as a table
 * (tools/record-def), with the machine's names and the day.
 */
#ifndef AEBMC_RECORD_H
#define AEBMC_RECORD_H

#include "figure.h"

struct record {
	const char *gpu, *cpu, *date;           /* of the times and budgets */
	double scalar_ns;                       /* the f64 reference on one core, a sample */
	struct figure_series paper, fast, host; /* medians; host: one CPU thread */
	double paper_fits[FIGURE_BUDGETS],
		fast_fits[FIGURE_BUDGETS]; /* samples in CALIBRATION_MS */
	const char *stops_gpu, *stops_date;
	size_t stops;
	const float *stop_m; /* of the paper's first samples, seed 1, Philox, f64 reference */
};

extern const struct record record;

#endif
