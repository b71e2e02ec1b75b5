/* SPDX-License-Identifier: MIT
 * Reproducible noise for made-up drives: Philox numbers one after the other, the same on any machine.
 */
#ifndef AEBMC_NOISE_H
#define AEBMC_NOISE_H

#include "normal.h"

/* Which stream, and how many numbers have been taken from it. */
struct noise {
	uint64_t seed, n;
};

static inline uint32_t noise_bits(struct noise *r)
{
	uint32_t ctr[4] = {(uint32_t)r->n, (uint32_t)(r->n >> 32), 0, 0};

	r->n++;
	normal_philox(ctr, (uint32_t)r->seed, (uint32_t)(r->seed >> 32));
	return ctr[0];
}

/** noise_uniform - in [0, 1). */
static inline double noise_uniform(struct noise *r)
{
	return (double)normal_uniform(noise_bits(r));
}

/** noise_normal - standard normal. */
static inline double noise_normal(struct noise *r)
{
	const struct normal_cut none = {.scale = 1, .limit = NORMAL_MAX_SIGMA + 1};

	return (double)normal_from_bits(noise_bits(r), &none);
}

#endif
