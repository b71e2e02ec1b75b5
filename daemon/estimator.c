/* SPDX-License-Identifier: MIT
 * Glue: frames (decode.c) to scans and ego speeds on their own times, those to objects (tracker.c), and the lead's filter
 * predicted to the moment asked for. The filters run behind by the radar's latency, so that what was measured earlier
 * is taken earlier although it arrives later; recent ego speeds wait in a queue and are taken by every scene.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"
#include "decode.h"
#include "estimator.h"
#include "fault.h"
#include "perception.h"
#include "scan.h"
#include "speeds.h"
#include "tracker.h"

/* The latest value of each signal of a role. */
struct role_value {
	int64_t t_ns[MAP_SPEEDS_MAX];
	double value;
};

#define BRAKE_PRESSED 1e-6 /* the brake pedal is a flag: anything above nothing */

struct estimator {
	const struct config *cfg;
	const struct mapping *map;
	struct decode decode;
	struct tracker tracker;
	struct role_value role[MAP_ROLES];

	struct speeds speeds;
	int64_t jumped_ns; /* when too many speeds in a row were implausible */

	struct scan pending;
	struct tracker_scan ended; /* the last one */
	uint64_t scan;             /* scans ended so far */
	int64_t scan_ns;           /* when the last one ended */
	int started;               /* every required input has been seen */
};

/* ---- staleness ------------------------------------------------------------------------------ */

static int64_t limit_ns(const struct estimator *e, int message)
{
	return e->cfg->bus_stale_periods * e->map->message[message].period_ns;
}

/* The last moment at which every message of the role has brought a value within its limit. */
static int64_t role_until_ns(const struct estimator *e, enum map_role role)
{
	const struct map_role_signals *r = &e->map->role[role];
	int64_t until_ns = r->n ? CLOCK_NEVER : DECODE_NEVER;

	for (int i = 0; i < r->n; i++) {
		until_ns =
			clock_earlier(until_ns, e->role[role].t_ns[i] + limit_ns(e, r->message[i]));
	}
	return until_ns;
}

static int is_role_fresh(const struct estimator *e, enum map_role role, int64_t now_ns)
{
	return now_ns <= role_until_ns(e, role);
}

static int64_t message_until_ns(const struct estimator *e, int message)
{
	return e->decode.message[message].t_ns + limit_ns(e, message);
}

/* Without a header every slot must be heard even while others are: the lead may be in it. With one, it must be heard, and
 * bring what it announces. */
static int64_t radar_until_ns(const struct estimator *e)
{
	const int header = e->map->list.header;
	int64_t until_ns = CLOCK_NEVER;

	if (header >= 0) {
		return e->pending.incomplete < (uint32_t)e->cfg->bus_stale_periods
			       ? message_until_ns(e, header)
			       : DECODE_NEVER;
	}
	for (int i = 0; i < e->map->n_tracks; i++) {
		until_ns = clock_earlier(until_ns, message_until_ns(e, e->map->track[i].message));
	}
	return until_ns;
}

static int is_radar_fresh(const struct estimator *e, int64_t now_ns)
{
	return now_ns <= radar_until_ns(e);
}

int64_t estimator_stale_ns(const struct estimator *e, int64_t now_ns)
{
	const int64_t until_ns[] = {role_until_ns(e, MAP_EGO_SPEED), radar_until_ns(e)};
	int64_t stale_ns = CLOCK_NEVER;

	for (int i = 0; i < 2; i++) {
		stale_ns =
			until_ns[i] < now_ns ? stale_ns : clock_earlier(stale_ns, until_ns[i] + 1);
	}
	return stale_ns;
}

/* ---- ego speed ------------------------------------------------------------------------------ */

static void restart(struct estimator *e)
{
	tracker_reset(&e->tracker);
	speeds_reset(&e->speeds);
}

