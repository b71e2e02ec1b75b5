/* SPDX-License-Identifier: MIT
 * The stopwatch of the benchmarks: device events around one rung at a time. Nothing here runs in the daemon.
 */
#include "mc_cuda_host.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define PEAK_ROUNDS 20000u /* of eight multiply-adds in every thread */

/* start, kernel begins, kernel ended, all copied */
enum mark { MARK_START, MARK_BEGIN, MARK_END, MARK_STOP, MARKS };

struct watch {
	cudaEvent_t mark[MARKS];
	void *memory[3]; /* device */
	void *host[3];   /* what is copied to and fro, by the same index */
	size_t bytes[3];
};

static int watch_open(struct watch *w)
{
	int err = 0;

	for (int i = 0; i < MARKS && !err; i++) {
		err = CUDA_CALL(TIME_EVENT, cudaEventCreate(&w->mark[i]));
	}
	for (int i = 0; i < 3 && !err; i++) {
		err = w->bytes[i] ? CUDA_CALL(TIME_ALLOC, cudaMalloc(&w->memory[i], w->bytes[i]))
				  : 0;
	}
	return err;
}

static int watch_close(struct watch *w)
{
	int err = 0;

	for (int i = 0; i < MARKS; i++) {
		const int e = w->mark[i] ? CUDA_CALL(TIME_DROP, cudaEventDestroy(w->mark[i])) : 0;

		err = err ? err : e;
	}
	for (int i = 0; i < 3; i++) {
		const int e = w->memory[i] ? CUDA_CALL(TIME_FREE, cudaFree(w->memory[i])) : 0;

		err = err ? err : e;
		free(w->host[i]);
	}
	return err;
}

static int watch_mark(const struct mc_backend *b, struct watch *w, enum mark m)
{
	return CUDA_CALL(TIME_RECORD, cudaEventRecord(w->mark[m], b->stream));
}

static int watch_read(struct watch *w, struct mc_cuda_time *ret)
{
	float kernel_ms = 0.0f, total_ms = 0.0f;
	int err = CUDA_CALL(TIME_SYNC, cudaEventSynchronize(w->mark[MARK_STOP]));

	err = err ? err
		  : CUDA_CALL(TIME_ELAPSED, cudaEventElapsedTime(&kernel_ms, w->mark[MARK_BEGIN],
								 w->mark[MARK_END]));
	err = err ? err
		  : CUDA_CALL(TIME_ELAPSED, cudaEventElapsedTime(&total_ms, w->mark[MARK_START],
								 w->mark[MARK_STOP]));
	ret->kernel_ns = 1e6 * kernel_ms;
	ret->total_ns = 1e6 * total_ms;
	return err;
}

/* ---- a plain kernel between two copies --------------------------------------------------------------- */

struct plain {
	enum cuda_kernel kernel;
	uint32_t blocks;
	void *args; /* its one argument */
	int put,
		get; /* how many of the buffers go there; the index of the one that comes back, or -1 */
};

static int time_plain(struct mc_backend *b, struct watch *w, const struct plain *p,
		      struct mc_cuda_time *ret)
{
	const struct cuda_kernel_row *row = &cuda_kernel_table[p->kernel];
	void *args[] = {p->args};
	int err = watch_mark(b, w, MARK_START);

	for (int i = 0; i < p->put && !err; i++) {
		err = CUDA_CALL(TIME_PUT, cudaMemcpyAsync(w->memory[i], w->host[i], w->bytes[i],
							  cudaMemcpyHostToDevice, b->stream));
	}
	err = err ? err : watch_mark(b, w, MARK_BEGIN);
	err = err ? err
		  : CUDA_CALL(TIME_LAUNCH,
			      cudaLaunchKernel(row->function, (dim3){p->blocks, 1, 1},
					       (dim3){row->block, 1, 1}, args, 0, b->stream));
	err = err ? err : watch_mark(b, w, MARK_END);
	if (p->get >= 0 && !err) {
		err = CUDA_CALL(TIME_GET, cudaMemcpyAsync(w->host[p->get], w->memory[p->get],
							  w->bytes[p->get], cudaMemcpyDeviceToHost,
							  b->stream));
	}
	err = err ? err : watch_mark(b, w, MARK_STOP);
	return err ? err : watch_read(w, ret);
}

