/* SPDX-License-Identifier: MIT
 * Opening and closing the CUDA backend: device, page-locked and device memory, resident draws with their checksums,
 * graphs. All of it before the first batch.
 */
#include "mc_cuda_host.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- device ---------------------------------------------------------------------------------------- */

int mc_cuda_info(struct mc_cuda_info *info)
{
	struct cudaDeviceProp prop;
	int devices = 0;
	int err = CUDA_CALL(COUNT, cudaGetDeviceCount(&devices));

	err = err ? err : devices > 0 ? 0 : -ENODEV;
	err = err ? err : CUDA_CALL(DEVICE, cudaSetDevice(0));
	err = err ? err : CUDA_CALL(PROPERTIES, cudaGetDeviceProperties(&prop, 0));
	err = err ? err
		  : CUDA_CALL(CLOCK,
			      cudaDeviceGetAttribute(&info->clock_khz, cudaDevAttrClockRate, 0));
	err = err ? err
		  : CUDA_CALL(MEMORY_CLOCK, cudaDeviceGetAttribute(&info->memory_clock_khz,
								   cudaDevAttrMemoryClockRate, 0));
	err = err ? err : CUDA_CALL(DRIVER, cudaDriverGetVersion(&info->driver));
	err = err ? err : CUDA_CALL(RUNTIME, cudaRuntimeGetVersion(&info->runtime));
	if (err) {
		return err;
	}
	snprintf(info->name, sizeof(info->name), "%s", prop.name);
	info->major = prop.major;
	info->minor = prop.minor;
	info->sms = prop.multiProcessorCount;
	return 0;
}

/* Asking for a kernel's attributes loads it, and fails where there is no machine code for the device. */
static int setup_kernel(struct mc_backend *b, enum cuda_kernel k)
{
	const struct cuda_kernel_row *row = &cuda_kernel_table[k];
	struct cudaFuncAttributes attr;
	int blocks = 0;
	int err = CUDA_CALL(KERNEL, cudaFuncGetAttributes(&attr, row->function));

	if (!err && row->shared) {
		err = CUDA_CALL(SHARED,
				cudaFuncSetAttribute(row->function,
						     cudaFuncAttributeMaxDynamicSharedMemorySize,
						     (int)row->shared));
	}
	err = err ? err
		  : CUDA_CALL(OCCUPANCY,
			      cudaOccupancyMaxActiveBlocksPerMultiprocessor(
				      &blocks, row->function, (int)row->block, row->shared));
	b->grid[k] = (uint32_t)(blocks * b->info.sms);
	return err ? err : b->grid[k] > MC_FUTURES_MAX ? 0 : -ENOEXEC;
}

/* ---- what stays on the device ------------------------------------------------------------------------ */

/* Thirty-two scenes that take every branch of the rollout: standing, moving and braking leads, grades, early stops. */
static void canary_inputs(float in[MODEL_INPUTS][CUDA_CANARIES])
{
	for (uint32_t i = 0; i < CUDA_CANARIES; i++) {
		in[MODEL_HEADWAY][i] = 4.0f + 3.0f * (float)i;
		in[MODEL_EGO_SPEED][i] = 1.0f + 1.75f * (float)(i * 11 % 32);
		in[MODEL_EGO_ACCEL][i] = -3.0f + (float)(i % 5);
		in[MODEL_LEAD_SPEED][i] = 6.0f * (float)(i % 4);
		in[MODEL_LEAD_ACCEL][i] = 1.0f - 1.5f * (float)(i % 6);
		in[MODEL_MU][i] = 0.15f + 0.03f * (float)i;
		in[MODEL_GRADE][i] = -0.15f + 0.05f * (float)(i % 7);
		in[MODEL_MASS][i] = 900.0f + 60.0f * (float)i;
		in[MODEL_DRAG][i] = 0.2f + 0.01f * (float)i;
		in[MODEL_TAU][i] = 0.05f + 0.01f * (float)(i % 16);
		in[MODEL_DELAY][i] = 0.15f * (float)(i % 3);
	}
}

