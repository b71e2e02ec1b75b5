/* SPDX-License-Identifier: MIT
 * Stands in for the CUDA backend where it was not built: the name is known, opening it is refused.
 */
#include "mc_cuda.h"
#include <errno.h>

static int none_open(const struct mc_params *p, struct mc_backend **ret)
{
	(void)p;
	(void)ret;
	return -ENOTSUP;
}

const struct mc_ops mc_cuda_ops = {.name = "cuda", .open = none_open};
