/* SPDX-License-Identifier: MIT
 * One chunk of a batch: what a block keeps, how its warps roll samples and count, the auditor, and how the last block hands
 * the sums over. Included by mc_cuda.cu alone.
 */

#define BATCH_BLOCK  256
#define BATCH_PER_SM 3
#define HIST_BLOCK   768
#define HIST_PER_SM  1
#define HIST_STAGGER 96
#define HIST_SHARED  (MC_HIST_BINS * (uint32_t)sizeof(uint32_t))

/* ---- a block's memory ----------------------------------------------------------------------------- */

#define POOL_MAX 40u /* below a warp, and what one round may add */
#define POOL_FEW 8u  /* colliding lanes below which a warp had better wait for more */

/* What all threads of a block read, and where they add up. */
struct alignas(16) block_memory {
	struct sample_plan sample;
	struct rollout_plan roll;
	uint64_t first;
	const float *draws; /* of the first sample */
	uint32_t flags, count, step, future, stride, histograms;
	int32_t centre;
	uint64_t sum[CUDA_SUMS];
	uint32_t last, lo, hi;
};

/* What each thread counts; in shared memory, because registers are what limits how many warps run at once. */
template <bool HIST> struct thread_sums {
	static const uint32_t threads = HIST ? HIST_BLOCK : BATCH_BLOCK,
			      hist_threads = HIST ? HIST_BLOCK : 1;
	uint32_t n[threads], floored[threads], hits[threads], undecided[threads], impact[threads];
	int64_t stop[hist_threads];
	uint64_t stop2[hist_threads];
};

/* ---- a block's part of a batch ------------------------------------------------------------------------ */

static __device__ uint64_t warp_sum(uint64_t x)
{
	for (int d = 16; d; d >>= 1) {
		x += __shfl_down_sync(0xffffffffu, x, d);
	}
	return x;
}

template <bool HIST>
static __device__ void add_up(struct block_memory *s, struct cuda_work *work,
			      const thread_sums<HIST> *t)
{
	const uint32_t me = threadIdx.x;
	const uint64_t mine[CUDA_SUMS] = {t->n[me],
					  t->floored[me],
					  t->hits[me],
					  t->undecided[me],
					  t->impact[me],
					  HIST ? (uint64_t)t->stop[me] : 0,
					  HIST ? t->stop2[me] : 0};

	for (uint32_t i = 0; i < CUDA_SUMS; i++) {
		const uint64_t x = warp_sum(mine[i]);

		if (threadIdx.x % 32 == 0 && x) {
			atomicAdd((unsigned long long *)&s->sum[i], x);
		}
	}
	__syncthreads();
	if (threadIdx.x < CUDA_SUMS && s->sum[threadIdx.x]) {
		const uint64_t x = s->sum[threadIdx.x];

		atomicAdd((unsigned long long *)&work->sum[s->future][threadIdx.x], x);
		atomicAdd((unsigned long long *)&work->check,
			  x * cuda_check_weight(s->future, threadIdx.x));
	}
}

extern __shared__ uint32_t hist[]; /* [MC_HIST_BINS] */

/* A bin holds two counters: stop below, need above. */
static __device__ __forceinline__ void count_hist(const struct rollout *r,
						  const struct block_memory *s, uint32_t flags,
						  thread_sums<true> *t)
{
	const float shift = r->headway - s->sample.mean[MODEL_HEADWAY];
	const int64_t q = tally_units(r->stop) - s->centre;

	t->stop[threadIdx.x] += q;
	t->stop2[threadIdx.x] += (uint64_t)(q * q);
	atomicAdd(&hist[tally_stop_bin(r->stop, flags)], 1u);
	atomicAdd(&hist[tally_need_bin(r->need, shift, flags, s->flags)], 0x10000u);
}

static __device__ __forceinline__ void count_hist(const struct rollout *r,
						  const struct block_memory *s, uint32_t flags,
						  thread_sums<false> *t)
{
}

/*
 * A warp is as slow as its slowest lane, and the impact speed of one lane takes as long as that of all. Where only a
 * few lanes collide their indices wait in the warp's pool until they fill a warp, and are rolled again from the start.
 */
