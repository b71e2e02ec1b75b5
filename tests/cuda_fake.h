/* SPDX-License-Identifier: MIT
 * A CUDA runtime without a device, for tests of the host side: memory is host memory, kernels are plain C built from
 * the same headers as the real ones. Launched work is done when the stream is next queried, so that a test can have it
 * done late or never. Define CUDA_CALL by cuda_inject.h before the backend's sources are included.
 */
#ifndef AEBMC_TESTS_CUDA_FAKE_H
#define AEBMC_TESTS_CUDA_FAKE_H

#include <stdlib.h>
#include <string.h>
#include "mc_cuda_dev.h"
#include "mc_ops.h"
#include "tally.h"

struct fake_launch {
	enum cuda_kernel kernel;
	struct cuda_args args;
};

struct CUgraph_st {
	struct fake_launch launch[2];
	int n;
};

static struct {
	int device_count, live; /* allocations, graphs, streams, events and pins not given back */
	int late;               /* queries until launched work is done; below 0: never */
	int capturing;
	struct CUgraph_st captured;
	struct fake_launch queue[4];
	int queued;
	void (*spoil)(struct cuda_args *a,
		      int done); /* called before and after a batch kernel, to change bits */
} fake = {.device_count = 1};

/* ---- kernels ----------------------------------------------------------------------------------------- */

static char fake_function[CUDA_KERNELS]; /* their addresses stand for the kernels */

#define HIST_SHARED 4u

