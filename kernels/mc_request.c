/* SPDX-License-Identifier: MIT
 * Requests as plain data: their check, their hash and the paper's preset.
 */
#include "mc.h"
#include <errno.h>
#include <string.h>

/* Nothing on a road is larger in SI units; it keeps every product of the rollouts finite. */
#define LIMIT     1e6f
#define FLAGS_ALL (MC_WANT_HIST | MC_WANT_IMPACT | MC_ROLLING_IS_CONTACT)

const double mc_risk_level[MC_RISKS] = {0.05, 0.01, 0.001};

static int outside(float x, float lo, float hi)
{
	return !(x >= lo && x <= hi);
}

static int any_outside(const float *x, uint32_t n, float lo, float hi)
{
	int bad = 0;

	for (uint32_t i = 0; i < n; i++) {
		bad |= outside(x[i], lo, hi);
	}
	return bad;
}

static int bad_counts(const struct mc_request *req)
{
	return req->n < 1 || req->flags & ~FLAGS_ALL || req->n_futures < 1 ||
	       req->n_futures > MC_FUTURES_MAX || req->n_priors > MC_PRIORS_MAX ||
	       req->hist_future >= req->n_futures || !(req->horizon_s > 0.0f) ||
	       outside(req->horizon_s, 0.0f, MC_HORIZON_MAX_S) ||
	       outside(req->centre_m, -LIMIT, LIMIT);
}

static int bad_inputs(const struct mc_request *req)
{
	const float *diagonal = req->factor;
	int bad = 0;

	for (int row = 0; row < MC_STATE_DIM; row++) {
		bad |= outside(*diagonal, 0.0f, LIMIT);
		diagonal += row + 2;
	}
	return bad || any_outside(req->mean, MODEL_INPUTS, -LIMIT, LIMIT) ||
	       any_outside(req->factor, MC_FACTOR_LEN, -LIMIT, LIMIT) ||
	       any_outside(req->sigma, MODEL_INPUTS - MC_STATE_DIM, 0.0f, LIMIT) ||
	       any_outside(req->floor, MC_FLOORS, 0.0f, LIMIT) || !(req->mean[MODEL_MU] > 0.0f) ||
	       !(req->mean[MODEL_MASS] > 0.0f) || !(req->mean[MODEL_TAU] > 0.0f) ||
	       outside(req->mean[MODEL_GRADE], -0.5f, 0.5f);
}

static int bad_vehicle(const struct model_vehicle *v)
{
	return outside(v->rho_kgpm3, 0.0f, LIMIT) || outside(v->area_m2, 0.0f, LIMIT) ||
	       outside(v->gravity_mps2, 0.0f, LIMIT) || outside(v->cg_height_m, 0.0f, LIMIT) ||
	       outside(v->wheelbase_m, 0.0f, LIMIT) || !(v->gravity_mps2 > 0.0f) ||
	       !(v->wheelbase_m > 0.0f) || v->bound > MODEL_BOUND_FRICTION;
}

static int bad_futures(const struct mc_request *req)
{
	int bad = 0;

	for (uint32_t i = 0; i < req->n_futures; i++) {
		bad |= outside(req->future[i].accel_cmd_mps2, -LIMIT, 0.0f) |
		       outside(req->future[i].extra_delay_s, 0.0f, LIMIT);
	}
	return bad;
}

static int bad_priors(const struct mc_request *req)
{
	float sum = req->n_priors ? 0.0f : 1.0f;
	int bad = 0;

	for (uint32_t i = 0; i < req->n_priors; i++) {
		bad |= outside(req->prior[i].weight, 0.0f, 1.001f) |
		       outside(req->prior[i].gain, -LIMIT, LIMIT) |
		       outside(req->prior[i].offset_mps2, -LIMIT, LIMIT) |
		       outside(req->prior[i].headway_m, -LIMIT, LIMIT) |
		       outside(req->prior[i].speed_mps, -LIMIT, LIMIT);
		sum += req->prior[i].weight;
	}
	return bad || outside(sum, 0.999f, 1.001f);
}

