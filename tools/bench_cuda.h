/* SPDX-License-Identifier: MIT
 * aebmc bench --backend cuda: what was measured (bench_cuda.c) and how it is shown (bench_cuda_out.c).
 */
#ifndef AEBMC_BENCH_CUDA_H
#define AEBMC_BENCH_CUDA_H

#include "bench_time.h"
#include "compute.h"
#include "mc_cuda.h"

#define BENCH_CUDA_MAIN    (1u << 20)
#define BENCH_CUDA_SCALAR  2000u /* samples that the scalar CPU is timed on; the rest is scaled */
#define BENCH_CUDA_STEPS   5
#define BENCH_CUDA_TRUTH_S 1e-4 /* step against which the others are held */

extern const double bench_cuda_step_s[BENCH_CUDA_STEPS];

enum bench_cuda_column {
	BC_PAPER,
	BC_PAPER_TOTAL,
	BC_REFERENCE,
	BC_FAST,
	BC_FAST_TOTAL,
	BC_CPU,
	BC_COLUMNS
};
enum bench_cuda_row {
	BC_MAIN_PAPER,
	BC_MAIN_REFERENCE,
	BC_MAIN_FAST,
	BC_MAIN_MOVING,
	BC_MAIN_FUTURES,
	BC_MAIN_ROWS
};

struct bench_cuda {
	struct mc_backend *gpu, *cpu;
	struct mc_cuda_info info;
	struct bench_timing figure[BENCH_SIZES][BC_COLUMNS];
	struct bench_timing main[BC_MAIN_ROWS], peak, step[BENCH_CUDA_STEPS];
	double scalar_ns; /* a sample, one core */
	double stop_max_m[BENCH_CUDA_STEPS + 1],
		stop_rms_m[BENCH_CUDA_STEPS + 1]; /* the last: the fast rollout */
};

/** bench_cuda - all tables, in words or JSON. Returns an exit code. */
int bench_cuda(const char *name, const struct compute_args *a);

/** bench_cuda_json, bench_cuda_words - on standard output. */
void bench_cuda_json(const struct bench_cuda *t, const struct compute_args *a);
void bench_cuda_words(const struct bench_cuda *t);

#endif
