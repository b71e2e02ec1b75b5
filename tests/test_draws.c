/* SPDX-License-Identifier: MIT
 * draws: the resident table is what normal.h says; nets stay nets after scrambling; moments, tails, truncation.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "draws.h"

#define N 65536u

static const enum mc_draws_kind kind[] = {MC_SOBOL, MC_PHILOX};

static struct mc_params params(enum mc_draws_kind k, uint64_t seed, uint32_t n)
{
	return (struct mc_params){.kind = k, .seed = seed, .n_resident = n};
}

static struct draws *opened(const struct mc_params *p)
{
	struct draws *d = NULL;

	assert_int_equal(draws_open(p, &d), 0);
	assert_non_null(d);
	return d;
}

static const float *row(const struct draws *d, int dim)
{
	uint32_t stride;
	const float *z = draws_table(d, &stride);

	return z + (size_t)dim * stride;
}

static void test_refused(void **arg)
{
	struct mc_params good = params(MC_SOBOL, 1, 16), p = good;
	struct draws *d = (struct draws *)&good;

	(void)arg;
	p.kind = (enum mc_draws_kind)2;
	assert_int_equal(draws_open(&p, &d), -EINVAL);
	p = good;
	p.n_resident = 0;
	assert_int_equal(draws_open(&p, &d), -EINVAL);
	p.n_resident = (1u << 24) + 1;
	assert_int_equal(draws_open(&p, &d), -EINVAL);
	for (int dim = 0; dim < MC_DIM; dim++) {
		static const float bad[] = {-1.0f, 6.4f, NAN, INFINITY};

		for (int i = 0; i < 4; i++) {
			p = good;
			p.truncate[dim] = bad[i];
			assert_int_equal(draws_open(&p, &d), -EINVAL);
		}
	}
	assert_ptr_equal(d, &good);
	draws_close(NULL);
}

static void test_table(void **arg)
{
	(void)arg;
	for (int k = 0; k < 2; k++) {
		struct mc_params p = params(kind[k], 0x123456789abcdef0u, 1000);
		struct draws *d = opened(&p);
		struct normal_plan plan;
		uint32_t stride;
		const float *z = draws_table(d, &stride);

		assert_int_equal(draws_plan(&p, &plan), 0);
		assert_true(stride >= 1000);
		assert_int_equal((uintptr_t)z % 64, 0);
		assert_int_equal(stride * sizeof(float) % 64, 0);
		for (uint32_t i = 0; i < 1000; i++) {
			for (uint32_t dim = 0; dim < MC_DIM; dim++) {
				float four[4];

				normal_four(&plan, i, dim / 4, four);
				assert_true(z[dim * stride + i] == four[dim % 4]);
			}
		}
		draws_close(d);
	}
}

/* Rows a power of two apart would share their cache sets. */
static void test_stride(void **arg)
{
	(void)arg;
	for (uint32_t n = 1024; n <= 65536; n *= 2) {
		struct mc_params p = params(MC_PHILOX, 1, n);
		struct draws *d = opened(&p);
		uint32_t stride;

		draws_table(d, &stride);
		assert_int_not_equal(stride % 1024, 0);
		draws_close(d);
	}
}

/* Beyond 2^32 the net is scrambled anew. */
static void test_beyond(void **arg)
{
	struct mc_params p = params(MC_SOBOL, 99, 1);
	struct normal_plan plan;

	(void)arg;
	assert_int_equal(draws_plan(&p, &plan), 0);
	for (uint32_t dim = 0; dim < MC_DIM; dim++) {
		uint32_t first = normal_sobol_bits(&plan, 0, dim);
		uint32_t again = normal_sobol_bits(&plan, 1ull << 32, dim);

		assert_int_not_equal(first, again);
		assert_int_not_equal(first ^ normal_sobol_bits(&plan, 1, dim),
				     again ^ normal_sobol_bits(&plan, (1ull << 32) + 1, dim));
	}
}

