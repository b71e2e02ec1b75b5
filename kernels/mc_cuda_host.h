/* SPDX-License-Identifier: MIT
 * The host side of the CUDA backend, private to mc_cuda*.c: one stream, one graph for each kind of batch, everything
 * allocated at open. One thread uses a backend at a time.
 */
#ifndef AEBMC_MC_CUDA_HOST_H
#define AEBMC_MC_CUDA_HOST_H

#include "cuda_calls.h"
#include "draws.h"
#include "mc_cuda.h"
#include "mc_cuda_dev.h"

struct mc_backend {
	struct mc_cuda_info info;

	/* host */
	struct draws *draws; /* the master copy, page-locked */
	int pinned;
	struct cuda_resident head;              /* what stands before the draws on the device */
	struct model_out canary[CUDA_CANARIES]; /* the known answers */
	uint64_t *slice_sum;                    /* [slices] */
	uint32_t n_resident, slices;
	struct mc_hist hist;
	uint32_t hist_lo, hist_hi; /* its bins that are not empty lie within lo..hi-1 */

	/* page-locked, mapped */
	struct cuda_job *job;
	struct cuda_out *out;

	/* device */
	struct cuda_resident *resident;
	struct cuda_work *work;
	struct cuda_args args;       /* the four, as the device sees them */
	uint32_t grid[CUDA_KERNELS]; /* blocks that run at once */
	cudaStream_t stream;
	cudaGraphExec_t graph[CUDA_KERNELS]; /* of the batch kernels */

	uint64_t seq;                 /* of the last chunk launched */
	uint64_t pending;             /* of a chunk that never answered, or 0 */
	int failed;                   /* -errno: the context is gone until the process ends */
	uint32_t spins, sleeps;       /* how long to wait for a chunk */
	const struct mc_watch *watch; /* NULL: nobody is told */
	uint64_t id;                  /* of the request under way */
};

/** mc_cuda_setup - device, memory, resident draws, graphs. Allocates; on failure mc_cuda_teardown() frees. */
int mc_cuda_setup(struct mc_backend *b, const struct mc_params *p);

/** mc_cuda_teardown - free all of it; a backend with a chunk that never answered keeps its memory. */
void mc_cuda_teardown(struct mc_backend *b);

/** mc_cuda_job - the part of a job that a request gives. Pure. */
void mc_cuda_job(struct cuda_job *job, const struct mc_request *req);

/** mc_cuda_chunk - run one chunk on graph @k and verify what came back; @job gets its number. 0 or -errno (mc_ops.h). */
int mc_cuda_chunk(struct mc_backend *b, enum cuda_kernel k, struct cuda_job *job);

/* mc_ops.samples and .roll; they allocate */
int mc_cuda_samples(struct mc_backend *b, const struct mc_request *req, enum mc_rollout which,
		    uint64_t first, uint32_t count, struct model_out *out);
int mc_cuda_roll(struct mc_backend *b, enum mc_rollout which, const struct model_vehicle *veh,
		 const struct model_future *fut, float horizon_s, const float *in, uint32_t count,
		 struct model_out *out);

#endif
