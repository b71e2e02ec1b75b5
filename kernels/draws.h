/* SPDX-License-Identifier: MIT
 * The resident table of standard normal draws: made once at open from (seed, index, dimension), the same bits on any
 * machine, so that every cycle sees the same draws and the risk is a smooth function of the scene.
 */
#ifndef AEBMC_DRAWS_H
#define AEBMC_DRAWS_H

#include "normal.h"

struct draws;

/**
 * draws_plan - what the draws depend on, ready for normal_four() on host or device
 * Reads kind, seed and truncate of @p. -EINVAL for an unknown kind, n_resident outside 1..2^24, or a truncation that is
 * not 0 or within 6.3 sigma; @ret untouched then. Pure.
 */
int draws_plan(const struct mc_params *p, struct normal_plan *ret);

/**
 * draws_open - make and keep n_resident draws of MC_DIM dimensions
 * Reads kind, seed, n_resident and truncate of @p. Allocates (64-byte aligned). -EINVAL as draws_plan(), -ENOMEM.
 */
int draws_open(const struct mc_params *p, struct draws **ret);

/** draws_table - [MC_DIM][stride] f32; rows are 64-byte aligned. Dimension MC_DIM_PRIOR holds a uniform in [0,1). */
const float *draws_table(const struct draws *d, uint32_t *stride);

/** draws_fill - the same numbers for indices first..first+count-1, into @z [MC_DIM][stride]. No allocation. */
void draws_fill(const struct draws *d, uint64_t first, uint32_t count, float *z, uint32_t stride);

/**
 * draws_intact - is one slice of the table, the @turn-th in a ring, what was made at open?
 * 64 KiB each, so that a look at one slice a batch goes round a table of 16,384 draws every 13 batches for a few
 * microseconds each. 1 or 0. No allocation.
 */
int draws_intact(const struct draws *d, uint64_t turn);

void draws_close(struct draws *d);

#endif
