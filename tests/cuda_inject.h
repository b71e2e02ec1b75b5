/* SPDX-License-Identifier: MIT
 * Makes any row of cuda_calls.def fail: put before the backend's sources. Counts how often every row was reached and
 * how often it was made to fail. Works with the real runtime and with cuda_fake.h.
 */
#ifndef AEBMC_TESTS_CUDA_INJECT_H
#define AEBMC_TESTS_CUDA_INJECT_H

#include <cuda_runtime_api.h>
#include <string.h>

/* A row that gives something back does so all the same, and then reports the error. */
#define CUDA_CALL(site, call)                                                                 \
	(!inject_now(CUDA_SITE_##site)       ? cuda_calls_errno(call)                         \
	 : inject_releases(CUDA_SITE_##site) ? ((void)(call), cuda_calls_errno(inject.error)) \
					     : cuda_calls_errno(inject.error))

static int inject_releases(int site);
static int inject_now(int site);

#include "cuda_calls.h"

static struct {
	int site, after; /* fail this row, at its after-th call from now (0: the next) */
	cudaError_t error;
	unsigned int reached[CUDA_SITES], failed[CUDA_SITES];
} inject = {.site = -1};

static const struct inject_row {
	const char *name, *function, *phase;
} inject_table[CUDA_SITES] = {
#define CUDA_SITE(name, function, phase) [CUDA_SITE_##name] = {#name, #function, #phase},
#include "cuda_calls.def"
#undef CUDA_SITE
};

static int inject_now(int site)
{
	inject.reached[site]++;
	if (site != inject.site || inject.after-- > 0) {
		return 0;
	}
	inject.site = -1;
	inject.failed[site]++;
	return 1;
}

static int inject_releases(int site)
{
	const char *f = inject_table[site].function;

	return strstr(f, "Free") || strstr(f, "Destroy") || strstr(f, "Unregister");
}

#endif
