/* SPDX-License-Identifier: MIT
 * hist: where durations are counted, and that a percentile is never less than the true one nor more than 1/16 above it.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>
#include "hist.h"

#define N 5000

static void test_buckets_follow_each_other(void **state)
{
	(void)state;
	assert_int_equal(hist_bucket(-5), 0);
	assert_int_equal(hist_bucket(0), 0);
	assert_int_equal(hist_bucket(INT64_MAX), HIST_BUCKETS - 1);
	assert_true(hist_end_ns(HIST_BUCKETS - 1) == INT64_MAX);
	for (int b = 0; b < HIST_BUCKETS - 1; b++) {
		const int64_t end_ns = hist_end_ns(b);

		assert_int_equal(hist_bucket(end_ns - 1), b);
		assert_int_equal(hist_bucket(end_ns), b + 1);
	}
}

static void test_empty(void **state)
{
	static const struct hist h;

	(void)state;
	assert_int_equal(hist_percentile(&h, 0.5), -1);
	assert_int_equal(hist_count(&h), 0);
	assert_int_equal(hist_max_ns(&h), 0);
	assert_int_equal(hist_rank(0, 0.5), 0);
}

static void test_rank(void **state)
{
	(void)state;
	assert_int_equal(hist_rank(1, 0.001), 1);
	assert_int_equal(hist_rank(10, 0.5), 5);
	assert_int_equal(hist_rank(11, 0.5), 6);
	assert_int_equal(hist_rank(1000, 0.999), 999);
	assert_int_equal(hist_rank(1000, 1), 1000);
}

static void test_one_value(void **state)
{
	static struct hist h;

	(void)state;
	hist_add(&h, 12345678);
	assert_int_equal(hist_percentile(&h, 0.001), 12345678); /* the maximum is known exactly */
	assert_int_equal(hist_percentile(&h, 1), 12345678);
}

static int by_time(const void *a, const void *b)
{
	const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

	return (x > y) - (x < y);
}

/* From 1 us and less up to 17 s. */
static void test_percentiles(void **state)
{
	static const double q[] = {0.01, 0.5, 0.95, 0.99, 0.999, 1};
	static struct hist h;
	static int64_t ns[N];
	uint64_t random = 1;

	(void)state;
	for (int i = 0; i < N; i++) {
		random = random * 6364136223846793005ULL + 1;
		ns[i] = (int64_t)(random >> 30 >> (random >> 59));
		hist_add(&h, ns[i]);
	}
	qsort(ns, N, sizeof(ns[0]), by_time);
	assert_int_equal(hist_count(&h), N);
	assert_int_equal(hist_max_ns(&h), ns[N - 1]);
	for (size_t i = 0; i < sizeof(q) / sizeof(q[0]); i++) {
		const int64_t want = ns[hist_rank(N, q[i]) - 1], got = hist_percentile(&h, q[i]);

		assert_true(got >= want);
		assert_true(got <= want + want / 16 + (1 << HIST_SHIFT));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_buckets_follow_each_other),
		cmocka_unit_test(test_empty),
		cmocka_unit_test(test_rank),
		cmocka_unit_test(test_one_value),
		cmocka_unit_test(test_percentiles),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
