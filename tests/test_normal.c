/* SPDX-License-Identifier: MIT
 * normal: against 50-digit quantiles, Random123 and another Sobol generator; bits that no machine may change.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "draws.h"
#include "kat.h"

/* The inputs in the order of their Sobol dimensions. */
static const int order[MC_DIM] = {MODEL_EGO_SPEED,  MODEL_GRADE,   MODEL_MU,     MODEL_LEAD_ACCEL,
				  MODEL_LEAD_SPEED, MODEL_HEADWAY, MC_DIM_PRIOR, MODEL_DELAY,
				  MODEL_EGO_ACCEL,  MODEL_TAU,     MODEL_DRAG,   MODEL_MASS};

static struct normal_plan plan(enum mc_draws_kind kind, uint64_t seed, float truncate)
{
	struct mc_params p = {.kind = kind, .seed = seed, .n_resident = 1};
	struct normal_plan ret;

	for (int i = 0; i < MC_DIM; i++) {
		p.truncate[i] = truncate;
	}
	assert_int_equal(draws_plan(&p, &ret), 0);
	return ret;
}

static void test_quantile(void **arg)
{
	FILE *f = kat_open("normal.txt");
	char line[128];
	int n = 0;

	(void)arg;
	while (kat_line(f, line, sizeof(line))) {
		uint32_t x;
		float limit;
		double want, err;
		struct normal_plan p;

		assert_int_equal(sscanf(line, "%x %a %la", &x, &limit, &want), 3);
		p = plan(MC_SOBOL, 0, limit);
		err = fabs((double)normal_from_bits(x, &p.cut[0]) - want);
		if (err > (limit > 0.0f ? 2e-6 : 9e-7)) {
			fail_msg("%08x within %g: off by %g from %g", x, (double)limit, err, want);
		}
		n++;
	}
	assert_int_equal(n, 325);
}

static void test_ends(void **arg)
{
	/* the second one is overshot by a rounding at x = 64 and has to be clamped */
	static const float limit[] = {0x1p-10f, 0x1.2e978ep+0f,  0.5f, 3.0f, 5.5f,
				      6.0f,     NORMAL_MAX_SIGMA};

	(void)arg;
	for (size_t i = 0; i < sizeof(limit) / sizeof(limit[0]); i++) {
		struct normal_plan p = plan(MC_SOBOL, 0, limit[i]);
		float low = normal_from_bits(0, &p.cut[0]);
		float high = normal_from_bits(UINT32_MAX, &p.cut[0]);

		assert_true(low == -high);
		assert_true(high <= limit[i]);
		assert_true(high > 0.98f * limit[i]);
		for (uint32_t x = 0; x < 200; x++) {
			assert_true(-normal_from_bits(x, &p.cut[0]) <= limit[i]);
		}
	}
}

static void test_odd(void **arg)
{
	struct normal_plan p = plan(MC_SOBOL, 0, 0.0f);

	(void)arg;
	for (uint32_t x = 0; x < 0x80000000u - 99991u; x += 99991u) {
		float z = normal_from_bits(x, &p.cut[0]);

		assert_true(z < 0.0f);
		assert_true(normal_from_bits(~x, &p.cut[0]) == -z);
		assert_true(normal_from_bits(x + 99991u, &p.cut[0]) > z);
	}
}

static void test_philox(void **arg)
{
	FILE *f = kat_open("philox.txt");
	char line[128];
	int n = 0;

	(void)arg;
	while (kat_line(f, line, sizeof(line))) {
		uint32_t c[4], k[2], want[4];

		assert_int_equal(sscanf(line, "%x %x %x %x %x %x %x %x %x %x", c, c + 1, c + 2,
					c + 3, k, k + 1, want, want + 1, want + 2, want + 3),
				 10);
		normal_philox(c, k[0], k[1]);
		assert_memory_equal(c, want, sizeof(want));
		n++;
	}
	assert_int_equal(n, 10);
}

static void test_sobol(void **arg)
{
	const struct normal_plan p = plan(MC_SOBOL, 0, 0.0f);
	FILE *f = kat_open("sobol.txt");
	char line[256];
	int n = 0;

	(void)arg;
	while (kat_line(f, line, sizeof(line))) {
		int at, more;
		uint32_t index, want;

		assert_int_equal(sscanf(line, "%u%n", &index, &at), 1);
		for (int i = 0; i < MC_DIM; i++, at += more) {
			assert_int_equal(sscanf(line + at, "%x%n", &want, &more), 1);
			assert_int_equal(normal_sobol(p.dir[order[i]], index), want);
		}
		n++;
	}
	assert_int_equal(n, 57);
}

/* Nested: equal leading bits stay equal, and the first that differs still differs. */
static void test_owen(void **arg)
{
	uint32_t ctr[4] = {0};

	(void)arg;
	for (int i = 0; i < 10000; i++) {
		uint32_t a, b, seed, first;

		normal_philox(ctr, 1, 2);
		a = ctr[0];
		first = 1u << (ctr[1] & 31);
		b = a ^ first ^ (ctr[2] & (first - 1));
		seed = ctr[3];
		a = normal_owen(a, seed);
		b = normal_owen(b, seed);
		assert_true((a ^ b) >= first);
		assert_true((a ^ b) - first < first);
	}
}

/* FNV-1a over the draws of a few blocks, so that a machine or compiler with other bits is noticed. */
static uint64_t hash_draws(const struct normal_plan *p)
{
	uint64_t h = 0xcbf29ce484222325u;

	for (uint64_t index = 0; index < 40000; index++) {
		for (uint32_t group = 0; group < NORMAL_GROUPS; group++) {
			float z[4];

			normal_four(p, index * 429497u, group, z);
			for (int k = 0; k < 4; k++) {
				h = (h ^ det_bits(z[k])) * 0x100000001b3u;
			}
		}
	}
	return h;
}

static void test_bits(void **arg)
{
	const struct normal_plan sobol = plan(MC_SOBOL, 1, 0.0f), philox = plan(MC_PHILOX, 1, 0.0f);
	const struct normal_plan cut = plan(MC_SOBOL, 2, 2.5f);

	(void)arg;
	assert_int_equal(hash_draws(&sobol), 0xe0d5150cbaac57f8u);
	assert_int_equal(hash_draws(&philox), 0x68305cda9ee90184u);
	assert_int_equal(hash_draws(&cut), 0xf50437a0b3937234u);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_quantile), cmocka_unit_test(test_ends),
		cmocka_unit_test(test_odd),      cmocka_unit_test(test_philox),
		cmocka_unit_test(test_sobol),    cmocka_unit_test(test_owen),
		cmocka_unit_test(test_bits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
