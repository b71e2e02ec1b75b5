/* SPDX-License-Identifier: MIT
 * detmath: accuracy against libm in f64, and bits that no machine may change.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "detmath.h"

#define STEPS 400000

/* Of all results below, on x86-64 and aarch64. */
#define EXP_BITS 0xb0b845dedda4f70du
#define LOG_BITS 0xec28a0a0a163721fu
#define SIN_BITS 0xacf3de7a6e17a667u

/* FNV-1a over bit patterns. */
static uint64_t mix(uint64_t h, uint32_t bits)
{
	return (h ^ bits) * 0x100000001b3u;
}

static double worst(double lo, double hi, float (*f)(float), double (*exact)(double),
		    uint64_t *hash)
{
	double most = 0.0;

	for (int i = 0; i <= STEPS; i++) {
		const float x = (float)(lo + (hi - lo) * i / STEPS);
		const float y = f(x);
		const double want = exact((double)x);
		const double err = fabs((double)y - want) / fmax(fabs(want), 1e-30);

		*hash = mix(*hash, det_bits(y));
		most = err > most ? err : most;
	}
	return most;
}

static float expf_of(float x)
{
	return det_expf(x);
}

static float logf_of(float x)
{
	return det_logf(x);
}

static float sinf_of(float x)
{
	return det_sinf(x);
}

static void test_exp(void **arg)
{
	uint64_t h = 0xcbf29ce484222325u;

	(void)arg;
	assert_true(det_expf(0.0f) == 1.0f);
	assert_true(worst(-28.0, 28.0, expf_of, exp, &h) < 1.5e-7);
	assert_true(worst(-87.0, 88.0, expf_of, exp, &h) < 3.1e-7);
	assert_true(h == EXP_BITS);
}

static void test_log(void **arg)
{
	uint64_t h = 0xcbf29ce484222325u;

	(void)arg;
	assert_true(det_logf(1.0f) == 0.0f);
	assert_true(worst(0.4, 2.5, logf_of, log, &h) < 1e-7);
	assert_true(worst(1.2e-38, 1e-3, logf_of, log, &h) < 1e-7);
	assert_true(worst(1e3, 3.4e38, logf_of, log, &h) < 1e-7);
	assert_true(h == LOG_BITS);
}

static void test_sin(void **arg)
{
	uint64_t h = 0xcbf29ce484222325u;

	(void)arg;
	assert_true(det_sinf(0.0f) == 0.0f);
	assert_true(worst(-0.5, 0.5, sinf_of, sin, &h) < 1e-7);
	assert_true(h == SIN_BITS);
	for (int i = -500; i <= 500; i++) {
		assert_true(fabs(det_sin(i * 1e-3) - sin(i * 1e-3)) < 1.2e-16);
		assert_true(det_sin(-i * 1e-3) == -det_sin(i * 1e-3));
	}
}

static void test_bits(void **arg)
{
	(void)arg;
	assert_int_equal(det_bits(1.0f), 0x3f800000);
	assert_true(det_float(0x40490fdb) == 3.14159274f);
	assert_true(det_minf(1.0f, 2.0f) == 1.0f && det_minf(2.0f, 1.0f) == 1.0f);
	assert_true(det_maxf(1.0f, 2.0f) == 2.0f && det_maxf(2.0f, 1.0f) == 2.0f);
	assert_true(det_maxf(NAN, 3.0f) == 3.0f && det_minf(NAN, 3.0f) == 3.0f);
	/* rounded once: the product alone would round to 1 */
	assert_true(det_fmaf(1.0f + 0x1p-12f, 1.0f - 0x1p-12f, -1.0f) == -0x1p-24f);
	assert_true(det_sqrtf(2.0f) == 0x1.6a09e6p+0f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_exp),
		cmocka_unit_test(test_log),
		cmocka_unit_test(test_sin),
		cmocka_unit_test(test_bits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
