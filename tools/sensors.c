/* SPDX-License-Identifier: MIT
 * Ego messages on their periods, radar scans as bursts of one frame per slot.
 */
#include "sensors.h"
#include <math.h>
#include <string.h>
#include "clock.h"

#define FRAMES_PER_MS   3                      /* how fast a scan's frames follow each other */
#define EGO_PERIOD_NS   (20 * CLOCK_NS_PER_MS) /* where the mapping gives none */
#define LATERAL_SIGMA_M 0.1
#define EXISTENCE       0.99
#define MOVE_SHARE      0.3 /* of scans in which a target changes its slot, as on a recorded drive */

struct sensors_params sensors_nominal(const struct config *cfg, uint64_t seed)
{
	return (struct sensors_params){
		.seed = seed,
		.range_sigma_m = cfg->radar_range_sigma,
		.rate_sigma_mps = cfg->radar_rate_sigma,
		.ego_sigma_mps = cfg->filter_ego_sigma,
		.latency_s = cfg->radar_latency,
		.period_s = cfg->radar_period / 1000,
		.ego_scale = 1,
		.corridor_m = cfg->radar_corridor,
	};
}

void sensors_open(struct sensors *s, const struct drive *d, const struct mapping *map,
		  const struct sensors_params *p)
{
	const struct drive_truth start = drive_begin(d);

	*s = (struct sensors){.drive = d, .map = map, .p = *p, .noise.seed = p->seed};
	encode_open(&s->encode, map);
	s->t_ns = DRIVE_START_NS;
	for (int i = 0; i < d->n; i++) {
		s->slot[i] = -1;
		s->rate_mps[i] = start.target[i].speed_mps - start.ego.speed_mps;
	}
	for (int i = 0; i < SENSORS_HISTORY_MS; i++) {
		s->history[i] = start;
	}
	/* the messages of a bus are not in step */
	for (int i = 0; i < map->n_messages; i++) {
		s->due_ns[i] = s->t_ns + (i + 1) * CLOCK_NS_PER_MS;
	}
	s->scan_due_ns = s->t_ns + 5 * CLOCK_NS_PER_MS;
}

static int64_t step_of(const struct sensors *s)
{
	return (s->t_ns - DRIVE_START_NS) / CLOCK_NS_PER_MS;
}

static const struct drive_truth *past(const struct sensors *s, double ago_s)
{
	const int64_t ago_ms = (int64_t)(ago_s * 1000 + 0.5);
	const int64_t at = step_of(s) > ago_ms ? step_of(s) - ago_ms : 0;

	return &s->history[at % SENSORS_HISTORY_MS];
}

static int send_message(struct sensors *s, int message, uint32_t roles, const double *value,
			const struct detection *det)
{
	struct bus_frame f;

	encode_message(&s->encode, message, roles, value, det, s->t_ns, &f);
	return s->emit(s->arg, &f, past(s, 0));
}

/* ---- the ego's messages --------------------------------------------------------------------- */

static int send_ego(struct sensors *s, int message)
{
	const struct map_message *m = &s->map->message[message];
	const struct drive_truth *w = past(s, s->p.ego_latency_s);
	const double noise = s->p.ego_sigma_mps * noise_normal(&s->noise);
	const double value[MAP_ROLES] = {
		[MAP_EGO_SPEED] = w->ego.speed_mps * s->p.ego_scale + noise,
		[MAP_YAW_RATE] = w->ego.speed_mps * s->drive->curvature_pm,
		[MAP_DRIVER_BRAKE] = w->driver_brakes,
	};

	s->due_ns[message] += m->period_ns > 0 ? m->period_ns : EGO_PERIOD_NS;
	return send_message(s, message, (1u << MAP_ROLES) - 1, value, NULL);
}

static int send_due_ego(struct sensors *s)
{
	int ret = 0;

	for (int i = 0; i < s->map->n_messages && !ret; i++) {
		if (s->map->message[i].ego && s->t_ns >= s->due_ns[i]) {
			ret = send_ego(s, i);
		}
	}
	return ret;
}

/* ---- the radar ------------------------------------------------------------------------------ */

static int has_slots(const struct sensors *s)
{
	return s->map->list.header < 0;
}

static int is_in_view(const struct sensors *s, const struct drive_truth *w, int target)
{
	const struct drive_target *g = &s->drive->target[target];
	const double gap_m = w->target[target].gap_m;

	return !(g->seen_m > 0 && gap_m > g->seen_m) && gap_m >= g->lost_m;
}

/* A radar with one slot reports the nearest car in the corridor; -1: none. */
static int single_target(const struct sensors *s, const struct drive_truth *w)
{
	int best = -1;

	for (int i = 0; i < s->drive->n; i++) {
		if (is_in_view(s, w, i) && fabs(w->target[i].lateral_m) <= s->p.corridor_m &&
		    (best < 0 || w->target[i].gap_m < w->target[best].gap_m)) {
			best = i;
		}
	}
	return best;
}

/* The slot a target is reported in; now and then it moves to another. Sets *@fresh when it is new there. */
static int pick_slot(struct sensors *s, int target, int *fresh)
{
	const int was = s->slot[target];
	const int moves = noise_uniform(&s->noise) < MOVE_SHARE;
	const int other = (int)(noise_uniform(&s->noise) * s->map->n_tracks);
	int slot = was < 0 || moves ? other : was;

	while (s->filled[slot]) {
		slot = (slot + 1) % s->map->n_tracks;
	}
	*fresh = slot != was;
	s->slot[target] = slot;
	return slot;
}

