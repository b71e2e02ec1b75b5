/* SPDX-License-Identifier: MIT
 * Per-sample results from the device, for verification and tools: memory comes and goes with the call.
 */
#include "mc_cuda_host.h"
#include <errno.h>
#include <string.h>

#define PIECE \
	(1u << 16) /* samples a launch: the reference rollout stays short on a slow device too */

/* Device memory of one call. */
struct roll {
	struct cuda_job *job;
	float *in;
	struct model_out *out;
};

static int roll_alloc(struct roll *r, uint32_t futures, int with_in)
{
	int err = CUDA_CALL(ROLL_JOB, cudaMalloc((void **)&r->job, sizeof(*r->job)));

	err = err ? err
		  : CUDA_CALL(ROLL_OUT, cudaMalloc((void **)&r->out,
						   (size_t)futures * PIECE * sizeof(*r->out)));
	if (with_in && !err) {
		err = CUDA_CALL(ROLL_IN, cudaMalloc((void **)&r->in,
						    (size_t)MODEL_INPUTS * PIECE * sizeof(*r->in)));
	}
	return err;
}

static int roll_free(struct roll *r)
{
	void *memory[] = {r->job, r->in, r->out};
	int err = 0;

	for (int i = 0; i < 3; i++) {
		const int e = memory[i] ? CUDA_CALL(ROLL_FREE, cudaFree(memory[i])) : 0;

		err = err ? err : e;
	}
	return err;
}

/* One launch: @in and @out point to its first column of @columns. */
static int roll_piece(struct mc_backend *b, const struct roll *r, enum mc_rollout which,
		      const struct cuda_job *job, const float *in, struct model_out *out,
		      uint32_t columns)
{
	const enum cuda_kernel k = which == MC_FAST ? CUDA_KERNEL_FAST : CUDA_KERNEL_REFERENCE;
	const struct cuda_kernel_row *row = &cuda_kernel_table[k];
	struct cuda_samples_args a = {b->resident,   r->job, in ? r->in : NULL, r->out,
				      b->n_resident, 0,      MODEL_STEP_S};
	void *args[] = {&a};
	const size_t in_bytes = job->count * sizeof(*in), out_bytes = job->count * sizeof(*out);
	int err = CUDA_CALL(ROLL_PUT_JOB,
			    cudaMemcpy(r->job, job, sizeof(*job), cudaMemcpyHostToDevice));

	if (in && !err) {
		err = CUDA_CALL(ROLL_PUT_IN,
				cudaMemcpy2D(r->in, in_bytes, in, columns * sizeof(*in), in_bytes,
					     MODEL_INPUTS, cudaMemcpyHostToDevice));
	}
	err = err ? err
		  : CUDA_CALL(ROLL_LAUNCH,
			      cudaLaunchKernel(row->function, (dim3){b->grid[k], 1, 1},
					       (dim3){row->block, 1, 1}, args, 0, NULL));
	return err ? err
		   : CUDA_CALL(ROLL_GET,
			       cudaMemcpy2D(out, columns * sizeof(*out), r->out, out_bytes,
					    out_bytes, job->n_futures, cudaMemcpyDeviceToHost));
}

static int roll_all(struct mc_backend *b, enum mc_rollout which, struct cuda_job *job,
		    uint64_t first, uint32_t count, const float *in, struct model_out *out)
{
	struct roll r = {NULL, NULL, NULL};
	int err = b->failed ? b->failed : roll_alloc(&r, job->n_futures, in != NULL);
	int free_err;

	for (uint32_t at = 0; at < count && !err; at += job->count) {
		job->first = first + at;
		job->count = count - at < PIECE ? count - at : PIECE;
		err = roll_piece(b, &r, which, job, in ? in + at : NULL, out + at, count);
	}
	free_err = roll_free(&r);
	return err ? err : free_err;
}

int mc_cuda_samples(struct mc_backend *b, const struct mc_request *req, enum mc_rollout which,
		    uint64_t first, uint32_t count, struct model_out *out)
{
	struct cuda_job job;

	if (mc_check(req)) {
		return -EINVAL;
	}
	mc_cuda_job(&job, req);
	return roll_all(b, which, &job, first, count, NULL, out);
}

int mc_cuda_roll(struct mc_backend *b, enum mc_rollout which, const struct model_vehicle *veh,
		 const struct model_future *fut, float horizon_s, const float *in, uint32_t count,
		 struct model_out *out)
{
	struct cuda_job job;

	memset(&job, 0, sizeof(job));
	job.n_futures = 1;
	job.vehicle = *veh;
	job.horizon_s = horizon_s;
	job.future[0] = *fut;
	job.roll[0] = rollout_plan(veh, fut, horizon_s);
	return roll_all(b, which, &job, 0, count, in, out);
}
