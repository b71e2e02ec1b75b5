/* SPDX-License-Identifier: MIT
 * The lane loops: each stage of rollout.h, the draws and the counts as a loop over the lanes of a block, which the
 * compiler vectorises (tests/vectorised.sh asks it). For lanes.c alone.
 */
#ifndef AEBMC_LANE_LOOPS_H
#define AEBMC_LANE_LOOPS_H

#include "lane_block.h"
#include "tally.h"
#include <stddef.h>

_Static_assert(offsetof(struct lanes_block, delay) == MODEL_DELAY * LANES * sizeof(float),
	       "the first fields are the inputs in their order");

/* A function with a lane loop. Inlined, it would lose what restrict says. */
#define LANE_LOOP static __attribute__((noinline))

#define LOAD(name)  r.name = b->name[i];
#define STORE(name) b->name[i] = r.name;

/* Fields that a stage leaves alone are loaded and stored for nothing; the compiler drops both. */
#define LANES_DO(name, count, call)                                              \
	LANE_LOOP void name(struct lanes_block *restrict b,                      \
			    const struct rollout_plan *restrict plan, int first) \
	{                                                                        \
		const struct rollout_plan p = *plan;                             \
		for (int i = first; i < first + (count); i++) {                  \
			struct rollout r;                                        \
			ROLLOUT_FIELDS(LOAD)                                     \
			call;                                                    \
			ROLLOUT_FIELDS(STORE)                                    \
		}                                                                \
		(void)p;                                                         \
	}
#define LANE_STAGE(stage, call) LANES_DO(lane_##stage, LANES, call)
#define LANE_GROUP(stage, call) LANES_DO(group_##stage, GROUP, call)

LANE_STAGE(scene, rollout_scene(&r, &p))
LANE_STAGE(coast, rollout_coast(&r, &p))
LANE_STAGE(unbraked, rollout_unbraked(&r))
LANE_STAGE(match, rollout_match(&r, &p))
LANE_STAGE(kink_time, rollout_kink_time(&r, &p))
LANE_STAGE(kink, rollout_kink(&r, &p))
LANE_STAGE(stop, rollout_stop(&r))
LANE_STAGE(fade, rollout_fade(&r))
LANE_STAGE(at, rollout_at(&r))
LANE_STAGE(short, rollout_short(&r))
LANE_STAGE(short_step, rollout_short_step(&r))
LANE_STAGE(late, rollout_late(&r, &p))
LANE_STAGE(roll, rollout_roll(&r))
LANE_STAGE(near, rollout_near(&r))
LANE_STAGE(near_fit, rollout_near_fit(&r))
LANE_STAGE(near_root, rollout_near_root(&r))
LANE_STAGE(approach, rollout_approach(&r))
LANE_STAGE(hit, rollout_hit(&r))
LANE_STAGE(hit_guess, rollout_hit_guess(&r))
LANE_STAGE(contact, rollout_contact(&r))
LANE_GROUP(fade, rollout_fade(&r))
LANE_GROUP(at, rollout_at(&r))
LANE_GROUP(approach, rollout_approach(&r))
LANE_GROUP(contact, rollout_contact(&r))

LANE_LOOP void lane_end(struct lanes_block *restrict b, const struct rollout_plan *restrict plan,
			uint32_t *restrict flags)
{
	const struct rollout_plan p = *plan;

	for (int i = 0; i < LANES; i++) {
		struct rollout r;
		ROLLOUT_FIELDS(LOAD)
		flags[i] = rollout_end(&r, &p);
		b->need[i] = r.need;
	}
}

LANE_LOOP void lane_draw(const struct sample_plan *restrict plan, const float *restrict z,
			 uint32_t stride, float *restrict in, uint32_t *restrict lifted)
{
	const struct sample_plan p = *plan;

	for (int i = 0; i < LANES; i++) {
		lifted[i] = (uint32_t)sample_draw(&p, z + i, stride, in + i, LANES);
	}
}

LANE_LOOP int lane_wanted(const float *restrict want)
{
	uint32_t any = 0;

	for (int i = 0; i < LANES; i++) {
		any |= det_bits(want[i]);
	}
	return any != 0;
}

static int group_wanted(const float *restrict want)
{
	uint32_t any = 0;

	for (int i = 0; i < GROUP; i++) {
		any |= det_bits(want[i]);
	}
	return any != 0;
}

LANE_LOOP uint32_t lane_count(const uint32_t *restrict flags, uint32_t n, uint32_t mask)
{
	uint32_t count = 0;

	for (uint32_t i = 0; i < n; i++) {
		count += (flags[i] & mask) != 0 ? 1 : 0;
	}
	return count;
}

LANE_LOOP void lane_mask(float *restrict want, const uint32_t *restrict flags)
{
	for (int i = 0; i < LANES; i++) {
		want[i] = (flags[i] & MODEL_CONTACT) != 0 ? want[i] : 0.0f;
	}
}

_Static_assert(MODEL_CONTACT == 1u, "makes a mask");

LANE_LOOP uint32_t lane_impact(const float *restrict mps, const uint32_t *restrict flags,
			       uint32_t n)
{
	uint32_t sum = 0; /* 128 lanes of at most 2^20 */

	for (uint32_t i = 0; i < n; i++) {
		sum += (uint32_t)tally_units(mps[i]) & (0u - (flags[i] & MODEL_CONTACT));
	}
	return sum;
}

LANE_LOOP void lane_moments(const float *restrict stop, uint32_t n, int32_t centre,
			    struct stats_sums *sums)
{
	int64_t sum = 0;
	uint64_t sum2 = 0;

	for (uint32_t i = 0; i < n; i++) {
		const int64_t d = tally_units(stop[i]) - centre;

		sum += d;
		sum2 += (uint64_t)(d * d);
	}
	sums->stop_sum += sum;
	sums->stop_sum2 += sum2;
}

LANE_LOOP void lane_bins(struct lanes_work *restrict w, float mean_headway_m, uint32_t req_flags)
{
	const struct lanes_block *b = &w->block;

	for (int i = 0; i < LANES; i++) {
		const uint32_t flags = w->flags[i];

		w->stop_bin[i] = tally_stop_bin(b->stop[i], flags);
		w->need_bin[i] = tally_need_bin(b->need[i], b->headway[i] - mean_headway_m, flags,
						req_flags);
	}
}

#endif