static int repeat(struct mc_backend *b, struct watch *w, const struct plain *p, uint32_t repeats,
		  struct mc_cuda_time *ret)
{
	int err = 0;

	for (uint32_t i = 0; i < repeats && !err; i++) {
		err = time_plain(b, w, p, &ret[i]);
	}
	return err;
}

/* ---- rungs -------------------------------------------------------------------------------------------- */

static void paper_samples(const struct mc_backend *b, const struct mc_request *req, double *v0,
			  struct cuda_paper_sample *param)
{
	struct sample_plan plan;
	uint32_t stride;
	const float *z = draws_table(b->draws, &stride);

	sample_plan(req, &plan);
	for (uint32_t i = 0; i < req->n; i++) {
		float in[MODEL_INPUTS];

		sample_draw(&plan, z + i % b->n_resident, stride, in, 1);
		v0[i] = in[MODEL_EGO_SPEED];
		param[i] = (struct cuda_paper_sample){in[MODEL_MU], in[MODEL_GRADE], in[MODEL_MASS],
						      in[MODEL_DRAG], in[MODEL_TAU]};
	}
}

static int time_paper(struct mc_backend *b, const struct mc_request *req, double dt_s,
		      uint32_t repeats, struct mc_cuda_time *ret)
{
	const struct model_vehicle *v = &req->vehicle;
	const uint32_t block = cuda_kernel_table[CUDA_KERNEL_PAPER].block;
	struct watch w = {.bytes = {req->n * sizeof(double),
				    req->n * sizeof(struct cuda_paper_sample),
				    req->n * sizeof(double)}};
	struct cuda_paper_args a = {
		NULL,
		NULL,
		NULL,
		req->n,
		0,
		v->rho_kgpm3,
		v->area_m2,
		v->gravity_mps2,
		v->bound == MODEL_BOUND_PAPER ? (double)v->cg_height_m / v->wheelbase_m : 0.0,
		req->future[0].accel_cmd_mps2,
		dt_s,
		req->horizon_s};
	const struct plain p = {CUDA_KERNEL_PAPER, (req->n + block - 1) / block, &a, 2, 2};
	int err = 0, close_err;

	for (int i = 0; i < 3 && !err; i++) {
		w.host[i] = malloc(w.bytes[i]);
		err = w.host[i] ? 0 : -ENOMEM;
	}
	err = err ? err : watch_open(&w);
	if (!err) {
		paper_samples(b, req, w.host[0], w.host[1]);
		a.v0 = w.memory[0];
		a.param = w.memory[1];
		a.stop_m = w.memory[2];
		err = repeat(b, &w, &p, repeats, ret);
	}
	close_err = watch_close(&w);
	return err ? err : close_err;
}

static int time_reference(struct mc_backend *b, const struct mc_request *req, double dt_s,
			  uint32_t repeats, struct mc_cuda_time *ret)
{
	struct cuda_job job;
	struct watch w = {.bytes = {sizeof(job), req->n * sizeof(struct model_out)}};
	struct cuda_samples_args a = {b->resident, NULL, NULL, NULL, b->n_resident, 0, dt_s};
	const struct plain p = {CUDA_KERNEL_REFERENCE, b->grid[CUDA_KERNEL_REFERENCE], &a, 0, -1};
	int err, close_err;

	mc_cuda_job(&job, req);
	job.count = req->n;
	job.n_futures = 1;
	err = watch_open(&w);
	err = err ? err
		  : CUDA_CALL(TIME_JOB,
			      cudaMemcpy(w.memory[0], &job, sizeof(job), cudaMemcpyHostToDevice));
	if (!err) {
		a.job = w.memory[0];
		a.out = w.memory[1];
		err = repeat(b, &w, &p, repeats, ret);
	}
	close_err = watch_close(&w);
	return err ? err : close_err;
}

