/* SPDX-License-Identifier: MIT
 * Verdicts from how targets move: the distance's own change against the relative speed, the drift of standing
 * objects against the yaw rate.
 */
#include <math.h>
#include <stdlib.h>
#include "inputs_checks.h"

#define STRETCHES_MIN 5
#define RATIO_SE_MAX  0.1
#define RATIO_OFF     0.15 /* from a named ratio, and */
#define RATIO_SIGMAS  4.0  /* its standard errors from 1 */
#define SPREAD_MAX    0.35 /* of the ratios, relative: beyond, the signal does not follow at all */
#define STILL_MPS     5.0  /* ego speed from which standing objects are told from leads */
#define PEAK_WIDTH    0.07
#define FULL_DOUBT    0.02
#define BEYOND_DOUBT  0.2
#define BEYOND_WRONG  0.9
#define BEHIND_WRONG  0.01
#define TARGETS_MIN   50
#define MOVES_MIN     0.3
#define MOVES_RATIO   0.3
#define NEAR_M        5.0 /* no radar sees nothing beyond */
#define NEAR_MIN      500
#define SILENT_MPS    2.0
#define SILENT_SHARE  0.2
#define SKIDS_WRONG   0.01
#define DRIFT_MPS     0.3 /* sideways, to be seen at all */
#define DRIFT_OFF     2.0 /* far from the 57 between units */
#define SIDE_MPS2     5.0 /* deg/s read as rad/s: more, except on a dead straight road */
#define SPEC_MAX      (2 * DBC_NAME_MAX + 40)

/* ---- relative speed ---------------------------------------------------------------------------- */

/* What a ratio of said to true speed means. */
static const struct {
	double ratio;
	const char *what, *change;
} ratios[] = {
	{-1, "has the wrong sign", "negate = yes (or no, if it is there already)"},
	{3.6, "looks like km/h read as m/s", "unit = km/h"},
	{1 / 3.6, "looks like m/s read as km/h", "unit = m/s"},
	{-3.6, "has the wrong sign, and looks like km/h read as m/s", "negate = yes, unit = km/h"},
	{-1 / 3.6, "has the wrong sign, and looks like m/s read as km/h",
	 "negate = yes, unit = m/s"},
};

/* How it is where the distance clearly shrinks, or else grows: medians. */
static void example(const struct inputs *in, double *slope, double *said)
{
	const struct stretch_list *l = &in->stretches;
	double *a = malloc((l->n + 1) * sizeof(*a)), *b = malloc((l->n + 1) * sizeof(*b));
	uint32_t n = 0;

	for (int sign = -1; a && b && n == 0 && sign <= 1; sign += 2) {
		for (uint32_t i = 0; i < l->n; i++) {
			if (sign * l->at[i].slope_mps > 1 && !isnan(l->at[i].rate_mps)) {
				a[n] = l->at[i].slope_mps;
				b[n++] = l->at[i].rate_mps;
			}
		}
	}
	*slope = a && b ? stretch_median(a, n).value : NAN;
	*said = a && b ? stretch_median(b, n).value : NAN;
	free(a);
	free(b);
}

static void say_ratio(struct inputs_judge *j, const char *spec, const char *what,
		      const char *change, const struct stretch_median *m)
{
	double slope, said;

	example(j->in, &slope, &said);
	inputs_say(
		j, INPUTS_WRONG, spec,
		"the relative speed %s: where the distance %s by %.1f m/s, the signal says %+.1f "
		"(ratio %.2f +- %.3f, %u stretches of 1 to 2 s)",
		what, slope < 0 ? "shrinks" : "grows", fabs(slope), said, m->value, m->se, m->n);
	inputs_change(j, "[signal rel_speed] %s", change);
}

static void judge_ratio(struct inputs_judge *j, const char *spec, const struct stretch_median *m)
{
	for (size_t i = 0; i < sizeof(ratios) / sizeof(ratios[0]); i++) {
		if (fabs(m->value / ratios[i].ratio - 1) < RATIO_OFF) {
			say_ratio(j, spec, ratios[i].what, ratios[i].change, m);
			return;
		}
	}
	say_ratio(j, spec, "is off by a factor",
		  "or [signal distance]: scale of one of them in the database, or unit", m);
}

