/* SPDX-License-Identifier: MIT
 * What one sample adds to a batch's integer statistics. Host and device, same bits; sums are stats.h's business.
 */
#ifndef AEBMC_TALLY_H
#define AEBMC_TALLY_H

#include "mc.h"

#define TALLY_UNIT_PER_M 1024.0f /* distances in 2^-10 m, speeds in 2^-10 m/s */
#define TALLY_BIN_SHIFT  7       /* 0.125 m a bin */
#define TALLY_MAX_M      1023.9f
#define TALLY_NEED_OFF_M 128.0f /* MC_HIST_NEED_OFF */

/** tally_units - @x [m or m/s], held within 0..1023.9, as an integer of 2^-10. */
HD int32_t tally_units(float x)
{
	const float held = det_minf(det_maxf(x, 0.0f), TALLY_MAX_M);

	return (int32_t)(held * TALLY_UNIT_PER_M + 0.5f);
}

/** tally_contact - 1 if a sample counts as contact: it is one, or rolls at the horizon and the request says so. */
HD uint32_t tally_contact(uint32_t out_flags, uint32_t req_flags)
{
	const uint32_t rolling = req_flags & MC_ROLLING_IS_CONTACT ? MODEL_ROLLING : 0u;

	return (out_flags & (MODEL_CONTACT | rolling)) != 0u ? 1u : 0u;
}

/** tally_undecided - 1 if a sample is undecided and does not count as contact. */
HD uint32_t tally_undecided(uint32_t out_flags, uint32_t req_flags)
{
	return (out_flags & MODEL_UNDECIDED) != 0u ? 1u - tally_contact(out_flags, req_flags) : 0u;
}

/** tally_stop_bin - bin of the stopping distance; rolling samples in the last one. */
HD uint32_t tally_stop_bin(float stop_m, uint32_t out_flags)
{
	const uint32_t bin = (uint32_t)(tally_units(stop_m) >> TALLY_BIN_SHIFT);

	return (out_flags & MODEL_ROLLING) != 0u ? MC_HIST_BINS - 1u : bin;
}

/**
 * tally_need_bin - bin of the mean headway at which the sample just touches
 * @shift_m: the sample's headway less the mean headway [m]
 * A sample that counts as contact because it rolls does so at any headway: last bin.
 */
HD uint32_t tally_need_bin(float need_m, float shift_m, uint32_t out_flags, uint32_t req_flags)
{
	const float at = need_m - shift_m + TALLY_NEED_OFF_M;
	const uint32_t bin = (uint32_t)(tally_units(at) >> TALLY_BIN_SHIFT);
	const uint32_t rolling = req_flags & MC_ROLLING_IS_CONTACT ? MODEL_ROLLING : 0u;

	return (out_flags & rolling) != 0u ? MC_HIST_BINS - 1u : bin;
}

#endif
