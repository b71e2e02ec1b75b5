/* SPDX-License-Identifier: MIT
 * One thread's memory for the lane loops; private to lane_loops.h, lanes.c and lane_pick.c.
 */
#ifndef AEBMC_LANE_BLOCK_H
#define AEBMC_LANE_BLOCK_H

#include "lanes.h"

#define GROUP 16  /* lanes that a late correction runs for */
#define LANES 128 /* lanes a block: the fields that a stage touches stay in the first-level cache */

/* Every field of struct rollout as an array over lanes. */
struct lanes_block {
#define LANES_ARRAY(name) float name[LANES] __attribute__((aligned(64)));
	ROLLOUT_FIELDS(LANES_ARRAY)
#undef LANES_ARRAY
};

struct lanes_work {
	struct lanes_block block;
	uint32_t flags[LANES]; /* MODEL_* of the future at hand */
	uint32_t lifted[LANES];
	uint32_t stop_bin[LANES], need_bin[LANES];
	/* colliding lanes of several blocks and futures, collected for their impact speed */
	struct lanes_block pool;
	uint32_t pool_future[LANES], pool_index[LANES];
	uint32_t pooled;
	float tail[MC_DIM][LANES]; /* the last, incomplete block's draws */
};

#endif