const struct cuda_kernel_row cuda_kernel_table[CUDA_KERNELS] = {
#define CUDA_KERNEL(id, name, function, block, shared) \
	[CUDA_KERNEL_##id] = {name, &fake_function[CUDA_KERNEL_##id], 128, shared},
#include "mc_cuda_kernels.def"
#undef CUDA_KERNEL
};

static void fake_inputs(const struct cuda_resident *res, const struct sample_plan *plan,
			uint64_t index, uint32_t n_resident, float in[MODEL_INPUTS], int *lifted)
{
	const float *z = (const float *)(res + 1);
	float made[MC_DIM];

	for (uint32_t d = 0; d < MC_DIM && index < n_resident; d++) {
		made[d] = z[(size_t)d * res->stride + index];
	}
	for (uint32_t g = 0; g < NORMAL_GROUPS && index >= n_resident; g++) {
		normal_four(&res->normal, index, g, made + 4 * g);
	}
	*lifted = sample_draw(plan, made, 1, in, 1);
}

static void fake_add(struct cuda_out *out, uint32_t future, enum cuda_sum which, uint64_t x)
{
	out->sum[future][which] += x;
	out->check += x * cuda_check_weight(future, which);
}

static void fake_hist(const struct cuda_job *job, struct cuda_out *out, const float *in,
		      const struct model_out *o)
{
	const int64_t q = tally_units(o->stop_m) - job->centre;
	const float shift = in[MODEL_HEADWAY] - job->sample.mean[MODEL_HEADWAY];

	fake_add(out, job->hist_future, CUDA_STOP, (uint64_t)q);
	fake_add(out, job->hist_future, CUDA_STOP2, (uint64_t)(q * q));
	out->stop[tally_stop_bin(o->stop_m, o->flags)]++;
	out->need[tally_need_bin(o->need_m, shift, o->flags, job->flags)]++;
}

static void fake_sample(const struct cuda_args *a, uint64_t index, uint32_t n_resident)
{
	const struct cuda_job *job = &a->work->job;
	float in[MODEL_INPUTS];
	int lifted;

	fake_inputs(a->resident, &job->sample, index, n_resident, in, &lifted);
	fake_add(a->out, 0, CUDA_N, 1);
	fake_add(a->out, 0, CUDA_FLOORED, (uint64_t)lifted);
	for (uint32_t f = 0; f < job->n_futures; f++) {
		const struct model_out o = rollout_sample(&job->roll[f], in, 1);

		fake_add(a->out, f, CUDA_HITS, tally_contact(o.flags, job->flags));
		fake_add(a->out, f, CUDA_UNDECIDED, tally_undecided(o.flags, job->flags));
		fake_add(a->out, f, CUDA_IMPACT, (uint64_t)tally_units(o.impact_mps));
		if (job->flags & MC_WANT_HIST && f == job->hist_future) {
			fake_hist(job, a->out, in, &o);
		}
	}
}

static uint64_t fake_digest(const void *p, uint32_t from, uint32_t to)
{
	uint64_t sum = 0;

	for (uint32_t i = from; i < to; i++) {
		uint32_t word;

		memcpy(&word, (const char *)p + (size_t)i * 4, 4);
		sum += cuda_digest_word(word, i);
	}
	return sum;
}

static void fake_batch(struct cuda_args *a, int generate)
{
	const struct cuda_job *job = &a->work->job;
	const uint32_t from = job->slice * CUDA_SLICE_WORDS, end = from + CUDA_SLICE_WORDS;
	struct cuda_out *out = a->out;

	memset(out, 0, offsetof(struct cuda_out, seq));
	for (uint64_t i = job->first; i < job->first + job->count; i++) {
		fake_sample(a, i, generate ? 0 : UINT32_MAX);
	}
	out->hi = MC_HIST_BINS;
	for (uint32_t i = 0; i < CUDA_CANARIES; i++) {
		out->canary[i] = rollout_sample(&a->resident->canary_plan,
						&a->resident->canary[0][i], CUDA_CANARIES);
	}
	out->hash = job->hash;
	out->digest = fake_digest(job, 0, sizeof(*job) / 4);
	out->slice_sum =
		fake_digest(a->resident, from, end < a->resident->words ? end : a->resident->words);
	__atomic_store_n(&out->seq, job->seq, __ATOMIC_RELEASE);
}

static void fake_samples(const struct cuda_samples_args *a, enum mc_rollout which)
{
	const struct cuda_job *job = a->job;
	int lifted;

	for (uint32_t i = 0; i < job->count; i++) {
		float in[MODEL_INPUTS];

		for (uint32_t d = 0; d < MODEL_INPUTS && a->in; d++) {
			in[d] = a->in[(size_t)d * job->count + i];
		}
		if (!a->in) {
			fake_inputs(a->resident, &job->sample, job->first + i, a->n_resident, in,
				    &lifted);
		}
		for (uint32_t f = 0; f < job->n_futures; f++) {
			a->out[(size_t)f * job->count + i] =
				which == MC_FAST ? rollout_sample(&job->roll[f], in, 1)
						 : model_rollout(&job->vehicle, &job->future[f],
								 job->horizon_s, a->dt_s, in, 1);
		}
	}
}

static void fake_do(struct fake_launch *l)
{
	struct cuda_args *a = &l->args;

	if (l->kernel == CUDA_KERNEL_FETCH) {
		a->work->job = *a->job;
		return;
	}
	if (fake.spoil) {
		fake.spoil(a, 0);
	}
	fake_batch(a, l->kernel == CUDA_KERNEL_DRAW || l->kernel == CUDA_KERNEL_DRAW_HIST);
	if (fake.spoil) {
		fake.spoil(a, 1);
	}
}

static void fake_flush(void)
{
	for (int i = 0; i < fake.queued; i++) {
		fake_do(&fake.queue[i]);
	}
	fake.queued = 0;
}

/* ---- runtime: what cuda_calls.def lists ---------------------------------------------------------------- */

static cudaError_t fake_alloc(void **p, size_t bytes)
{
	*p = calloc(1, bytes);
	fake.live += *p != NULL;
	return *p ? cudaSuccess : cudaErrorMemoryAllocation;
}

static cudaError_t fake_free(void *p)
{
	fake.live -= p != NULL;
	free(p);
	return cudaSuccess;
}

cudaError_t cudaGetDeviceCount(int *n)
{
	*n = fake.device_count;
	return cudaSuccess;
}

cudaError_t cudaSetDevice(int device)
{
	return device ? cudaErrorInvalidDevice : cudaSuccess;
}

cudaError_t cudaGetDeviceProperties(struct cudaDeviceProp *p, int device)
{
	memset(p, 0, sizeof(*p));
	strcpy(p->name, "fake");
	p->multiProcessorCount = 4 + device;
	return cudaSuccess;
}

cudaError_t cudaDeviceGetAttribute(int *value, enum cudaDeviceAttr attr, int device)
{
	*value = (int)attr + device;
	return cudaSuccess;
}

cudaError_t cudaDriverGetVersion(int *v)
{
	*v = 13000;
	return cudaSuccess;
}

cudaError_t cudaRuntimeGetVersion(int *v)
{
	*v = 13000;
	return cudaSuccess;
}

cudaError_t cudaFuncGetAttributes(struct cudaFuncAttributes *a, const void *func)
{
	memset(a, 0, sizeof(*a));
	return func ? cudaSuccess : cudaErrorInvalidDeviceFunction;
}

cudaError_t cudaFuncSetAttribute(const void *func, enum cudaFuncAttribute attr, int value)
{
	return func && attr == cudaFuncAttributeMaxDynamicSharedMemorySize && value
		       ? cudaSuccess
		       : cudaErrorInvalidValue;
}

cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessor(int *blocks, const void *func, int block,
							  size_t shared)
{
	*blocks = func && block && shared < 48u << 10 ? 2 : 0;
	return cudaSuccess;
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t *s, unsigned int flags)
{
	return fake_alloc((void **)s, 1 + flags);
}

cudaError_t cudaStreamDestroy(cudaStream_t s)
{
	return fake_free(s);
}

cudaError_t cudaHostRegister(void *p, size_t bytes, unsigned int flags)
{
	fake.live++;
	return p && bytes && !flags ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaHostUnregister(void *p)
{
	fake.live--;
	return p ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaMalloc(void **p, size_t bytes)
{
	return fake_alloc(p, bytes);
}

cudaError_t cudaFree(void *p)
{
	return fake_free(p);
}

cudaError_t cudaHostAlloc(void **p, size_t bytes, unsigned int flags)
{
	return flags == cudaHostAllocMapped ? fake_alloc(p, bytes) : cudaErrorInvalidValue;
}

cudaError_t cudaFreeHost(void *p)
{
	return fake_free(p);
}

cudaError_t cudaHostGetDevicePointer(void **device, void *host, unsigned int flags)
{
	*device = host;
	return flags ? cudaErrorInvalidValue : cudaSuccess;
}

cudaError_t cudaMemcpy(void *to, const void *from, size_t bytes, enum cudaMemcpyKind kind)
{
	memcpy(to, from, bytes);
	return kind == cudaMemcpyHostToDevice ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaMemcpyAsync(void *to, const void *from, size_t bytes, enum cudaMemcpyKind kind,
			    cudaStream_t s)
{
	memcpy(to, from, bytes);
	return s && kind != cudaMemcpyHostToHost ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaMemcpy2D(void *to, size_t to_pitch, const void *from, size_t from_pitch,
			 size_t width, size_t height, enum cudaMemcpyKind kind)
{
	for (size_t i = 0; i < height; i++) {
		memcpy((char *)to + i * to_pitch, (const char *)from + i * from_pitch, width);
	}
	return kind != cudaMemcpyHostToHost ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaMemset(void *p, int value, size_t bytes)
{
	memset(p, value, bytes);
	return cudaSuccess;
}

cudaError_t cudaStreamBeginCapture(cudaStream_t s, enum cudaStreamCaptureMode mode)
{
	fake.capturing = 1;
	fake.captured.n = 0;
	return s && mode == cudaStreamCaptureModeThreadLocal ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaLaunchKernel(const void *func, dim3 grid, dim3 block, void **args, size_t shared,
			     cudaStream_t s)
{
	const enum cuda_kernel k = (enum cuda_kernel)((const char *)func - fake_function);

	if (!grid.x || !block.x || shared > HIST_SHARED) {
		return cudaErrorInvalidConfiguration;
	}
	if (fake.capturing) {
		fake.captured.launch[fake.captured.n++] =
			(struct fake_launch){k, *(struct cuda_args *)args[0]};
	} else if (k == CUDA_KERNEL_FAST || k == CUDA_KERNEL_REFERENCE) {
		fake_samples(args[0], k == CUDA_KERNEL_FAST ? MC_FAST : MC_REFERENCE);
	} else {
		return s ? cudaSuccess
			 : cudaErrorInvalidValue; /* the yardsticks: nothing looks at what they compute */
	}
	return cudaSuccess;
}

cudaError_t cudaStreamEndCapture(cudaStream_t s, cudaGraph_t *graph)
{
	fake.capturing = 0;
	fake.live++;
	*graph = malloc(sizeof(**graph));
	**graph = fake.captured;
	return s ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaGraphInstantiate(cudaGraphExec_t *exec, cudaGraph_t graph, unsigned long long flags)
{
	fake.live++;
	*exec = malloc(sizeof(*graph));
	memcpy(*exec, graph, sizeof(*graph));
	return flags ? cudaErrorInvalidValue : cudaSuccess;
}

cudaError_t cudaGraphDestroy(cudaGraph_t graph)
{
	return fake_free(graph);
}

cudaError_t cudaGraphExecDestroy(cudaGraphExec_t exec)
{
	return fake_free(exec);
}

cudaError_t cudaGraphUpload(cudaGraphExec_t exec, cudaStream_t s)
{
	return exec && s ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaGraphLaunch(cudaGraphExec_t exec, cudaStream_t s)
{
	const struct CUgraph_st *g = (const struct CUgraph_st *)exec;

	for (int i = 0; i < g->n && s; i++) {
		fake.queue[fake.queued++] = g->launch[i];
	}
	if (fake.late == 0) {
		fake_flush();
	}
	return cudaSuccess;
}

cudaError_t cudaStreamQuery(cudaStream_t s)
{
	if (fake.late > 0 && --fake.late == 0) {
		fake_flush();
	}
	return s && fake.queued ? cudaErrorNotReady : cudaSuccess;
}

cudaError_t cudaEventCreate(cudaEvent_t *e)
{
	return fake_alloc((void **)e, 1);
}

cudaError_t cudaEventDestroy(cudaEvent_t e)
{
	return fake_free(e);
}

cudaError_t cudaEventRecord(cudaEvent_t e, cudaStream_t s)
{
	return e && s ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaEventSynchronize(cudaEvent_t e)
{
	return e ? cudaSuccess : cudaErrorInvalidValue;
}

cudaError_t cudaEventElapsedTime(float *ms, cudaEvent_t from, cudaEvent_t to)
{
	*ms = 1.0f;
	return from && to ? cudaSuccess : cudaErrorInvalidValue;
}

#endif
