/* SPDX-License-Identifier: MIT
 * From configuration to an opened Monte Carlo backend: which one, with which draws, how many threads.
 */
#ifndef AEBMC_ENGINE_H
#define AEBMC_ENGINE_H

#include "config.h"
#include "mc.h"
#include "publish.h"

/**
 * engine_open - open the backend that mc.backend names; `auto` takes CUDA where there is a device, else the CPU
 * @how: MC_INLINE on a log (results must not depend on how fast this machine is), a worker when live
 * @which: what it is, for STATUS. Allocates; blocks while draws are made. 0 or -errno, @err says why in one line.
 */
int engine_open(const struct config *cfg, enum mc_worker how, struct mc **ret,
		enum publish_backend *which, char *err, int err_len);

#endif