static int time_peak(struct mc_backend *b, uint32_t repeats, struct mc_cuda_time *ret)
{
	const uint32_t threads =
		b->grid[CUDA_KERNEL_PEAK] * cuda_kernel_table[CUDA_KERNEL_PEAK].block;
	const double scale = MC_CUDA_PEAK_OPS / (8.0 * PEAK_ROUNDS * threads);
	struct watch w = {.bytes = {threads * sizeof(float)}};
	struct cuda_peak_args a = {NULL, PEAK_ROUNDS, 0.999f, 0.001f};
	const struct plain p = {CUDA_KERNEL_PEAK, b->grid[CUDA_KERNEL_PEAK], &a, 0, -1};
	int err = watch_open(&w), close_err;

	a.out = w.memory[0];
	err = err ? err : repeat(b, &w, &p, repeats, ret);
	for (uint32_t i = 0; i < repeats && !err; i++) {
		ret[i].kernel_ns *= scale;
		ret[i].total_ns *= scale;
	}
	close_err = watch_close(&w);
	return err ? err : close_err;
}

/* The chunk that run() left in mapped memory, twice: the second starts when the first ends, whatever the host does. */
static int time_again(struct mc_backend *b, struct watch *w, enum cuda_kernel k,
		      struct mc_cuda_time *ret)
{
	struct mc_cuda_time again = {0};
	int err = CUDA_CALL(TIME_GRAPH, cudaGraphLaunch(b->graph[k], b->stream));

	err = err ? err : watch_mark(b, w, MARK_BEGIN);
	err = err ? err : CUDA_CALL(TIME_GRAPH, cudaGraphLaunch(b->graph[k], b->stream));
	err = err ? err : watch_mark(b, w, MARK_END);
	err = err ? err : watch_mark(b, w, MARK_STOP);
	err = err ? err : watch_read(w, &again);
	ret->kernel_ns = again.kernel_ns;
	return err;
}

static int time_fast(struct mc_backend *b, const struct mc_request *req, uint32_t repeats,
		     struct mc_cuda_time *ret)
{
	const enum cuda_kernel k = req->flags & MC_WANT_HIST ? CUDA_KERNEL_HIST : CUDA_KERNEL_BATCH;
	const int one_chunk = req->n <= b->n_resident && req->n <= CUDA_CHUNK;
	struct watch w = {0};
	struct mc_result res;
	int err = watch_open(&w), close_err;

	for (uint32_t i = 0; i < repeats && !err; i++) {
		err = watch_mark(b, &w, MARK_START);
		err = err ? err : watch_mark(b, &w, MARK_BEGIN);
		err = err ? err : mc_cuda_ops.run(b, req, NULL, &res);
		err = err ? err : watch_mark(b, &w, MARK_END);
		err = err ? err : watch_mark(b, &w, MARK_STOP);
		err = err ? err : watch_read(&w, &ret[i]);
		err = err || !one_chunk ? err : time_again(b, &w, k, &ret[i]);
	}
	close_err = watch_close(&w);
	return err ? err : close_err;
}

int mc_cuda_time(struct mc_backend *b, enum mc_cuda_rung rung, const struct mc_request *req,
		 double dt_s, uint32_t repeats, struct mc_cuda_time *ret)
{
	if (mc_check(req) || !(dt_s > 0.0) ||
	    (rung == MC_CUDA_REFERENCE && req->n > b->n_resident)) {
		return -EINVAL;
	}
	switch (rung) {
	case MC_CUDA_PAPER:
		return time_paper(b, req, dt_s, repeats, ret);
	case MC_CUDA_REFERENCE:
		return time_reference(b, req, dt_s, repeats, ret);
	case MC_CUDA_FAST:
		return time_fast(b, req, repeats, ret);
	case MC_CUDA_PEAK:
		return time_peak(b, repeats, ret);
	default:
		return -EINVAL;
	}
}
