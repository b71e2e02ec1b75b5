/* SPDX-License-Identifier: MIT
 * Probabilities of objects to a chain: the nearest that is there is met.
 */
#include "perception.h"
#include <math.h>
#include "detmath.h"

/* Normal distribution function to 1.4e-4: Bowling et al., "A logistic approximation to the cumulative normal
 * distribution", J. Industrial Engineering and Management 2 (2009). */
static double normal_cdf(double x)
{
	const double y = x * (1.5976 + 0.07056 * x * x);

	return 1 / (1 + (double)det_expf((float)fmin(fmax(-y, -80), 80)));
}

/* Seconds over which its lateral motion counts. */
static double ahead_s(const struct config *c, const struct tracker_object *o)
{
	const double closing = o->k.x[SCENE_EGO_SPEED] - o->k.x[SCENE_LEAD_SPEED];
	const double gap = fmax(o->k.x[SCENE_HEADWAY], 0);

	return gap < closing * c->perception_lookahead ? gap / closing : c->perception_lookahead;
}

double perception_inside(const struct tracker *t, const struct tracker_object *o)
{
	const struct config *c = t->cfg;
	const double d = o->k.x[SCENE_HEADWAY];
	const double rate = o->k.x[SCENE_LEAD_SPEED] - o->k.x[SCENE_EGO_SPEED];
	const double at =
		tracker_lateral(t, o) + (o->lateral_mps - t->curvature * d * rate) * ahead_s(c, o);
	const double bend = t->curvature_sigma * d * d / 2;
	const double sigma =
		sqrt(c->perception_lateral_sigma * c->perception_lateral_sigma + bend * bend);

	if (sigma < 1e-6) {
		return fabs(at) <= c->radar_corridor;
	}
	return normal_cdf((c->radar_corridor - at) / sigma) -
	       normal_cdf((-c->radar_corridor - at) / sigma);
}

/* That the object is one, and not a ghost. */
static double exists(const struct config *c, const struct tracker_object *o)
{
	return c->perception_ghosts ? c->perception_existence * o->existence : 1;
}

/* That an object other than the lead is there, in the corridor. */
static double is_there(const struct tracker *t, const struct tracker_object *o)
{
	const struct config *c = t->cfg;
	const double seen = tracker_confirmed(t, o) ? 1
						    : c->perception_missed * o->hits /
							      (double)c->radar_confirm_scans;

	if (seen <= 0 || tracker_oncoming(t, o)) {
		return 0;
	}
	return seen * exists(c, o) *
	       (c->perception_cutin ? perception_inside(t, o)
				    : fabs(tracker_lateral(t, o)) <= c->radar_corridor);
}

struct perception perception_weigh(const struct tracker *t, const struct tracker_object *lead)
{
	const struct config *c = t->cfg;
	const double there = exists(c, lead);
	const double stays = c->perception_cutout ? perception_inside(t, lead) : 1;
	struct perception w = {.p = {0}};

	for (int i = 0; i < t->n; i++) {
		const struct tracker_object *o = &t->object[i];
		const int side = o->k.x[SCENE_HEADWAY] < lead->k.x[SCENE_HEADWAY] ? SCENE_NEARER
										  : SCENE_BEHIND;
		const double p = o == lead ? 0 : is_there(t, o);

		if (p > w.p[side]) {
			w.p[side] = p;
			w.object[side] = o;
		}
	}
	const double behind = w.p[SCENE_BEHIND], reached = 1 - w.p[SCENE_NEARER];
	const double passed = reached * (1 - there * stays) * (1 - behind);

	w.p[SCENE_BEHIND] = reached * (1 - there * stays) * behind;
	w.p[SCENE_HIDDEN] = reached * there * (1 - stays) * (1 - behind) * c->perception_hidden;
	w.p[SCENE_NOTHING] = passed - w.p[SCENE_HIDDEN];
	return w;
}
