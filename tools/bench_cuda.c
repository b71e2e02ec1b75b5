/* SPDX-License-Identifier: MIT
 * aebmc bench --backend cuda: the paper's figure, time against N, for three rungs in one run (its kernel, the reference
 * rollout, the fast rollout) beside one CPU core; the fast rollout against the paper's kernel; step size against error.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "bench_cuda.h"
#include "bench_scene.h"
#include "cli.h"
#include "draws.h"
#include "progress.h"
#include "rollout.h"
#include "sample.h"

#define RESIDENT 10000000u

const double bench_cuda_step_s[BENCH_CUDA_STEPS] = {0.001, 0.002, 0.005, 0.010, 0.020};

/* ---- measuring --------------------------------------------------------------------------------- */

static int time_rung(struct bench_cuda *t, enum mc_cuda_rung rung, const struct mc_request *req,
		     double dt_s, uint32_t reps, struct bench_timing *kernel,
		     struct bench_timing *total)
{
	struct mc_cuda_time each[BENCH_REPS_MAX + 1];
	double ns[BENCH_REPS_MAX];
	int error = mc_cuda_time(t->gpu, rung, req, dt_s, reps + 1, each); /* the first warms up */

	for (uint32_t i = 0; i < reps; i++) {
		ns[i] = each[i + 1].kernel_ns;
	}
	*kernel = bench_timing_of(ns, reps);
	for (uint32_t i = 0; i < reps; i++) {
		ns[i] = each[i + 1].total_ns;
	}
	if (total) {
		*total = bench_timing_of(ns, reps);
	}
	return error ? error : cli_interrupted() ? -EINTR : 0;
}

/* More where it is quick, but the slow ones often enough for a median. */
static uint32_t reps_of(uint32_t n, uint32_t most)
{
	const uint32_t r = n <= 100000 ? most : n <= 1000000 ? most / 2 : most / 8;

	return r < 5 ? 5 : r;
}

static int measure_figure(struct bench_cuda *t, struct progress *line)
{
	struct mc_request req;
	int error = 0;

	for (int i = 0; i < BENCH_SIZES && !error; i++) {
		struct bench_timing *row = t->figure[i];

		bench_scene_paper(&req, bench_size[i]);
		req.flags |= MC_WANT_IMPACT;
		error = time_rung(t, MC_CUDA_PAPER, &req, 1e-3, reps_of(bench_size[i], 40),
				  &row[BC_PAPER], &row[BC_PAPER_TOTAL]);
		error = error ? error
			      : time_rung(t, MC_CUDA_REFERENCE, &req, 1e-3,
					  reps_of(bench_size[i], 40), &row[BC_REFERENCE], NULL);
		error = error ? error
			      : time_rung(t, MC_CUDA_FAST, &req, 1e-3, reps_of(bench_size[i], 400),
					  &row[BC_FAST], NULL);
		error = error ? error
			      : bench_time_run(&mc_cuda_ops, t->gpu, &req,
					       reps_of(bench_size[i], 400), &row[BC_FAST_TOTAL]);
		error = error ? error
			      : bench_time_run(&mc_cpu_ops, t->cpu, &req,
					       reps_of(bench_size[i], 40), &row[BC_CPU]);
		progress_update(line, 0.6 * (i + 1) / BENCH_SIZES, "time against N");
	}
	return error;
}

static int measure_scalar(struct bench_cuda *t)
{
	struct model_out out[BENCH_CUDA_SCALAR];

	return bench_time_scalar(t->cpu, BENCH_CUDA_SCALAR, out, &t->scalar_ns);
}

static int measure_main(struct bench_cuda *t, struct progress *line)
{
	struct mc_request paper, moving, futures;
	int error = bench_scene_moving(&moving, BENCH_CUDA_MAIN);

	error = error ? error : bench_scene_futures(&futures, BENCH_CUDA_MAIN);
	bench_scene_paper(&paper, BENCH_CUDA_MAIN);
	paper.flags |= MC_WANT_IMPACT;
	error = error ? error : time_rung(t, MC_CUDA_PEAK, &paper, 1e-3, 10, &t->peak, NULL);
	error = error ? error
		      : time_rung(t, MC_CUDA_PAPER, &paper, 1e-3, 100, &t->main[BC_MAIN_PAPER],
				  NULL);
	progress_update(line, 0.8, "a million samples");
	error = error ? error
		      : time_rung(t, MC_CUDA_REFERENCE, &paper, 1e-3, 100,
				  &t->main[BC_MAIN_REFERENCE], NULL);
	error = error ? error
		      : time_rung(t, MC_CUDA_FAST, &paper, 1e-3, BENCH_REPS_MAX,
				  &t->main[BC_MAIN_FAST], NULL);
	error = error ? error
		      : time_rung(t, MC_CUDA_FAST, &moving, 1e-3, BENCH_REPS_MAX,
				  &t->main[BC_MAIN_MOVING], NULL);
	error = error ? error
		      : time_rung(t, MC_CUDA_FAST, &futures, 1e-3, BENCH_REPS_MAX,
				  &t->main[BC_MAIN_FUTURES], NULL);
	for (int i = 0; i < BENCH_CUDA_STEPS && !error; i++) {
		error = time_rung(t, MC_CUDA_REFERENCE, &paper, bench_cuda_step_s[i], 10,
				  &t->step[i], NULL);
	}
	return error;
}

