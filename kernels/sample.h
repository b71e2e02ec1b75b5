/* SPDX-License-Identifier: MIT
 * From standard normal draws to the inputs of one sample: means, lower-triangular factor, sigmas, prior about the lead,
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
	float prior_cum[MC_PRIORS_MAX]; /* cumulative; the last > 1: a pick always exists */
	float prior_gain[MC_PRIORS_MAX];
	float prior_offset[MC_PRIORS_MAX];
	float prior_headway[MC_PRIORS_MAX];
	float prior_speed[MC_PRIORS_MAX];
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
		p->prior_headway[i] = have ? req->prior[i].headway_m : 0.0f;
		p->prior_speed[i] = have ? req->prior[i].speed_mps : 0.0f;
	}
}

#define SAMPLE_TAU_FLOOR_S 0.02f /* shortest actuator lag that the closed forms are good for */

/* sample_lift - @v, not below @lo; *lifted becomes 1 if it was. */
HD float sample_lift(float v, float lo, int *lifted)
{
	*lifted = v < lo ? 1 : *lifted;
	return v < lo ? lo : v;
}

/* sample_row - the row of the prior that the uniform @u picks. */
HD uint32_t sample_row(const float cum[MC_PRIORS_MAX], float u)
{
	return (u < cum[0] ? 0u : 1u) + (u < cum[1] ? 0u : 1u) + (u < cum[2] ? 0u : 1u) +
	       (u < cum[3] ? 0u : 1u) + (u < cum[4] ? 0u : 1u) + (u < cum[5] ? 0u : 1u) +
	       (u < cum[6] ? 0u : 1u);
}

/**
 * sample_draw - inputs of one sample
 * @z:  MC_DIM draws, @stride floats apart
 * @in: MODEL_INPUTS inputs, @in_stride floats apart; overlaps neither @z nor @p
 * Returns 1 if a floor lifted an input (headway, mu, mass, delay; speeds below 0, C_d below 0 and tau below 0.02 s are
 * lifted too and counted alike), else 0. Branch-free; a loop over lanes vectorises if its pointers are restrict.
 */
HD int sample_draw(const struct sample_plan *__restrict__ p, const float *__restrict__ z,
		   uint32_t stride, float *__restrict__ in, uint32_t in_stride)
{
	const float *m = p->mean, *f = p->factor, *sd = p->sigma, *lo = p->floor;
	const size_t s = stride, o = in_stride;
	float z0 = z[0], z1 = z[s], z2 = z[2 * s], z3 = z[3 * s], z4 = z[4 * s];
	const uint32_t row = sample_row(p->prior_cum, z[MC_DIM_PRIOR * s]);
	float hw = det_fmaf(f[0], z0, m[0]);
	float ve = det_fmaf(f[2], z1, det_fmaf(f[1], z0, m[1]));
	float ae = det_fmaf(f[5], z2, det_fmaf(f[4], z1, det_fmaf(f[3], z0, m[2])));
	float vl = det_fmaf(f[7], z1, det_fmaf(f[6], z0, m[3]));
	float al = det_fmaf(f[11], z1, det_fmaf(f[10], z0, m[4]));
	float mu = det_fmaf(sd[0], z[5 * s], m[5]);
	float mass = det_fmaf(sd[2], z[7 * s], m[7]);
	float drag = det_fmaf(sd[3], z[8 * s], m[8]);
	float tau = det_fmaf(sd[4], z[9 * s], m[9]);
	float delay = det_fmaf(sd[5], z[10 * s], m[10]);
	int lifted = 0;

	vl = det_fmaf(f[9], z3, det_fmaf(f[8], z2, vl));
	al = det_fmaf(f[14], z4, det_fmaf(f[13], z3, det_fmaf(f[12], z2, al)));
	al = det_fmaf(p->prior_gain[row], al, p->prior_offset[row]);
	hw = hw + p->prior_headway[row];
	vl = vl + p->prior_speed[row];
	in[0] = sample_lift(hw, lo[MC_FLOOR_HEADWAY], &lifted);
	in[o] = sample_lift(ve, 0.0f, &lifted);
	in[2 * o] = ae;
	in[3 * o] = sample_lift(vl, 0.0f, &lifted);
	in[4 * o] = al;
	in[5 * o] = sample_lift(mu, lo[MC_FLOOR_MU], &lifted);
	in[6 * o] = det_fmaf(sd[1], z[6 * s], m[6]);
	in[7 * o] = sample_lift(mass, lo[MC_FLOOR_MASS], &lifted);
	in[8 * o] = sample_lift(drag, 0.0f, &lifted);
	in[9 * o] = sample_lift(tau, SAMPLE_TAU_FLOOR_S, &lifted);
	in[10 * o] = sample_lift(delay, lo[MC_FLOOR_DELAY], &lifted);
	return lifted;
}

#endif
