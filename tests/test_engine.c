/* SPDX-License-Identifier: MIT
 * engine: which backend the live daemon gets, and why not the one it asked for. On a machine without a GPU.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <string.h>
#include "engine.h"
#include "fault.h"
#include "mc_cuda.h"

enum choice { AUTO, CPU, CUDA };

static struct engine opened(enum choice c, char *err, int err_len)
{
	struct engine e = {0};
	struct config cfg;

	config_defaults(&cfg);
	cfg.mc_backend = (config_choice)c;
	cfg.mc_samples = 256;
	assert_int_equal(engine_open_live(&cfg, &e, err, err_len), 0);
	assert_non_null(e.mc);
	return e;
}

static int has_gpu(void)
{
	struct mc_cuda_info info;

	return mc_cuda_info(&info) == 0;
}

static void test_the_cpu_when_asked_for(void **state)
{
	char err[256] = "x";
	struct engine e = opened(CPU, err, sizeof(err));

	(void)state;
	assert_int_equal(e.which, PUBLISH_BACKEND_CPU);
	assert_null(e.spare);
	assert_int_equal(e.faults, 0);
	assert_string_equal(err, "");
	engine_close(&e);
}

static void test_auto_without_a_gpu_is_no_fault(void **state)
{
	char err[256] = "x";

	(void)state;
	if (has_gpu()) {
		puts("# needs a machine without a GPU");
		skip();
	}
	struct engine e = opened(AUTO, err, sizeof(err));

	assert_int_equal(e.which, PUBLISH_BACKEND_CPU);
	assert_null(e.spare);
	assert_int_equal(e.faults, 0);
	assert_string_equal(err, "");
	engine_close(&e);
}

static void test_a_gpu_asked_for_and_missing_is_a_fault(void **state)
{
	char err[256] = "";

	(void)state;
	if (has_gpu()) {
		puts("# needs a machine without a GPU");
		skip();
	}
	struct engine e = opened(CUDA, err, sizeof(err));

	assert_int_equal(e.which, PUBLISH_BACKEND_CPU);
	assert_true(e.faults == FAULT_BIT(GPU_DRIVER) || e.faults == FAULT_BIT(GPU_NONE));
	assert_int_equal(fault_state(e.faults), STATE_DEGRADED);
	assert_non_null(strstr(err, "running on the CPU"));
	engine_close(&e);
}

static void test_every_error_has_its_reason(void **state)
{
	static const struct {
		int err;
		uint32_t fault;
	} row[] = {
		{-ENOTSUP, FAULT_BIT(GPU_NONE)},   {-ENODEV, FAULT_BIT(GPU_NONE)},
		{-ENOSYS, FAULT_BIT(GPU_DRIVER)},  {-ENOEXEC, FAULT_BIT(GPU_OLD)},
		{-ENOMEM, FAULT_BIT(GPU_MEMORY)},  {-EFAULT, FAULT_BIT(GPU_ADDRESS)},
		{-ETIMEDOUT, FAULT_BIT(GPU_HANG)}, {-EBADMSG, FAULT_BIT(GPU_BITS)},
		{-EIO, FAULT_BIT(GPU_LOST)},       {-EINVAL, FAULT_BIT(GPU_LOST)},
	};

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		assert_int_equal(engine_fault(row[i].err), row[i].fault);
		assert_int_equal(fault_state(row[i].fault), STATE_DEGRADED);
	}
}

/* Timed through the worker: at least the fewest, at most what the configuration says, a power of two. */
static void test_size_is_chosen(void **state)
{
	static const struct {
		double target_ms;
		int64_t least, most;
		uint32_t samples;
	} row[] = {
		{530, 1, 512, 512},      /* the target is met by far */
		{530, 1, 1000, 512},     /* a power of two */
		{1e-3, 1, 16384, 256},   /* no target is met: the fewest that are measured */
		{1e-3, 700, 16384, 1024} /* or that are evidence */
	};

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		char err[256];
		struct engine e;
		struct config cfg;

		config_defaults(&cfg);
		cfg.mc_backend = CPU;
		cfg.decision_samples_min = row[i].least;
		cfg.mc_samples = row[i].most;
		cfg.mc_target = row[i].target_ms;
		cfg.mc_budget = 100000;
		assert_int_equal(engine_open_live(&cfg, &e, err, sizeof(err)), 0);
		assert_int_equal(e.size.samples, row[i].samples);
		assert_true(e.size.cost.sample_ns > 0);
		assert_int_equal(e.spare_size.samples, 0);
		engine_close(&e);
	}
}

static void test_too_slow_for_the_budget(void **state)
{
	char err[256];
	struct engine e;
	struct config cfg;

	(void)state;
	config_defaults(&cfg);
	cfg.mc_backend = CPU;
	cfg.mc_samples = 256;
	cfg.mc_budget = 1e-6; /* 1 ns */
	assert_int_equal(engine_open_live(&cfg, &e, err, sizeof(err)), -ETIMEDOUT);
	assert_non_null(strstr(err, "from decision.samples_min = 256 to mc.samples = 256 samples"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_the_cpu_when_asked_for),
		cmocka_unit_test(test_auto_without_a_gpu_is_no_fault),
		cmocka_unit_test(test_a_gpu_asked_for_and_missing_is_a_fault),
		cmocka_unit_test(test_every_error_has_its_reason),
		cmocka_unit_test(test_size_is_chosen),
		cmocka_unit_test(test_too_slow_for_the_budget),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
