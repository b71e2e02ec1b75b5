/* SPDX-License-Identifier: MIT
 * The risk against the headway, from one histogram of `need` (mc_ops.h): that is the whole curve.
 */
#ifndef AEBMC_RISK_CURVE_H
#define AEBMC_RISK_CURVE_H

#include "mc_ops.h"

#define RISK_CURVE_ROWS 400 /* most rows of CSV, JSON and pictures */
#define STOP_BINS       8   /* of MC_HIST_BIN_M: a metre */
#define STOP_METRES     (MC_HIST_BINS / STOP_BINS)

struct risk_row {
	double headway_m, p, lo, hi; /* 0..1, with the 95 % Wilson interval */
	int bound;                   /* no hit: hi is 3/n, an upper bound */
};

/**
 * risk_curve - rows at round headways, from a risk of 99.9 % (or headway 0) to none
 * @need: [MC_HIST_BINS], of @n samples, >= 1
 * @most: 3..RISK_CURVE_ROWS rows
 * Returns how many there are. Pure.
 */
int risk_curve(const uint64_t *need, uint64_t n, int most, struct risk_row row[]);

/* Stopping distances by the metre: how many are in [first_m + i, first_m + i + 1). */
struct stop_counts {
	double first_m;
	int n;
	uint64_t count[STOP_METRES];
};

/** stop_counts - by the metre; what the histogram cannot place is left out. Pure. */
void stop_counts(const uint64_t *stop, struct stop_counts *ret);

#endif
