/* SPDX-License-Identifier: MIT
 * Plain figures in ascending order, for medians and percentiles.
 */
#ifndef AEBMC_SORT_H
#define AEBMC_SORT_H

#include <stdint.h>
#include <stdlib.h>

static inline int sort_by_double(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static inline int sort_by_int64(const void *a, const void *b)
{
	const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

	return (x > y) - (x < y);
}

/** sort_doubles - put @v[@n] in ascending order; no NaN among them. May allocate (qsort). */
static inline void sort_doubles(double *v, size_t n)
{
	qsort(v, n, sizeof(*v), sort_by_double);
}

/** sort_times - the same for whole nanoseconds. */
static inline void sort_times(int64_t *ns, size_t n)
{
	qsort(ns, n, sizeof(*ns), sort_by_int64);
}

#endif