static void take_speed(struct estimator *e, int message, const struct speed *s)
{
	const struct config *c = e->cfg;
	struct speed old;

	if (s->t_ns - e->speeds.heard_ns > limit_ns(e, message)) {
		restart(e);
	}
	const int jumps = speeds_judge(&e->speeds, s, c->filter_ego_accel_max,
				       2 * c->filter_gate * c->filter_ego_sigma);

	e->decode.rejected[SCENE_REJECT_IMPLAUSIBLE] += jumps > 0;
	if (jumps > 0 && jumps < c->bus_stale_periods) {
		return;
	}
	if (jumps > 0) {
		e->jumped_ns = s->t_ns;
		restart(e);
	}
	if (speeds_push(&e->speeds, s, &old)) {
		tracker_ego_speed(&e->tracker, old.t_ns, old.mps);
	}
}

static void take_roles(struct estimator *e, const struct decode_frame *d, int64_t t_ns)
{
	for (int role = 0; role < MAP_ROLES; role++) {
		const struct map_role_signals *r = &e->map->role[role];

		if (!(d->roles >> role & 1)) {
			continue;
		}
		e->role[role].value = d->value[role];
		for (int i = 0; i < r->n; i++) {
			if (r->message[i] == d->message) {
				e->role[role].t_ns[i] = t_ns;
			}
		}
	}
	if (d->roles >> MAP_EGO_SPEED & 1) {
		take_speed(e, d->message, &(struct speed){t_ns, d->value[MAP_EGO_SPEED]});
	}
}

/* ---- scans ---------------------------------------------------------------------------------- */

/* The ego's path: as the yaw rate bends it, straight where that is unknown. */
static void bend(const struct estimator *e, int64_t now_ns, struct tracker_scan *t)
{
	const double v = e->tracker.ego.x[SCENE_EGO_SPEED];
	const int known = is_role_fresh(e, MAP_YAW_RATE, now_ns) && v >= e->cfg->decision_speed_min;

	t->curvature = known ? e->role[MAP_YAW_RATE].value / v : 0;
	t->curvature_sigma =
		known ? e->cfg->perception_yaw_sigma / v : e->cfg->perception_curve_sigma;
}

static int64_t measured_ns(const struct estimator *e, int64_t received_ns)
{
	return received_ns - clock_s_to_ns(e->cfg->radar_latency);
}

static void end_scan(struct estimator *e, int64_t now_ns)
{
	struct tracker_scan *t = &e->ended;
	struct speed s;

	scan_end(&e->pending);
	t->t_ns = measured_ns(e, e->pending.first_ns);
	t->seen_ns = e->pending.first_ns;
	t->n = e->pending.n;
	memcpy(t->det, e->pending.det, (size_t)t->n * sizeof(t->det[0]));
	while (speeds_pop(&e->speeds, t->t_ns, &s)) {
		tracker_ego_speed(&e->tracker, s.t_ns, s.mps);
	}
	bend(e, now_ns, t);
	tracker_scan(&e->tracker, t);
	e->scan++;
	e->scan_ns = now_ns;
	e->started |= is_radar_fresh(e, now_ns) && is_role_fresh(e, MAP_EGO_SPEED, now_ns);
}

/* Returns 1 if a scan ended: the pending one, because this frame is of the next, or this frame's, by being the last. */
static int take_part(struct estimator *e, const struct decode_frame *d, int64_t t_ns)
{
	const int broken = scan_breaks(&e->pending, d);

	if (broken) {
		end_scan(e, t_ns);
	}
	if (scan_add(&e->pending, d, t_ns)) {
		end_scan(e, t_ns);
		return 1;
	}
	return broken;
}

int estimator_frame(struct estimator *e, const struct bus_frame *f)
{
	int ended = estimator_tick(e, f->t_ns);
	struct decode_frame d;

	if (!decode_take(&e->decode, f, &d)) {
		return ended;
	}
	take_roles(e, &d, f->t_ns);
	if (d.part != MAP_NO_PART) {
		ended |= take_part(e, &d, f->t_ns);
	}
	return ended;
}

int64_t estimator_deadline(const struct estimator *e)
{
	return e->pending.open ? e->pending.last_ns + e->map->scan_gap_ns : CLOCK_NEVER;
}

int estimator_tick(struct estimator *e, int64_t now_ns)
{
	if (!e->pending.open || now_ns < estimator_deadline(e)) {
		return 0;
	}
	end_scan(e, estimator_deadline(e));
	return 1;
}

/* ---- the scene ------------------------------------------------------------------------------ */