int mc_check(const struct mc_request *req)
{
	return bad_counts(req) || bad_inputs(req) || bad_vehicle(&req->vehicle) ||
			       bad_futures(req) || bad_priors(req)
		       ? -EINVAL
		       : 0;
}

/* FNV-1a (Fowler, Noll, Vo), 64 bit, over the little-endian bytes of 32-bit words. */
static uint64_t hash_word(uint64_t h, uint32_t x)
{
	for (int i = 0; i < 4; i++) {
		h = (h ^ (x >> 8 * i & 0xff)) * 0x100000001b3u;
	}
	return h;
}

static uint64_t hash_floats(uint64_t h, const float *x, uint32_t n)
{
	for (uint32_t i = 0; i < n; i++) {
		h = hash_word(h, det_bits(x[i]));
	}
	return h;
}

uint64_t mc_request_hash(const struct mc_request *req)
{
	const struct model_vehicle *v = &req->vehicle;
	const float shared[] = {v->rho_kgpm3,   v->area_m2,     v->gravity_mps2, v->cg_height_m,
				v->wheelbase_m, req->horizon_s, req->centre_m};
	const uint32_t words[] = {req->n,        req->flags,       req->n_futures,
				  req->n_priors, req->hist_future, v->bound};
	uint64_t h = 0xcbf29ce484222325u;

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		h = hash_word(h, words[i]);
	}
	h = hash_floats(h, shared, sizeof(shared) / sizeof(shared[0]));
	h = hash_floats(h, req->mean, MODEL_INPUTS);
	h = hash_floats(h, req->factor, MC_FACTOR_LEN);
	h = hash_floats(h, req->sigma, MODEL_INPUTS - MC_STATE_DIM);
	h = hash_floats(h, req->floor, MC_FLOORS);
	for (uint32_t i = 0; i < req->n_futures && i < MC_FUTURES_MAX; i++) {
		h = hash_floats(h, &req->future[i].accel_cmd_mps2, 1);
		h = hash_floats(h, &req->future[i].extra_delay_s, 1);
	}
	for (uint32_t i = 0; i < req->n_priors && i < MC_PRIORS_MAX; i++) {
		const struct mc_prior *row = &req->prior[i];
		const float x[] = {row->weight, row->gain, row->offset_mps2, row->headway_m,
				   row->speed_mps};

		h = hash_floats(h, x, sizeof(x) / sizeof(x[0]));
	}
	return h;
}

void mc_preset_paper(struct mc_request *req, float headway_m, uint32_t n)
{
	*req = (struct mc_request){
		.id = 1,
		.n = n,
		.flags = MC_WANT_HIST | MC_ROLLING_IS_CONTACT,
		.n_futures = 1,
		.mean = {[MODEL_HEADWAY] = headway_m,
			 [MODEL_EGO_SPEED] = 30.0f,
			 [MODEL_MU] = 0.8f,
			 [MODEL_MASS] = 1500.0f,
			 [MODEL_DRAG] = 0.3f,
			 [MODEL_TAU] = 0.15f},
		.factor = {[2] = 2.0f}, /* ego speed */
		.sigma = {[MODEL_MU - MC_STATE_DIM] = 0.1f,
			  [MODEL_GRADE - MC_STATE_DIM] = 0.05f,
			  [MODEL_MASS - MC_STATE_DIM] = 100.0f,
			  [MODEL_DRAG - MC_STATE_DIM] = 0.05f},
		.floor = {[MC_FLOOR_MU] = 0.05f, [MC_FLOOR_MASS] = 100.0f},
		.horizon_s = 10.0f,
		.centre_m = 79.0f,
		.vehicle = {.rho_kgpm3 = 1.225f,
			    .area_m2 = 2.2f,
			    .gravity_mps2 = 9.81f,
			    .cg_height_m = 0.5f,
			    .wheelbase_m = 2.7f,
			    .bound = MODEL_BOUND_PAPER},
		.future = {{.accel_cmd_mps2 = -6.0f}},
	};
}
