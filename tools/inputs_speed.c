/* SPDX-License-Identifier: MIT
 * Is the speed of the car in the unit it is read in? Against other speed signals, standing objects, and what cars can do.
 */
#include <math.h>
#include <string.h>
#include "inputs_checks.h"

#define STRETCHES_MIN 5
#define STILL_MPS     5.0 /* ego speed from which standing objects are told from leads */
#define PEAK_WIDTH    0.07
#define PEAK_RATIO    5.0 /* of standing objects, to their neighbourhood */
#define PEAK_MIN      20
#define SPEED_MAX     70.0 /* m/s */
#define SPEED_DOUBT   50.0
#define OTHERS_MIN    50
#define OTHERS_OFF    0.2
#define OTHERS_CORR   0.98
#define OTHERS_SIGMA  1.0 /* m/s of variation, to correlate at all */
#define SPEC_MAX      (2 * DBC_NAME_MAX + 40)

/* How many stretches look like objects that stand, if the true speed is @factor times what is said; and how many are
 * beside that, in a band as wide. */
static int standing(const struct inputs *in, double factor, int *beside)
{
	const struct stretch_list *l = &in->stretches;
	int n = 0, b = 0;

	for (uint32_t i = 0; i < l->n; i++) {
		const struct stretch *s = &l->at[i];
		const double off = -s->slope_mps / (s->ego_mps * factor) - 1;

		if (s->ego_mps * factor > STILL_MPS &&
		    s->slope_se_mps < 0.25 * fabs(s->slope_mps)) {
			n += fabs(off) < PEAK_WIDTH;
			b += fabs(off) >= PEAK_WIDTH && fabs(off) < 2 * PEAK_WIDTH;
		}
	}
	*beside = b;
	return n;
}

static int is_peak(const struct inputs *in, double factor)
{
	int beside, n = standing(in, factor, &beside);

	return n >= PEAK_MIN && n > PEAK_RATIO * beside ? n : 0;
}

/* Ratio of another speed signal of the car to the mapped one; NaN if they do not go together. */
static double ratio_of(const struct inputs_other *o)
{
	const double n = (double)o->n;
	const double xx = o->xx - o->x * o->x / n, yy = o->yy - o->y * o->y / n;
	const double xy = o->xy - o->x * o->y / n;

	if (o->n < OTHERS_MIN || xx < n * OTHERS_SIGMA * OTHERS_SIGMA ||
	    !(xy > OTHERS_CORR * sqrt(xx * yy))) {
		return NAN;
	}
	return o->y / o->x;
}

static void say_other(struct inputs_judge *j, const char *spec, const struct inputs_other *o)
{
	const double n = (double)o->n, ratio = o->y / o->x;
	const char *unit = fabs(ratio * 3.6 - 1) < PEAK_WIDTH   ? "km/h"
			   : fabs(ratio / 3.6 - 1) < PEAK_WIDTH ? "m/s"
								: NULL;

	inputs_say(j, INPUTS_WRONG, spec,
		   "looks like %s: on average it says %.1f m/s, %s.%s at the same time %.1f",
		   !unit                  ? "another unit"
		   : !strcmp(unit, "m/s") ? "m/s read as km/h"
					  : "km/h read as m/s",
		   o->x / n, o->msg->name, o->sig->name, o->y / n);
	inputs_change(j, "[signal ego_speed] unit = %s",
		      unit ? unit : "..., or the scale of either in the database");
}

static int judge_others(struct inputs_judge *j, const char *spec)
{
	for (int i = 0; i < j->in->n_others; i++) {
		if (fabs(ratio_of(&j->in->other[i]) - 1) > OTHERS_OFF) {
			say_other(j, spec, &j->in->other[i]);
			return 1;
		}
	}
	return 0;
}

static int judge_standing(struct inputs_judge *j, const char *spec)
{
	static const struct {
		double factor;
		const char *what, *unit;
	} rows[] = {{1 / 3.6, "km/h read as m/s", "km/h"}, {3.6, "m/s read as km/h", "m/s"}};

	for (size_t i = 0; i < 2 && !is_peak(j->in, 1); i++) {
		const int n = is_peak(j->in, rows[i].factor);

		if (n) {
			inputs_say(j, INPUTS_WRONG, spec,
				   "looks like %s: %d stretches of targets come closer at %.2f "
				   "times that speed, as "
				   "standing objects would",
				   rows[i].what, n, rows[i].factor);
			inputs_change(j, "[signal ego_speed] unit = %s", rows[i].unit);
			return 1;
		}
	}
	return 0;
}

static double fastest(const struct inputs *in)
{
	double max = 0;

	for (int i = 0; i < in->n_signals; i++) {
		if (in->signal[i].role == INPUTS_EGO_SPEED && in->signal[i].max > max) {
			max = in->signal[i].max;
		}
	}
	return max;
}

static int judge_plausible(struct inputs_judge *j, const char *spec)
{
	const struct inputs *in = j->in;
	const double max = fastest(in);

	if (max > SPEED_MAX || (in->pulls >= STRETCHES_MIN && in->hard_pulls >= 3)) {
		inputs_say(j, INPUTS_WRONG, spec,
			   "up to %.1f m/s (%.0f km/h), changing by up to %.1f m/s2: looks like "
			   "km/h read as m/s",
			   max, max * 3.6, in->accel_mps2);
		inputs_change(j, "[signal ego_speed] unit = km/h, or its scale or byte order in "
				 "the database");
		return 1;
	}
	return 0;
}

/* A second speed signal that agrees, or NULL. */
static const struct inputs_other *agrees(const struct inputs *in)
{
	for (int i = 0; i < in->n_others; i++) {
		if (fabs(ratio_of(&in->other[i]) - 1) < PEAK_WIDTH) {
			return &in->other[i];
		}
	}
	return NULL;
}

void inputs_check_speed_unit(struct inputs_judge *j)
{
	const struct inputs_other *same = agrees(j->in);
	const int still = is_peak(j->in, 1);
	char spec[SPEC_MAX];

	inputs_spec(j->in, INPUTS_EGO_SPEED, spec, sizeof(spec));
	if (judge_others(j, spec) || judge_standing(j, spec) || judge_plausible(j, spec)) {
		return;
	}
	if (still) {
		inputs_say(j, INPUTS_GOOD, spec,
			   "%d stretches of standing objects come closer at just this speed",
			   still);
	} else if (same) {
		inputs_say(j, INPUTS_GOOD, spec, "agrees with %s.%s", same->msg->name,
			   same->sig->name);
	} else if (fastest(j->in) > SPEED_DOUBT) {
		inputs_say(j, INPUTS_DOUBT, spec,
			   "up to %.1f m/s (%.0f km/h), and no standing object and no second speed "
			   "signal to check that: km/h or mph read as m/s?",
			   fastest(j->in), fastest(j->in) * 3.6);
		inputs_change(j, "[signal ego_speed] unit = km/h or mph; or leave it, if it was "
				 "so fast");
	} else {
		inputs_say(j, INPUTS_UNTOLD, spec,
			   "not enough data to check its unit: no standing object and no second "
			   "speed signal; "
			   "up to %.1f m/s (%.0f km/h), is that right?",
			   fastest(j->in), fastest(j->in) * 3.6);
	}
}
