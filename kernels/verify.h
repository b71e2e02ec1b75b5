/* SPDX-License-Identifier: MIT
 * Fast rollout against reference: hard scenes, made from a seed, and the comparison. Pure, the caller has the backend
 * and the threads. A group shares what mc_ops.roll takes once: vehicle, future and horizon.
 */
#ifndef AEBMC_VERIFY_H
#define AEBMC_VERIFY_H

#include "mc_ops.h"

enum verify_kind {
	VERIFY_PAPER, /* draws of the paper's preset: standing lead, braking from t = 0 */
	VERIFY_MOVING, /* random scenes: 0-60 m/s, mu 0.1-1, grades to +-0.5 rad, standing to accelerating leads,
			* relative speeds that almost touch zero; half of them graze, by 0.5 to 110 mm */
};

struct verify_group {
	struct model_vehicle vehicle;
	struct model_future future;
	float horizon_s;
	uint32_t count;
	float *in; /* [MODEL_INPUTS][count], the caller's */
};

#define VERIFY_BAND_M \
	0.5e-3 /* verdicts may differ where the reference's headway - need is within this */

struct verify_tally {
	uint64_t scenes, contacts, grazing; /* grazing: within 0.11 m of contact */
	uint64_t
		verdict_mismatches; /* any flag differs, outside the band, and the horizon does not explain it */
	uint64_t in_band; /* scenes within the band, excluded from verdicts */
	uint64_t
		at_horizon; /* differing flags with |t_stop - T| < 1 ms or |v_ego - v_lead| < 1 cm/s at T */
	uint64_t not_finite; /* fast results with a NaN or an infinity */
	double stop_dev_m;   /* largest |fast - reference| of the stopping distance, both stopped */
	double need_dev_m;   /* of the headway that just touches, all scenes */
	double impact_dev_mps; /* of the impact speed, both in contact, outside the band */
};

/**
 * verify_scenes - fill @g with g->count scenes
 * @group: any number; the same (kind, seed, group, count) gives the same scenes on any machine
 * Reads count and in, sets the rest. Headways that graze are placed with the fast rollout's need. Pure.
 */
void verify_scenes(enum verify_kind kind, uint64_t seed, uint64_t group, struct verify_group *g);

/** verify_compare - add the comparison of @fast with @ref, [g->count] each, to @t. Reference runs for lanes that differ. */
void verify_compare(const struct verify_group *g, const struct model_out *fast,
		    const struct model_out *ref, struct verify_tally *t);

/** verify_add - a += b. */
void verify_add(struct verify_tally *a, const struct verify_tally *b);

#endif
