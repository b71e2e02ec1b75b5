/* SPDX-License-Identifier: MIT
 * Analysis of variance over classes of one input.
 */
#include <stdlib.h>
#include "sensitivity.h"

#define ROUNDING \
	1e-20 /* variance, relative to the mean squared, that summing up leaves of a constant */

static int by_x(const void *a, const void *b)
{
	const float x = ((const struct sensitivity_pair *)a)->x;
	const float y = ((const struct sensitivity_pair *)b)->x;

	return (x > y) - (x < y);
}

static double mean_y(const struct sensitivity_pair *p, uint32_t n)
{
	double sum = 0;

	for (uint32_t i = 0; i < n; i++) {
		sum += p[i].y;
	}
	return sum / n;
}

/* The end of the class that begins at @from: equal values stay together. */
static uint32_t class_end(const struct sensitivity_pair *p, uint32_t n, uint32_t from)
{
	uint32_t end = from + (n + SENSITIVITY_CLASSES - 1) / SENSITIVITY_CLASSES;

	end = end < n ? end : n;
	while (end < n && p[end].x <= p[end - 1].x) {
		end++;
	}
	return end;
}

double sensitivity_share(struct sensitivity_pair *pair, uint32_t n)
{
	double total = 0, between = 0;
	uint32_t classes = 0;

	qsort(pair, n, sizeof(*pair), by_x);
	const double mean = mean_y(pair, n);

	for (uint32_t i = 0; i < n; i++) {
		total += (pair[i].y - mean) * (pair[i].y - mean);
	}
	for (uint32_t from = 0, to; from < n; from = to, classes++) {
		to = class_end(pair, n, from);
		const double off = mean_y(pair + from, to - from) - mean;

		between += (to - from) * off * off;
	}
	if (!(total > ROUNDING * n * mean * mean) || n <= classes) {
		return 0;
	}
	const double within = (total - between) / (n - classes);
	const double share = (between - (classes - 1) * within) / total;

	return share > 0 ? share : 0;
}
