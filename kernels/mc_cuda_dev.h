/* SPDX-License-Identifier: MIT
 * What the host side of the CUDA backend and its kernels share: the job and the results in pinned, mapped memory, what
 * stays resident on the device, and the table of kernels. For mc_cuda*.c, mc_cuda.cu and their tests.
 */
#ifndef AEBMC_MC_CUDA_DEV_H
#define AEBMC_MC_CUDA_DEV_H

#include <assert.h>
#include "normal.h"
#include "rollout.h"
#include "sample.h"

#define CUDA_CANARIES    32u
#define CUDA_SLICE_WORDS 4096u      /* of the resident memory, checked with every chunk */
#define CUDA_CHUNK       (1u << 22) /* samples between two looks at the cut word; all sums fit 64 bit */

/* Samples of a chunk for each block of a histogram kernel: a bin has 16 bits there, and blocks differ by one round. */
#define CUDA_HIST_BLOCK_MAX 60000u

/* Samples of a chunk for each thread: 32 bits hold their impact speeds. */
#define CUDA_THREAD_MAX 4000u

/* What is counted for each future; n and floored for future 0 alone. */
enum cuda_sum {
	CUDA_N,
	CUDA_FLOORED,
	CUDA_HITS,
	CUDA_UNDECIDED,
	CUDA_IMPACT, /* [2^-10 m/s] */
	CUDA_STOP,   /* sum of (q - centre), two's complement */
	CUDA_STOP2,  /* sum of (q - centre)^2 */
	CUDA_SUMS
};

/* One chunk of a batch. The host writes it, the first kernel copies it to the device. */
struct cuda_job {
	uint64_t seq;   /* number of this chunk, from 1; echoed last */
	uint64_t first; /* draw of its first sample */
	uint64_t hash;  /* mc_request_hash(), echoed */
	uint32_t count; /* 1..CUDA_CHUNK */
	uint32_t flags; /* of the request */
	uint32_t n_futures;
	uint32_t hist_future;
	int32_t centre; /* stats_centre() */
	uint32_t slice; /* which part of the resident memory to check */
	struct sample_plan sample;
	struct model_vehicle vehicle;
	struct model_future future[MC_FUTURES_MAX];
	struct rollout_plan roll[MC_FUTURES_MAX];
	float horizon_s;
	uint32_t pad;
};

/* The answer to one chunk. The device writes it, seq last and after a system-wide fence. */
struct cuda_out {
	uint64_t hash;      /* of the job */
	uint64_t digest;    /* of the job's words as the device held them */
	uint64_t slice_sum; /* of the resident slice */
	uint64_t check;     /* weighted sum of sum[][] that the blocks kept apart */
	uint64_t sum[MC_FUTURES_MAX][CUDA_SUMS];
	struct model_out canary[CUDA_CANARIES];
	uint32_t lo, hi; /* the bins outside lo..hi-1 are empty, and not written */
	uint32_t stop[MC_HIST_BINS], need[MC_HIST_BINS];
	uint64_t seq;
};

/* Accumulators of one chunk, on the device; all zero but the job between chunks. */
struct cuda_work {
	struct cuda_job job;
	uint64_t sum[MC_FUTURES_MAX][CUDA_SUMS];
	uint64_t check;
	uint32_t ticket, lo, hi, pad;
	uint32_t stop[MC_HIST_BINS], need[MC_HIST_BINS];
};

/* Resident on the device for as long as the backend is open, followed by the draws [MC_DIM][stride]. */
struct cuda_resident {
	struct normal_plan normal;
	struct rollout_plan canary_plan;
	float canary[MODEL_INPUTS][CUDA_CANARIES];
	uint32_t stride;
	uint32_t words; /* of all of it, draws included */
	uint32_t pad[9];
};

static_assert(sizeof(struct cuda_job) % 8 == 0, "copied and checked in words");
static_assert(sizeof(struct sample_plan) % 16 == 0,
	      "the plan behind it is read 16 bytes at a time");
static_assert(sizeof(struct cuda_resident) % 64 == 0, "the draws that follow are aligned");

/* What a kernel reads and writes; every kernel of a batch takes this one argument. */
struct cuda_args {
	const struct cuda_resident *resident;
	const struct cuda_job *job; /* mapped */
	struct cuda_work *work;
	struct cuda_out *out; /* mapped */
};

/* One sample at a time, for mc_ops.samples and .roll: device memory throughout. */
struct cuda_samples_args {
	const struct cuda_resident *resident;
	const struct cuda_job *job;
	const float *in;       /* [MODEL_INPUTS][count], NULL: draws of the job */
	struct model_out *out; /* [n_futures][count] */
	uint32_t n_resident;
	uint32_t pad;
	double dt_s; /* of the reference rollout */
};

/* The paper's kernel: parameters as an array of structures (Sec. V). */
struct cuda_paper_sample {
	double mu, grade, mass, drag, tau;
};

struct cuda_paper_args {
	const double *v0;                      /* [count] */
	const struct cuda_paper_sample *param; /* [count] */
	double *stop_m;                        /* [count] */
	uint32_t count, pad;
	double rho_kgpm3, area_m2, gravity_mps2, h_over_l, cmd_mps2, dt_s, horizon_s;
};

/* out [blocks * threads] */
struct cuda_peak_args {
	float *out;
	uint32_t rounds; /* of eight multiply-adds */
	float gain, offset;
};

enum cuda_kernel {
#define CUDA_KERNEL(id, name, function, block, shared) CUDA_KERNEL_##id,
#include "mc_cuda_kernels.def"
#undef CUDA_KERNEL
	CUDA_KERNELS
};

struct cuda_kernel_row {
	const char *name;
	const void *function;
	uint32_t block;  /* threads */
	uint32_t shared; /* dynamic shared memory [bytes] */
};

#ifdef __cplusplus
extern "C" {
#endif
extern const struct cuda_kernel_row cuda_kernel_table[CUDA_KERNELS];
#ifdef __cplusplus
}
#endif

/* Checksums: order-free, and no single changed bit leaves them as they were. */
HD uint64_t cuda_digest_word(uint32_t word, uint64_t index)
{
	return (uint64_t)word * (2u * index + 1u);
}

HD uint64_t cuda_check_weight(uint32_t future, uint32_t sum)
{
	return 0x9e3779b97f4a7c15u * (future * CUDA_SUMS + sum) | 1u;
}

#endif
