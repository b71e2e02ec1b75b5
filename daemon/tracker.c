/* SPDX-License-Identifier: MIT
 * Association by nearest neighbour within a gate on place, speed and lateral offset; life and death of objects.
 */
#include <string.h>
#include "clock.h"
#include "tracker.h"

#define COST_NONE 1e300 /* beyond any gate */

void tracker_open(struct tracker *t, const struct config *cfg)
{
	memset(t, 0, sizeof(*t));
	t->cfg = cfg;
}

void tracker_reset(struct tracker *t)
{
	t->ego_valid = 0;
	t->n = 0;
	t->lead_id = 0;
}

static void predict(const struct tracker *t, struct kalman *k, int64_t t_ns)
{
	kalman_predict(k, t_ns, t->cfg->filter_ego_jerk, t->cfg->filter_lead_jerk);
}

void tracker_ego_speed(struct tracker *t, int64_t t_ns, double speed_mps)
{
	const double sigma = t->cfg->filter_ego_sigma;

	if (!t->ego_valid) {
		kalman_open_ego(&t->ego, t_ns, speed_mps, sigma, t->cfg->filter_accel_sigma);
		t->ego_valid = 1;
		return;
	}
	predict(t, &t->ego, t_ns);
	kalman_forget_lead(&t->ego);
	kalman_update(&t->ego, KALMAN_EGO_SPEED, speed_mps, sigma);
	for (int i = 0; i < t->n; i++) {
		predict(t, &t->object[i].k, t_ns);
		kalman_update(&t->object[i].k, KALMAN_EGO_SPEED, speed_mps, sigma);
	}
}

/* ---- association ---------------------------------------------------------------------------- */

/* The noise of a measurement: what the radar says of this target, or what the configuration says of all. */
static double distance_sigma(const struct config *c, const struct detection *d)
{
	return d->distance_sigma_m > 0 ? d->distance_sigma_m : c->radar_range_sigma;
}

static double rate_sigma(const struct config *c, const struct detection *d)
{
	return d->rate_sigma_mps > 0 ? d->rate_sigma_mps : c->radar_rate_sigma;
}

/* Squared distance from an object's prediction in sigmas; the lateral offset may differ by the corridor's half width. */
static double cost(const struct config *c, const struct tracker_object *o,
		   const struct detection *d)
{
	double s11, s22;
	const double a = kalman_innovation(&o->k, KALMAN_DISTANCE, d->distance_m,
					   distance_sigma(c, d), &s11);
	const double b = kalman_innovation(&o->k, KALMAN_RATE, d->rate_mps, rate_sigma(c, d), &s22);
	const double s12 =
		o->k.p[SCENE_HEADWAY][SCENE_LEAD_SPEED] - o->k.p[SCENE_HEADWAY][SCENE_EGO_SPEED];
	const double l = (d->lateral_m - o->lateral_m) * c->filter_gate / c->radar_corridor;

	return (a * a * s22 - 2 * a * b * s12 + b * b * s11) / (s11 * s22 - s12 * s12) + l * l;
}

static int is_gated(const struct config *c, double squared_sigmas)
{
	return squared_sigmas < c->filter_gate * c->filter_gate;
}

static void fill_costs(struct tracker *t, const struct tracker_scan *s)
{
	for (int i = 0; i < t->n; i++) {
		for (int j = 0; j < s->n; j++) {
			const double c = cost(t->cfg, &t->object[i], &s->det[j]);

			t->cost[i][j] = is_gated(t->cfg, c) ? c : COST_NONE;
		}
	}
}

/* The cheapest pair left. Returns 0 when none is. */
static int next_pair(struct tracker *t, int n_det, int *object, int *det)
{
	double best = COST_NONE;

	for (int i = 0; i < t->n; i++) {
		for (int j = 0; j < n_det; j++) {
			if (t->cost[i][j] < best) {
				best = t->cost[i][j];
				*object = i;
				*det = j;
			}
		}
	}
	return best < COST_NONE;
}

static void strike_out(struct tracker *t, int n_det, int object, int det)
{
	for (int i = 0; i < t->n; i++) {
		t->cost[i][det] = COST_NONE;
	}
	for (int j = 0; j < n_det; j++) {
		t->cost[object][j] = COST_NONE;
	}
}

/* ---- life of an object ---------------------------------------------------------------------- */

int tracker_confirmed(const struct tracker *t, const struct tracker_object *o)
{
	return o->hits >= (uint32_t)t->cfg->radar_confirm_scans;
}

/* Benedict and Bordner, "Synthesis of an optimal set of radar track-while-scan smoothing equations", IRE Trans. Automatic
 * Control 7 (1962): the gain on the rate that goes with one on the place. */
static void follow_sideways(const struct config *c, struct tracker_object *o, double lateral_m,
			    double step_s)
{
	const double gain = 2 / (double)(c->radar_confirm_scans + 1);
	const double error = lateral_m - o->lateral_m;

	o->lateral_m += gain * error;
	if (step_s > 0) {
		o->lateral_mps += gain * gain / (2 - gain) * error / step_s;
	}
}

static void follow(const struct tracker *t, struct tracker_object *o, const struct detection *d,
		   int64_t seen_ns)
{
	const struct config *c = t->cfg;

	kalman_update(&o->k, KALMAN_DISTANCE, d->distance_m, distance_sigma(c, d));
	kalman_update(&o->k, KALMAN_RATE, d->rate_mps, rate_sigma(c, d));
	follow_sideways(c, o, d->lateral_m, t->step_s);
	o->existence = d->existence;
	o->seen_ns = seen_ns;
	o->hits += !d->fresh;
	o->missed = 0;
}

