/* SPDX-License-Identifier: MIT
 * trace: a provider that is not wanted or not there, the environment it gets, when the alarm goes off, and what a backend's
 * watch passes on.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"
#include "trace.h"

static void test_none(void **state)
{
	const struct trace_ops *ops = (const struct trace_ops *)1;
	char err[200] = "";

	(void)state;
	assert_int_equal(trace_load(TRACE_NONE, 1, &ops, err, sizeof(err)), 0);
	assert_null(ops);
}

/* No provider lies beside the test; the environment is prepared before it is looked for. */
static void test_absent(void **state)
{
	const struct trace_ops *ops;
	char err[200] = "";

	(void)state;
	setenv("LTTNG_UST_ALLOW_BLOCKING", "1", 1);
	setenv("LTTNG_UST_REGISTER_TIMEOUT", "3000", 1);
	assert_int_equal(trace_load(TRACE_LTTNG, 0, &ops, err, sizeof(err)), -ENOENT);
	assert_non_null(strstr(err, "trace-lttng.so"));
	assert_null(ops);
	assert_null(getenv("LTTNG_UST_ALLOW_BLOCKING"));
	assert_string_equal(getenv("LTTNG_UST_REGISTER_TIMEOUT"), "3000");
	assert_int_equal(trace_load(TRACE_NVTX, 1, &ops, err, sizeof(err)), -ENOENT);
	assert_string_equal(getenv("LTTNG_UST_REGISTER_TIMEOUT"), "0");
}

static void test_alarm(void **state)
{
	struct trace_alarm a = {0};
	const int64_t s = CLOCK_NS_PER_S;

	(void)state;
	assert_int_equal(trace_alarm(&a, 0, 1 * s), 0);
	assert_int_equal(trace_alarm(&a, 1, 2 * s), 0); /* what comes after is wanted too */
	assert_int_equal(trace_alarm(&a, 5, 3 * s - 1), 0);
	assert_int_equal(trace_alarm(&a, 5, 3 * s), 1);
	assert_int_equal(trace_alarm(&a, 5, 3 * s + 1), 0);
	assert_int_equal(trace_alarm(&a, 6, 4 * s), 0);
	assert_int_equal(trace_alarm(&a, 7, 13 * s - 1), 0); /* once in ten seconds */
	assert_int_equal(trace_alarm(&a, 7, 13 * s), 1);
	assert_int_equal(trace_alarm(&a, 7, 40 * s), 0);
	assert_int_equal(trace_alarm(&a, 8, 50 * s), 0);
	assert_int_equal(trace_alarm(&a, 8, 51 * s), 1);
}

static int met;
static uint64_t last_id;
static enum mc_edge last_edge;
static int64_t last_ns;

static void thread(void)
{
	met++;
}

static void batch(uint64_t cycle, enum mc_edge e, int64_t t_ns)
{
	last_id = cycle;
	last_edge = e;
	last_ns = t_ns;
}

static void test_watch(void **state)
{
	static const struct trace_ops ops = {.thread = thread, .batch = batch};
	const struct mc_watch w = trace_watch(&ops);
	const int64_t from_ns = clock_now_ns();

	(void)state;
	w.hello(w.arg);
	w.edge(w.arg, MC_EDGE_ANSWERED, 7);
#ifdef TRACE_PROVIDERS
	assert_int_equal(met, 1);
	assert_int_equal(last_id, 7);
	assert_int_equal(last_edge, MC_EDGE_ANSWERED);
	assert_in_range(last_ns, from_ns, clock_now_ns());
#else
	assert_int_equal(met, 0); /* compiled to nothing */
	assert_int_equal(last_id + (uint64_t)last_edge + (uint64_t)last_ns, 0);
	assert_true(from_ns > 0);
#endif
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_none),
		cmocka_unit_test(test_absent),
		cmocka_unit_test(test_alarm),
		cmocka_unit_test(test_watch),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
