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

static void none_close(struct mc_backend *b)
{
	(void)b;
}

int mc_cuda_info(struct mc_cuda_info *ret)
{
	(void)ret;
	return -ENOTSUP;
}

int mc_cuda_time(struct mc_backend *b, enum mc_cuda_rung rung, const struct mc_request *req,
		 double dt_s, uint32_t repeats, struct mc_cuda_time *ret)
{
	(void)b;
	(void)rung;
	(void)req;
	(void)dt_s;
	(void)repeats;
	(void)ret;
	return -ENOTSUP;
}

const struct mc_ops mc_cuda_ops = {.name = "cuda", .open = none_open, .close = none_close};
