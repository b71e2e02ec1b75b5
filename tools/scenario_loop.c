/* SPDX-License-Identifier: MIT
 * The world of a closed loop.
 */
#include "scenario_loop.h"
#include <errno.h>
#include <math.h>
#include "clock.h"
#include "codec.h"

#define DRIVER_MPS2    (-0.4 * 9.81) /* FMVSS 127: 0.4 g on average */
#define DRIVER_JERK    25.0          /* so reached in 0.16 s */
#define ATTENTION_S    0.7           /* from what the lead does to what the attentive driver does */
#define ATTENTION_PS   0.6           /* how he closes a difference in speed */
#define ATTENTION_PS2  0.12          /* and one in headway */
#define ATTENTION_MPS2 -6.0          /* the hardest he brakes */
#define STAND_END_S    0.5

/* Cars that begin at the ego's speed are in its convoy: they begin at its drawn speed too. */
static struct drive at_speed(const struct drive *d, double more_mps)
{
	struct drive own = *d;

	for (int i = 0; i < own.n; i++) {
		if (own.target[i].path.speed_mps == own.ego.speed_mps) {
			own.target[i].path.speed_mps += more_mps;
		}
	}
	own.ego.speed_mps += more_mps;
	return own;
}

void scenario_loop_open(struct scenario_loop *l, const struct config *cfg,
			const struct mapping *map, const struct scenario *row,
			const struct scenario_draw *d)
{
	*l = (struct scenario_loop){
		.cfg = cfg,
		.row = row,
		.drive = at_speed(&row->drive, d->speed_mps),
		.reaction_s = d->reaction_s,
		.result = {.closest_m = NAN, .warn_s = NAN, .partial_s = NAN, .full_s = NAN},
	};
	l->now = drive_begin(&l->drive);
	plant_open(&l->plant, cfg, &d->car);
	sensors_open(&l->sensors, &l->drive, map, &d->sensors);
}

/* ---- the driver ------------------------------------------------------------------------------ */

static double limited(double wanted, double was, double jerk)
{
	const double most = jerk * DRIVE_STEP_S;

	return was + fmax(fmin(wanted - was, most), -most);
}

static double attentive(const struct scenario_loop *l)
{
	const struct drive_truth *seen = sensors_past(&l->sensors, ATTENTION_S);
	const struct drive_target *lead = &l->drive.target[0];
	const double headway_s = lead->gap_m / fmax(l->drive.ego.speed_mps, 3);
	const double wanted_m = fmax(headway_s * seen->ego.speed_mps, 3);
	const double wanted = seen->target[0].accel_mps2 +
			      ATTENTION_PS * (seen->target[0].speed_mps - seen->ego.speed_mps) +
			      ATTENTION_PS2 * (seen->target[0].gap_m - wanted_m);

	return fmax(fmin(wanted, 2), ATTENTION_MPS2);
}

static double driver(const struct scenario_loop *l)
{
	const double since_s = l->now.t_s - l->result.warn_s;

	if (l->row->driver == DRIVER_ATTENTIVE) {
		return limited(attentive(l), l->driver_mps2, 10);
	}
	if (l->row->driver == DRIVER_WARNED && since_s >= l->reaction_s) {
		return limited(DRIVER_MPS2, l->driver_mps2, DRIVER_JERK);
	}
	return drive_accel(&l->drive.ego, l->now.t_s, l->driver_mps2);
}

/* ---- what is noted --------------------------------------------------------------------------- */

static void note_gaps(struct scenario_loop *l)
{
	struct scenario_result *r = &l->result;
	const int hit = drive_contact(&l->drive, &l->now, l->cfg->radar_corridor);

	for (int i = 0; i < l->drive.n; i++) {
		const struct drive_car *c = &l->now.target[i];

		if (!l->drive.target[i].no_obstacle && c->gap_m >= 0 &&
		    fabs(c->lateral_m) <= l->cfg->radar_corridor) {
			r->closest_m =
				fmin(r->closest_m, c->gap_m); /* of NaN and a number: the number */
		}
	}
	if (hit >= 0) {
		r->contact = 1;
		r->closest_m = 0;
		r->impact_mps = fmax(l->now.ego.speed_mps - l->now.target[hit].speed_mps, 0);
	}
}

static void note_deceleration(struct scenario_loop *l)
{
	struct scenario_result *r = &l->result;
	double *peak = isnan(scenario_first(r)) ? &r->peak_before_mps2 : &r->peak_after_mps2;

	*peak = fmax(*peak, -l->now.ego.accel_mps2);
}

static void enter(double now_s, double *first_s, unsigned *n)
{
	*first_s = isnan(*first_s) ? now_s : *first_s;
	++*n;
}

static void note_stage(struct scenario_loop *l, int stage)
{
	struct scenario_result *r = &l->result;

	if (stage == l->stage) {
		return;
	}
	l->stage = stage;
	if (stage == AEB_REQUEST_STAGE_WARN) {
		enter(l->now.t_s, &r->warn_s, &r->warn);
	} else if (stage == AEB_REQUEST_STAGE_PARTIAL && !l->deaf) {
		enter(l->now.t_s, &r->partial_s, &r->partial);
	} else if (stage == AEB_REQUEST_STAGE_FULL && !l->deaf) {
		enter(l->now.t_s, &r->full_s, &r->full);
	}
}

void scenario_loop_hear(struct scenario_loop *l, const struct bus_frame *f, int64_t now_ns)
{
	plant_receive(&l->plant, f, now_ns);
	note_stage(l, l->plant.stage);
	if (l->deaf) {
		plant_ask(&l->plant, l->asked_mps2);
	}
}

void scenario_loop_ask(struct scenario_loop *l, double accel_mps2)
{
	if (accel_mps2 < 0 && l->asked_mps2 == 0) {
		enter(l->now.t_s, &l->result.full_s, &l->result.full);
	}
	l->asked_mps2 = accel_mps2;
	plant_ask(&l->plant, accel_mps2);
}

/* ---- the step -------------------------------------------------------------------------------- */

static void move(struct scenario_loop *l)
{
	const double before = l->now.ego.speed_mps;

	l->now.t_s += DRIVE_STEP_S;
	l->driver_mps2 = driver(l);
	l->now.driver_brakes = l->driver_mps2 < -1;
	plant_step(&l->plant, l->sensors.t_ns, l->driver_mps2, &l->now.ego);
	drive_others(&l->drive, &l->now, before);
	l->stood_s = l->now.ego.speed_mps > 0 ? 0 : l->stood_s + DRIVE_STEP_S;
	note_gaps(l);
	note_deceleration(l);
}

static int is_over(const struct scenario_loop *l)
{
	const int stopped = l->stood_s > STAND_END_S && l->row->driver != DRIVER_ATTENTIVE;

	return l->result.contact || stopped || l->now.t_s >= l->drive.end_s;
}

int scenario_loop_step(struct scenario_loop *l, sensors_emit emit, void *arg)
{
	if (l->sensors.t_ns > DRIVE_START_NS) {
		move(l);
	}
	return is_over(l) ? -ENODATA : sensors_step(&l->sensors, &l->now, emit, arg);
}

double scenario_first(const struct scenario_result *r)
{
	return fmin(r->partial_s, r->full_s); /* of NaN and a number: the number */
}

int scenario_passed(const struct scenario *row, const struct scenario_result *r)
{
	switch (row->goal) {
	case GOAL_NO_CONTACT:
		return !r->contact;
	case GOAL_NO_REQUEST:
		return !r->partial && !r->full && !r->contact;
	case GOAL_UNKNOWABLE:
		return !r->partial && !r->full;
	default:
		return 1;
	}
}
