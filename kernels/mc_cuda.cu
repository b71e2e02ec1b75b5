/* SPDX-License-Identifier: MIT
 * The kernels of the CUDA backend, and nothing else: which rollout runs on which draws is decided here, everything about
 * memory, launches and errors on the host side (mc_cuda.c). One thread rolls one sample of one future; blocks add up
 * integers, so that neither their order nor their number shows in a result. The only file that nvcc compiles.
 */
#include "mc_cuda_dev.h"
#include "mc_ops.h"
#include "tally.h"

/* Copies @n words; the threads of a block share the work. */
static __device__ void copy_words(void *to, const volatile void *from, uint32_t bytes)
{
	uint32_t *t = (uint32_t *)to;
	const volatile uint32_t *f = (const volatile uint32_t *)from;

	for (uint32_t i = threadIdx.x; i < bytes / sizeof(uint32_t); i += blockDim.x) {
		t[i] = f[i];
	}
}

static __device__ void clear_words(void *p, uint32_t bytes)
{
	for (uint32_t i = threadIdx.x; i < bytes / sizeof(uint32_t); i += blockDim.x) {
		((uint32_t *)p)[i] = 0;
	}
}

/* ---- before the batch: the job from mapped memory, the sums to zero ------------------------------ */

static __global__ void fetch(struct cuda_args a)
{
	uint64_t *sum = &a.work->sum[0][0];

	copy_words(&a.work->job, a.job, sizeof(struct cuda_job));
	if (threadIdx.x < MC_FUTURES_MAX * CUDA_SUMS) {
		sum[threadIdx.x] = 0;
	}
	if (threadIdx.x == 0) {
		a.work->check = 0;
		a.work->ticket = 0;
		a.work->lo = MC_HIST_BINS;
		a.work->hi = 0;
	}
}

/* ---- one sample ---------------------------------------------------------------------------------- */

/* Inputs of draw first + i: from the resident draws @z of first, or made here from the same plan. Returns 1 if a floor
 * lifted one. */
template <bool GENERATE>
static __device__ __forceinline__ uint32_t draw(const float *z, uint32_t stride,
						const struct normal_plan *normal,
						const struct sample_plan *plan, uint64_t first,
						uint32_t i, float in[MODEL_INPUTS])
{
	if (GENERATE) {
		float made[MC_DIM];

#pragma unroll
		for (uint32_t g = 0; g < NORMAL_GROUPS; g++) {
			normal_four(normal, first + i, g, made + 4 * g);
		}
		return (uint32_t)sample_draw(plan, made, 1, in, 1);
	}
	return (uint32_t)sample_draw(plan, z + i, stride, in, 1);
}

#include "mc_cuda_batch.cuh"

/* ---- per-sample results ---------------------------------------------------------------------------- */

template <enum mc_rollout WHICH>
static __global__ void __launch_bounds__(128) samples(struct cuda_samples_args a)
{
	const struct cuda_job *job = a.job;
	const uint64_t all = (uint64_t)job->count * job->n_futures;

	for (uint64_t k = blockIdx.x * blockDim.x + threadIdx.x; k < all;
	     k += (uint64_t)gridDim.x * blockDim.x) {
		const uint32_t future = (uint32_t)(k / job->count), i = (uint32_t)(k % job->count);
		const uint64_t index = job->first + i;
		float in[MODEL_INPUTS];

		if (a.in) {
			for (uint32_t d = 0; d < MODEL_INPUTS; d++) {
				in[d] = a.in[(size_t)d * job->count + i];
			}
		} else if (index < a.n_resident) {
			draw<false>((const float *)(a.resident + 1) + job->first,
				    a.resident->stride, NULL, &job->sample, 0, i, in);
		} else {
			draw<true>(NULL, 0, &a.resident->normal, &job->sample, job->first, i, in);
		}
		a.out[k] = WHICH == MC_FAST ? rollout_sample(&job->roll[future], in, 1)
					    : model_rollout(&job->vehicle, &job->future[future],
							    job->horizon_s, a.dt_s, in, 1);
	}
}

#include "mc_cuda_paper.cuh"

#ifdef MC_CUDA_FAULTS
#include "../tests/gpu/faults.cuh"
#endif

extern "C" const struct cuda_kernel_row cuda_kernel_table[CUDA_KERNELS] = {
#define CUDA_KERNEL(id, name, function, block, shared) \
	{name, (const void *)function, block, shared},
#include "mc_cuda_kernels.def"
#undef CUDA_KERNEL
};
