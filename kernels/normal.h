/* SPDX-License-Identifier: MIT
 * From a sample's index to its draws: 32 bits by scrambled Sobol or Philox, then a tail probability, then a standard
 * normal. Any index at any time, no state; host and device, same bits. Knows no requests and no memory.
 */
#ifndef AEBMC_NORMAL_H
#define AEBMC_NORMAL_H

#include "mc.h"

#define NORMAL_GROUPS (MC_DIM / 4) /* draws are made four dimensions at a time */

/* A normal cut at +-limit: tail probability beyond it, and what is left between the cuts. */
struct normal_cut {
	float tail;  /* 0 .. 0.5 */
	float scale; /* 1 - 2 tail */
	float limit; /* [sigma] */
};

/* Everything a draw depends on; made by draws_plan(). Plain data: a kernel takes it by value. */
struct normal_plan {
	uint32_t kind;   /* enum mc_draws_kind */
	uint32_t key[2]; /* Philox key: the seed */
	struct normal_cut cut[MC_DIM];
	uint32_t dir[MC_DIM][32]; /* Sobol direction numbers, one for each bit of the index */
	uint32_t owen[MC_DIM];    /* seed of the Owen scramble */
	uint32_t shift[MC_DIM];   /* digital shift */
};

/* The tail numbers below are odd multiples of 2^-33, never 0: the farthest normal is 6.34 sigma away. */
#define NORMAL_MAX_SIGMA 6.3f

/**
 * normal_quantile - how far out the tail probability @p lies
 * @p: tail probability                                [2^-33, 0.5]
 * @q: 0.5 - p, given apart: neither is good to f32 where the other is small
 * Split and inner rational of Wichura, "Algorithm AS 241", Appl. Statist. 37 (1988), PPND7. The outer one is minimax
 * on what sqrt(-2 log p) is too large by, which keeps rounding small. Absolute error below 9e-7. Returns z >= 0.
 */
HD float normal_quantile(float p, float q)
{
	int mid = q <= 0.425f ? 1 : 0;
	float c = 0.180625f - q * q;
	float r = det_sqrtf(-det_logf(p));
	float d = r - 1.6f;
	float mid_num =
		((59.109374720f * c + 159.29113202f) * c + 50.434271938f) * c + 3.3871327179f;
	float mid_den = ((67.187563600f * c + 78.757757664f) * c + 17.895169469f) * c + 1.0f;
	float far_num = ((2.2306925e-4f * d - 7.3221567e-3f) * d - 0.32105058f) * d - 0.83930413f;
	float far_den = (0.11829169f * d + 0.73223924f) * d + 1.0f;
	float v = (mid ? q * mid_num : far_num) / (mid ? mid_den : far_den);

	return mid ? v : det_fmaf(1.41421356f, r, v);
}

/** normal_from_bits - 32 uniform bits as a standard normal within @cut; rises with @x. */
HD float normal_from_bits(uint32_t x, const struct normal_cut *cut)
{
	uint32_t t = 2u * (x ^ (0u - (x >> 31))) + 1u; /* tail probability in units of 2^-33 */
	float p = (float)t * 0x1p-33f * cut->scale + cut->tail;
	float q = (float)(0u - t) * 0x1p-33f * cut->scale;
	float z = normal_quantile(p, q);

	z = z < cut->limit ? z : cut->limit;
	return x >> 31 ? z : -z;
}

/** normal_uniform - 32 uniform bits as a uniform in [0,1), 24 bits. */
HD float normal_uniform(uint32_t x)
{
	return (float)(x >> 8) * 0x1p-24f;
}

/**
 * normal_philox - Philox4x32-10
 * Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC'11. @ctr becomes the result.
 */
HD void normal_philox(uint32_t ctr[4], uint32_t k0, uint32_t k1)
{
	for (int round = 0; round < 10; round++) {
		uint64_t a = (uint64_t)0xd2511f53u * ctr[0];
		uint64_t b = (uint64_t)0xcd9e8d57u * ctr[2];

		ctr[0] = (uint32_t)(b >> 32) ^ ctr[1] ^ k0;
		ctr[2] = (uint32_t)(a >> 32) ^ ctr[3] ^ k1;
		ctr[1] = (uint32_t)b;
		ctr[3] = (uint32_t)a;
		k0 += 0x9e3779b9u;
		k1 += 0xbb67ae85u;
	}
}

/** normal_sobol - point @index (natural order) of the Sobol sequence with direction numbers @dir. */
HD uint32_t normal_sobol(const uint32_t dir[32], uint32_t index)
{
	uint32_t x = 0;

	for (int bit = 0; index; bit++, index >>= 1) {
		x ^= dir[bit] & (0u - (index & 1u));
	}
	return x;
}

/* normal_reverse - bit 31 becomes bit 0 and so on. */
HD uint32_t normal_reverse(uint32_t x)
{
	x = (x >> 16) | (x << 16);
	x = ((x & 0xff00ff00u) >> 8) | ((x & 0x00ff00ffu) << 8);
	x = ((x & 0xf0f0f0f0u) >> 4) | ((x & 0x0f0f0f0fu) << 4);
	x = ((x & 0xccccccccu) >> 2) | ((x & 0x33333333u) << 2);
	return ((x & 0xaaaaaaaau) >> 1) | ((x & 0x55555555u) << 1);
}

/**
 * normal_owen - Owen scrambling by a hash: every bit is flipped by a function of the bits above it
 * Laine, Karras, "Stratified sampling for stochastic transparency", CGF 30 (2011); Burley, "Practical hash-based
 * Owen scrambling", JCGT 9 (2020), listing 3.
 */
HD uint32_t normal_owen(uint32_t x, uint32_t seed)
{
	x = normal_reverse(x) + seed;
	x ^= x * 0x6c50b47cu;
	x ^= x * 0xb82f1e52u;
	x ^= x * 0xc7afe638u;
	x ^= x * 0x8d22f6e6u;
	return normal_reverse(x);
}

/* normal_sobol_bits - the sequence has 2^32 points; what lies beyond is the same sequence scrambled anew. */
HD uint32_t normal_sobol_bits(const struct normal_plan *p, uint64_t index, uint32_t dim)
{
	uint32_t again = (uint32_t)(index >> 32) * 0x9e3779b9u;
	uint32_t x = normal_sobol(p->dir[dim], (uint32_t)index);

	return normal_owen(x, p->owen[dim] + again) ^ p->shift[dim] ^ again;
}

/**
 * normal_four - draws 4*group .. 4*group+3 of sample @index
 * Standard normals, cut as the plan says; dimension MC_DIM_PRIOR is a uniform in [0,1).
 */
HD void normal_four(const struct normal_plan *p, uint64_t index, uint32_t group, float z[4])
{
	uint32_t x[4] = {(uint32_t)index, (uint32_t)(index >> 32), group, 0};

	if (p->kind == MC_PHILOX) {
		normal_philox(x, p->key[0], p->key[1]);
	} else {
		for (uint32_t k = 0; k < 4; k++) {
			x[k] = normal_sobol_bits(p, index, 4 * group + k);
		}
	}
	for (uint32_t k = 0; k < 4; k++) {
		uint32_t dim = 4 * group + k;

		z[k] = dim == MC_DIM_PRIOR ? normal_uniform(x[k])
					   : normal_from_bits(x[k], &p->cut[dim]);
	}
}

#endif