/* Does it follow if the car's own speed is taken off? Then it is the target's. */
static int is_absolute(const struct inputs *in)
{
	const struct stretch_median m = stretch_ratio(&in->stretches, 1);

	return m.n >= STRETCHES_MIN && fabs(m.value - 1) < RATIO_OFF && m.spread < SPREAD_MAX;
}

/* The signal says much where the distance changes little. */
static struct stretch_median silent(const struct inputs *in, uint32_t *n_said)
{
	const struct stretch_list *l = &in->stretches;
	double *ratio = malloc((l->n + 1) * sizeof(*ratio));
	uint32_t n = 0;

	for (uint32_t i = 0; ratio && i < l->n; i++) {
		if (fabs(l->at[i].rate_mps) > SILENT_MPS) {
			ratio[n++] = l->at[i].slope_mps / l->at[i].rate_mps;
		}
	}
	*n_said = n;

	const struct stretch_median m = stretch_median(ratio, n);

	free(ratio);
	return m;
}

static void judge_few(struct inputs_judge *j, const char *spec, uint32_t n)
{
	uint32_t n_said;
	const struct stretch_median m = silent(j->in, &n_said);

	if (n_said >= STRETCHES_MIN && fabs(m.value) < SILENT_SHARE) {
		inputs_say(j, INPUTS_WRONG, spec,
			   "in %u stretches of 1 to 2 s it is beyond %g m/s, but the distance "
			   "changes %.2f times as "
			   "fast",
			   n_said, SILENT_MPS, m.value);
		inputs_change(j, "[signal distance] or [signal rel_speed]: from, unit, or scale in "
				 "the database");
		return;
	}
	inputs_say(j, INPUTS_UNTOLD, spec,
		   "not enough data to compare it with the distance: %u stretches of 1 to 2 s in "
		   "which the "
		   "distance clearly changes, %d are needed",
		   n, STRETCHES_MIN);
}

void inputs_check_rel_speed(struct inputs_judge *j)
{
	const struct stretch_median m = stretch_ratio(&j->in->stretches, 0);
	char spec[SPEC_MAX];

	inputs_spec(j->in, INPUTS_REL_SPEED, spec, sizeof(spec));
	if (m.n < STRETCHES_MIN) {
		judge_few(j, spec, m.n);
	} else if (fabs(m.value - 1) < RATIO_OFF && m.spread < SPREAD_MAX) {
		inputs_say(j, INPUTS_GOOD, spec,
			   "the relative speed is the change of the distance (ratio %.2f +- %.2f, "
			   "%u stretches)",
			   m.value, m.se, m.n);
	} else if (is_absolute(j->in)) {
		inputs_say(j, INPUTS_WRONG, spec,
			   "is the target's own speed: less the car's it is the change of the "
			   "distance");
		inputs_change(
			j, "[signal rel_speed] from = a signal of the speed relative to the car");
	} else if (m.spread > SPREAD_MAX * fabs(m.value)) {
		inputs_say(j,
			   m.spread < 1 || fabs(m.value) < SPREAD_MAX ? INPUTS_WRONG : INPUTS_DOUBT,
			   spec,
			   "does not follow the distance (ratio %.2f, most within +- %.2f; %u "
			   "stretches)",
			   m.value, m.spread, m.n);
		inputs_change(j, "[signal rel_speed] or [signal distance] from = another signal, "
				 "or byte order");
	} else if (m.se > RATIO_SE_MAX * fabs(m.value) || fabs(m.value - 1) < RATIO_SIGMAS * m.se) {
		inputs_say(j, INPUTS_UNTOLD, spec,
			   "not enough data: it changes %.2f +- %.2f times as fast as the distance",
			   m.value, m.se);
	} else {
		judge_ratio(j, spec, &m);
	}
}

/* ---- targets ----------------------------------------------------------------------------------- */

/* Do distances live where there should be no target, and not where there should? */
static int is_turned(const struct inputs *in)
{
	const double there = inputs_share(in->invalid_there, in->invalid);
	const double moves = inputs_share(in->invalid_moves, in->invalid);

	return moves > MOVES_MIN && there > MOVES_MIN &&
	       (inputs_share(in->valid_moves, in->valid) < MOVES_RATIO * moves);
}

