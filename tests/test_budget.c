/* SPDX-License-Identifier: MIT
 * budget: the largest power of two that meets the target, at least 256 while the ceiling allows; which batches are timed
 * to find the cost of one, and what becomes of a backend that fails or does not answer.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <math.h>
#include <poll.h>
#include "budget.h"
#include "mc_ops.h"

#define MS       1000000LL
#define RUNS_MAX 64

static void test_table(void **arg)
{
	static const struct {
		double ns, overhead_ns;
		int64_t target_ns, ceiling_ns;
		uint32_t min, max, n;
	} row[] = {
		{100, 0, 20 * MS, 530 * MS, 1, 16384, 16384},      /* 1.6 ms: the maximum holds */
		{100, 0, 20 * MS, 530 * MS, 1, 1u << 24, 131072},  /* 200,000 fit */
		{1e6 / 1024, 0, 1 * MS, 530 * MS, 1, 16384, 1024}, /* exactly fits */
		{1e6 / 1023, 0, 1 * MS, 530 * MS, 1, 16384, 512},  /* just does not */
		{1000, 19 * MS, 20 * MS, 530 * MS, 1, 16384, 512}, /* the overhead counts */
		{1e6, 0, 20 * MS, 530 * MS, 1, 16384,
		 256},                                    /* misses the target, meets the ceiling */
		{1e6, 0, 20 * MS, 255 * MS, 1, 16384, 0}, /* nor the ceiling */
		{1e6, 0, 20 * MS, 256 * MS, 1, 16384, 256},  /* the ceiling exactly */
		{1000, 0, 530 * MS, 1 * MS, 1, 16384, 512},  /* a ceiling below the target binds */
		{100, 0, 20 * MS, 530 * MS, 1, 12000, 8192}, /* power of two below the maximum */
		{100, 0, 20 * MS, 530 * MS, 1, 256, 256},    /* smallest maximum */
		{100, 0, 20 * MS, 530 * MS, 1, 255, 0},      /* too small a maximum */
		{0.001, 0, 530 * MS, 530 * MS, 1, UINT32_MAX, 1u << 31}, /* no overflow */
		{1e6, 0, 20 * MS, 530 * MS, 257, 16384, 512}, /* the fewest that are evidence */
		{1e6, 0, 20 * MS, 511 * MS, 257, 16384, 0},   /* not within the ceiling */
		{1, 0, 20 * MS, 530 * MS, 1025, 2047, 0},     /* no power of two between */
		{1, 0, 20 * MS, 530 * MS, 1024, 2047, 1024},
		{NAN, 0, 20 * MS, 530 * MS, 1, 16384, 0},
		{100, INFINITY, 20 * MS, 530 * MS, 1, 16384, 0},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		const struct budget_cost cost = {row[i].ns, row[i].overhead_ns};

		assert_int_equal(budget_samples(&cost, row[i].target_ns, row[i].ceiling_ns,
						row[i].min, row[i].max),
				 row[i].n);
	}
}

/* ---- measured on a backend that keeps a list ------------------------------------------------------------ */

static struct mc_backend {
	uint32_t n[RUNS_MAX];
	int runs;
	int error;      /* of every run */
	uint32_t sleep; /* runs of at least so many samples take 3 ms */
	int stuck;      /* runs end with the cut alone */
} fake;

static int fake_open(const struct mc_params *p, struct mc_backend **ret)
{
	(void)p;
	fake = (struct mc_backend){.sleep = UINT32_MAX};
	*ret = &fake;
	return 0;
}

static int fake_run(struct mc_backend *b, const struct mc_request *req, const uint64_t *cut,
		    struct mc_result *res)
{
	(void)res;
	assert_true(b->runs < RUNS_MAX);
	assert_int_equal(req->id, 1);
	b->n[b->runs++] = req->n;
	while (b->stuck && __atomic_load_n(cut, __ATOMIC_ACQUIRE) < req->id) {
		poll(NULL, 0, 1);
	}
	if (req->n >= b->sleep) {
		poll(NULL, 0, 3);
	}
	return b->error;
}

