/* SPDX-License-Identifier: MIT
 * Hard scenes and the comparison of both rollouts on them.
 */
#include "verify.h"
#include "draws.h"
#include "rollout.h"
#include "sample.h"

#define GRAZE_MAX_M 0.11

/* Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014: SplitMix64. */
struct dice {
	uint64_t state;
};

static float uniform(struct dice *d, float lo, float hi)
{
	uint64_t z = d->state += 0x9e3779b97f4a7c15u;

	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	z ^= z >> 31;
	return lo + (hi - lo) * ((float)(z >> 40) * 0x1p-24f);
}

static int chance(struct dice *d, float p)
{
	return uniform(d, 0.0f, 1.0f) < p;
}

static void paper_scenes(uint64_t seed, uint64_t group, struct verify_group *g)
{
	const struct mc_params params = {
		.kind = MC_PHILOX, .seed = seed, .n_resident = 1, .threads = 1};
	struct normal_plan draws;
	struct sample_plan plan;
	struct mc_request req;

	mc_preset_paper(&req, 100.0f, g->count);
	g->vehicle = req.vehicle;
	g->future = req.future[0];
	g->horizon_s = req.horizon_s;
	sample_plan(&req, &plan);
	if (draws_plan(&params, &draws)) {
		return; /* cannot be: the parameters are constants */
	}
	for (uint32_t i = 0; i < g->count; i++) {
		float z[MC_DIM];

		for (uint32_t k = 0; k < NORMAL_GROUPS; k++) {
			normal_four(&draws, group * g->count + i, k, z + 4 * k);
		}
		sample_draw(&plan, z, 1, g->in + i, g->count);
	}
}

static void moving_group(struct dice *d, struct verify_group *g)
{
	g->vehicle = (struct model_vehicle){.rho_kgpm3 = 1.225f,
					    .area_m2 = 2.2f,
					    .gravity_mps2 = 9.81f,
					    .cg_height_m = 0.5f,
					    .wheelbase_m = 2.7f,
					    .bound = chance(d, 0.7f) ? MODEL_BOUND_PAPER
								     : MODEL_BOUND_FRICTION};
	g->future.accel_cmd_mps2 = chance(d, 0.03f) ? 0.0f : -uniform(d, 1.0f, 10.0f);
	g->future.extra_delay_s = chance(d, 0.3f) ? uniform(d, 0.0f, 1.5f) : 0.0f;
	g->horizon_s = chance(d, 0.7f) ? 10.0f : uniform(d, 2.0f, 15.0f);
	g->future.extra_delay_s = chance(d, 0.04f) ? g->horizon_s : g->future.extra_delay_s;
}

static void moving_ego(struct dice *d, float in[MODEL_INPUTS])
{
	in[MODEL_EGO_SPEED] = uniform(d, 0.0f, chance(d, 0.15f) ? 5.0f : 60.0f);
	in[MODEL_EGO_SPEED] = chance(d, 0.01f) ? 0.0f : in[MODEL_EGO_SPEED];
	in[MODEL_EGO_ACCEL] = chance(d, 0.4f) ? 0.0f : uniform(d, -6.0f, 3.0f);
	in[MODEL_MU] = uniform(d, 0.1f, 1.0f);
	in[MODEL_GRADE] = chance(d, 0.15f) ? uniform(d, -0.5f, 0.5f) : uniform(d, -0.15f, 0.15f);
	in[MODEL_MASS] = uniform(d, 1000.0f, 3500.0f);
	in[MODEL_DRAG] = chance(d, 0.05f) ? 0.0f : uniform(d, 0.1f, 0.7f);
	in[MODEL_TAU] = uniform(d, 0.05f, 0.4f);
	in[MODEL_DELAY] = chance(d, 0.3f) ? 0.0f : uniform(d, 0.0f, 1.0f);
}

/* Leads at any speed or nearly the ego's; some brake just as hard as the ego will, so that relative speed lingers. */
static void moving_lead(struct dice *d, const struct verify_group *g, float in[MODEL_INPUTS])
{
	const float v0 = in[MODEL_EGO_SPEED];
	const float brake =
		det_maxf(g->future.accel_cmd_mps2, -g->vehicle.gravity_mps2 * in[MODEL_MU]);

	in[MODEL_LEAD_SPEED] =
		chance(d, 0.4f) ? v0 * uniform(d, 0.8f, 1.2f) : uniform(d, 0.0f, 60.0f);
	in[MODEL_LEAD_SPEED] = chance(d, 0.12f) ? 0.0f : in[MODEL_LEAD_SPEED];
	in[MODEL_LEAD_ACCEL] =
		chance(d, 0.25f) ? brake + uniform(d, -1.0f, 1.0f) : uniform(d, -10.0f, 4.0f);
	in[MODEL_LEAD_ACCEL] = chance(d, 0.2f) ? 0.0f : in[MODEL_LEAD_ACCEL];
}

