/* SPDX-License-Identifier: MIT
 * The scenes that bench times.
 */
#include "bench_scene.h"
#include <string.h>
#include "pipeline.h"

void bench_scene_paper(struct mc_request *req, uint32_t n)
{
	mc_preset_paper(req, 100, n);
	req->factor[0] = 0.25f;
	req->sigma[MODEL_TAU - MC_STATE_DIM] = 0.01f;
}

static int from_scene(struct mc_request *req, uint32_t n, const struct scene_object *other)
{
	static const double sigma[SCENE_DIM] = {0.2, 0.05, 0.3, 0.12, 0.6};
	struct scene s = {.ego_valid = 1,
			  .lead_valid = 1,
			  .existence = 1,
			  .lead_scans = 100,
			  .x = {20, 30, -0.2, 28, -5}};
	struct config cfg;

	memcpy(s.other, other, sizeof(s.other));
	for (int i = 0; i < SCENE_DIM; i++) {
		for (int k = 0; k < SCENE_DIM; k++) {
			s.cov[i][k] = sigma[i] * sigma[k] * (i == k ? 1 : 0.3);
		}
	}
	config_defaults(&cfg);
	cfg.brake_tau_sigma = 0.01;
	cfg.brake_delay_sigma = 0.02;
	int error = pipeline_request(&cfg, &s, 1, req);

	req->n = n;
	req->flags |= MC_WANT_HIST | MC_WANT_IMPACT;
	return error;
}

int bench_scene_futures(struct mc_request *req, uint32_t n)
{
	static const struct scene_object none[SCENE_OTHERS] = {{0}};

	return from_scene(req, n, none);
}

int bench_scene_perception(struct mc_request *req, uint32_t n)
{
	static const struct scene_object other[SCENE_OTHERS] = {
		[SCENE_NEARER] = {0.1, 12, 26, 0},
		[SCENE_BEHIND] = {0.1, 50, 25, 0},
		[SCENE_HIDDEN] = {0.05, 30, 0, 0},
		[SCENE_NOTHING] = {.p = 0.1},
	};

	return from_scene(req, n, other);
}

int bench_scene_moving(struct mc_request *req, uint32_t n)
{
	int error = bench_scene_futures(req, n);

	req->n_futures = 1;
	req->hist_future = 0;
	req->future[0] = req->future[FUTURE_NOW];
	return error;
}
