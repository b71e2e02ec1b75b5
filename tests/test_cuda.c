/* SPDX-License-Identifier: MIT
 * mc_cuda: the host side on a made-up runtime gives what the CPU gives; requests, chunks, the cut. What the kernels compute
 * on a real device: tests/gpu.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "cuda_backend.h"

#define N 3000u

/* ---- equality -------------------------------------------------------------------------------------- */

static void same_batch(struct mc_backend *cpu, struct mc_backend *gpu, const struct mc_request *req)
{
	struct mc_result c, g;

	memset(&c, 0, sizeof(c));
	memset(&g, 0xff, sizeof(g));
	assert_int_equal(mc_cpu_ops.run(cpu, req, NULL, &c), 0);
	assert_int_equal(mc_cuda_ops.run(gpu, req, NULL, &g), 0);
	assert_memory_equal(&c, &g, sizeof(c));
	if (req->flags & MC_WANT_HIST) {
		assert_memory_equal(mc_cpu_ops.hist(cpu), mc_cuda_ops.hist(gpu),
				    sizeof(struct mc_hist));
	}
}

static void test_batches_equal_the_cpu(void **state)
{
	const struct mc_params p = params();
	struct mc_request req[] = {scene_standing(N), scene_moving(N), scene_lead(100),
				   scene_moving(RESIDENT)};
	struct mc_backend *gpu = opened(), *cpu;

	(void)state;
	assert_int_equal(mc_cpu_ops.open(&p, &cpu), 0);
	for (size_t i = 0; i < sizeof(req) / sizeof(req[0]); i++) {
		same_batch(cpu, gpu, &req[i]);
		req[i].flags = MC_WANT_IMPACT;
		same_batch(cpu, gpu, &req[i]);
	}
	mc_cpu_ops.close(cpu);
	closed(gpu);
}

static void test_samples_equal_the_cpu(void **state)
{
	const struct mc_params p = params();
	const struct mc_request req = scene_moving(N);
	static struct model_out c[MC_FUTURES_MAX * 300], g[MC_FUTURES_MAX * 300];
	struct mc_backend *gpu = opened(), *cpu;

	(void)state;
	assert_int_equal(mc_cpu_ops.open(&p, &cpu), 0);
	for (int which = MC_FAST; which <= MC_REFERENCE; which++) {
		memset(g, 0xff, sizeof(g));
		assert_int_equal(mc_cpu_ops.samples(cpu, &req, which, RESIDENT - 100, 300, c), 0);
		assert_int_equal(mc_cuda_ops.samples(gpu, &req, which, RESIDENT - 100, 300, g), 0);
		assert_memory_equal(c, g, sizeof(c));
	}
	mc_cpu_ops.close(cpu);
	closed(gpu);
}

static void test_roll_takes_explicit_inputs(void **state)
{
	const struct mc_request req = scene_lead(1);
	struct mc_backend *gpu = opened();
	static float in[MODEL_INPUTS * 70000]; /* more than one piece */
	static struct model_out g[70000];

	(void)state;
	for (uint32_t i = 0; i < 70000; i++) {
		for (uint32_t d = 0; d < MODEL_INPUTS; d++) {
			in[d * 70000 + i] = req.mean[d];
		}
		in[MODEL_EGO_SPEED * 70000 + i] = 1.0f + (float)i * 5e-4f;
	}
	assert_int_equal(
		mc_cuda_ops.roll(gpu, MC_FAST, &req.vehicle, &req.future[0], 10.0f, in, 70000, g),
		0);
	for (uint32_t i = 0; i < 70000; i += 999) {
		const struct rollout_plan plan = rollout_plan(&req.vehicle, &req.future[0], 10.0f);
		const struct model_out want = rollout_sample(&plan, in + i, 70000);

		assert_memory_equal(&want, &g[i], sizeof(want));
	}
	closed(gpu);
}

static void test_cut_ends_between_chunks(void **state)
{
	struct mc_request req = scene_lead(N);
	struct mc_backend *b = opened();
	uint64_t cut = req.id - 1;
	struct mc_result res;

	(void)state;
	assert_int_equal(mc_cuda_ops.run(b, &req, &cut, &res), 0);
	assert_int_equal(res.n, N);
	cut = req.id;
	assert_int_equal(mc_cuda_ops.run(b, &req, &cut, &res), 0);
	assert_int_equal(res.n, 0);
	assert_int_equal(res.flags & MC_RES_CUT, MC_RES_CUT);
	closed(b);
}

static void test_bad_requests(void **state)
{
	struct mc_request req = scene_lead(N);
	struct mc_backend *b = opened();
	struct mc_cuda_time t;
	struct model_out out;
	struct mc_result res;

	(void)state;
	assert_int_equal(mc_cuda_time(b, MC_CUDA_REFERENCE, &req, 1e-3, 1, &t),
			 -EINVAL); /* beyond the resident draws */
	assert_int_equal(mc_cuda_time(b, MC_CUDA_PEAK, &req, 0.0, 1, &t), -EINVAL);
	assert_int_equal(mc_cuda_time(b, MC_CUDA_RUNGS, &req, 1e-3, 1, &t), -EINVAL);
	req.mean[MODEL_MU] = NAN;
	assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &res), -EINVAL);
	assert_int_equal(mc_cuda_ops.samples(b, &req, MC_FAST, 0, 1, &out), -EINVAL);
	closed(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(test_batches_equal_the_cpu, reset),
		cmocka_unit_test_setup(test_samples_equal_the_cpu, reset),
		cmocka_unit_test_setup(test_roll_takes_explicit_inputs, reset),
		cmocka_unit_test_setup(test_cut_ends_between_chunks, reset),
		cmocka_unit_test_setup(test_bad_requests, reset),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
