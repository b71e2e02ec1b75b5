/* SPDX-License-Identifier: MIT
 * The tables of aebmc bench --backend cuda, in words and as JSON.
 */
#include <math.h>
#include "bench_cuda.h"

static const char *const column_key[BC_COLUMNS] = {"paper_kernel",     "paper_with_copies",
						   "reference_kernel", "fast_kernel",
						   "fast_run",         "cpu_simd"};

static const char *const main_key[BC_MAIN_ROWS] = {"paper_style", "reference", "fast_paper",
						   "fast_moving", "fast_futures"};
static const char *const main_words[BC_MAIN_ROWS] = {
	"the paper's kernel (Sec. V), f64, 1 ms", "reference rollout, f64, 1 ms, lead and gap",
	"fast, paper's scene, statistics and impact", "fast, moving lead, statistics and impact",
	"fast, moving lead, four futures, everything"};

static void json_timing(struct json *j, const char *key, const struct bench_timing *x)
{
	json_open(j, key, '{');
	json_num(j, "p50_ns", x->p50);
	json_num(j, "p99_ns", x->p99);
	json_close(j, '}');
}

static void json_device(struct json *j, const struct mc_cuda_info *i)
{
	json_open(j, "device", '{');
	json_str(j, "name", i->name);
	json_num(j, "capability", i->major + i->minor / 10.0);
	json_uint(j, "multiprocessors", (uint64_t)i->sms);
	json_uint(j, "clock_khz", (uint64_t)i->clock_khz);
	json_uint(j, "memory_clock_khz", (uint64_t)i->memory_clock_khz);
	json_uint(j, "cuda_driver", (uint64_t)i->driver);
	json_uint(j, "cuda_runtime", (uint64_t)i->runtime);
	json_close(j, '}');
}

void bench_cuda_json(const struct bench_cuda *t, const struct compute_args *a)
{
	struct json j = json_start(stdout);

	json_head(&j, "bench-cuda");
	compute_json(&j, a, t->info.name);
	json_device(&j, &t->info);
	json_num(&j, "cpu_scalar_ns", t->scalar_ns);
	json_uint(&j, "cpu_scalar_samples", BENCH_CUDA_SCALAR);
	json_num(&j, "peak_f32_fma_per_s", MC_CUDA_PEAK_OPS / (t->peak.p50 * 1e-9));
	json_open(&j, "figure", '[');
	for (int i = 0; i < BENCH_SIZES; i++) {
		json_open(&j, NULL, '{');
		json_uint(&j, "n", bench_size[i]);
		for (int c = 0; c < BC_COLUMNS; c++) {
			json_timing(&j, column_key[c], &t->figure[i][c]);
		}
		json_close(&j, '}');
	}
	json_close(&j, ']');
	json_open(&j, "million", '{');
	for (int i = 0; i < BC_MAIN_ROWS; i++) {
		json_timing(&j, main_key[i], &t->main[i]);
	}
	json_num(&j, "paper_ratio", t->main[BC_MAIN_PAPER].p50 / t->main[BC_MAIN_FAST].p50);
	json_num(&j, "moving_ratio", t->main[BC_MAIN_PAPER].p50 / t->main[BC_MAIN_MOVING].p50);
	json_close(&j, '}');
	json_open(&j, "steps", '[');
	for (int i = 0; i <= BENCH_CUDA_STEPS; i++) {
		json_open(&j, NULL, '{');
		json_num(&j, "dt_s", i < BENCH_CUDA_STEPS ? bench_cuda_step_s[i] : NAN);
		json_num(&j, "stop_max_m", t->stop_max_m[i]);
		json_num(&j, "stop_rms_m", t->stop_rms_m[i]);
		json_timing(&j, "kernel",
			    i < BENCH_CUDA_STEPS ? &t->step[i] : &t->main[BC_MAIN_FAST]);
		json_close(&j, '}');
	}
	json_close(&j, ']');
	json_close(&j, '}');
}

static void print_figure(const struct bench_cuda *t)
{
	printf("Time against N, paper's scene, us: median (p99; the largest where fewer than 100 "
	       "were timed).\n"
	       "%10s %21s %21s %21s %21s %13s %11s %11s\n",
	       "N", "paper kernel", "paper with copies", "reference kernel", "fast: run()",
	       "CPU SIMD", "x scalar*", "x CPU SIMD");
	for (int i = 0; i < BENCH_SIZES; i++) {
		const struct bench_timing *r = t->figure[i];

		printf("%10u", bench_size[i]);
		for (int c = 0; c < BC_COLUMNS - 1; c++) {
			if (c != BC_FAST) {
				printf(" %10.1f (%8.1f)", r[c].p50 * 1e-3, r[c].p99 * 1e-3);
			}
		}
		printf(" %13.1f %11.0f %11.1f\n", r[BC_CPU].p50 * 1e-3,
		       t->scalar_ns * bench_size[i] / r[BC_FAST_TOTAL].p50,
		       r[BC_CPU].p50 / r[BC_FAST_TOTAL].p50);
	}
	printf("* scalar f64 reference on one core: %.1f us a sample, timed on %u samples and "
	       "scaled.\n"
	       "  paper over the same, with copies, at N = %u: %.0f x\n\n",
	       t->scalar_ns * 1e-3, BENCH_CUDA_SCALAR, bench_size[BENCH_SIZES - 1],
	       t->scalar_ns * bench_size[BENCH_SIZES - 1] /
		       t->figure[BENCH_SIZES - 1][BC_PAPER_TOTAL].p50);
}

static void print_main(const struct bench_cuda *t)
{
	printf("N = %u, device time, us:\n%-46s %10s %10s %14s\n", BENCH_CUDA_MAIN, "", "median",
	       "p99", "x the paper's");
	for (int i = 0; i < BC_MAIN_ROWS; i++) {
		printf("%-46s %10.1f %10.1f %14.0f\n", main_words[i], t->main[i].p50 * 1e-3,
		       t->main[i].p99 * 1e-3, t->main[BC_MAIN_PAPER].p50 / t->main[i].p50);
	}
	printf("Measured f32 peak: %.1f T fused multiply-adds a second.\n\n",
	       MC_CUDA_PEAK_OPS / t->peak.p50 * 1e-3);
}

static void print_steps(const struct bench_cuda *t)
{
	printf("Step against error (stopping distance, %u samples that stop, against %g ms) and "
	       "time (N = %u):\n"
	       "%10s %14s %14s %14s\n",
	       BENCH_CUDA_SCALAR, BENCH_CUDA_TRUTH_S * 1e3, BENCH_CUDA_MAIN, "dt, ms",
	       "largest, mm", "rms, mm", "kernel, us");
	for (int i = 0; i <= BENCH_CUDA_STEPS; i++) {
		const double ns = i < BENCH_CUDA_STEPS ? t->step[i].p50 : t->main[BC_MAIN_FAST].p50;

		if (i < BENCH_CUDA_STEPS) {
			printf("%10.0f", bench_cuda_step_s[i] * 1e3);
		} else {
			printf("%10s", "fast");
		}
		printf(" %14.4f %14.4f %14.1f\n", t->stop_max_m[i] * 1e3, t->stop_rms_m[i] * 1e3,
		       ns * 1e-3);
	}
}

void bench_cuda_words(const struct bench_cuda *t)
{
	printf("%s, capability %d.%d, %d multiprocessors, %d MHz, CUDA %d\n\n", t->info.name,
	       t->info.major, t->info.minor, t->info.sms, t->info.clock_khz / 1000,
	       t->info.runtime);
	print_figure(t);
	print_main(t);
	print_steps(t);
}
