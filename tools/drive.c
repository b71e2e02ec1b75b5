/* SPDX-License-Identifier: MIT
 * The table of drives and the cars' motion. Which frames come of it is in drive_run.c.
 */
#include <math.h>
#include <string.h>
#include "drive.h"

#define JERK_MPS3    10.0 /* a hard pedal: 0.5 g within half a second */
#define BRAKING_MPS2 -1.0 /* more than the engine does */
#define KMH(v)       ((v) / 3.6)
#define G(a)         ((a)*9.81)

const struct drive drive_table[] = {
	{
		.name = "brake",
		.doc = "80 km/h, 27 m behind a lead that brakes at 0.55 g after 20 s; the driver "
		       "does nothing",
		.end_s = 40,
		.ego = {KMH(80), {{4, -0.3}, {7, 0.3}, {10, 0}}},
		.n = 1,
		.target = {{
			.gap_m = 27,
			.path = {KMH(80), {{3.5, -0.3}, {6.5, 0.3}, {9.5, 0}, {20, G(-0.55)}}},
			.lateral_m = 0.1,
		}},
	},
	{
		.name = "follow",
		.doc = "100 km/h, 40 m behind a lead that changes its speed gently",
		.end_s = 40,
		.ego = {KMH(100), {{10.7, -0.8}, {14.7, 0}, {20.7, 0.8}, {24.7, 0}}},
		.n = 1,
		.target = {{
			.gap_m = 40,
			.path = {KMH(100), {{10, -0.8}, {14, 0}, {20, 0.8}, {24, 0}}},
			.lateral_m = -0.2,
		}},
	},
	{
		.name = "stopped",
		.doc = "50 km/h towards a car that stands 140 m ahead; the driver does nothing",
		.end_s = 30,
		.ego = {.speed_mps = KMH(50)},
		.n = 1,
		.target = {{.gap_m = 140}},
	},
	{
		.name = "cutin",
		.doc = "100 km/h, a slower car moves in from the left 20 m ahead; the driver eases "
		       "off",
		.end_s = 30,
		.ego = {KMH(100), {{9, -1.5}, {12, 0}}},
		.n = 2,
		.target = {{.gap_m = 70, .path = {.speed_mps = KMH(100)}},
			   {.gap_m = 38,
			    .path = {.speed_mps = KMH(93)},
			    .lateral_m = 3.5,
			    .change_s = 7,
			    .changed_s = 10}},
	},
	{
		.name = "cutout",
		.doc = "80 km/h, the lead leaves to the right and uncovers a slower car; the "
		       "driver eases off",
		.end_s = 30,
		.ego = {KMH(80), {{10, -1.5}, {13, 0}}},
		.n = 2,
		.target = {{.gap_m = 22,
			    .path = {.speed_mps = KMH(80)},
			    .to_lateral_m = -3.5,
			    .change_s = 8,
			    .changed_s = 10.5},
			   {.gap_m = 110, .path = {.speed_mps = KMH(66)}}},
	},
	{
		.name = "light",
		.doc = "80 km/h, 35 m behind a lead that brakes at 0.2 g for 4 s; the driver "
		       "follows 0.9 s later",
		.end_s = 30,
		.ego = {KMH(80), {{10.9, -2.2}, {14.7, 0}}},
		.n = 1,
		.target = {{.gap_m = 35, .path = {KMH(80), {{10, G(-0.2)}, {14, 0}}}}},
	},
	{0},
};

const struct drive *drive_find(const char *name)
{
	for (const struct drive *d = drive_table; d->name; d++) {
		if (!strcmp(d->name, name)) {
			return d;
		}
	}
	return NULL;
}

/* ---- motion --------------------------------------------------------------------------------- */

double drive_accel(const struct drive_path *p, double t_s, double accel_mps2)
{
	double wanted = 0, jerk = JERK_MPS3;

	for (int i = 0; i < DRIVE_PHASES_MAX && p->phase[i].start_s > 0; i++) {
		if (t_s >= p->phase[i].start_s) {
			wanted = p->phase[i].accel_mps2;
			jerk = p->phase[i].jerk_mps3 > 0 ? p->phase[i].jerk_mps3 : JERK_MPS3;
		}
	}
	const double most = jerk * DRIVE_STEP_S, change = wanted - accel_mps2;

	return accel_mps2 + fmax(fmin(change, most), -most);
}

static void step_car(const struct drive_path *p, double t_s, struct drive_car *c)
{
	c->accel_mps2 = drive_accel(p, t_s, c->accel_mps2);
	c->speed_mps += c->accel_mps2 * DRIVE_STEP_S;
	if (c->speed_mps <= 0) {
		c->speed_mps = 0;
		c->accel_mps2 = 0;
	}
}

static double lateral(const struct drive_target *g, double t_s)
{
	if (t_s <= g->change_s || g->changed_s <= g->change_s) {
		return g->lateral_m;
	}
	const double x =
		t_s < g->changed_s ? (t_s - g->change_s) / (g->changed_s - g->change_s) : 1;

	return g->lateral_m + (g->to_lateral_m - g->lateral_m) * x * x * (3 - 2 * x);
}

struct drive_truth drive_begin(const struct drive *d)
{
	struct drive_truth w = {.ego.speed_mps = d->ego.speed_mps};

	for (int i = 0; i < d->n; i++) {
		const struct drive_target *g = &d->target[i];

		w.target[i] = (struct drive_car){
			.speed_mps = g->path.speed_mps,
			.gap_m = g->gap_m,
			.lateral_m = g->lateral_m,
		};
	}
	return w;
}

void drive_others(const struct drive *d, struct drive_truth *w, double ego_before_mps)
{
	for (int i = 0; i < d->n; i++) {
		struct drive_car *c = &w->target[i];
		const double before = c->speed_mps;

		step_car(&d->target[i].path, w->t_s, c);
		c->gap_m += (before + c->speed_mps - ego_before_mps - w->ego.speed_mps) / 2 *
			    DRIVE_STEP_S;
		c->lateral_m = lateral(&d->target[i], w->t_s);
	}
}

void drive_step(const struct drive *d, struct drive_truth *w)
{
	const double ego_before = w->ego.speed_mps;

	w->t_s += DRIVE_STEP_S;
	step_car(&d->ego, w->t_s, &w->ego);
	w->driver_brakes = w->ego.accel_mps2 < BRAKING_MPS2;
	drive_others(d, w, ego_before);
}

int drive_contact(const struct drive *d, const struct drive_truth *w, double corridor_m)
{
	for (int i = 0; i < d->n; i++) {
		const struct drive_car *c = &w->target[i];

		if (!d->target[i].no_obstacle && c->gap_m <= 0 &&
		    fabs(c->lateral_m) <= corridor_m) {
			return i;
		}
	}
	return -1;
}
