/* SPDX-License-Identifier: MIT
 * What the CUDA backend offers beyond struct mc_ops: which device it is, and the stopwatch of the benchmarks.
 * Without CUDA in the build every function here returns -ENOTSUP.
 */
#ifndef AEBMC_MC_CUDA_H
#define AEBMC_MC_CUDA_H

#include "mc_ops.h"

/* The device, and what a measurement on it depends on. */
struct mc_cuda_info {
	char name[256];
	int major, minor;                /* compute capability */
	int sms;                         /* multiprocessors */
	int clock_khz, memory_clock_khz; /* the highest the driver states */
	int driver, runtime;             /* CUDA versions, 1000 * major + 10 * minor */
};

#define MC_CUDA_PEAK_OPS 1000000000000.0

/* What the stopwatch can time. */
enum mc_cuda_rung {
	MC_CUDA_PAPER, /* the paper's kernel (Sec. V): f64, copies to and from the device; draws from the host */
	MC_CUDA_REFERENCE, /* the reference rollout on resident draws, results left on the device */
	MC_CUDA_FAST, /* what run() does: fast rollout, statistics, result readable by the host */
	MC_CUDA_PEAK, /* plain f32 multiply-adds */
	MC_CUDA_RUNGS
};

struct mc_cuda_time {
	double kernel_ns; /* on the device, by its own events */
	double total_ns;  /* the same with copies, where the rung has them */
};

/** mc_cuda_info - the device that the backend would run on. Blocks while the driver starts. 0 or -errno (mc_ops.h). */
int mc_cuda_info(struct mc_cuda_info *ret);

/**
 * mc_cuda_time - timed executions, one after the other; not for the daemon
 * @req:  for REFERENCE at most as many samples as resident draws; PAPER takes those again and again; both take the first
 *         future alone
 * @dt_s: step of PAPER and REFERENCE
 * @ret:  [repeats]
 * Allocates and frees. 0, -EINVAL, or -errno as in mc_ops.h.
 */
int mc_cuda_time(struct mc_backend *b, enum mc_cuda_rung rung, const struct mc_request *req,
		 double dt_s, uint32_t repeats, struct mc_cuda_time *ret);

#endif
