/* SPDX-License-Identifier: MIT
 * The scenes that the GPU tests share: the paper's, and a lead that brakes, with every input drawn and four futures.
 */
#ifndef AEBMC_TESTS_GPU_SCENES_H
#define AEBMC_TESTS_GPU_SCENES_H

#include "mc.h"

static inline struct mc_request scene_standing(uint32_t n)
{
	struct mc_request r;

	mc_preset_paper(&r, 100.0f, n);
	r.flags |= MC_WANT_IMPACT;
	r.factor[0] = 0.25f;
	r.sigma[MODEL_TAU - MC_STATE_DIM] = 0.01f;
	return r;
}

/* 20 m behind a lead that brakes at 5 m/s2, at 30 m/s: now, one period later, the driver, nobody. */
static inline struct mc_request scene_moving(uint32_t n)
{
	struct mc_request r = scene_standing(n);
	static const float mean[MC_STATE_DIM] = {20.0f, 30.0f, -0.2f, 28.0f, -5.0f};
	static const float factor[MC_FACTOR_LEN] = {0.2f,  0.015f, 0.048f, 0.09f, 0.07f,
						    0.27f, 0.036f, 0.03f,  0.02f, 0.11f,
						    0.18f, 0.14f,  0.1f,   0.1f,  0.53f};
	static const struct model_future future[MC_FUTURES_MAX] = {
		{-9.0f, 0.0f}, {-9.0f, 0.05f}, {-4.0f, 1.2f}, {0.0f, 30.0f}};
	static const struct mc_prior prior[MC_PRIORS_MAX] = {
		{0.4f, 1.0f, 0.0f, 0.0f, 0.0f},     {0.1f, 0.5f, 0.0f, 0.0f, 0.0f},
		{0.1f, 1.0f, -2.0f, 0.0f, 0.0f},    {0.1f, 1.0f, 1.0f, 0.0f, 0.0f},
		{0.1f, 1.0f, 5.0f, -8.0f, -2.0f},   /* a nearer one */
		{0.1f, 1.0f, 5.0f, 30.0f, -5.0f},   /* one behind it */
		{0.05f, 0.0f, 0.0f, 10.0f, -28.0f}, /* one that stands */
		{0.05f, 0.0f, 0.0f, 1e3f, 200.0f}}; /* none */

	memcpy(r.mean, mean, sizeof(mean));
	memcpy(r.factor, factor, sizeof(factor));
	memcpy(r.future, future, sizeof(future));
	memcpy(r.prior, prior, sizeof(prior));
	r.mean[MODEL_DELAY] = 0.2f;
	r.sigma[MODEL_DELAY - MC_STATE_DIM] = 0.02f;
	r.n_futures = MC_FUTURES_MAX;
	r.n_priors = MC_PRIORS_MAX;
	r.hist_future = 1;
	r.centre_m = 40.0f;
	r.flags = MC_WANT_HIST | MC_WANT_IMPACT;
	return r;
}

/* The same lead, one future. */
static inline struct mc_request scene_lead(uint32_t n)
{
	struct mc_request r = scene_moving(n);

	r.n_futures = 1;
	r.hist_future = 0;
	return r;
}

#endif
