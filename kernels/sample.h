/* SPDX-License-Identifier: MIT
 * From standard normal draws to the inputs of one sample: means, lower-triangular factor, sigmas, prior of the lead,
 * floors. Host and device, same bits.
 */
#ifndef AEBMC_SAMPLE_H
#define AEBMC_SAMPLE_H

#include "mc.h"

/* The request, made ready for the sample path (cumulative prior weights, defaults filled). */
struct sample_plan {
	float mean[MODEL_INPUTS];
	float factor[MC_FACTOR_LEN];
	float sigma[MODEL_INPUTS - MC_STATE_DIM];
	float floor[MC_FLOORS];
	float prior_cum[MC_PRIORS_MAX]; /* cumulative weight; the last is > 1 so that a pick always exists */
	float prior_gain[MC_PRIORS_MAX];
	float prior_offset[MC_PRIORS_MAX];
};

/** sample_plan - derive the plan; an absent prior is "hold". Pure. */
static inline void sample_plan(const struct mc_request *req, struct sample_plan *p)
{
	float cum = 0.0f;

	for (int i = 0; i < MODEL_INPUTS; i++) {
		p->mean[i] = req->mean[i];
	}
	for (int i = 0; i < MC_FACTOR_LEN; i++) {
		p->factor[i] = req->factor[i];
	}
	for (int i = 0; i < MODEL_INPUTS - MC_STATE_DIM; i++) {
		p->sigma[i] = req->sigma[i];
	}
	for (int i = 0; i < MC_FLOORS; i++) {
		p->floor[i] = req->floor[i];
	}
	for (uint32_t i = 0; i < MC_PRIORS_MAX; i++) {
		int have = i < req->n_priors;

		cum += have ? req->prior[i].weight : 0.0f;
		p->prior_cum[i] = have && i + 1 < req->n_priors ? cum : 2.0f;
		p->prior_gain[i] = have ? req->prior[i].gain : 1.0f;
		p->prior_offset[i] = have ? req->prior[i].offset_mps2 : 0.0f;
	}
}

/**
 * sample_draw - inputs of one sample
 * @z:  MC_DIM draws, @stride floats apart
 * @in: MODEL_INPUTS inputs, @in_stride floats apart
 * Returns 1 if a floor lifted an input (headway, mu, mass, delay; speeds below 0, C_d below 0 and tau below 0.02 s are
 * lifted too and counted alike), else 0. Branch-free.
 */

#endif
