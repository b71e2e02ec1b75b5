/* SPDX-License-Identifier: MIT
 * Stretches of a target's distance: slopes of known lines, what ends a stretch, medians, ratios.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "../tools/noise.h"
#include "../tools/stretch.c"

#define STEP_NS (CLOCK_NS_PER_S / 20)

static struct stretch_sample at(int i, double slope_mps)
{
	const double t = i * 0.05;

	return (struct stretch_sample){.t_ns = i * STEP_NS,
				       .distance_m = 50 + slope_mps * t,
				       .rate_mps = 2 * slope_mps,
				       .lateral_m = 1 - 0.5 * t,
				       .ego_mps = 20,
				       .yaw_radps = 0.1};
}

static void test_line(void **state)
{
	struct stretch_run r = {0};
	struct stretch done;
	int n = 0;

	(void)state;
	for (int i = 0; i < 200; i++) {
		const struct stretch_sample s = at(i, -3);

		n += stretch_add(&r, &s, &done);
	}
	assert_int_equal(n, 4); /* of 10 s, the last not yet ended */
	assert_true(fabs(done.slope_mps + 3) < 1e-9 && done.slope_se_mps < 1e-6);
	assert_true(fabs(done.lateral_mps + 0.5) < 1e-9);
	assert_true(fabs(done.rate_mps + 6) < 1e-9 && fabs(done.ego_mps - 20) < 1e-9);
	assert_true(fabs(done.yaw_radps - 0.1) < 1e-9);
	assert_int_equal(stretch_end(&r, &done), 1);
	assert_int_equal(stretch_end(&r, &done), 0);
}

/* A target of @n samples that then goes on as @next says. */
static int ends(int n, struct stretch_sample next)
{
	struct stretch_run r = {0};
	struct stretch done;

	for (int i = 0; i < n; i++) {
		const struct stretch_sample s = at(i, -3);

		assert_int_equal(stretch_add(&r, &s, &done), 0);
	}
	return stretch_add(&r, &next, &done);
}

static void test_ends(void **state)
{
	struct stretch_sample leap = at(25, -3), late = at(36, -3);

	(void)state;
	assert_int_equal(ends(25, at(25, -3)), 0);
	leap.distance_m += 4.5; /* 1 m of noise and 60 m/s for 50 ms make 4 m */
	assert_int_equal(ends(25, leap), 1);
	leap.distance_m -= 1;
	assert_int_equal(ends(25, leap), 0);
	assert_int_equal(ends(25, late), 1);
	late.t_ns = 34 * STEP_NS;
	assert_int_equal(ends(25, late), 0);
	leap.distance_m = 500;
	assert_int_equal(ends(20, leap), 0); /* shorter than 1 s: of no use */
}

static void test_few_samples(void **state)
{
	struct stretch_run r = {0};
	struct stretch done;

	(void)state;
	for (int i = 0; i < 4; i++) {
		struct stretch_sample s = at(8 * i, -3);

		assert_int_equal(stretch_add(&r, &s, &done), 0);
	}
	assert_int_equal(stretch_end(&r, &done), 0); /* 1.2 s, but 4 samples */
}

static void test_noise(void **state)
{
	struct noise noise = {0};
	int far = 0;

	(void)state;
	for (int k = 0; k < 400; k++) {
		struct stretch_run r = {0};
		struct stretch done;

		for (int i = 0; i < 40; i++) {
			struct stretch_sample s = at(i, -3);

			s.distance_m += 0.2 * noise_normal(&noise);
			stretch_add(&r, &s, &done);
		}
		assert_int_equal(stretch_end(&r, &done), 1);
		far += fabs(done.slope_mps + 3) > 2 * done.slope_se_mps;
	}
	assert_in_range(far, 8, 36); /* 5 % of 400, and four of its standard deviations */
}

static void test_medians(void **state)
{
	double one[] = {7}, odd[] = {1, 100, 3}, even[] = {4, 1, 2, 3};
	struct stretch_median m = stretch_median(one, 0);

	(void)state;
	assert_true(m.n == 0 && isnan(m.value));
	assert_true(stretch_median(one, 1).value == 7);
	m = stretch_median(odd, 3);
	assert_true(m.value == 3 && fabs(m.spread - 2 * 1.4826) < 1e-12);
	m = stretch_median(even, 4);
	assert_true(m.value == 2.5 && fabs(m.spread - 1.4826) < 1e-12);
	assert_true(fabs(m.se - 1.2533 * 1.4826 / 2) < 1e-12);
}

static void test_ratio(void **state)
{
	struct stretch_list l = {0};
	struct stretch_median m;

	(void)state;
	for (int i = 0; i < 200; i++) {
		const double slope = i % 2 ? -4 : 0.3; /* the second is too slow to count */

		stretch_keep(&l, &(struct stretch){.slope_mps = slope,
						   .slope_se_mps = 0.1,
						   .rate_mps = i % 10 == 1 ? 99 : -slope,
						   .ego_mps = 20});
	}
	stretch_keep(&l, &(struct stretch){.slope_mps = -9, .slope_se_mps = 3, .rate_mps = 9});
	stretch_keep(&l, &(struct stretch){.slope_mps = -9, .slope_se_mps = 0.1, .rate_mps = NAN});
	assert_int_equal(l.n, 202);
	m = stretch_ratio(&l, 0);
	assert_true(m.n == 100 && m.value == -1 && m.spread == 0);
	m = stretch_ratio(&l, 1);
	assert_true(m.n == 100 && m.value == 4); /* (4 - 20) / -4 */
	free(l.at);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_line),        cmocka_unit_test(test_ends),
		cmocka_unit_test(test_few_samples), cmocka_unit_test(test_noise),
		cmocka_unit_test(test_medians),     cmocka_unit_test(test_ratio),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
