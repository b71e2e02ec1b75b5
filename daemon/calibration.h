/* SPDX-License-Identifier: MIT
 * What `aebmc budget` measured, kept in a file with everything it depends on: device, clocks, CUDA versions. A machine
 * that is not the one measured any more is worth a warning. Knows no backend beyond its description.
 */
#ifndef AEBMC_CALIBRATION_H
#define AEBMC_CALIBRATION_H

#include <stdio.h>
#include "mc_cuda.h"

#define CALIBRATION_MS      400, 530, 800 /* the paper's budget and its alternatives, Sec. VI */
#define CALIBRATION_BUDGETS 3
#define CALIBRATION_KERNELS 2 /* the paper's, the fast one */

struct calibration {
	struct mc_cuda_info device;
	uint32_t samples[CALIBRATION_KERNELS][CALIBRATION_BUDGETS];
};

/** calibration_write - as lines "key = value". Errors stay in ferror(@f). */
void calibration_write(const struct calibration *c, FILE *f);

/**
 * calibration_differs - is @now another device, clock or CUDA version than the file was made with?
 * Returns 0 if not, 1 with one line in @why naming the first difference, or -errno (-EINVAL: not such a file).
 */
int calibration_differs(const char *path, const struct mc_cuda_info *now, char *why, int why_len);

#endif