void inputs_check_valid(struct inputs_judge *j)
{
	const struct inputs *in = j->in;
	const uint64_t all = in->valid + in->invalid;
	char spec[SPEC_MAX];

	if (!inputs_mapped(in, INPUTS_VALID) || all < TARGETS_MIN) {
		return;
	}
	inputs_spec(in, INPUTS_VALID, spec, sizeof(spec));
	if (is_turned(in)) {
		inputs_say(j, INPUTS_WRONG, spec,
			   "the distance changes in %.0f %% of the %llu frames that it calls "
			   "invalid, in %.0f %% of "
			   "the %llu valid ones: turned round?",
			   100 * inputs_share(in->invalid_moves, in->invalid),
			   (unsigned long long)in->invalid,
			   100 * inputs_share(in->valid_moves, in->valid),
			   (unsigned long long)in->valid);
		inputs_change(j, "[signal valid] negate = yes, or from = another signal");
	} else if (!in->valid) {
		inputs_say(j, INPUTS_DOUBT, spec, "never valid in %llu frames: no target",
			   (unsigned long long)all);
		inputs_change(j, "[signal valid] negate or from; or drive behind a car");
	} else if (!inputs_still(in)) {
		inputs_say(j, INPUTS_GOOD, spec, "%.0f %% of %llu frames hold a target",
			   100 * inputs_share(in->valid, all), (unsigned long long)all);
	}
}

static const struct map_signal *distance_of(const struct inputs *in)
{
	return &in->map->track[0].distance;
}

static double full_m(const struct inputs *in)
{
	const struct map_signal *s = distance_of(in);

	return s->gain * (s->sig->scale * ldexp(1.0, s->sig->len) + s->sig->offset) + s->offset;
}

void inputs_check_distance(struct inputs_judge *j)
{
	const struct inputs *in = j->in;
	const double limit = in->cfg->radar_range_max;
	char spec[SPEC_MAX];

	inputs_spec(in, INPUTS_DISTANCE, spec, sizeof(spec));
	if (in->targets < TARGETS_MIN) {
		inputs_say(j, INPUTS_UNTOLD, spec, "not enough data: %llu distances of targets",
			   (unsigned long long)in->targets);
	} else if (inputs_share(in->behind, in->targets) > BEHIND_WRONG) {
		inputs_say(j, INPUTS_WRONG, spec, "%.0f %% of the distances are negative",
			   100 * inputs_share(in->behind, in->targets));
		inputs_change(j, "[signal distance] negate, or sign or byte order in the database");
	} else if (inputs_share(in->beyond, in->targets) > BEYOND_DOUBT) {
		inputs_say(j,
			   inputs_share(in->beyond, in->targets) > BEYOND_WRONG ? INPUTS_WRONG
										: INPUTS_DOUBT,
			   spec, "%.0f %% of the distances are beyond radar.range_max, %g m",
			   100 * inputs_share(in->beyond, in->targets), limit);
		inputs_change(j, "[signal distance] unit (cm, mm?), or radar.range_max");
	} else if (in->targets >= NEAR_MIN && in->far_m < NEAR_M) {
		inputs_say(j, INPUTS_DOUBT, spec, "no target beyond %.2f m in %llu distances",
			   in->far_m, (unsigned long long)in->targets);
		inputs_change(j, "[signal distance] unit, or scale in the database");
	} else if (inputs_share(in->full, in->targets) > FULL_DOUBT && full_m(in) <= limit) {
		inputs_say(j, INPUTS_DOUBT, spec,
			   "at full scale in %.0f %% of the frames: no target?",
			   100 * inputs_share(in->full, in->targets));
		inputs_change(j, "[signal distance] na = 0x%llX",
			      (1ull << (distance_of(in)->sig->len % 64)) - 1);
	} else if (!inputs_stuck(in, INPUTS_DISTANCE) && !inputs_still(in)) {
		inputs_say(j, INPUTS_GOOD, spec, "%llu distances of targets, %.0f %% within %g m",
			   (unsigned long long)in->targets,
			   100 * (1 - inputs_share(in->beyond + in->full, in->targets)), limit);
	}
}

/* ---- turning ----------------------------------------------------------------------------------- */

/* Seen from a car that turns left by w, an object that stands d ahead drifts to the right by w d: ratio 1. */
static struct stretch_median drift(const struct inputs *in)
{
	const struct stretch_list *l = &in->stretches;
	double *ratio = malloc((l->n + 1) * sizeof(*ratio));
	uint32_t n = 0;

