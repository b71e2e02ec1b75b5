/* SPDX-License-Identifier: MIT
 * The risk against the headway. See risk_curve.h.
 */
#include "risk_curve.h"
#include "stats.h"

#define ZERO ((int)(MC_HIST_NEED_OFF / MC_HIST_BIN_M)) /* bin of headway 0 */

static struct risk_row row_at(const uint64_t *need, uint64_t n, int bin)
{
	struct risk_row r = {.headway_m = bin * MC_HIST_BIN_M - MC_HIST_NEED_OFF};
	uint64_t hits = 0;

	for (int i = bin; i < MC_HIST_BINS; i++) {
		hits += need[i];
	}
	stats_wilson(hits, n, &r.lo, &r.hi);
	r.bound = hits == 0;
	r.p = (double)hits / (double)n;
	return r;
}

/* Bins between which something happens. */
static void span(const uint64_t *need, uint64_t n, int *first, int *last)
{
	uint64_t below = 0;
	int i = 0;

	while (i < MC_HIST_BINS - 1 && (below + need[i]) * 1000 < n) {
		below += need[i++];
	}
	*first = i > ZERO ? i : ZERO;
	for (i = MC_HIST_BINS - 1; i > *first && !need[i - 1];) {
		i--;
	}
	*last = i;
}

/* The smallest round step, in bins, with at most @rows rows. */
static int step_for(int bins, int rows)
{
	static const int steps[] = {1, 2, 4, 8, 16, 40, 80, 160, 400, 800};
	size_t i = 0;

	while (i + 1 < sizeof(steps) / sizeof(steps[0]) && bins / steps[i] + 2 > rows) {
		i++;
	}
	return steps[i];
}

int risk_curve(const uint64_t *need, uint64_t n, int most, struct risk_row row[])
{
	int first, last, rows = 0;

	span(need, n, &first, &last);
	const int step = step_for(last - first, most);

	first = ZERO + (first - ZERO) / step * step; /* round headways */
	for (int bin = first; bin < last + step && bin < MC_HIST_BINS && rows < most; bin += step) {
		row[rows++] = row_at(need, n, bin);
	}
	return rows;
}

static uint64_t metre(const uint64_t *stop, int i)
{
	uint64_t sum = 0;

	for (int k = i * STOP_BINS; k < (i + 1) * STOP_BINS && k < MC_HIST_BINS - 1; k++) {
		sum += stop[k];
	}
	return sum;
}

void stop_counts(const uint64_t *stop, struct stop_counts *ret)
{
	int first = 0, end = STOP_METRES;

	while (first < STOP_METRES - 1 && !metre(stop, first)) {
		first++;
	}
	while (end > first && !metre(stop, end - 1)) {
		end--;
	}
	ret->first_m = first;
	ret->n = end - first;
	for (int i = first; i < end; i++) {
		ret->count[i - first] = metre(stop, i);
	}
}