/* Noise is drawn for a target that is missed too: what is seen does not depend on what was not. */
static struct detection measure(struct sensors *s, const struct drive_truth *w, int target)
{
	const struct drive_target *g = &s->drive->target[target];
	const struct drive_car *car = &w->target[target];
	const double a = noise_normal(&s->noise), b = noise_normal(&s->noise);
	const double l = noise_normal(&s->noise);
	struct detection det = {
		.distance_m = fmax(car->gap_m + s->p.range_sigma_m * a, 0),
		.rate_mps = s->rate_mps[target] + s->p.rate_sigma_mps * b,
		.lateral_m = car->lateral_m + s->drive->curvature_pm / 2 * car->gap_m * car->gap_m +
			     LATERAL_SIGMA_M * l,
		.existence = g->existence > 0 ? g->existence : EXISTENCE,
		.distance_sigma_m = s->p.range_sigma_m,
		.rate_sigma_mps = s->p.rate_sigma_mps,
	};

	return det;
}

static int is_missed(struct sensors *s, int target)
{
	const double again = s->missed[target] ? s->p.burst : 0;
	const double least = fmax(s->p.dropout, again);
	const double own = s->drive->target[target].missed;

	s->missed[target] = noise_uniform(&s->noise) < least + (1 - least) * own;
	return s->missed[target];
}

static void report(struct sensors *s, const struct drive_truth *w, int target)
{
	struct detection det = measure(s, w, target);

	if (is_missed(s, target) || !is_in_view(s, w, target)) {
		return;
	}
	if (!has_slots(s)) {
		det.id = (uint32_t)target;
		s->det[s->n_listed++] = det;
		return;
	}
	const int slot = s->map->n_tracks > 1 ? pick_slot(s, target, &det.fresh) : 0;

	s->det[slot] = det;
	s->filled[slot] = 1;
}

/* A header, the objects, then their quality; or every slot. */
static int count_frames(const struct sensors *s)
{
	const int each = s->map->list.quality >= 0 ? 2 : 1;

	return has_slots(s) ? s->map->n_tracks : 1 + each * s->n_listed;
}

static void begin_scan(struct sensors *s)
{
	const struct drive_truth *seen = past(s, s->p.latency_s);

	memset(s->filled, 0, sizeof(s->filled));
	s->scan_due_ns += clock_s_to_ns(s->p.period_s);
	s->next_frame = s->n_listed = 0;
	if (has_slots(s) && s->map->n_tracks == 1) {
		const int target = single_target(s, seen);

		if (target >= 0) {
			report(s, seen, target);
		}
	} else {
		for (int i = 0; i < s->drive->n; i++) {
			report(s, seen, i);
		}
	}
	s->n_frames = count_frames(s);
}

static int send_header(struct sensors *s)
{
	struct bus_frame f;

	encode_header(&s->encode, s->n_listed, s->t_ns, &f);
	return s->emit(s->arg, &f, past(s, 0));
}

/* The @i-th frame of a scan. */
static int send_scan(struct sensors *s, int i)
{
	const double none[MAP_ROLES] = {0};

	if (has_slots(s)) {
		return send_message(s, s->map->track[i].message, 0, none,
				    s->filled[i] ? &s->det[i] : NULL);
	}
	if (i == 0) {
		return send_header(s);
	}
	if (i <= s->n_listed) {
		const int slot = s->map->list.id.sig ? 0 : i - 1;

		return send_message(s, s->map->track[slot].message, 0, none, &s->det[i - 1]);
	}
	return send_message(s, s->map->list.quality, 0, none, &s->det[i - 1 - s->n_listed]);
}

static int send_due_radar(struct sensors *s)
{
	int ret = 0;

	for (int i = 0; i < FRAMES_PER_MS && s->next_frame < s->n_frames && !ret; i++) {
		ret = send_scan(s, s->next_frame++);
	}
	return ret;
}

/* ---- the step ------------------------------------------------------------------------------- */

/* The relative speed as it was measured when the next frame's content was, through the radar's own filter. */
static void follow_rates(struct sensors *s)
{
	const struct drive_truth *seen = past(s, s->p.latency_s);
	const double share = s->p.rate_lag_s > DRIVE_STEP_S ? DRIVE_STEP_S / s->p.rate_lag_s : 1;

	for (int i = 0; i < s->drive->n; i++) {
		const double rate = seen->target[i].speed_mps - seen->ego.speed_mps;

		s->rate_mps[i] =
			share < 1 ? s->rate_mps[i] + share * (rate - s->rate_mps[i]) : rate;
	}
}

int sensors_step(struct sensors *s, const struct drive_truth *now, sensors_emit emit, void *arg)
{
	s->emit = emit;
	s->arg = arg;
	s->history[step_of(s) % SENSORS_HISTORY_MS] = *now;
	follow_rates(s);
	if (s->t_ns >= s->scan_due_ns) {
		begin_scan(s);
	}
	int ret = send_due_ego(s);

	ret = ret ? ret : send_due_radar(s);
	s->t_ns += CLOCK_NS_PER_MS;
	return ret;
}

const struct drive_truth *sensors_past(const struct sensors *s, double ago_s)
{
	return past(s, ago_s + DRIVE_STEP_S);
}

/* ---- a drive by itself ---------------------------------------------------------------------- */

int drive_run(const struct drive *d, const struct config *cfg, const struct mapping *map,
	      const struct drive_options *o)
{
	struct sensors_params p = sensors_nominal(cfg, o->seed);
	struct drive_truth now = drive_begin(d);
	struct sensors s;
	int ret = 0;

	p.dropout = o->dropout;
	sensors_open(&s, d, map, &p);
	while (!ret && now.t_s < d->end_s && drive_contact(d, &now, cfg->radar_corridor) < 0) {
		ret = sensors_step(&s, &now, o->emit, o->arg);
		drive_step(d, &now);
	}
	return ret;
}
