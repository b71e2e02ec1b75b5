/* SPDX-License-Identifier: MIT
 * Every call of the CUDA runtime goes through CUDA_CALL with a row of cuda_calls.def, so that a test can make each of
 * them fail, and comes back as 0 or -errno.
 */
#ifndef AEBMC_CUDA_CALLS_H
#define AEBMC_CUDA_CALLS_H

#include <cuda_runtime_api.h>

enum cuda_site {
#define CUDA_SITE(name, function, phase) CUDA_SITE_##name,
#include "cuda_calls.def"
#undef CUDA_SITE
	CUDA_SITES
};

/**
 * cuda_calls_errno - a CUDA error as the -errno that mc_ops documents
 * cudaSuccess is 0; cudaErrorNotReady is -EAGAIN; what has no meaning of its own is -EIO. Pure.
 */
int cuda_calls_errno(cudaError_t err);

/* A test that includes the caller's source puts its own macro here first. */
#ifndef CUDA_CALL
#define CUDA_CALL(site, call) ((void)CUDA_SITE_##site, cuda_calls_errno(call))
#endif

#endif
