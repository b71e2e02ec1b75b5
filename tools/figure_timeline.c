/* SPDX-License-Identifier: MIT
 * The picture of a replay: speed, distance, risk, request, stage and state against one time axis.
 */
#include <math.h>
#include <string.h>
#include "decision.h"
#include "fault.h"
#include "figure.h"

#define MARKS_MAX \
	12 /* rises of the stage drawn through all panels; of more nothing could be told */

enum lane { LANE_STAGE, LANE_STATE, LANES };
static const char *const lane_name[LANES] = {"stage", "state"};

static const enum svg_colour level_colour[LEVELS] = {[LEVEL_NONE] = SVG_GREY,
						     [LEVEL_WARN] = SVG_AMBER,
						     [LEVEL_PARTIAL] = SVG_RED,
						     [LEVEL_FULL] = SVG_PURPLE};
static const enum svg_colour state_colour[STATES] = {
	[STATE_INIT] = SVG_GREY,      [STATE_ARMED] = SVG_GREEN, [STATE_BRAKE] = SVG_PURPLE,
	[STATE_DEGRADED] = SVG_AMBER, [STATE_INHIBIT] = SVG_SKY, [STATE_FAULT] = SVG_RED};

static size_t place(const char *word, const char *const *names, size_t n)
{
	size_t i = 0;

	while (i + 1 < n && strcmp(word, names[i]) != 0) {
		i++;
	}
	return i;
}

/* ---- panels ------------------------------------------------------------------------------------ */

/* One line for each lead: a new one is not a jump of the old. */
static void draw_by_lead(struct svg *s, enum svg_colour c, const struct figure_timeline *t,
			 const double *v)
{
	for (size_t i = 0, end; i < t->n; i = end) {
		for (end = i + 1; end < t->n && t->lead[end] == t->lead[i];) {
			end++;
		}
		svg_line(s, c, SVG_SOLID, t->time_s + i, v + i, end - i);
	}
}

static void draw_rises(struct svg *s, const struct figure_timeline *t)
{
	int rises = 0;

	for (size_t i = 1; i < t->n; i++) {
		rises += place(t->level[i], level_name, LEVELS) >
			 place(t->level[i - 1], level_name, LEVELS);
	}
	for (size_t i = 1; i < t->n && rises <= MARKS_MAX; i++) {
		if (place(t->level[i], level_name, LEVELS) >
		    place(t->level[i - 1], level_name, LEVELS)) {
			svg_mark(s, SVG_GREY, t->time_s[i], NULL);
		}
	}
}

static void open_panel(struct svg *s, const struct figure_timeline *t, struct svg_panel *p)
{
	p->x = (struct svg_axis){.label = p->x.label,
				 .min = t->from_s,
				 .max = t->to_s,
				 .gap = svg_gap(t->time_s, t->n)};
	svg_panel(s, p);
	if (p->y.scale != SVG_NAMES) {
		draw_rises(s, t);
	}
}

static void draw_speed(struct svg *s, const struct figure_timeline *t)
{
	static const struct svg_key key[] = {{SVG_BLUE, SVG_KEY_LINE, "ego"},
					     {SVG_RED, SVG_KEY_LINE, "lead"}};
	struct svg_panel p = {.title = "Speed", .y = {.label = "[m/s]"}, .key = key, .keys = 2};

	svg_cover(t->ego_mps, t->n, &p.y.min, &p.y.max);
	svg_cover(t->lead_mps, t->n, &p.y.min, &p.y.max);
	p.y.min = fmax(p.y.min, -5); /* the estimate of a lead that stands */
	svg_round_out(&p.y);
	open_panel(s, t, &p);
	draw_by_lead(s, SVG_RED, t, t->lead_mps);
	svg_line(s, SVG_BLUE, SVG_SOLID, t->time_s, t->ego_mps, t->n);
}

