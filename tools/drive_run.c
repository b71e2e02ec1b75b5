/* SPDX-License-Identifier: MIT
 * A drive to frames: ego messages on their periods, radar scans as bursts of one frame per slot.
 */
#include <string.h>
#include "clock.h"
#include "drive.h"
#include "noise.h"

#define HISTORY_MS      512                    /* longer than any latency */
#define SLOTS_PER_MS    3                      /* how fast a scan's frames follow each other */
#define EGO_PERIOD_NS   (20 * CLOCK_NS_PER_MS) /* where the mapping gives none */
#define LATERAL_SIGMA_M 0.1
#define BRAKING_MPS2    -1.0 /* more than the engine does */
#define MOVE_SHARE      0.3 /* of scans in which a target changes its slot, as on a recorded drive */

struct run {
	const struct drive *drive;
	const struct config *cfg;
	const struct mapping *map;
	const struct drive_options *opt;
	struct encode encode;
	struct noise noise;
	struct drive_truth now, history[HISTORY_MS];
	int64_t t_ns;
	int64_t due_ns[MAP_MESSAGES_MAX]; /* of ego messages */
	int64_t scan_due_ns;
	int slot[DRIVE_TARGETS_MAX]; /* where each target is reported; -1: not yet */
	struct detection det[MAP_TRACKS_MAX];
	int filled[MAP_TRACKS_MAX];
	int next_slot; /* of the scan being sent; n_tracks: none */
};

static void start(struct run *r)
{
	r->t_ns = DRIVE_START_NS;
	r->now.ego.speed_mps = r->drive->ego.speed_mps;
	for (int i = 0; i < r->drive->n; i++) {
		const struct drive_target *g = &r->drive->target[i];

		r->now.target[i] = (struct drive_car){
			.speed_mps = g->path.speed_mps,
			.gap_m = g->gap_m,
			.lateral_m = g->lateral_m,
		};
		r->slot[i] = -1;
	}
	for (int i = 0; i < HISTORY_MS; i++) {
		r->history[i] = r->now;
	}
	/* the messages of a bus are not in step */
	for (int i = 0; i < r->map->n_messages; i++) {
		r->due_ns[i] = r->t_ns + (i + 1) * CLOCK_NS_PER_MS;
	}
	r->scan_due_ns = r->t_ns + 5 * CLOCK_NS_PER_MS;
	r->next_slot = r->map->n_tracks;
}

static int64_t step_of(const struct run *r)
{
	return (r->t_ns - DRIVE_START_NS) / CLOCK_NS_PER_MS;
}

static int send_message(struct run *r, int message, uint32_t roles, const double *value,
			const struct detection *det)
{
	struct bus_frame f;

	encode_message(&r->encode, message, roles, value, det, r->t_ns, &f);
	return r->opt->emit(r->opt->arg, &f, &r->now);
}

/* ---- the ego's messages --------------------------------------------------------------------- */

static int send_ego(struct run *r, int message)
{
	const struct map_message *m = &r->map->message[message];
	const double noise = r->cfg->filter_ego_sigma * noise_normal(&r->noise);
	const double value[MAP_ROLES] = {
		[MAP_EGO_SPEED] = r->now.ego.speed_mps + noise,
		[MAP_DRIVER_BRAKE] = r->now.ego.accel_mps2 < BRAKING_MPS2,
	};

	r->due_ns[message] += m->period_ns > 0 ? m->period_ns : EGO_PERIOD_NS;
	return send_message(r, message, (1u << MAP_ROLES) - 1, value, NULL);
}

static int send_due_ego(struct run *r)
{
	int ret = 0;

	for (int i = 0; i < r->map->n_messages && !ret; i++) {
		if (r->map->message[i].ego && r->t_ns >= r->due_ns[i]) {
			ret = send_ego(r, i);
		}
	}
	return ret;
}

/* ---- the radar ------------------------------------------------------------------------------ */

static int is_in_corridor(const struct run *r, const struct drive_car *c)
{
	return c->lateral_m <= r->cfg->radar_corridor && c->lateral_m >= -r->cfg->radar_corridor;
}

