/* SPDX-License-Identifier: MIT
 * Arithmetic with the same bits on x86-64, aarch64 and every GPU: built from + - * / sqrt fma and integer operations
 * on bit patterns alone. Every translation unit is compiled without contraction (-ffp-contract=off, --fmad=false):
 * a fused operation happens only where the source says det_fmaf. Selections are written with ?: so that compilers
 * vectorise loops over these functions.
 */
#ifndef AEBMC_DETMATH_H
#define AEBMC_DETMATH_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifdef __CUDACC__
#define HD static __inline__ __host__ __device__
#else
#define HD static inline __attribute__((always_inline))
#endif

/** det_fmaf - a * b + c, rounded once. */
HD float det_fmaf(float a, float b, float c)
{
	return fmaf(a, b, c);
}

/** det_sqrtf - correctly rounded square root; NaN below zero. */
HD float det_sqrtf(float x)
{
	return sqrtf(x);
}

/** det_minf, det_maxf - a where a < b (a > b), else b: with a NaN in a, b. */
HD float det_minf(float a, float b)
{
	return a < b ? a : b;
}

HD float det_maxf(float a, float b)
{
	return a > b ? a : b;
}

/** det_bits, det_float - the bit pattern of a float, and back. */
HD uint32_t det_bits(float x)
{
	uint32_t u;

	memcpy(&u, &x, sizeof(u));
	return u;
}

HD float det_float(uint32_t u)
{
	float x;

	memcpy(&x, &u, sizeof(x));
	return x;
}

/**
 * det_expf - e^x
 * @x: -87 .. 88; the caller clamps, outside the result is meaningless (but harmless).
 * det_expf(0) == 1; relative error below 3.1e-7, for |x| <= 28 below 1.5e-7.
 */
HD float det_expf(float x)
{
	const float magic =
		12582912.0f; /* 1.5 * 2^23: adding it rounds to an integer kept in the low bits */
	float t = det_fmaf(x, 1.44269504f, magic);
	float r = det_fmaf(t - magic, -0.693147181f, x);
	float p = 1.38253566e-3f;

	p = det_fmaf(p, r, 8.36641334e-3f);
	p = det_fmaf(p, r, 4.16680359e-2f);
	p = det_fmaf(p, r, 1.66665452e-1f);
	p = det_fmaf(p, r, 0.499999959f);
	p = det_fmaf(p, r, 1.0f);
	p = det_fmaf(p, r, 1.0f);
	return det_float(det_bits(p) + (det_bits(t) << 23));
}

/**
 * det_logf - natural logarithm
 * @x: a positive normal number, 1.2e-38 .. 3.4e38; the caller clamps.
 * det_logf(1) == 0; relative error below 1e-7.
 */
HD float det_logf(float x)
{
	uint32_t u = det_bits(x) -
		     0x3f3504f3u; /* sqrt(1/2): the mantissa kept lies in [sqrt(1/2), sqrt(2)) */
	float e = (float)((int32_t)u >> 23);
	float f = det_float((u & 0x7fffffu) + 0x3f3504f3u) - 1.0f;
	float f2 = f * f;
	float p = -7.63449399e-2f;

	p = det_fmaf(p, f, 1.27615745e-1f);
	p = det_fmaf(p, f, -1.31601822e-1f);
	p = det_fmaf(p, f, 1.42017584e-1f);
	p = det_fmaf(p, f, -1.66233574e-1f);
	p = det_fmaf(p, f, 2.00012269e-1f);
	p = det_fmaf(p, f, -2.50008210e-1f);
	p = det_fmaf(p, f, 3.33333317e-1f);
	p = det_fmaf(p * f, f2, -0.5f * f2);
	return det_fmaf(e, 0.693147181f, f + p);
}

/** det_sinf - sine of |x| <= 0.5; odd, relative error below 1e-7. */
HD float det_sinf(float x)
{
	float u = x * x;
	float p = det_fmaf(u, -1.98412698e-4f, 8.33333333e-3f);

	p = det_fmaf(p, u, -0.166666667f);
	return det_fmaf(p * u, x, x);
}

/** det_sin - f64 sine of |x| <= 0.5 to rounding; no fused operation (the reference rollout has none). */
HD double det_sin(double x)
{
	double u = x * x;
	double p = -1.0 / 1307674368000.0;

	p = p * u + 1.0 / 6227020800.0;
	p = p * u - 1.0 / 39916800.0;
	p = p * u + 1.0 / 362880.0;
	p = p * u - 1.0 / 5040.0;
	p = p * u + 1.0 / 120.0;
	p = p * u - 1.0 / 6.0;
	return x + x * u * p;
}

#endif
