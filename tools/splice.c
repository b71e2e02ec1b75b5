/* SPDX-License-Identifier: MIT
 * Another lead in a recorded drive.
 */
#include "splice.h"
#include "clock.h"

#define SCANS_PER_SLOT 3 /* then ours moves on to the next one, as real ones do */

int splice_open(struct splice *s, const struct config *cfg, const struct mapping *map, double at_s,
		uint64_t seed)
{
	*s = (struct splice){
		.cfg = cfg,
		.map = map,
		.noise.seed = seed,
		.at_s = at_s,
		.first_ns = DECODE_NEVER,
	};
	decode_open(&s->decode, map, cfg->radar_range_max, cfg->radar_existence_min);
	return estimator_open(cfg, map, &s->recorded);
}

void splice_close(struct splice *s)
{
	estimator_close(s->recorded);
}

static void move(struct splice *s, int64_t t_ns)
{
	const double dt = (double)(t_ns - s->t_ns) * 1e-9;
	const double speed = s->lead_mps + SPLICE_ACCEL_MPS2 * dt;
	const double after = speed > 0 ? speed : 0;

	s->gap_m += ((s->lead_mps + after) / 2 - s->ego_mps - s->ego_mps2 * dt / 2) * dt;
	s->lead_mps = after;
	s->ego_mps += s->ego_mps2 * dt;
	s->t_ns = t_ns;
}

/* The radar tells what was the case one latency ago. */
static void look(struct splice *s)
{
	const struct config *c = s->cfg;
	const double ago = c->radar_latency;
	const double accel = (s->lead_mps > 0 ? SPLICE_ACCEL_MPS2 : 0) - s->ego_mps2;
	const double rate = s->lead_mps - s->ego_mps;
	const double a = noise_normal(&s->noise), b = noise_normal(&s->noise);
	const double distance =
		s->gap_m - rate * ago + accel * ago * ago / 2 + c->radar_range_sigma * a;

	s->det = (struct detection){
		.distance_m = distance > 0 ? distance : 0,
		.rate_mps = rate - accel * ago + c->radar_rate_sigma * b,
		.existence = 1,
		.fresh = s->scans % SCANS_PER_SLOT == 0,
	};
}

static void end_of_scan(struct splice *s, int64_t now_ns)
{
	struct scene recorded;

	estimator_scene(s->recorded, now_ns, &recorded);
	if (s->scans == 0) {
		if (!recorded.lead_valid || now_ns - s->first_ns < clock_s_to_ns(s->at_s)) {
			return;
		}
		s->gap_m = recorded.x[SCENE_HEADWAY];
		s->lead_mps = recorded.x[SCENE_LEAD_SPEED];
	} else {
		move(s, now_ns);
	}
	s->t_ns = now_ns;
	s->ego_mps = recorded.x[SCENE_EGO_SPEED];
	s->ego_mps2 = recorded.x[SCENE_EGO_ACCEL];
	s->scans++;
	look(s);
}

static int is_in_the_way(const struct config *c, const struct decode_frame *d)
{
	const double limit = c->radar_corridor + c->radar_corridor_margin;

	return d->target && d->det.lateral_m < limit && d->det.lateral_m > -limit;
}

int splice_frame(struct splice *s, struct bus_frame *f)
{
	const struct bus_frame original = *f;
	struct decode_frame d;

	s->first_ns = s->first_ns == DECODE_NEVER ? f->t_ns : s->first_ns;
	if (decode_take(&s->decode, f, &d) && d.track >= 0 && s->scans > 0) {
		if (d.track == s->scans / SCANS_PER_SLOT % s->map->n_tracks) {
			encode_track(s->map, d.message, &s->det, f);
		} else if (is_in_the_way(s->cfg, &d)) {
			encode_track(s->map, d.message, NULL, f);
		}
	}
	if (estimator_frame(s->recorded, &original)) {
		end_of_scan(s, f->t_ns);
	}
	return s->scans > 0 && s->gap_m <= 0;
}
