/* SPDX-License-Identifier: MIT
 * Measured cost per sample to batch size: N is a power of two, chosen once at start, fixed while the daemon runs.
 */
#ifndef AEBMC_BUDGET_H
#define AEBMC_BUDGET_H

#include <stdint.h>

#define BUDGET_SAMPLES_MIN 256u /* fewer are no evidence */

/**
 * budget_samples - largest power of two that fits
 * @ns_per_sample: measured cost of one sample with all futures, > 0
 * @overhead_ns:   fixed cost of a batch, >= 0
 * @target_ns:     aim; @ceiling_ns: hard bound (530 ms); both > 0
 * @max:           configured N (the choice never exceeds it)
 * Returns N in [BUDGET_SAMPLES_MIN, max]; 0 if not even the minimum fits the ceiling. Pure.
 */
uint32_t budget_samples(double ns_per_sample, double overhead_ns, int64_t target_ns,
			int64_t ceiling_ns, uint32_t max);

#endif