static void fake_close(struct mc_backend *b)
{
	(void)b;
}

static const struct mc_ops fake_ops = {
	.name = "fake", .open = fake_open, .run = fake_run, .close = fake_close};

static struct mc *opened(void)
{
	const struct mc_params p = {.n_resident = 1, .threads = 1};
	struct mc *mc = NULL;

	assert_int_equal(mc_open(&fake_ops, &p, MC_WORKER, &mc), 0);
	return mc;
}

static int measure(struct mc *mc, int64_t target_ns, int64_t limit_ns, uint32_t max,
		   struct budget_cost *cost)
{
	struct mc_request req;

	mc_preset_paper(&req, 100.0f, 1);
	return budget_measure(mc, &req, target_ns, limit_ns, max, cost);
}

static void test_sizes_double_up_to_the_most(void **arg)
{
	static const uint32_t want[] = {256, 256, 256, 512, 512, 512, 1024, 1024, 1024};
	struct budget_cost cost = {NAN, NAN};
	struct mc *mc = opened();

	(void)arg;
	assert_int_equal(measure(mc, 3600000 * MS, 3600000 * MS, 2047, &cost), 0);
	assert_int_equal(fake.runs, 9);
	assert_memory_equal(fake.n, want, sizeof(want));
	assert_true(cost.sample_ns > 0);
	assert_true(cost.overhead_ns >= 0);
	mc_close(mc);
}

static void test_no_size_beyond_the_target(void **arg)
{
	struct budget_cost cost;
	struct mc *mc = opened();

	(void)arg;
	fake.sleep = 512;
	assert_int_equal(measure(mc, 3 * MS, 3600000 * MS, 1u << 24, &cost), 0);
	assert_true(fake.n[fake.runs - 1] <= 512);
	assert_true(cost.overhead_ns + 512 * cost.sample_ns >= 3.0 * MS || fake.runs == 3);
	fake.sleep = 0;
	fake.runs = 0;
	assert_int_equal(measure(mc, 3 * MS, 3600000 * MS, 1u << 24, &cost), 0);
	assert_int_equal(fake.runs, 3);
	assert_true(256 * cost.sample_ns >= 3.0 * MS);
	assert_true(cost.overhead_ns == 0);
	mc_close(mc);
}

static void test_backend_that_fails(void **arg)
{
	struct budget_cost cost = {1, 2};
	struct mc *mc = opened();

	(void)arg;
	fake.error = -EFAULT;
	assert_int_equal(measure(mc, MS, 3600000 * MS, 1024, &cost), -EFAULT);
	assert_int_equal(fake.runs, 1);
	assert_true(cost.sample_ns == 1 && cost.overhead_ns == 2);
	mc_close(mc);
}

static void test_backend_that_does_not_answer(void **arg)
{
	struct budget_cost cost = {1, 2};
	struct mc *mc = opened();

	(void)arg;
	fake.stuck = 1;
	assert_int_equal(measure(mc, MS, 2 * MS, 1024, &cost), -ETIMEDOUT);
	assert_true(cost.sample_ns == 1 && cost.overhead_ns == 2);
	mc_close(mc);
}

static void test_request_that_no_backend_takes(void **arg)
{
	struct budget_cost cost = {1, 2};
	struct mc *mc = opened();
	struct mc_request req;

	(void)arg;
	mc_preset_paper(&req, NAN, 1);
	assert_int_equal(budget_measure(mc, &req, MS, MS, 1024, &cost), -EINVAL);
	assert_int_equal(fake.runs, 0);
	mc_close(mc);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_table),
		cmocka_unit_test(test_sizes_double_up_to_the_most),
		cmocka_unit_test(test_no_size_beyond_the_target),
		cmocka_unit_test(test_backend_that_fails),
		cmocka_unit_test(test_backend_that_does_not_answer),
		cmocka_unit_test(test_request_that_no_backend_takes),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