static void setup_head(struct mc_backend *b, uint32_t stride)
{
	static const struct model_vehicle vehicle = {1.225f, 2.2f, 9.81f,
						     0.5f,   2.7f, MODEL_BOUND_PAPER};
	static const struct model_future future = {-6.0f, 0.1f};

	b->head.canary_plan = rollout_plan(&vehicle, &future, 10.0f);
	canary_inputs(b->head.canary);
	for (uint32_t i = 0; i < CUDA_CANARIES; i++) {
		b->canary[i] =
			rollout_sample(&b->head.canary_plan, &b->head.canary[0][i], CUDA_CANARIES);
	}
	b->head.stride = stride;
	b->head.words = (uint32_t)(sizeof(b->head) / sizeof(uint32_t)) + MC_DIM * stride;
}

static int setup_slices(struct mc_backend *b, const float *draws)
{
	const uint32_t head_words = sizeof(b->head) / sizeof(uint32_t);

	b->slices = (b->head.words + CUDA_SLICE_WORDS - 1) / CUDA_SLICE_WORDS;
	b->slice_sum = calloc(b->slices, sizeof(*b->slice_sum));
	if (!b->slice_sum) {
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < b->head.words; i++) {
		uint32_t word;

		memcpy(&word,
		       i < head_words ? (const char *)&b->head + i * sizeof(word)
				      : (const char *)&draws[i - head_words],
		       sizeof(word));
		b->slice_sum[i / CUDA_SLICE_WORDS] += cuda_digest_word(word, i);
	}
	return 0;
}

static int setup_resident(struct mc_backend *b, const struct mc_params *p)
{
	uint32_t stride;
	int err = draws_plan(p, &b->head.normal);

	err = err ? err : draws_open(p, &b->draws);
	if (err) {
		return err;
	}
	const float *draws = draws_table(b->draws, &stride);
	const size_t bytes = (size_t)MC_DIM * stride * sizeof(*draws);

	b->n_resident = p->n_resident;
	setup_head(b, stride);
	err = setup_slices(b, draws);
	err = err ? err
		  : CUDA_CALL(PIN, cudaHostRegister((void *)draws, bytes, cudaHostRegisterDefault));
	b->pinned = !err;
	err = err ? err
		  : CUDA_CALL(RESIDENT, cudaMalloc((void **)&b->resident, sizeof(b->head) + bytes));
	err = err ? err
		  : CUDA_CALL(PUT_HEAD, cudaMemcpy(b->resident, &b->head, sizeof(b->head),
						   cudaMemcpyHostToDevice));
	return err ? err
		   : CUDA_CALL(PUT_DRAWS,
			       cudaMemcpy(b->resident + 1, draws, bytes, cudaMemcpyHostToDevice));
}

/* ---- what changes with every batch --------------------------------------------------------------------- */

static int setup_work(struct mc_backend *b)
{
	void *job = NULL, *out = NULL;
	int err = CUDA_CALL(WORK, cudaMalloc((void **)&b->work, sizeof(*b->work)));

	err = err ? err : CUDA_CALL(CLEAR, cudaMemset(b->work, 0, sizeof(*b->work)));
	err = err ? err
		  : CUDA_CALL(JOB, cudaHostAlloc((void **)&b->job, sizeof(*b->job),
						 cudaHostAllocMapped));
	err = err ? err : CUDA_CALL(JOB_ADDRESS, cudaHostGetDevicePointer(&job, b->job, 0));
	err = err ? err
		  : CUDA_CALL(OUT, cudaHostAlloc((void **)&b->out, sizeof(*b->out),
						 cudaHostAllocMapped));
	err = err ? err : CUDA_CALL(OUT_ADDRESS, cudaHostGetDevicePointer(&out, b->out, 0));
	if (err) {
		return err;
	}
	memset(b->out, 0, sizeof(*b->out));
	b->args = (struct cuda_args){b->resident, job, b->work, out};
	return 0;
}

