/* SPDX-License-Identifier: MIT
 * How long a batch takes. See bench_time.h.
 */
#include "bench_time.h"
#include <errno.h>
#include <math.h>
#include "bench_scene.h"
#include "cli.h"
#include "clock.h"
#include "sort.h"

#define SCALAR_PARTS 20 /* of a few milliseconds: one of them is left alone on a busy machine too */

const uint32_t bench_size[BENCH_SIZES] = {1000,    2000,    5000,    10000,  20000,
					  50000,   100000,  200000,  500000, 1000000,
					  2000000, 5000000, 10000000};

struct bench_timing bench_timing_of(double *ns, uint32_t n)
{
	sort_doubles(ns, n);
	return (struct bench_timing){ns[n / 2], ns[n < 100 ? n - 1 : n * 99 / 100]};
}

int bench_time_run(const struct mc_ops *ops, struct mc_backend *b, const struct mc_request *req,
		   uint32_t reps, struct bench_timing *ret)
{
	double ns[BENCH_REPS_MAX];
	struct mc_result res;
	int error = 0;

	for (uint32_t i = 0; i < reps && !error; i++) {
		const int64_t start_ns = clock_now_ns();

		error = ops->run(b, req, NULL, &res);
		ns[i] = (double)(clock_now_ns() - start_ns);
	}
	*ret = bench_timing_of(ns, reps);
	return error ? error : cli_interrupted() ? -EINTR : 0;
}

int bench_time_sizes(const struct mc_ops *ops, struct mc_backend *b, uint32_t reps,
		     struct bench_timing ret[BENCH_SIZES_CPU])
{
	struct mc_request req;
	int error = 0;

	for (int i = 0; i < BENCH_SIZES_CPU && !error; i++) {
		bench_scene_paper(&req, bench_size[i]);
		error = bench_time_run(ops, b, &req, reps, &ret[i]);
	}
	return error;
}

int bench_time_scalar(struct mc_backend *cpu, uint32_t n, struct model_out *out, double *ret)
{
	const uint32_t part = n > SCALAR_PARTS ? n / SCALAR_PARTS : 1;
	struct mc_request req;
	int error = 0;

	bench_scene_paper(&req, n);
	*ret = INFINITY;
	for (uint32_t first = 0; !error && first + part <= n; first += part) {
		const int64_t start_ns = clock_now_ns();

		error = mc_cpu_ops.samples(cpu, &req, MC_REFERENCE, first, part, out + first);
		*ret = fmin(*ret, (double)(clock_now_ns() - start_ns) / part);
	}
	return error;
}
