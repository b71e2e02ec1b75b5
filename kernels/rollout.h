/* SPDX-License-Identifier: MIT
 * The fast rollout: the scenes of model.h in f32 without time steps. Actuator lag, friction bound, grade and drag have
 * closed forms; closest approach and first contact are roots found in a few corrections.
 * Host and device, same bits. Each stage is a branch-free function of one lane: a device thread calls them in a row
 * (rollout_sample), the CPU runs each over a block of lanes (lanes.c), where the compiler vectorises it.
 */
#ifndef AEBMC_ROLLOUT_H
#define AEBMC_ROLLOUT_H

#include "rollout_ego.h"
#include "rollout_gap.h"

#define ROLLOUT_APPROACH_MAX 8 /* corrections after which what is found counts */
#define ROLLOUT_SHORT_STEPS  2
#define ROLLOUT_CONTACT_MAX  24

/* From onset to standstill or horizon, and the closest approach on the way. */
HD void rollout_brake(struct rollout *r, const struct rollout_plan *p)
{
	rollout_match(r, p);
	rollout_kink_time(r, p);
	rollout_kink(r, p);
	rollout_stop(r);
	if (r->want > 0.0f) {
		rollout_short(r);
		for (int i = 0; i < ROLLOUT_SHORT_STEPS; i++) {
			rollout_fade(r);
			rollout_at(r);
			rollout_short_step(r);
		}
	}
	rollout_late(r, p);
	if (r->want > 0.0f) {
		rollout_fade(r);
		rollout_at(r);
		rollout_roll(r);
	}
	if (r->lead_stop > 0.0f) {
		rollout_near(r);
		rollout_near_fit(r);
		rollout_near_root(r);
		for (int i = 0; i < ROLLOUT_APPROACH_MAX && r->want > 0.0f; i++) {
			rollout_fade(r);
			rollout_at(r);
			rollout_approach(r);
		}
	}
}

/**
 * rollout_need - all stages of one lane but its impact speed
 * @in: MODEL_INPUTS values, @stride floats apart, within the ranges of enum model_input
 * @r:  stop and need are results; ready for rollout_impact() if the flags say contact
 * Returns the flags. Against model_rollout(): see verify.h. The bits are those of the lane loops. Pure.
 */
HD uint32_t rollout_need(const struct rollout_plan *p, const float *in, uint32_t stride,
			 struct rollout *r)
{
	r->headway = in[MODEL_HEADWAY * stride];
	r->v0 = in[MODEL_EGO_SPEED * stride];
	r->a0 = in[MODEL_EGO_ACCEL * stride];
	r->vl = in[MODEL_LEAD_SPEED * stride];
	r->al = in[MODEL_LEAD_ACCEL * stride];
	r->mu = in[MODEL_MU * stride];
	r->theta = in[MODEL_GRADE * stride];
	r->mass = in[MODEL_MASS * stride];
	r->drag = in[MODEL_DRAG * stride];
	r->tau = in[MODEL_TAU * stride];
	r->delay = in[MODEL_DELAY * stride];
	rollout_scene(r, p);
	rollout_coast(r, p);
	if (rollout_brakes(p)) {
		rollout_brake(r, p);
	} else {
		rollout_unbraked(r);
	}
	return rollout_end(r, p);
}

/** rollout_impact - closing speed at the first contact of a lane that has one. */
HD float rollout_impact(struct rollout *r)
{
	rollout_hit(r);
	rollout_hit_guess(r);
	for (int i = 0; i < ROLLOUT_CONTACT_MAX && r->want > 0.0f; i++) {
		rollout_fade(r);
		rollout_at(r);
		rollout_contact(r);
	}
	return r->impact;
}

/** rollout_sample - one lane to its end, impact speed included. */
HD struct model_out rollout_sample(const struct rollout_plan *p, const float *in, uint32_t stride)
{
	struct rollout r = {0};
	struct model_out out;

	out.flags = rollout_need(p, in, stride, &r);
	out.stop_m = r.stop;
	out.need_m = r.need;
	out.impact_mps = out.flags & MODEL_CONTACT ? rollout_impact(&r) : 0.0f;
	return out;
}

#endif