/* Any piece at any offset is the same as that part of a longer run, also where the index passes 2^32. */
static void test_pieces(void **arg)
{
	static const uint64_t first[] = {0, 1, 777, (1ull << 32) - 100, 1ull << 40};
	static float whole[MC_DIM][200], piece[MC_DIM][70];

	(void)arg;
	for (int i = 0; i < 10; i++) {
		struct mc_params p = params(kind[i % 2], 5, 1);
		struct draws *d = opened(&p);

		draws_fill(d, first[i / 2], 200, whole[0], 200);
		draws_fill(d, first[i / 2] + 123, 70, piece[0], 70);
		for (int dim = 0; dim < MC_DIM; dim++) {
			assert_memory_equal(piece[dim], whole[dim] + 123, sizeof(piece[dim]));
		}
		draws_close(d);
	}
}

static void test_seeds(void **arg)
{
	(void)arg;
	for (int k = 0; k < 2; k++) {
		float a[MC_DIM][64], b[MC_DIM][64];

		for (uint64_t bit = 0; bit < 64; bit++) {
			struct mc_params p = params(kind[k], 0, 1),
					 q = params(kind[k], 1ull << bit, 1);
			struct draws *d = opened(&p), *e = opened(&q);

			draws_fill(d, 0, 64, a[0], 64);
			draws_fill(e, 0, 64, b[0], 64);
			for (int dim = 0; dim < MC_DIM; dim++) {
				assert_memory_not_equal(a[dim], b[dim], sizeof(a[dim]));
			}
			draws_close(d);
			draws_close(e);
		}
	}
}

/* Every aligned block of 2^k points has one point in each of the 2^k intervals, in every dimension. */
static void test_stratified(void **arg)
{
	static const uint64_t start[] = {0, 1u << 20, 1ull << 32, 5ull << 32};
	struct mc_params p = params(MC_SOBOL, 99, 1);
	struct normal_plan plan;

	(void)arg;
	assert_int_equal(draws_plan(&p, &plan), 0);
	for (int i = 0; i < 4 * MC_DIM; i++) {
		for (int k = 1; k <= 13; k++) {
			static uint8_t seen[1 << 13];

			memset(seen, 0, sizeof(seen));
			for (uint32_t j = 0; j < 1u << k; j++) {
				uint32_t x = normal_sobol_bits(&plan, start[i / MC_DIM] + j,
							       (uint32_t)(i % MC_DIM));

				assert_int_equal(seen[x >> (32 - k)]++, 0);
			}
		}
	}
}

/* Pairs of the leading dimensions: 2^(2k) points, one in each square of a 2^k grid for the first pair. */
static void test_pair_stratified(void **arg)
{
	struct mc_params p = params(MC_SOBOL, 7, 1);
	struct normal_plan plan;
	static uint8_t seen[64][64];

	(void)arg;
	assert_int_equal(draws_plan(&p, &plan), 0);
	for (uint32_t j = 0; j < 4096; j++) {
		uint32_t x = normal_sobol_bits(&plan, j, MODEL_EGO_SPEED) >> 26;
		uint32_t y = normal_sobol_bits(&plan, j, MODEL_GRADE) >> 26;

		assert_int_equal(seen[x][y]++, 0);
	}
}

static double moment(const float *z, int power)
{
	double sum = 0.0;

	for (uint32_t i = 0; i < N; i++) {
		double x = (double)z[i], y = x;

		for (int k = 1; k < power; k++) {
			y *= x;
		}
		sum += y;
	}
	return sum / N;
}

static uint32_t beyond(const float *z, float limit)
{
	uint32_t n = 0;

	for (uint32_t i = 0; i < N; i++) {
		n += z[i] > limit;
	}
	return n;
}

/* Bounds: 4.5 standard errors of independent draws, far less for the net, where the figure is a smooth one. */
static void check_normal(const float *z, double smooth)
{
	static const struct {
		float limit;
		double p;
	} tail[] = {{-2.0f, 0.977249868}, {0.0f, 0.5},         {1.0f, 0.158655254},
		    {2.0f, 0.022750132},  {3.0f, 0.001349898}, {3.7190165f, 1e-4}};
	double unit = 4.5 / sqrt(N);

	assert_true(fabs(moment(z, 1)) < unit * smooth);
	assert_true(fabs(moment(z, 2) - 1.0) < unit * sqrt(2.0) * smooth);
	assert_true(fabs(moment(z, 3)) < unit * sqrt(15.0) * smooth);
	assert_true(fabs(moment(z, 4) - 3.0) < unit * sqrt(96.0) * smooth);
	for (int i = 0; i < 6; i++) {
		double se = sqrt(tail[i].p * (1.0 - tail[i].p) * N);
		double off = fabs((double)beyond(z, tail[i].limit) - tail[i].p * N);

		assert_true(off < (smooth < 1.0 ? 2.0 : 4.5 * se));
	}
}

