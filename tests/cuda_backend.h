/* SPDX-License-Identifier: MIT
 * The CUDA backend's host side compiled into a test, on the made-up runtime, with every call open to injection. Include
 * once, after cmocka.h.
 */
#ifndef AEBMC_TESTS_CUDA_BACKEND_H
#define AEBMC_TESTS_CUDA_BACKEND_H

#include <errno.h>
#include <time.h>
#include "cuda_inject.h"

/* Sleeping takes no time here. */
#define nanosleep(a, b) ((void)(a), (void)(b))
#include "../kernels/mc_cuda.c"
#undef nanosleep
#include "../kernels/mc_cuda_roll.c"
#include "../kernels/mc_cuda_setup.c"
#include "../kernels/mc_cuda_time.c"
#include "cuda_fake.h"
#include "gpu/scenes.h"

#define RESIDENT 2048u
#define SPINS    64u /* looks before it sleeps */

static inline struct mc_params params(void)
{
	return (struct mc_params){
		.kind = MC_SOBOL, .seed = 1, .n_resident = RESIDENT, .threads = 1};
}

static inline struct mc_backend *opened(void)
{
	const struct mc_params p = params();
	struct mc_backend *b = NULL;

	assert_int_equal(mc_cuda_ops.open(&p, &b), 0);
	assert_non_null(b);
	b->spins = SPINS;
	return b;
}

static inline void closed(struct mc_backend *b)
{
	mc_cuda_ops.close(b);
	assert_int_equal(fake.live, 0);
}

static inline int reset(void **state)
{
	(void)state;
	fake.late = 0;
	fake.queued = 0;
	fake.spoil = NULL;
	fake.device_count = 1;
	inject.site = -1;
	return 0;
}

#endif
