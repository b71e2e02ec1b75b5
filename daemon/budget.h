/* SPDX-License-Identifier: MIT
 * Measured cost per sample to batch size: N is a power of two, chosen once at start, fixed while the daemon runs.
 */
#ifndef AEBMC_BUDGET_H
#define AEBMC_BUDGET_H

#include "mc.h"

#define BUDGET_SAMPLES_MIN 256u

/* What a batch of n samples takes: overhead_ns + n * sample_ns. */
struct budget_cost {
	double sample_ns;   /* one sample with all futures, > 0 */
	double overhead_ns; /* >= 0 */
};

/**
 * budget_measure - the cost of batches like @like on an open backend with a worker
 * @target_ns: measured from BUDGET_SAMPLES_MIN upwards until a batch takes as long, or has @max samples
 * @limit_ns:  a batch that takes longer has failed
 * The shortest of a few batches counts: what else the machine does meanwhile is not the backend's cost. All carry id 1.
 * Blocks for about 12 @target_ns at most, or @limit_ns. 0, -ETIMEDOUT, or -errno of the backend; @ret untouched then.
 */
int budget_measure(struct mc *mc, const struct mc_request *like, int64_t target_ns,
		   int64_t limit_ns, uint32_t max, struct budget_cost *ret);

/**
 * budget_samples - largest power of two that fits
 * @target_ns: aim; @ceiling_ns: hard bound (530 ms); both > 0
 * @min:       fewer are no evidence: at least so many, and at least BUDGET_SAMPLES_MIN, whatever the target
 * @max:       configured N (the choice never exceeds it)
 * Returns N, or 0 if no power of two in [min, max] fits the ceiling. Pure.
 */
uint32_t budget_samples(const struct budget_cost *cost, int64_t target_ns, int64_t ceiling_ns,
			uint32_t min, uint32_t max);

#endif
