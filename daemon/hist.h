/* SPDX-License-Identifier: MIT
 * A histogram of durations in fixed memory: 16 buckets to each doubling from 1 us to 17 s, so that a percentile read
 * from it lies at most 1/16 above the true one. One thread adds, any thread reads.
 */
#ifndef AEBMC_HIST_H
#define AEBMC_HIST_H

#include <stdint.h>

#define HIST_SHIFT   10 /* the first bucket ends at 2^10 ns */
#define HIST_OCTAVES 24
#define HIST_SUB     16                            /* a power of two */
#define HIST_BUCKETS (HIST_OCTAVES * HIST_SUB + 2) /* one below, one above */

/* Words are read and written whole; a reader may see one value counted in n and not yet in its bucket. */
struct hist {
	uint64_t n;
	int64_t max_ns; /* 0 without a value */
	uint64_t bucket[HIST_BUCKETS];
};

/** hist_add - count one duration; one below 0 counts as 0. No allocation, no lock. */
void hist_add(struct hist *h, int64_t ns);

/** hist_bucket - where a duration is counted, 0..HIST_BUCKETS-1. Pure. */
int hist_bucket(int64_t ns);

/** hist_end_ns - the first duration past bucket @b; INT64_MAX for the last one. Pure. */
int64_t hist_end_ns(int b);

/**
 * hist_percentile - the duration that the share @q (0..1] of all stayed within (nearest rank)
 * The upper end of its bucket, or the maximum if that is less: never less than is true. -1 without a value.
 */
int64_t hist_percentile(const struct hist *h, double q);

/** hist_count, hist_max_ns - for another thread than the one that adds. */
uint64_t hist_count(const struct hist *h);
int64_t hist_max_ns(const struct hist *h);

/** hist_rank - how many of @n values the nearest-rank percentile @q counts, 1..n; 0 if n is 0. Pure. */
uint64_t hist_rank(uint64_t n, double q);

#endif