static uint32_t faults(const struct estimator *e, int64_t now_ns)
{
	const int64_t radar_ns = clock_s_to_ns(e->cfg->radar_period / 1000);
	uint32_t fault = 0;

	if (!e->started) {
		fault |= FAULT_BIT(STARTING);
	} else {
		fault |= is_role_fresh(e, MAP_EGO_SPEED, now_ns) ? 0 : FAULT_BIT(EGO_STALE);
		fault |= is_radar_fresh(e, now_ns) ? 0 : FAULT_BIT(RADAR_STALE);
	}
	for (int i = 0; i < MAP_MESSAGES_MAX; i++) {
		if (e->decode.message[i].refused >= (uint32_t)e->cfg->bus_stale_periods) {
			fault |= FAULT_BIT(INPUT_CHECK);
		}
	}
	if (now_ns - e->jumped_ns < radar_ns) {
		fault |= FAULT_BIT(IMPLAUSIBLE);
	}
	return fault;
}

/* Neither vehicle drives backwards, and one that stands does not brake any further. */
static void clamp_at_standstill(double x[SCENE_DIM])
{
	const int pair[][2] = {{SCENE_EGO_SPEED, SCENE_EGO_ACCEL},
			       {SCENE_LEAD_SPEED, SCENE_LEAD_ACCEL}};

	for (int i = 0; i < 2; i++) {
		double *v = &x[pair[i][0]], *a = &x[pair[i][1]];

		if (*v <= 0) {
			*v = 0;
			*a = *a > 0 ? *a : 0;
		}
	}
	x[SCENE_HEADWAY] = x[SCENE_HEADWAY] > 0 ? x[SCENE_HEADWAY] : 0;
}

/* A vehicle that stands does not drive off, one that comes to a stop goes on braking: otherwise noise about 0 would let
 * half of a standing car's futures drive away. The filter itself stays free, to see when it does drive off. */
static void hold_if_standing(const struct config *c, struct kalman *k)
{
	const double a = k->x[SCENE_LEAD_ACCEL];

	if (k->x[SCENE_LEAD_SPEED] < c->filter_standing_speed) {
		kalman_set_lead_accel(k, a < 0 ? a : 0, c->filter_standing_sigma);
	}
}

/* The filter at @now_ns, with the ego speeds that it has not seen yet. */
static struct kalman predicted(const struct estimator *e, const struct kalman *from, int64_t now_ns)
{
	const struct config *c = e->cfg;
	struct kalman k = *from;

	for (int i = 0; i < e->speeds.n; i++) {
		const struct speed *speed = speeds_at(&e->speeds, i);

		kalman_predict(&k, speed->t_ns, c->filter_ego_jerk, c->filter_lead_jerk);
		kalman_update(&k, KALMAN_EGO_SPEED, speed->mps, c->filter_ego_sigma);
	}
	kalman_predict(&k, now_ns, c->filter_ego_jerk, c->filter_lead_jerk);
	hold_if_standing(c, &k);
	return k;
}

/* The radar's latency is not known better than to its sigma: what it saw moved on for longer, or for less. */
static void add_latency(const struct config *c, double x[SCENE_DIM],
			double cov[SCENE_DIM][SCENE_DIM])
{
	const double by = c->radar_latency_sigma;
	const double d[SCENE_DIM] = {
		[SCENE_HEADWAY] = (x[SCENE_LEAD_SPEED] - x[SCENE_EGO_SPEED]) * by,
		[SCENE_LEAD_SPEED] = x[SCENE_LEAD_ACCEL] * by,
	};

	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = 0; j < SCENE_DIM; j++) {
			cov[i][j] += d[i] * d[j];
		}
	}
}

static void fill_state(const struct kalman *k, struct scene *s)
{
	for (int i = 0; i < SCENE_DIM; i++) {
		s->x[i] = k->x[i];
		for (int j = 0; j < SCENE_DIM; j++) {
			s->cov[i][j] = k->p[i][j];
		}
	}
	clamp_at_standstill(s->x);
}

/* 1 from @least on, -1 unknown. */
static int pressed(const struct estimator *e, enum map_role role, double least, int64_t now_ns)
{
	return is_role_fresh(e, role, now_ns) ? e->role[role].value >= least : -1;
}