template <bool HIST, bool GENERATE>
static __device__ void roll(const struct cuda_args *a, struct block_memory *s,
			    const struct normal_plan *normal, thread_sums<HIST> *t, uint32_t *pool,
			    uint32_t rank)
{
	const uint32_t me = threadIdx.x, lane = me % 32;
	/* neighbouring warps of a block take samples far apart: the last round is shared by all blocks */
	uint32_t base = s->step ? (me / 32 * (s->step / blockDim.x) + rank) * 32 : s->count,
		 pooled = 0;

	while (base < s->count || pooled) {
		const bool again = pooled >= 32 || base >= s->count;
		const uint32_t left = again ? pooled : s->count - base, n = left < 32 ? left : 32;
		uint32_t index = base + lane, contact = 0, mask;
		struct rollout r;

		/* the plan stays in shared memory: as registers it would spill */
		asm volatile("" ::: "memory");
		pooled -= again ? n : 0;
		if (lane < n) {
			float in[MODEL_INPUTS];
			uint32_t flags, lifted;

			index = again ? pool[pooled + lane] : index;
			lifted = draw<GENERATE>(s->draws, s->stride, normal, &s->sample, s->first,
						index, in);
			t->floored[me] += again ? 0 : lifted;
			flags = rollout_need(&s->roll, in, 1, &r);
			contact = flags & MODEL_CONTACT && s->flags & MC_WANT_IMPACT;
			if (!again) {
				t->n[me]++;
				t->hits[me] += tally_contact(flags, s->flags);
				t->undecided[me] += tally_undecided(flags, s->flags);
				if (HIST && s->histograms) {
					count_hist(&r, s, flags, t);
				}
			}
		}
		mask = __ballot_sync(0xffffffffu, contact);
		if (again || __popc(mask) >= POOL_FEW) {
			if (contact) {
				t->impact[me] += (uint32_t)tally_units(rollout_impact(&r));
			}
		} else {
			if (contact) {
				pool[pooled + __popc(mask & ((1u << lane) - 1))] = index;
			}
			pooled += __popc(mask);
		}
		__syncwarp();
		base += again ? 0 : s->step;
	}
	add_up<HIST>(s, a->work, t);
}

/* A block's histogram into the device's. Blocks start at different bins, so as not to queue for the same ones. */
static __device__ void hist_flush(struct block_memory *s, struct cuda_work *work)
{
	uint32_t lo = MC_HIST_BINS, hi = 0;

	for (uint32_t k = threadIdx.x; k < MC_HIST_BINS; k += blockDim.x) {
		const uint32_t i = (k + blockIdx.x * HIST_STAGGER) % MC_HIST_BINS,
			       stop = hist[i] & 0xffffu, need = hist[i] >> 16;

		if (stop) {
			atomicAdd(&work->stop[i], stop);
		}
		if (need) {
			atomicAdd(&work->need[i], need);
		}
		lo = stop | need && i < lo ? i : lo;
		hi = stop | need && i >= hi ? i + 1 : hi;
	}
	lo = __reduce_min_sync(0xffffffffu, lo);
	hi = __reduce_max_sync(0xffffffffu, hi);
	if (threadIdx.x % 32 == 0) {
		atomicMin(&s->lo, lo);
		atomicMax(&s->hi, hi);
	}
	__syncthreads();
	if (threadIdx.x == 0) {
		atomicMin(&work->lo, s->lo);
		atomicMax(&work->hi, s->hi);
	}
}

/* ---- the auditor: one block of each chunk, another one every time --------------------------------- */

/* Words from..to-1, by the threads from @warp on; all of them multiples of four words. */
static __device__ uint64_t digest(const void *p, uint32_t from, uint32_t to, uint32_t warp)
{
	const uint4 *w = (const uint4 *)p;
	uint64_t sum = 0;

#pragma unroll 8
	for (uint32_t i = from / 4 + threadIdx.x - 32 * warp; i < to / 4;
	     i += blockDim.x - 32 * warp) {
		const uint4 x = __ldcg(&w[i]);

		sum += cuda_digest_word(x.x, 4ull * i) + cuda_digest_word(x.y, 4ull * i + 1) +
		       cuda_digest_word(x.z, 4ull * i + 2) + cuda_digest_word(x.w, 4ull * i + 3);
	}
	return warp_sum(sum);
}

