/* SPDX-License-Identifier: MIT
 * How long a batch takes: what bench and paper measure alike on every backend.
 */
#ifndef AEBMC_BENCH_TIME_H
#define AEBMC_BENCH_TIME_H

#include "mc_ops.h"

#define BENCH_REPS_MAX  1000u
#define BENCH_SIZES     13
#define BENCH_SIZES_CPU 10 /* up to a million */

/* The numbers of samples of the figure of time against N, ascending. */
extern const uint32_t bench_size[BENCH_SIZES];

/* Nanoseconds: median and the value that one in a hundred exceeds (the largest of fewer than a hundred). */
struct bench_timing {
	double p50, p99;
};

/** bench_timing_of - of @n times, 1..; sorts them. */
struct bench_timing bench_timing_of(double *ns, uint32_t n);

/** bench_time_run - @reps runs, 1..BENCH_REPS_MAX, of one request. 0, -EINTR on Ctrl-C or the backend's -errno. */
int bench_time_run(const struct mc_ops *ops, struct mc_backend *b, const struct mc_request *req,
		   uint32_t reps, struct bench_timing *ret);

/** bench_time_sizes - the paper's scene with BENCH_SIZES_CPU numbers of samples, @reps runs each. As bench_time_run. */
int bench_time_sizes(const struct mc_ops *ops, struct mc_backend *b, uint32_t reps,
		     struct bench_timing ret[BENCH_SIZES_CPU]);

/**
 * bench_time_scalar - one core, one sample after the other: the f64 reference, nanoseconds a sample
 * The least of some twenty parts of @n samples: other work on the machine would make every ratio to it larger. 0 or -errno.
 */
int bench_time_scalar(struct mc_backend *cpu, uint32_t n, struct model_out *out, double *ret);

#endif