static int64_t oldest_ns(const struct estimator *e, const struct tracker_object *lead,
			 int64_t now_ns)
{
	return now_ns - clock_earlier(e->speeds.last.t_ns, lead ? lead->seen_ns : now_ns);
}

static void fill_others(const struct estimator *e, const struct tracker_object *lead,
			int64_t now_ns, struct scene *s)
{
	const struct perception w = perception_weigh(&e->tracker, lead);

	for (int i = 0; i < SCENE_OTHERS; i++) {
		s->other[i].p = w.p[i];
		if (w.object[i]) {
			struct kalman k = predicted(e, &w.object[i]->k, now_ns);

			clamp_at_standstill(k.x);
			s->other[i].headway_m = k.x[SCENE_HEADWAY];
			s->other[i].speed_mps = k.x[SCENE_LEAD_SPEED];
			s->other[i].accel_mps2 = k.x[SCENE_LEAD_ACCEL];
		}
	}
	s->other[SCENE_HIDDEN].headway_m = s->x[SCENE_HEADWAY] + e->cfg->perception_hidden_gap;
}

static void fill_lead(const struct estimator *e, const struct tracker_object *lead, int64_t now_ns,
		      struct scene *s)
{
	s->lead_valid = 1;
	s->lateral_m = tracker_lateral(&e->tracker, lead);
	s->existence = lead->existence;
	s->lead_id = lead->id;
	s->lead_scans = lead->hits;
	add_latency(e->cfg, s->x, s->cov);
	fill_others(e, lead, now_ns, s);
}

void estimator_scene(struct estimator *e, int64_t now_ns, struct scene *s)
{
	*s = (struct scene){
		.t_ns = now_ns,
		.scan_ns = e->scan_ns,
		.scan = e->scan,
		.fault = faults(e, now_ns),
		.driver_brake = pressed(e, MAP_DRIVER_BRAKE, BRAKE_PRESSED, now_ns),
		.driver_accel = pressed(e, MAP_DRIVER_ACCEL, e->cfg->driver_override, now_ns),
	};
	s->ego_valid = e->tracker.ego_valid && is_role_fresh(e, MAP_EGO_SPEED, now_ns);
	if (!s->ego_valid) {
		return;
	}
	const struct tracker_object *lead =
		is_radar_fresh(e, now_ns) ? tracker_lead(&e->tracker) : NULL;

	const struct kalman k = predicted(e, lead ? &lead->k : &e->tracker.ego, now_ns);

	fill_state(&k, s);
	if (lead) {
		fill_lead(e, lead, now_ns, s);
	}
	s->oldest_input_ns = oldest_ns(e, lead, now_ns);
	s->yaw_rate_radps =
		is_role_fresh(e, MAP_YAW_RATE, now_ns) ? e->role[MAP_YAW_RATE].value : 0;
}

/* ---- life ----------------------------------------------------------------------------------- */

static void forget_times(struct estimator *e)
{
	for (int role = 0; role < MAP_ROLES; role++) {
		for (int i = 0; i < MAP_SPEEDS_MAX; i++) {
			e->role[role].t_ns[i] = DECODE_NEVER;
		}
	}
}

int estimator_open(const struct config *cfg, const struct mapping *map, struct estimator **ret)
{
	struct estimator *e = calloc(1, sizeof(*e));

	if (!e) {
		return -ENOMEM;
	}
	e->cfg = cfg;
	e->map = map;
	e->jumped_ns = DECODE_NEVER;
	decode_open(&e->decode, map, cfg->radar_range_max, cfg->radar_existence_min);
	scan_open(&e->pending, map, cfg->radar_existence_min);
	tracker_open(&e->tracker, cfg);
	restart(e);
	forget_times(e);
	*ret = e;
	return 0;
}

void estimator_distrust(struct estimator *e)
{
	decode_distrust(&e->decode);
	restart(e);
	forget_times(e);
	scan_forget(&e->pending);
}

const uint64_t *estimator_rejected(const struct estimator *e)
{
	return e->decode.rejected;
}

void estimator_close(struct estimator *e)
{
	free(e);
}