	for (uint32_t i = 0; ratio && i < l->n; i++) {
		const struct stretch *s = &l->at[i];
		const double should = -s->yaw_radps * s->distance_m;

		if (s->ego_mps > STILL_MPS && fabs(s->slope_mps / s->ego_mps + 1) < PEAK_WIDTH &&
		    fabs(should) > DRIFT_MPS && !isnan(s->lateral_mps)) {
			ratio[n++] = s->lateral_mps / should;
		}
	}
	const struct stretch_median m = stretch_median(ratio, n);

	free(ratio);
	return m;
}

static double largest(const struct inputs *in, enum inputs_role role)
{
	double max = NAN;

	for (int i = 0; i < in->n_signals; i++) {
		if (in->signal[i].role == role) {
			max = fmax(max, fmax(fabs(in->signal[i].min), fabs(in->signal[i].max)));
		}
	}
	return max;
}

static void judge_yaw(struct inputs_judge *j, const char *spec)
{
	const struct inputs *in = j->in;
	const struct stretch_median m = drift(in);

	if (in->turns >= TARGETS_MIN && inputs_share(in->skids, in->turns) > SKIDS_WRONG) {
		inputs_say(j, INPUTS_WRONG, spec,
			   "times the speed it is more than tyres hold in %.0f %% of the frames: "
			   "looks like deg/s "
			   "read as rad/s",
			   100 * inputs_share(in->skids, in->turns));
		inputs_change(j, "[signal yaw_rate] unit = deg/s");
	} else if (m.n >= STRETCHES_MIN && fabs(m.value) > 1 / DRIFT_OFF &&
		   fabs(m.value) < DRIFT_OFF) {
		inputs_say(j, INPUTS_GOOD, spec,
			   "standing objects drift %.2f times as fast as it says (%u stretches)",
			   fabs(m.value), m.n);
	} else if (in->bends >= TARGETS_MIN && in->side_mps2 < SIDE_MPS2) {
		inputs_say(j, INPUTS_GOOD, spec,
			   "times the speed up to %.1f m/s2, as cars take bends", in->side_mps2);
	} else {
		inputs_say(j, INPUTS_UNTOLD, spec,
			   "not enough data to check its unit: up to %.2f deg/s, %.2g m/s2 "
			   "sideways: is that right?",
			   largest(in, INPUTS_YAW_RATE) * 180 / M_PI, in->side_mps2);
	}
}

void inputs_check_yaw_unit(struct inputs_judge *j)
{
	char spec[SPEC_MAX];

	if (!isnan(largest(j->in, INPUTS_YAW_RATE)) && !inputs_stuck(j->in, INPUTS_YAW_RATE)) {
		judge_yaw(j, inputs_spec(j->in, INPUTS_YAW_RATE, spec, sizeof(spec)));
	}
}

void inputs_check_lateral(struct inputs_judge *j)
{
	char spec[SPEC_MAX];

	if (!inputs_mapped(j->in, INPUTS_LATERAL)) {
		return;
	}
	const struct stretch_median m = drift(j->in);

	inputs_spec(j->in, INPUTS_LATERAL, spec, sizeof(spec));
	if (m.n < STRETCHES_MIN || fabs(m.value) < RATIO_SIGMAS * m.se) {
		inputs_say(j, INPUTS_UNTOLD, spec,
			   "not enough data to check its sign: %u stretches of standing objects in "
			   "a bend%s",
			   m.n,
			   inputs_mapped(j->in, INPUTS_YAW_RATE) ? "" : ", no yaw rate is mapped");
	} else if (m.value < 0) {
		inputs_say(j, INPUTS_WRONG, spec,
			   "in bends standing objects drift to the wrong side: its sign or that of "
			   "the yaw rate "
			   "is wrong (ratio %.2f +- %.3f, %u stretches)",
			   m.value, m.se, m.n);
		inputs_change(j, "negate = yes in [signal lateral] or in [signal yaw_rate]: both "
				 "are positive to "
				 "the left");
	} else {
		inputs_say(j, INPUTS_GOOD, spec,
			   "in bends standing objects drift as the yaw rate says (ratio %.2f +- "
			   "%.2f, %u stretches)",
			   m.value, m.se, m.n);
	}
}