static void begin(struct tracker *t, const struct detection *d, int64_t seen_ns)
{
	const struct config *c = t->cfg;

	if (t->n == TRACKER_OBJECTS_MAX) {
		return;
	}
	struct tracker_object *o = &t->object[t->n++];

	*o = (struct tracker_object){
		.k = t->ego,
		.lateral_m = d->lateral_m,
		.existence = d->existence,
		.seen_ns = seen_ns,
		.id = ++t->last_id,
		.hits = !d->fresh,
	};
	kalman_open_lead(&o->k, d->distance_m, distance_sigma(c, d), d->rate_mps, rate_sigma(c, d),
			 c->filter_accel_sigma);
}

/* An object is given up after more scans without a detection than it had with one, coast_scans at most. */
static int is_lost(const struct tracker *t, const struct tracker_object *o)
{
	return o->missed > o->hits || o->missed > (uint32_t)t->cfg->radar_coast_scans;
}

/* 1 if an older object is at the same place with the same speed: one vehicle seen twice. */
static int is_duplicate(const struct tracker *t, int n_older, const struct tracker_object *o)
{
	const struct detection seen = {
		.distance_m = o->k.x[SCENE_HEADWAY],
		.rate_mps = o->k.x[SCENE_LEAD_SPEED] - o->k.x[SCENE_EGO_SPEED],
		.lateral_m = o->lateral_m,
	};

	for (int i = 0; i < n_older; i++) {
		const double c = cost(t->cfg, &t->object[i], &seen);

		if (is_gated(t->cfg, c)) {
			return 1;
		}
	}
	return 0;
}

static void drop_lost_and_duplicates(struct tracker *t)
{
	int kept = 0;

	for (int i = 0; i < t->n; i++) {
		if (!is_lost(t, &t->object[i]) && !is_duplicate(t, kept, &t->object[i])) {
			t->object[kept++] = t->object[i];
		}
	}
	t->n = kept;
}

/* ---- the lead ------------------------------------------------------------------------------- */

double tracker_lateral(const struct tracker *t, const struct tracker_object *o)
{
	const double d = o->k.x[SCENE_HEADWAY];

	return o->lateral_m - t->curvature * d * d / 2;
}

/* What surely comes towards us is oncoming traffic, not a lead; a filter may overshoot when its lead stops. */
int tracker_oncoming(const struct tracker *t, const struct tracker_object *o)
{
	const struct config *c = t->cfg;
	const double v = o->k.x[SCENE_LEAD_SPEED] + c->filter_standing_speed;

	return v < 0 &&
	       v * v > c->filter_gate * c->filter_gate * o->k.p[SCENE_LEAD_SPEED][SCENE_LEAD_SPEED];
}

static int may_lead(const struct tracker *t, const struct tracker_object *o)
{
	const struct config *c = t->cfg;
	const double lateral = tracker_lateral(t, o);
	const double limit =
		c->radar_corridor + (o->id == t->lead_id ? c->radar_corridor_margin : 0);

	return tracker_confirmed(t, o) && lateral <= limit && lateral >= -limit &&
	       !tracker_oncoming(t, o);
}

static void choose_lead(struct tracker *t)
{
	const struct tracker_object *lead = NULL;

	for (int i = 0; i < t->n; i++) {
		const struct tracker_object *o = &t->object[i];

		if (may_lead(t, o) && (!lead || o->k.x[SCENE_HEADWAY] < lead->k.x[SCENE_HEADWAY])) {
			lead = o;
		}
	}
	t->lead_id = lead ? lead->id : 0;
}

const struct tracker_object *tracker_lead(const struct tracker *t)
{
	for (int i = 0; i < t->n; i++) {
		if (t->object[i].id == t->lead_id) {
			return &t->object[i];
		}
	}
	return NULL;
}

/* ---- a scan --------------------------------------------------------------------------------- */

/* After a silence too long to tell the objects apart, begin anew. */
static void predict_all(struct tracker *t, int64_t t_ns)
{
	const double silence_ms = (double)(t_ns - t->scan_ns) / CLOCK_NS_PER_MS;

	if (silence_ms > (double)t->cfg->bus_stale_periods * t->cfg->radar_period) {
		t->n = 0;
	}
	t->step_s = (double)(t_ns - t->scan_ns) / CLOCK_NS_PER_S;
	t->scan_ns = t_ns;
	predict(t, &t->ego, t_ns);
	kalman_forget_lead(&t->ego);
	for (int i = 0; i < t->n; i++) {
		predict(t, &t->object[i].k, t_ns);
		t->object[i].lateral_m += t->object[i].lateral_mps * t->step_s;
		t->object[i].missed++;
	}
}

void tracker_scan(struct tracker *t, const struct tracker_scan *s)
{
	uint64_t taken = 0;
	int object, det;

	if (!t->ego_valid) {
		return;
	}
	predict_all(t, s->t_ns);
	t->curvature = s->curvature;
	t->curvature_sigma = s->curvature_sigma;
	fill_costs(t, s);
	while (next_pair(t, s->n, &object, &det)) {
		strike_out(t, s->n, object, det);
		follow(t, &t->object[object], &s->det[det], s->seen_ns);
		taken |= 1ull << det;
	}
	for (int j = 0; j < s->n; j++) {
		if (!(taken >> j & 1)) {
			begin(t, &s->det[j], s->seen_ns);
		}
	}
	drop_lost_and_duplicates(t);
	choose_lead(t);
}
