/* SPDX-License-Identifier: MIT
 * How much of a figure's variance one input explains, from the samples of a batch as they are: no further rollout.
 */
#ifndef AEBMC_SENSITIVITY_H
#define AEBMC_SENSITIVITY_H

#include <stdint.h>

#define SENSITIVITY_CLASSES 32

struct sensitivity_pair {
	float x;
	double y;
};

/**
 * sensitivity_share - first-order index Var(E[Y|X]) / Var(Y) of Sobol' (1993), 0..1
 * @pair: @n samples of input and figure; sorted by x afterwards
 * Estimated from given data (Plischke, Borgonovo, Smith, "Global sensitivity measures from given data", Eur. J. Oper. Res.
 * 226 (2013)): variance between 32 classes of equal size, less what chance leaves there; equal values stay in one class, so
 * that an input of few values has as many classes. With correlated inputs it counts what each tells about the others too.
 * 0 where either is constant. No allocation.
 */
double sensitivity_share(struct sensitivity_pair *pair, uint32_t n);

#endif