/* A radar with one slot reports the nearest car in the corridor; -1: none. */
static int single_target(const struct run *r, const struct drive_truth *w)
{
	int best = -1;

	for (int i = 0; i < r->drive->n; i++) {
		if (is_in_corridor(r, &w->target[i]) &&
		    (best < 0 || w->target[i].gap_m < w->target[best].gap_m)) {
			best = i;
		}
	}
	return best;
}

/* The slot a target is reported in; now and then it moves to another. Sets *@fresh when it is new there. */
static int pick_slot(struct run *r, int target, int *fresh)
{
	const int was = r->slot[target];
	const int moves = noise_uniform(&r->noise) < MOVE_SHARE;
	const int other = (int)(noise_uniform(&r->noise) * r->map->n_tracks);
	int slot = was < 0 || moves ? other : was;

	while (r->filled[slot]) {
		slot = (slot + 1) % r->map->n_tracks;
	}
	*fresh = slot != was;
	r->slot[target] = slot;
	return slot;
}

static void report(struct run *r, const struct drive_truth *w, int target)
{
	const struct config *c = r->cfg;
	const struct drive_car *car = &w->target[target];
	const double a = noise_normal(&r->noise), b = noise_normal(&r->noise);
	const double l = noise_normal(&r->noise);
	struct detection det = {
		.distance_m = car->gap_m + c->radar_range_sigma * a,
		.rate_mps = car->speed_mps - w->ego.speed_mps + c->radar_rate_sigma * b,
		.lateral_m = car->lateral_m + LATERAL_SIGMA_M * l,
		.existence = 0.99,
	};

	if (noise_uniform(&r->noise) < r->opt->dropout) {
		return;
	}
	const int slot = r->map->n_tracks > 1 ? pick_slot(r, target, &det.fresh) : 0;

	det.distance_m = det.distance_m > 0 ? det.distance_m : 0;
	r->det[slot] = det;
	r->filled[slot] = 1;
}

static void begin_scan(struct run *r)
{
	const int64_t latency_ms = (int64_t)(r->cfg->radar_latency * 1000 + 0.5);
	const int64_t at = step_of(r) > latency_ms ? step_of(r) - latency_ms : 0;
	const struct drive_truth *seen = &r->history[at % HISTORY_MS];

	memset(r->filled, 0, sizeof(r->filled));
	r->scan_due_ns += clock_s_to_ns(r->cfg->radar_period / 1000);
	r->next_slot = 0;
	if (r->map->n_tracks == 1) {
		const int target = single_target(r, seen);

		if (target >= 0) {
			report(r, seen, target);
		}
		return;
	}
	for (int i = 0; i < r->drive->n; i++) {
		report(r, seen, i);
	}
}

static int send_slots(struct run *r)
{
	int ret = 0;

	for (int i = 0; i < SLOTS_PER_MS && r->next_slot < r->map->n_tracks && !ret; i++) {
		const int slot = r->next_slot++;
		const double none[MAP_ROLES] = {0};

		ret = send_message(r, r->map->track[slot].message, 0, none,
				   r->filled[slot] ? &r->det[slot] : NULL);
	}
	return ret;
}

/* ---- the loop ------------------------------------------------------------------------------- */

static int has_contact(const struct run *r)
{
	for (int i = 0; i < r->drive->n; i++) {
		if (r->now.target[i].gap_m <= 0 && is_in_corridor(r, &r->now.target[i])) {
			return 1;
		}
	}
	return 0;
}

int drive_run(const struct drive *d, const struct config *cfg, const struct mapping *map,
	      const struct drive_options *o)
{
	struct run r = {.drive = d, .cfg = cfg, .map = map, .opt = o, .noise.seed = o->seed};
	int ret = 0;

	encode_open(&r.encode, map);
	start(&r);
	while (!ret && r.now.t_s < d->end_s && !has_contact(&r)) {
		r.history[step_of(&r) % HISTORY_MS] = r.now;
		if (r.t_ns >= r.scan_due_ns) {
			begin_scan(&r);
		}
		ret = send_due_ego(&r);
		ret = ret ? ret : send_slots(&r);
		drive_step(d, &r.now);
		r.t_ns += CLOCK_NS_PER_MS;
	}
	return ret;
}