static __device__ __noinline__ void audit(struct cuda_args args, struct block_memory *s)
{
	const struct cuda_args *a = &args;
	const struct cuda_resident *res = a->resident;
	const uint32_t from = a->work->job.slice * CUDA_SLICE_WORDS;
	const uint32_t to =
		from + CUDA_SLICE_WORDS < res->words ? from + CUDA_SLICE_WORDS : res->words;

	if (threadIdx.x < CUDA_CANARIES) {
		a->out->canary[threadIdx.x] = rollout_sample(
			&res->canary_plan, &res->canary[0][threadIdx.x], CUDA_CANARIES);
	} else {
		const uint64_t job =
			digest(&a->work->job, 0, sizeof(struct cuda_job) / sizeof(uint32_t), 1);
		const uint64_t slice = digest(res, from, to, 1);

		if (threadIdx.x % 32 == 0) {
			atomicAdd((unsigned long long *)&s->sum[0], job);
			atomicAdd((unsigned long long *)&s->sum[1], slice);
		}
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

/* The bins from lo to hi; the device's own back to zero. */
static __device__ void publish_hist(const struct cuda_args *a)
{
	const uint32_t lo = __ldcg(&a->work->lo), hi = __ldcg(&a->work->hi);

	for (uint32_t i = lo + threadIdx.x; i < hi; i += blockDim.x) {
		a->out->stop[i] = __ldcg(&a->work->stop[i]);
		a->out->need[i] = __ldcg(&a->work->need[i]);
		a->work->stop[i] = 0;
		a->work->need[i] = 0;
	}
	if (threadIdx.x == 0) {
		a->out->lo = lo;
		a->out->hi = hi;
	}
}

template <bool HIST> static __device__ void publish(const struct cuda_args *a)
{
	const uint64_t *sum = &a->work->sum[0][0];

	if (threadIdx.x < MC_FUTURES_MAX * CUDA_SUMS) {
		(&a->out->sum[0][0])[threadIdx.x] = __ldcg(&sum[threadIdx.x]);
	}
	if (threadIdx.x == 0) {
		a->out->check = __ldcg(&a->work->check);
	}
	if (HIST) {
		publish_hist(a);
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
	__shared__ struct block_memory s;
	__shared__ thread_sums<HIST> sums;
	__shared__ uint32_t normal[GENERATE ? sizeof(struct normal_plan) / sizeof(uint32_t) : 1];
	__shared__ uint32_t pool[HIST ? HIST_BLOCK / 32 : BATCH_BLOCK / 32][POOL_MAX];
	const struct cuda_job *job = &a.work->job;
	const uint32_t rank =
		(blockIdx.x + gridDim.x - (uint32_t)(job->seq % gridDim.x)) % gridDim.x;

	if (threadIdx.x < CUDA_SUMS) {
		s.sum[threadIdx.x] = 0;
	}
	if (threadIdx.x == 0) {
		s.lo = MC_HIST_BINS;
		s.hi = 0;
	}
	if (rank == 0) {
		__syncthreads();
		audit(a, &s);
	} else {
		const uint32_t future = (rank - 1) % job->n_futures,
			       slot = (rank - 1) / job->n_futures;
		const uint32_t slots = (gridDim.x - 1) / job->n_futures;
		const bool histograms = HIST && future == job->hist_future;

		clear_words(&sums, sizeof(sums));
		copy_words(&s.sample, &job->sample, sizeof(s.sample));
		copy_words(&s.roll, &job->roll[future], sizeof(s.roll));
		if (threadIdx.x == 0) {
			s.first = job->first;
			s.draws = (const float *)(a.resident + 1) + job->first;
			s.flags = job->flags;
			s.count = job->count;
			s.centre = job->centre;
			s.future = future;
			s.stride = a.resident->stride;
			s.histograms = histograms;
			s.step = slot < slots ? slots * blockDim.x : 0;
		}
		if (GENERATE) {
			copy_words(normal, &a.resident->normal, sizeof(normal));
		}
		if (histograms) {
			clear_words(hist, MC_HIST_BINS * sizeof(*hist));
		}
		__syncthreads();
		roll<HIST, GENERATE>(&a, &s, (const struct normal_plan *)normal, &sums,
				     pool[threadIdx.x / 32], slot);
		if (histograms) {
			hist_flush(&s, a.work);
		}
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