static float moving_headway(struct dice *d, const struct rollout_plan *p,
			    const float in[MODEL_INPUTS])
{
	const float need = rollout_sample(p, in, 1).need_m;
	const float by = det_expf(uniform(d, -7.6f, -2.2f)); /* 0.5 to 110 mm */
	const float side = chance(d, 0.5f) && need > by ? -by : by;

	return chance(d, 0.5f) ? need + side : uniform(d, 0.0f, chance(d, 0.5f) ? 30.0f : 200.0f);
}

static void moving_scenes(uint64_t seed, uint64_t group, struct verify_group *g)
{
	struct dice d = {seed * 0xd1342543de82ef95u + group * 0x2545f4914f6cdd1du};
	struct rollout_plan plan;

	moving_group(&d, g);
	plan = rollout_plan(&g->vehicle, &g->future, g->horizon_s);
	for (uint32_t i = 0; i < g->count; i++) {
		float in[MODEL_INPUTS] = {0.0f};

		moving_ego(&d, in);
		moving_lead(&d, g, in);
		in[MODEL_HEADWAY] = moving_headway(&d, &plan, in);
		for (uint32_t k = 0; k < MODEL_INPUTS; k++) {
			g->in[(size_t)k * g->count + i] = in[k];
		}
	}
}

void verify_scenes(enum verify_kind kind, uint64_t seed, uint64_t group, struct verify_group *g)
{
	if (kind == VERIFY_PAPER) {
		paper_scenes(seed, group, g);
	} else {
		moving_scenes(seed, group, g);
	}
}

static int rolls(const struct verify_group *g, uint32_t i, float horizon_s)
{
	const struct model_out o = model_rollout(&g->vehicle, &g->future, horizon_s, MODEL_STEP_S,
						 g->in + i, g->count);

	return (o.flags & MODEL_ROLLING) != 0;
}

/* Whether the ego has just stopped at the horizon, or which of two nearly equal speeds is larger there, is no matter of
 * the gap: such flags may differ. */
static int horizon_explains(const struct verify_group *g, uint32_t i)
{
	const float t = g->horizon_s, ms = 1e-3f;
	const struct model_sample p = model_sample(&g->vehicle, &g->future, t, g->in + i, g->count);
	struct model_watch w = {0.0, 0.0, 0.0, 0.0, 0};
	const struct model_state s =
		model_brake(&p, MODEL_STEP_S, model_coast(&p, MODEL_STEP_S, &w), &w);

	return (s.v > 0.0 && fabs(w.closing) < 0.01) || rolls(g, i, t - ms) != rolls(g, i, t + ms);
}

static void compare_flags(const struct verify_group *g, uint32_t i, double miss_m, uint32_t differ,
			  struct verify_tally *t)
{
	if (fabs(miss_m) <= VERIFY_BAND_M) {
		t->in_band++;
		return;
	}
	if (differ & MODEL_CONTACT || (differ && !horizon_explains(g, i))) {
		t->verdict_mismatches++;
	} else if (differ) {
		t->at_horizon++;
	}
}

static double larger(double a, double b)
{
	return a > b ? a : b;
}

void verify_compare(const struct verify_group *g, const struct model_out *fast,
		    const struct model_out *ref, struct verify_tally *t)
{
	for (uint32_t i = 0; i < g->count; i++) {
		const struct model_out f = fast[i], r = ref[i];
		const double miss = (double)g->in[i] - r.need_m;
		const int hit = (f.flags & r.flags & MODEL_CONTACT) && fabs(miss) > VERIFY_BAND_M;

		t->scenes++;
		t->contacts += (r.flags & MODEL_CONTACT) != 0;
		t->grazing += fabs(miss) < GRAZE_MAX_M;
		if (!isfinite(f.stop_m) || !isfinite(f.need_m) || !isfinite(f.impact_mps)) {
			t->not_finite++;
			t->verdict_mismatches++;
			continue;
		}
		compare_flags(g, i, miss, f.flags ^ r.flags, t);
		if (!((f.flags | r.flags) & MODEL_ROLLING)) {
			t->stop_dev_m = larger(t->stop_dev_m, fabs((double)f.stop_m - r.stop_m));
		}
		t->need_dev_m = larger(t->need_dev_m, fabs((double)f.need_m - r.need_m));
		if (hit) {
			t->impact_dev_mps = larger(t->impact_dev_mps,
						   fabs((double)f.impact_mps - r.impact_mps));
		}
	}
}

void verify_add(struct verify_tally *a, const struct verify_tally *b)
{
	a->scenes += b->scenes;
	a->contacts += b->contacts;
	a->grazing += b->grazing;
	a->verdict_mismatches += b->verdict_mismatches;
	a->in_band += b->in_band;
	a->at_horizon += b->at_horizon;
	a->not_finite += b->not_finite;
	a->stop_dev_m = larger(a->stop_dev_m, b->stop_dev_m);
	a->need_dev_m = larger(a->need_dev_m, b->need_dev_m);
	a->impact_dev_mps = larger(a->impact_dev_mps, b->impact_dev_mps);
}
