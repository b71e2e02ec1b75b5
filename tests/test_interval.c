/* SPDX-License-Identifier: MIT
 * Does the 95 % interval hold the true risk in 95 % of the cases? Over Philox seeds, at 5, 1 and 0.1 %: for a sum of
 * normals, whose risk is known, and for the paper's scene, whose risk a far larger Sobol set gives. A hundred seeds,
 * or INTERVAL_SEEDS as interval.sh sets it.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>
#include "draws.h"
#include "stats.h"

#define N 16384
#define TRUTH \
	(1u << 20) /* its error is 3 % of the interval's half-width at 0.1 %, less at the others */

static int seeds(void)
{
	const char *s = getenv("INTERVAL_SEEDS");

	return s ? atoi(s) : 100;
}

/* 93 to 97 % of 2,000, and as many standard errors of fewer. */
static void check_coverage(const char *what, const int held[MC_RISKS])
{
	double margin = 2.0 * sqrt(2000.0 / seeds());

	for (int i = 0; i < MC_RISKS; i++) {
		double share = 100.0 * held[i] / seeds();

		print_message("# %s, risk %g: held by %.2f %% of %d intervals\n", what,
			      mc_risk_level[i], share, seeds());
		assert_true(fabs(share - 95.0) <= margin);
	}
}

static void test_known_risk(void **arg)
{
	static const double level[MC_RISKS] = {1.6448536269514722, 2.3263478740408408,
					       3.0902323061678132};
	int held[MC_RISKS] = {0};

	(void)arg;
	for (int seed = 1; seed <= seeds(); seed++) {
		const struct mc_params p = {
			.kind = MC_PHILOX, .seed = (uint64_t)seed, .n_resident = 1};
		struct normal_plan plan;
		uint64_t hits[MC_RISKS] = {0};

		assert_int_equal(draws_plan(&p, &plan), 0);
		for (uint64_t index = 0; index < N; index++) {
			float z[4];

			normal_four(&plan, index, 0, z);
			for (int i = 0; i < MC_RISKS; i++) {
				double sum =
					(double)z[0] + (double)z[1] + (double)z[2] + (double)z[3];

				hits[i] += sum / 2 > level[i];
			}
		}
		for (int i = 0; i < MC_RISKS; i++) {
			double lo, hi;

			stats_wilson(hits[i], N, &lo, &hi);
			held[i] += lo <= mc_risk_level[i] && mc_risk_level[i] <= hi;
		}
	}
	check_coverage("sum of normals", held);
}

static struct mc_backend *opened(enum mc_draws_kind kind, uint64_t seed, uint32_t n)
{
	const struct mc_params p = {.kind = kind, .seed = seed, .n_resident = n, .threads = 1};
	struct mc_backend *b;

	assert_int_equal(mc_cpu_ops.open(&p, &b), 0);
	return b;
}

static struct mc_risk paper_risk(struct mc_backend *b, float headway_m, uint32_t n)
{
	struct mc_request req;
	struct mc_result res;

	mc_preset_paper(&req, headway_m, n);
	req.flags &= ~MC_WANT_HIST;
	assert_int_equal(mc_cpu_ops.run(b, &req, NULL, &res), 0);
	return res.risk[0];
}

/* Headways near 5, 1 and 0.1 %, and the risk there. */
static void paper_truth(float headway_m[MC_RISKS], double risk[MC_RISKS])
{
	struct mc_backend *b = opened(MC_SOBOL, 1, TRUTH);
	struct mc_request req;
	struct mc_result res;

	mc_preset_paper(&req, 100.0f, TRUTH);
	assert_int_equal(mc_cpu_ops.run(b, &req, NULL, &res), 0);
	for (int i = 0; i < MC_RISKS; i++) {
		headway_m[i] = (float)res.headway_m[i];
		risk[i] = paper_risk(b, headway_m[i], TRUTH).p;
		assert_true(fabs(risk[i] / mc_risk_level[i] - 1.0) < 0.01);
	}
	mc_cpu_ops.close(b);
}

static void test_paper(void **arg)
{
	float headway_m[MC_RISKS];
	double risk[MC_RISKS];
	int held[MC_RISKS] = {0};

	(void)arg;
	paper_truth(headway_m, risk);
	for (int seed = 1; seed <= seeds(); seed++) {
		struct mc_backend *b = opened(MC_PHILOX, (uint64_t)seed, N);

		for (int i = 0; i < MC_RISKS; i++) {
			const struct mc_risk r = paper_risk(b, headway_m[i], N);

			held[i] += r.lo <= risk[i] && risk[i] <= r.hi;
		}
		mc_cpu_ops.close(b);
	}
	check_coverage("paper's scene", held);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_known_risk),
		cmocka_unit_test(test_paper),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
