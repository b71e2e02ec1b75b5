/* SPDX-License-Identifier: MIT
 * The scalar reference's time is that of its quickest part, so that a busy machine does not make ratios larger.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>
#include "clock.h"
#include "mc_ops.h"

static int64_t now_ns;
extern const struct mc_ops fake_ops;

static int64_t fake_now_ns(void)
{
	return now_ns;
}

#define clock_now_ns fake_now_ns
#define mc_cpu_ops   fake_ops
#include "../tools/bench_scene.c"
#include "../tools/bench_time.c"

int cli_interrupted(void)
{
	return 0;
}

#define SAMPLES 107

static int calls, fails_at;

/* Every part but the fifth is disturbed. */
static int fake_samples(struct mc_backend *b, const struct mc_request *req, enum mc_rollout which,
			uint64_t first, uint32_t count, struct model_out *out)
{
	(void)b;
	assert_int_equal(which, MC_REFERENCE);
	assert_true(first + count <= req->n);
	calls++;
	now_ns += (int64_t)count * (calls == 5 ? 1000 : 1500 + 100 * (calls % 7));
	out[0].stop_m = (float)first;
	return calls == fails_at ? -EIO : 0;
}

const struct mc_ops fake_ops = {.samples = fake_samples};

static void test_least(void **state)
{
	struct model_out out[SAMPLES];
	double ns = 0;

	(void)state;
	calls = fails_at = 0;
	assert_int_equal(bench_time_scalar(NULL, SAMPLES, out, &ns), 0);
	assert_true(ns == 1000);
	assert_in_range(calls, 20, 22);
	assert_true(out[50].stop_m == 50);
}

static void test_few(void **state)
{
	struct model_out out[3];
	double ns = 0;

	(void)state;
	calls = fails_at = 0;
	assert_int_equal(bench_time_scalar(NULL, 3, out, &ns), 0);
	assert_int_equal(calls, 3);
	assert_true(ns == 1600);
}

static void test_error(void **state)
{
	struct model_out out[SAMPLES];
	double ns;

	(void)state;
	calls = 0;
	fails_at = 2;
	assert_int_equal(bench_time_scalar(NULL, SAMPLES, out, &ns), -EIO);
	assert_int_equal(calls, 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_least),
		cmocka_unit_test(test_few),
		cmocka_unit_test(test_error),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