static int capture(struct mc_backend *b, enum cuda_kernel k)
{
	const struct cuda_kernel_row *fetch = &cuda_kernel_table[CUDA_KERNEL_FETCH],
				     *batch = &cuda_kernel_table[k];
	void *args[] = {&b->args};
	cudaGraph_t graph = NULL;
	int err = CUDA_CALL(CAPTURE,
			    cudaStreamBeginCapture(b->stream, cudaStreamCaptureModeThreadLocal));

	if (err) {
		return err;
	}
	err = CUDA_CALL(FETCH, cudaLaunchKernel(fetch->function, (dim3){1, 1, 1},
						(dim3){fetch->block, 1, 1}, args, 0, b->stream));
	err = err ? err
		  : CUDA_CALL(BATCH, cudaLaunchKernel(batch->function, (dim3){b->grid[k], 1, 1},
						      (dim3){batch->block, 1, 1}, args,
						      batch->shared, b->stream));
	/* also after a failure: the stream must leave capture mode */
	const int end = CUDA_CALL(CAPTURED, cudaStreamEndCapture(b->stream, &graph));

	err = err ? err : end;
	err = err ? err : CUDA_CALL(INSTANTIATE, cudaGraphInstantiate(&b->graph[k], graph, 0));
	if (graph) {
		const int drop = CUDA_CALL(DROP_GRAPH, cudaGraphDestroy(graph));

		err = err ? err : drop;
	}
	return err ? err : CUDA_CALL(UPLOAD, cudaGraphUpload(b->graph[k], b->stream));
}

int mc_cuda_setup(struct mc_backend *b, const struct mc_params *p)
{
	int err = mc_cuda_info(&b->info);

	for (int k = 0; k < CUDA_KERNELS && !err; k++) {
		err = setup_kernel(b, (enum cuda_kernel)k);
	}
	err = err ? err : setup_resident(b, p);
	err = err ? err : setup_work(b);
	err = err ? err
		  : CUDA_CALL(STREAM, cudaStreamCreateWithFlags(&b->stream, cudaStreamNonBlocking));
	for (int k = CUDA_KERNEL_BATCH; k <= CUDA_KERNEL_DRAW_HIST && !err; k++) {
		err = capture(b, (enum cuda_kernel)k);
	}
	return err;
}

/* What fails here is of no use to anyone any more. */
static void ignore(int err)
{
	(void)err;
}

void mc_cuda_teardown(struct mc_backend *b)
{
	uint32_t stride;

	if (b->pending) {
		return; /* the device may still write to all of it, and freeing would wait for ever */
	}
	for (int k = 0; k < CUDA_KERNELS; k++) {
		if (b->graph[k]) {
			ignore(CUDA_CALL(CLOSE_GRAPH, cudaGraphExecDestroy(b->graph[k])));
		}
	}
	if (b->stream) {
		ignore(CUDA_CALL(CLOSE_STREAM, cudaStreamDestroy(b->stream)));
	}
	if (b->work) {
		ignore(CUDA_CALL(CLOSE_WORK, cudaFree(b->work)));
	}
	if (b->resident) {
		ignore(CUDA_CALL(CLOSE_RESIDENT, cudaFree(b->resident)));
	}
	if (b->out) {
		ignore(CUDA_CALL(CLOSE_OUT, cudaFreeHost(b->out)));
	}
	if (b->job) {
		ignore(CUDA_CALL(CLOSE_JOB, cudaFreeHost(b->job)));
	}
	if (b->pinned) {
		ignore(CUDA_CALL(CLOSE_PIN,
				 cudaHostUnregister((void *)draws_table(b->draws, &stride))));
	}
	draws_close(b->draws);
	free(b->slice_sum);
	free(b);
}