static void test_moments(void **arg)
{
	(void)arg;
	for (int k = 0; k < 2; k++) {
		struct mc_params p = params(kind[k], 2024, N);
		struct draws *d = opened(&p);

		for (int dim = 0; dim < MODEL_INPUTS; dim++) {
			check_normal(row(d, dim), kind[k] == MC_SOBOL ? 0.02 : 1.0);
		}
		draws_close(d);
	}
}

static void test_uncorrelated(void **arg)
{
	(void)arg;
	for (int k = 0; k < 2; k++) {
		struct mc_params p = params(kind[k], 11, N);
		struct draws *d = opened(&p);

		for (int pair = 0; pair < MODEL_INPUTS * MODEL_INPUTS; pair++) {
			const float *a = row(d, pair / MODEL_INPUTS);
			const float *b = row(d, pair % MODEL_INPUTS);
			double sum = 0.0;

			for (uint32_t i = 0; i < N && a != b; i++) {
				sum += (double)a[i] * (double)b[i];
			}
			assert_true(fabs(sum) < 4.5 * sqrt(N) * (kind[k] == MC_SOBOL ? 0.1 : 1.0));
		}
		draws_close(d);
	}
}

static void test_prior(void **arg)
{
	(void)arg;
	for (int k = 0; k < 2; k++) {
		struct mc_params p = params(kind[k], 3, N);
		struct draws *d = opened(&p);
		const float *u = row(d, MC_DIM_PRIOR);

		for (uint32_t i = 0; i < N; i++) {
			float fine = u[i] * 0x1p24f;

			assert_true(u[i] >= 0.0f);
			assert_true(u[i] < 1.0f);
			assert_true(fine == floorf(fine));
		}
		assert_true(fabs(moment(u, 1) - 0.5) < 4.5 / sqrt(12.0 * N));
		assert_true(fabs(moment(u, 2) - 1.0 / 3.0) < 4.5 * sqrt(4.0 / 45.0 / N));
		draws_close(d);
	}
}

/* Variance of a standard normal cut at +-t: 1 - 2 t phi(t) / (1 - 2 Q(t)). */
static void test_truncated(void **arg)
{
	static const double limit[] = {0x1p-7, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 6.25};

	(void)arg;
	for (int i = 0; i < 10; i++) {
		double t = limit[i], phi = exp(-t * t / 2) / sqrt(2 * M_PI);
		double var = 1.0 - 2.0 * t * phi / erf(t / sqrt(2.0));
		struct mc_params p = params(MC_SOBOL, 1, N);
		struct draws *d;
		const float *z;

		p.truncate[MODEL_MU] = (float)t;
		d = opened(&p);
		z = row(d, MODEL_MU);
		assert_int_equal(beyond(z, (float)t), 0);
		assert_true(fabs(moment(z, 1)) < 1e-4 * t);
		assert_true(fabs(moment(z, 2) / var - 1.0) < 1e-3);
		if (t <= 3.0) {
			assert_true(beyond(z, 0.99f * (float)t) > 0);
		}
		check_normal(row(d, MODEL_MASS), 0.02);
		draws_close(d);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_refused),    cmocka_unit_test(test_table),
		cmocka_unit_test(test_pieces),     cmocka_unit_test(test_stride),
		cmocka_unit_test(test_beyond),     cmocka_unit_test(test_seeds),
		cmocka_unit_test(test_stratified), cmocka_unit_test(test_pair_stratified),
		cmocka_unit_test(test_moments),    cmocka_unit_test(test_uncorrelated),
		cmocka_unit_test(test_prior),      cmocka_unit_test(test_truncated),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
