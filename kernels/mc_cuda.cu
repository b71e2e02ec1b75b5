/* SPDX-License-Identifier: MIT
 * The kernels of the CUDA backend, and nothing else: which rollout runs on which draws is decided here, everything about
 * memory, launches and errors on the host side (mc_cuda.c). One thread rolls one sample of one future; blocks add up
 * integers, so that neither their order nor their number shows in a result. The only file that nvcc compiles.
 */
#include "mc_cuda_dev.h"
#include "mc_ops.h"
#include "tally.h"

#define BATCH_BLOCK  128
#define BATCH_PER_SM 5
#define HIST_BLOCK   512
#define HIST_PER_SM  1
#define HIST_SHARED  (2u * MC_HIST_BINS * (uint32_t)sizeof(uint32_t))

#define CONCAT(a, b) a##b

/* Copies @n words; the threads of a block share the work. */
static __device__ void copy_words(void *to, const volatile void *from, uint32_t bytes)
{
	uint32_t *t = (uint32_t *)to;
	const volatile uint32_t *f = (const volatile uint32_t *)from;

	for (uint32_t i = threadIdx.x; i < bytes / sizeof(uint32_t); i += blockDim.x) {
		t[i] = f[i];
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
	}
}

/* ---- one sample ---------------------------------------------------------------------------------- */

/* Inputs of draw @index: from the resident table, or made here from the same plan. Returns 1 if a floor lifted one. */
template <bool GENERATE>
static __device__ __forceinline__ int
draw(const struct cuda_resident *res, const struct normal_plan *normal,
     const struct sample_plan *plan, uint64_t index, float in[MODEL_INPUTS])
{
	if (GENERATE) {
		float z[MC_DIM];

		for (uint32_t g = 0; g < NORMAL_GROUPS; g++) {
			normal_four(normal, index, g, z + 4 * g);
		}
		return sample_draw(plan, z, 1, in, 1);
	}
	return sample_draw(plan, (const float *)(res + 1) + index, res->stride, in, 1);
}

/* ---- a block's part of a batch ------------------------------------------------------------------- */

struct block_memory {
	struct sample_plan sample;
	struct rollout_plan roll;
	struct normal_plan normal;
	uint64_t sum[CUDA_SUMS];
	uint32_t last;
};

/* What one thread counts; 32 bits hold CUDA_CHUNK samples. */
struct thread_sums {
	uint32_t n, floored, hits, undecided;
	uint64_t impact;
	int64_t stop;
	uint64_t stop2;
};

static __device__ uint64_t warp_sum(uint64_t x)
{
	for (int d = 16; d; d >>= 1) {
		x += __shfl_down_sync(0xffffffffu, x, d);
	}
	return x;
}

static __device__ void add_up(struct block_memory *s, struct cuda_work *work, uint32_t future,
			      const struct thread_sums *t)
{
	const uint64_t mine[CUDA_SUMS] = {t->n,      t->floored,        t->hits, t->undecided,
					  t->impact, (uint64_t)t->stop, t->stop2};

	for (uint32_t i = 0; i < CUDA_SUMS; i++) {
		const uint64_t x = warp_sum(mine[i]);

		if (threadIdx.x % 32 == 0 && x) {
			atomicAdd((unsigned long long *)&s->sum[i], x);
		}
	}
	__syncthreads();
	if (threadIdx.x < CUDA_SUMS && s->sum[threadIdx.x]) {
		const uint64_t x = s->sum[threadIdx.x];

		atomicAdd((unsigned long long *)&work->sum[future][threadIdx.x], x);
		atomicAdd((unsigned long long *)&work->check,
			  x * cuda_check_weight(future, threadIdx.x));
	}
}

template <bool HIST, bool GENERATE>
static __device__ void roll(const struct cuda_args *a, struct block_memory *s, uint32_t *hist,
			    uint32_t rank)
{
	const struct cuda_job *job = &a->work->job;
	const uint32_t futures = job->n_futures, future = rank % futures;
	const uint32_t slots = (gridDim.x - 1) / futures, slot = rank / futures;
	const uint32_t flags = job->flags, count = job->count;
	const bool histograms = HIST && future == job->hist_future;
	struct thread_sums t = {};

	copy_words(&s->sample, &job->sample, sizeof(s->sample));
	copy_words(&s->roll, &job->roll[future], sizeof(s->roll));
	if (GENERATE) {
		copy_words(&s->normal, &a->resident->normal, sizeof(s->normal));
	}
	for (uint32_t i = threadIdx.x; HIST && i < 2 * MC_HIST_BINS; i += blockDim.x) {
		hist[i] = 0;
	}
	__syncthreads();
	for (uint32_t i = slot * blockDim.x + threadIdx.x; slot < slots && i < count;
	     i += slots * blockDim.x) {
		float in[MODEL_INPUTS];

		asm volatile(
			"" ::
				: "memory"); /* the plan stays in shared memory: as registers it would spill */
		const int lifted =
			draw<GENERATE>(a->resident, &s->normal, &s->sample, job->first + i, in);
		const struct model_out out = rollout_sample(&s->roll, in, 1);

		t.n += future == 0;
		t.floored += future == 0 ? lifted : 0;
		t.hits += tally_contact(out.flags, flags);
		t.undecided += tally_undecided(out.flags, flags);
		t.impact += (uint32_t)tally_units(out.impact_mps);
		if (histograms) {
			const int64_t q = tally_units(out.stop_m) - job->centre;

			t.stop += q;
			t.stop2 += (uint64_t)(q * q);
			atomicAdd(&hist[tally_stop_bin(out.stop_m, out.flags)], 1u);
			atomicAdd(&hist[MC_HIST_BINS +
					tally_need_bin(out.need_m,
						       in[MODEL_HEADWAY] -
							       s->sample.mean[MODEL_HEADWAY],
						       out.flags, flags)],
				  1u);
		}
	}
	add_up(s, a->work, future, &t);
	for (uint32_t i = threadIdx.x; histograms && i < 2 * MC_HIST_BINS; i += blockDim.x) {
		if (hist[i]) {
			atomicAdd(i < MC_HIST_BINS ? &a->work->stop[i]
						   : &a->work->need[i - MC_HIST_BINS],
				  hist[i]);
		}
	}
}