/* ---- step size against error ------------------------------------------------------------------- */

static void note_error(struct bench_cuda *t, int i, const struct model_out *o,
		       const struct model_out *truth)
{
	const double d = fabs((double)o->stop_m - (double)truth->stop_m);

	t->stop_max_m[i] = fmax(t->stop_max_m[i], d);
	t->stop_rms_m[i] += d * d / BENCH_CUDA_SCALAR;
}

static int measure_errors(struct bench_cuda *t, const struct mc_params *p)
{
	float z[MC_DIM * BENCH_CUDA_SCALAR];
	struct mc_request req;
	struct sample_plan plan;
	struct draws *d;
	const struct mc_params few = {.kind = p->kind, .seed = p->seed, .n_resident = 1};
	const int error = draws_open(&few, &d);

	if (error) {
		return error;
	}
	bench_scene_paper(&req, BENCH_CUDA_SCALAR);
	sample_plan(&req, &plan);
	draws_fill(d, 0, BENCH_CUDA_SCALAR, z, BENCH_CUDA_SCALAR);
	draws_close(d);
	const struct rollout_plan fast = rollout_plan(&req.vehicle, &req.future[0], req.horizon_s);

	for (uint32_t k = 0; k < BENCH_CUDA_SCALAR && !cli_interrupted(); k++) {
		float in[MODEL_INPUTS];

		sample_draw(&plan, z + k, BENCH_CUDA_SCALAR, in, 1);
		const struct model_out truth = model_rollout(
			&req.vehicle, &req.future[0], req.horizon_s, BENCH_CUDA_TRUTH_S, in, 1);

		for (int i = 0; i < BENCH_CUDA_STEPS && !(truth.flags & MODEL_ROLLING); i++) {
			const struct model_out o =
				model_rollout(&req.vehicle, &req.future[0], req.horizon_s,
					      bench_cuda_step_s[i], in, 1);

			note_error(t, i, &o, &truth);
		}
		if (!(truth.flags & MODEL_ROLLING)) {
			const struct model_out o = rollout_sample(&fast, in, 1);

			note_error(t, BENCH_CUDA_STEPS, &o, &truth);
		}
	}
	for (int i = 0; i <= BENCH_CUDA_STEPS; i++) {
		t->stop_rms_m[i] = sqrt(t->stop_rms_m[i]);
	}
	return 0;
}

static int measure(struct bench_cuda *t, const struct mc_params *p)
{
	struct progress line = progress_start("bench");
	int error = mc_cuda_info(&t->info);

	cli_catch_interrupt();
	error = error ? error : measure_scalar(t);
	error = error ? error : measure_figure(t, &line);
	error = error ? error : measure_main(t, &line);
	error = error ? error : measure_errors(t, p);
	progress_clear(&line);
	return error;
}

int bench_cuda(const char *name, const struct compute_args *a)
{
	struct bench_cuda t = {0};
	struct compute_args cuda = *a;
	const struct mc_ops *ops;

	cuda.params.n_resident = RESIDENT;
	int code = compute_open(name, &cuda, &ops, &t.gpu);

	if (code) {
		return code;
	}
	int error = mc_cpu_ops.open(&cuda.params, &t.cpu);

	error = error ? error : measure(&t, &cuda.params);
	if (error) {
		code = cli_error(CLI_FAILED, name, "%s",
				 error == -EINTR ? "interrupted" : strerror(-error));
	} else if (a->json) {
		bench_cuda_json(&t, &cuda);
	} else {
		bench_cuda_words(&t);
	}
	mc_cpu_ops.close(t.cpu);
	mc_cuda_ops.close(t.gpu);
	return code;
}
