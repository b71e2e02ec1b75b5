/* SPDX-License-Identifier: MIT
 * From configuration to an opened Monte Carlo backend: which one, with which draws, how many threads.
 */
#ifndef AEBMC_ENGINE_H
#define AEBMC_ENGINE_H

#include "budget.h"
#include "config.h"
#include "mc.h"
#include "publish.h"

/** engine_params - how the backend of @cfg is opened for @samples an evaluation: its draws in particular. Pure. */
struct mc_params engine_params(const struct config *cfg, config_int samples);

/**
 * engine_open - open the backend that mc.backend names; `auto` takes CUDA where there is a device, else the CPU
 * @how: MC_INLINE on a log (results must not depend on how fast this machine is), a worker when live
 * @which: what it is, for STATUS. Allocates; blocks while draws are made. 0 or -errno, @err says why in one line.
 */
int engine_open(const struct config *cfg, enum mc_worker how, struct mc **ret,
		enum publish_backend *which, char *err, int err_len);

/* How much one evaluation on a backend is, and why. */
struct engine_size {
	uint32_t samples; /* 0: there is no such backend */
	struct budget_cost cost;
};

/* What the live daemon runs on: mc, and the CPU behind it where mc is the GPU. */
struct engine {
	struct mc *mc, *spare; /* spare is NULL where mc is the CPU */
	struct engine_size size, spare_size;
	enum publish_backend which;
	uint32_t faults; /* why it is not what was asked for; 0 if it is */
};

/**
 * engine_open_live - open the CPU and, unless the CPU was asked for, the GPU, each with a worker, and time both
 * The samples of an evaluation are as many as mc.target allows, mc.samples or mc.samples_cuda at most.
 * Without a GPU that was asked for, or with one that fails, mc is the CPU and faults says why; `auto` on a machine without
 * one is no fault. Allocates; blocks. 0 or -errno (-ETIMEDOUT: the CPU does not run decision.samples_min samples
 * within mc.budget); @err is empty or one line, also a warning where 0 is returned.
 */
int engine_open_live(const struct config *cfg, struct engine *ret, char *err, int err_len);

/** engine_fault - the reason (fault.def, as a bit) that an error of the CUDA backend stands for (mc_ops.h). Pure. */
uint32_t engine_fault(int err);

void engine_close(struct engine *e);

#endif
