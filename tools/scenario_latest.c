/* SPDX-License-Identifier: MIT
 * The physical limit of a row: until when can braking still avoid contact?
 */
#include <math.h>
#include "scenario.h"

#define STEPS 20 /* halvings: below a millisecond */

/* Contact if full braking is asked for at @at_s? The driver keeps his foot where it is. */
static int collides(const struct config *cfg, const struct scenario *row,
		    const struct scenario_draw *d, double at_s)
{
	struct drive_truth w = drive_begin(&row->drive);
	struct plant p;

	plant_open(&p, cfg, &d->car);
	while (w.t_s < row->drive.end_s &&
	       drive_contact(&row->drive, &w, cfg->radar_corridor) < 0) {
		const double before = w.ego.speed_mps;

		plant_ask(&p, w.t_s >= at_s ? cfg->brake_accel : 0);
		w.t_s += DRIVE_STEP_S;
		plant_step(&p, 0, 0, &w.ego);
		drive_others(&row->drive, &w, before);
	}
	return drive_contact(&row->drive, &w, cfg->radar_corridor) >= 0;
}

double scenario_latest(const struct config *cfg, const struct scenario *row)
{
	struct scenario_draw d = scenario_draw(cfg, row, 0, 0);
	double good_s = row->onset_s, bad_s = row->drive.end_s;

	d.car.delay_s = 0;
	if (!collides(cfg, row, &d, bad_s)) {
		return INFINITY;
	}
	if (collides(cfg, row, &d, good_s)) {
		return NAN;
	}
	for (int i = 0; i < STEPS; i++) {
		const double mid_s = (good_s + bad_s) / 2;

		*(collides(cfg, row, &d, mid_s) ? &bad_s : &good_s) = mid_s;
	}
	return good_s - row->onset_s;
}