static void draw_distance(struct svg *s, const struct figure_timeline *t)
{
	static const struct svg_key key[] = {
		{SVG_GREEN, SVG_KEY_LINE, "to the lead"},
		{SVG_AMBER, SVG_KEY_LINE, "from which braking now is safe at 1 % risk"}};
	struct svg_panel p = {.title = "Distance", .y = {.label = "[m]"}, .key = key, .keys = 2};
	double safe_m = 0;

	svg_cover(t->headway_m, t->n, &p.y.min, &p.y.max);
	svg_cover(t->safe_m, t->n, &p.y.min, &safe_m);
	p.y.max = fmax(p.y.max, fmin(safe_m, 3 * p.y.max)); /* beyond, nothing else could be seen */
	p.y.min = 0;
	svg_round_out(&p.y);
	open_panel(s, t, &p);
	draw_by_lead(s, SVG_AMBER, t, t->safe_m);
	draw_by_lead(s, SVG_GREEN, t, t->headway_m);
}

/* Down to the bound of an evaluation without a hit, which is as little as these samples can say. */
static void draw_risk(struct svg *s, const struct figure_timeline *t)
{
	static const struct svg_key key[] = {
		{SVG_BLUE, SVG_KEY_LINE, "if full braking waits one period"},
		{SVG_BLUE, SVG_KEY_AREA, "95 % interval"},
		{SVG_AMBER, SVG_KEY_LINE, "if the driver brakes"}};
	struct svg_panel p = {
		.title = "Risk",
		.y = {.label = "[%]", .scale = SVG_LOG, .unit = 0.01, .min = 0.001, .max = 1},
		.share = 1.3,
		.key = key,
		.keys = t->driver ? 3 : 2};
	double min = INFINITY, max = 0;

	svg_cover(t->hi, t->n, &min, &max);
	p.y.min = fmax(fmin(p.y.min, min), 1e-9);
	svg_round_out(&p.y);
	open_panel(s, t, &p);
	if (t->driver) {
		svg_line(s, SVG_AMBER, SVG_SOLID, t->time_s, t->driver, t->n);
	}
	svg_band(s, SVG_BLUE, t->time_s, t->lo, t->hi, t->n);
	svg_line(s, SVG_BLUE, SVG_SOLID, t->time_s, t->p, t->n);
}

static void draw_request(struct svg *s, const struct figure_timeline *t)
{
	struct svg_panel p = {
		.title = "Acceleration requested", .y = {.label = "[m/s\302\262]"}, .share = 0.8};

	svg_cover(t->accel_mps2, t->n, &p.y.min, &p.y.max);
	p.y.min = fmin(p.y.min, -1);
	svg_round_out(&p.y);
	open_panel(s, t, &p);
	svg_line(s, SVG_PURPLE, SVG_STEP, t->time_s, t->accel_mps2, t->n);
}

/* Whether @i follows on the evaluation before it, none missing between them. */
static int follows(const struct svg *s, const struct figure_timeline *t, size_t i)
{
	return i < t->n && svg_goes_on(s, t->time_s[i - 1], t->time_s[i]);
}

static void draw_lane(struct svg *s, const struct figure_timeline *t, int lane)
{
	const char *const *word = lane == LANE_STAGE ? t->level : t->state;

	for (size_t i = 0, end; i < t->n; i = end) {
		for (end = i + 1; follows(s, t, end) && !strcmp(word[end], word[i]);) {
			end++;
		}
		const double until_s = t->time_s[follows(s, t, end) ? end : end - 1];
		const enum svg_colour c =
			lane == LANE_STAGE ? level_colour[place(word[i], level_name, LEVELS)]
					   : state_colour[place(word[i], state_name, STATES)];

		svg_span(s, c, lane, t->time_s[i], until_s, word[i]);
	}
}

void figure_timeline(FILE *out, const void *timeline)
{
	const struct figure_timeline *t = timeline;
	const struct svg_page page = {.width_px = 900,
				      .height_px = 760,
				      .shares = 5.1,
				      .title = t->text.title,
				      .subtitle = t->text.subtitle,
				      .note = t->text.note};
	struct svg_panel lanes = {.x = {.label = "time [s]"},
				  .y = {.scale = SVG_NAMES, .name = lane_name, .n = LANES},
				  .share = 1};
	struct svg s = svg_start(out, &page);

	draw_speed(&s, t);
	draw_distance(&s, t);
	draw_risk(&s, t);
	draw_request(&s, t);
	open_panel(&s, t, &lanes);
	draw_lane(&s, t, LANE_STAGE);
	draw_lane(&s, t, LANE_STATE);
	svg_end(&s);
}
