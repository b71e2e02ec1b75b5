/* SPDX-License-Identifier: MIT
 * budget: the largest power of two that meets the target, at least 256 while the ceiling allows.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include "budget.h"

#define MS 1000000LL

static void test_table(void **arg)
{
	static const struct {
		double ns, overhead_ns;
		int64_t target_ns, ceiling_ns;
		uint32_t max, n;
	} row[] = {
		{100, 0, 20 * MS, 530 * MS, 16384, 16384},      /* 1.6 ms: the maximum holds */
		{100, 0, 20 * MS, 530 * MS, 1u << 24, 131072},  /* 200,000 fit */
		{1e6 / 1024, 0, 1 * MS, 530 * MS, 16384, 1024}, /* exactly fits */
		{1e6 / 1023, 0, 1 * MS, 530 * MS, 16384, 512},  /* just does not */
		{1000, 19 * MS, 20 * MS, 530 * MS, 16384, 512}, /* the overhead counts */
		{1e6, 0, 20 * MS, 530 * MS, 16384, 256},  /* misses the target, meets the ceiling */
		{1e6, 0, 20 * MS, 255 * MS, 16384, 0},    /* nor the ceiling */
		{1e6, 0, 20 * MS, 256 * MS, 16384, 256},  /* the ceiling exactly */
		{1000, 0, 530 * MS, 1 * MS, 16384, 512},  /* a ceiling below the target binds */
		{100, 0, 20 * MS, 530 * MS, 12000, 8192}, /* power of two below the maximum */
		{100, 0, 20 * MS, 530 * MS, 256, 256},    /* smallest maximum */
		{100, 0, 20 * MS, 530 * MS, 255, 0},      /* too small a maximum */
		{0.001, 0, 530 * MS, 530 * MS, UINT32_MAX, 1u << 31}, /* no overflow */
		{NAN, 0, 20 * MS, 530 * MS, 16384, 0},
		{100, INFINITY, 20 * MS, 530 * MS, 16384, 0},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		assert_int_equal(budget_samples(row[i].ns, row[i].overhead_ns, row[i].target_ns,
						row[i].ceiling_ns, row[i].max),
				 row[i].n);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(test_table)};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
