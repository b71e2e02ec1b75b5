/* SPDX-License-Identifier: MIT
 * What a backend is. Synchronous: the caller's thread does the work (or launches it and waits).
 * For mc.c, the backends themselves and offline tools.
 */
#ifndef AEBMC_MC_OPS_H
#define AEBMC_MC_OPS_H

#include "mc.h"

struct mc_backend;

/* Histograms of the last run with MC_WANT_HIST, 0.125 m a bin; see stats.h. */
struct mc_hist {
	uint64_t stop
		[MC_HIST_BINS]; /* stopping distance; bin 0 starts at 0 m; rolling samples in the last bin */
	uint64_t need
		[MC_HIST_BINS]; /* need - (headway - mean headway), bin 0 starts at -MC_HIST_NEED_OFF m    */
};
#define MC_HIST_BIN_M 0.125
#define MC_HIST_NEED_OFF \
	128 /* m below zero kept by the need histogram: a receding lead needs less than nothing */

enum mc_rollout { MC_FAST, MC_REFERENCE };

struct mc_ops {
	const char *name; /* "cpu", "cuda" */

	/* Allocates everything; may block. 0 or -errno, @ret untouched on failure. */
	int (*open)(const struct mc_params *p, struct mc_backend **ret);

	/* Runs a batch. @cut: NULL, or a word read with acquire between chunks: the batch ends early once *cut >= req->id.
	 * 0 or -errno. No allocation. */
	int (*run)(struct mc_backend *b, const struct mc_request *req, const uint64_t *cut,
		   struct mc_result *res);

	/* Per-sample results of draws first..first+count-1 of @req, without statistics: @out is [n_futures][count]. */
	int (*samples)(struct mc_backend *b, const struct mc_request *req, enum mc_rollout which,
		       uint64_t first, uint32_t count, struct model_out *out);

	/* Rolls explicit samples instead of draws: @in is [MODEL_INPUTS][count], @out is [count]. No floors. */
	int (*roll)(struct mc_backend *b, enum mc_rollout which, const struct model_vehicle *veh,
		    const struct model_future *fut, float horizon_s, const float *in,
		    uint32_t count, struct model_out *out);

	/* Histograms of the last run that wanted them; valid until the next run. */
	const struct mc_hist *(*hist)(const struct mc_backend *b);

	/* Tell @w of the edges within run() from now on; it outlives the backend. NULL where there are none. */
	void (*watch)(struct mc_backend *b, const struct mc_watch *w);

	/* One word for humans: lane variant or device name. */
	const char *(*describe)(const struct mc_backend *b);

	void (*close)(struct mc_backend *b); /* NULL and half-open are fine */
};

/*
 * Errors of the CUDA backend, each of which says what happened (of the CPU's: -ENOMEM, and -EBADMSG for its draws):
 * -ENOTSUP   not part of this build                 -EIO        a launch or another call failed
 * -ENOSYS    no driver, or one too old              -EFAULT     a kernel touched an illegal address
 * -ENODEV    no device                              -ETIMEDOUT  a batch did not end (hang)
 * -ENOEXEC   no machine code for this device        -EBADMSG    results, draws or canaries have wrong bits
 * -ENOMEM    device or page-locked memory is short
 */
extern const struct mc_ops mc_cpu_ops, mc_cuda_ops;

#endif