/* ---- the auditor: one block of each chunk, another one every time --------------------------------- */

static __device__ uint64_t digest(const void *p, uint32_t from, uint32_t to)
{
	const uint32_t *w = (const uint32_t *)p;
	uint64_t sum = 0;

	for (uint32_t i = from + threadIdx.x; i < to; i += blockDim.x) {
		sum += cuda_digest_word(__ldcg(&w[i]), i);
	}
	return warp_sum(sum);
}

static __device__ void audit(const struct cuda_args *a, struct block_memory *s)
{
	const struct cuda_resident *res = a->resident;
	const uint32_t from = a->work->job.slice * CUDA_SLICE_WORDS;
	const uint32_t to =
		from + CUDA_SLICE_WORDS < res->words ? from + CUDA_SLICE_WORDS : res->words;
	const uint64_t job = digest(&a->work->job, 0, sizeof(struct cuda_job) / sizeof(uint32_t));
	const uint64_t slice = digest(res, from, to);

	if (threadIdx.x % 32 == 0) {
		atomicAdd((unsigned long long *)&s->sum[0], job);
		atomicAdd((unsigned long long *)&s->sum[1], slice);
	}
	if (threadIdx.x < CUDA_CANARIES) {
		a->out->canary[threadIdx.x] = rollout_sample(
			&res->canary_plan, &res->canary[0][threadIdx.x], CUDA_CANARIES);
	}
	__syncthreads();
	if (threadIdx.x == 0) {
		a->out->hash = a->work->job.hash;
		a->out->digest = s->sum[0];
		a->out->slice_sum = s->sum[1];
	}
	__threadfence_system();
}

/* ---- the end: the last block to arrive hands everything over ---------------------------------------- */

template <bool HIST> static __device__ void publish(const struct cuda_args *a)
{
	const uint64_t *sum = &a->work->sum[0][0];

	if (threadIdx.x < MC_FUTURES_MAX * CUDA_SUMS) {
		(&a->out->sum[0][0])[threadIdx.x] = __ldcg(&sum[threadIdx.x]);
	}
	if (threadIdx.x == 0) {
		a->out->check = __ldcg(&a->work->check);
	}
	for (uint32_t i = threadIdx.x; HIST && i < MC_HIST_BINS; i += blockDim.x) {
		a->out->stop[i] = __ldcg(&a->work->stop[i]);
		a->out->need[i] = __ldcg(&a->work->need[i]);
		a->work->stop[i] = 0;
		a->work->need[i] = 0;
	}
	__threadfence_system();
	__syncthreads();
	if (threadIdx.x == 0) {
		*(volatile uint64_t *)&a->out->seq = a->work->job.seq;
	}
}

template <bool HIST, bool GENERATE>
static __global__ void __launch_bounds__(HIST ? HIST_BLOCK : BATCH_BLOCK,
					 HIST ? HIST_PER_SM : BATCH_PER_SM)
	batch(struct cuda_args a)
{
	extern __shared__ uint32_t hist[]; /* [2][MC_HIST_BINS] */
	__shared__ struct block_memory s;
	const uint32_t rank =
		(blockIdx.x + gridDim.x - (uint32_t)(a.work->job.seq % gridDim.x)) % gridDim.x;

	if (threadIdx.x < CUDA_SUMS) {
		s.sum[threadIdx.x] = 0;
	}
	__syncthreads();
	if (rank == 0) {
		audit(&a, &s);
	} else {
		roll<HIST, GENERATE>(&a, &s, hist, rank - 1);
	}
	__threadfence();
	__syncthreads();
	if (threadIdx.x == 0) {
		s.last = atomicAdd(&a.work->ticket, 1u) == gridDim.x - 1;
	}
	__syncthreads();
	if (s.last) {
		__threadfence();
		publish<HIST>(&a);
	}
}

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
			draw<false>(a.resident, NULL, &job->sample, index, in);
		} else {
			draw<true>(NULL, &a.resident->normal, &job->sample, index, in);
		}
		a.out[k] = WHICH == MC_FAST ? rollout_sample(&job->roll[future], in, 1)
					    : model_rollout(&job->vehicle, &job->future[future],
							    job->horizon_s, a.dt_s, in, 1);
	}
}

#include "mc_cuda_paper.cuh"

extern "C" const struct cuda_kernel_row cuda_kernel_table[CUDA_KERNELS] = {
#define CUDA_KERNEL(id, name, function, block, shared) \
	{name, (const void *)function, block, shared},
#include "mc_cuda_kernels.def"
#undef CUDA_KERNEL
};
