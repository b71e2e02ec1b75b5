/* SPDX-License-Identifier: MIT
 * From integer counts to figures: mean, standard deviation, quantiles, proportions with their interval.
 * Integers make any order, thread count and backend agree; these functions run once per batch, on the host, in f64.
 */
#ifndef AEBMC_STATS_H
#define AEBMC_STATS_H

#include "mc_ops.h"

#define STATS_UNIT_PER_M 1024 /* distances are counted in units of 2^-10 m */

/* Everything a batch accumulates, all integers; blocks, threads and devices add theirs up. */
struct stats_sums {
	uint64_t n, floored;
	uint64_t hits[MC_FUTURES_MAX];
	uint64_t undecided[MC_FUTURES_MAX];
	uint64_t impact_units[MC_FUTURES_MAX]; /* of 2^-10 m/s */
	int64_t stop_sum;                      /* sum of (q - centre), q in units of 2^-10 m */
	unsigned __int128 stop_sum2;           /* sum of (q - centre)^2 */
};

/** stats_centre - the centre that a batch sums about, in units. Pure. */
int32_t stats_centre(const struct mc_request *req);

/** stats_add - a += b. */
void stats_add(struct stats_sums *a, const struct stats_sums *b);

/**
 * stats_wilson - two-sided 95 % Wilson score interval for k of n
 * At the ends the rule of three: with k == 0 hi is 3/n, with k == n lo is 1 - 3/n (within 0..1). n > 0. Pure.
 */
void stats_wilson(uint64_t k, uint64_t n, double *lo, double *hi);

/**
 * stats_quantile - value [m] below which a share @q (0..1) of histogram @h lies, linear within its bin
 * @off_m: lower edge of bin 0
 * NaN if it falls into the overflow bin or the histogram is empty. Pure.
 */
double stats_quantile(const uint64_t h[MC_HIST_BINS], double off_m, double q);

/**
 * stats_finish - the whole result from @sums and, with MC_WANT_HIST, @hist (else NULL)
 * Fills id, hash and flags too: cut if fewer samples than @req asks for. Without any sample p is NaN in 0..1. Pure.
 */
void stats_finish(const struct mc_request *req, const struct stats_sums *sums,
		  const struct mc_hist *hist, struct mc_result *res);

#endif
