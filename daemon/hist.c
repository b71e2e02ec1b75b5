/* SPDX-License-Identifier: MIT
 * Durations in log-linear buckets. See hist.h.
 */
#include "hist.h"

/* The only writer's own words need no atomic add; readers see each whole. */
static void put(uint64_t *word, uint64_t v)
{
	__atomic_store_n(word, v, __ATOMIC_RELAXED);
}

static uint64_t get(const uint64_t *word)
{
	return __atomic_load_n(word, __ATOMIC_RELAXED);
}

int hist_bucket(int64_t ns)
{
	int octave, sub;

	if (ns < 1 << HIST_SHIFT) {
		return 0;
	}
	octave = 63 - __builtin_clzll((uint64_t)ns) - HIST_SHIFT;
	if (octave >= HIST_OCTAVES) {
		return HIST_BUCKETS - 1;
	}
	sub = (int)((uint64_t)ns * HIST_SUB >> (octave + HIST_SHIFT)) & (HIST_SUB - 1);
	return 1 + octave * HIST_SUB + sub;
}

int64_t hist_end_ns(int b)
{
	if (b >= HIST_BUCKETS - 1) {
		return INT64_MAX;
	}
	return (int64_t)(HIST_SUB + b % HIST_SUB) << (b / HIST_SUB + HIST_SHIFT) >> 4;
}

void hist_add(struct hist *h, int64_t ns)
{
	uint64_t *const b = &h->bucket[hist_bucket(ns)];

	put(b, *b + 1);
	if (ns > h->max_ns) {
		__atomic_store_n(&h->max_ns, ns, __ATOMIC_RELAXED);
	}
	put(&h->n, h->n + 1);
}

uint64_t hist_rank(uint64_t n, double q)
{
	const double at = q * (double)n;
	uint64_t rank = (uint64_t)at;

	rank += (double)rank < at;
	return rank < 1 && n ? 1 : rank > n ? n : rank;
}

int64_t hist_percentile(const struct hist *h, double q)
{
	const uint64_t rank = hist_rank(hist_count(h), q);
	const int64_t max_ns = hist_max_ns(h);
	uint64_t seen = 0;

	for (int b = 0; b < HIST_BUCKETS && rank; b++) {
		seen += get(&h->bucket[b]);
		if (seen >= rank) {
			return hist_end_ns(b) < max_ns ? hist_end_ns(b) : max_ns;
		}
	}
	return rank ? max_ns : -1;
}

uint64_t hist_count(const struct hist *h)
{
	return get(&h->n);
}

int64_t hist_max_ns(const struct hist *h)
{
	return __atomic_load_n(&h->max_ns, __ATOMIC_RELAXED);
}
