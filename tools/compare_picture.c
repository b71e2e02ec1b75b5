/* SPDX-License-Identifier: MIT
 * The picture of a log under two configurations: distance, both risks, both stages.
 */
#include <math.h>
#include <stdlib.h>
#include "cli.h"
#include "compare.h"
#include "svg.h"

#define MARGIN_S 5.0 /* before and after what differs: how it came to it */

static const enum svg_colour side_colour[SIDES] = {SVG_BLUE, SVG_RED};
static const char *const side_name[SIDES] = {"A", "B"};
static const enum svg_colour level_colour[LEVELS] = {[LEVEL_NONE] = SVG_GREY,
						     [LEVEL_WARN] = SVG_AMBER,
						     [LEVEL_PARTIAL] = SVG_RED,
						     [LEVEL_FULL] = SVG_PURPLE};

/* The points of a run as svg.h wants them. */
struct series {
	size_t n;
	double *time_s, *p, *lo, *hi, *driver, *headway_m; /* one allocation, at time_s */
};

/* Those within @time. */
static int unfold(const struct compare_run *r, const struct svg_axis *time, struct series *s)
{
	const size_t n = r->head.n_points;
	double *v = calloc(6 * n + 1, sizeof(*v));

	if (!v) {
		return -1;
	}
	*s = (struct series){0, v, v + n, v + 2 * n, v + 3 * n, v + 4 * n, v + 5 * n};
	for (const struct compare_point *p = r->point; p < r->point + n; p++) {
		if (p->time_s >= time->min && p->time_s <= time->max) {
			s->time_s[s->n] = p->time_s;
			s->p[s->n] = p->p;
			s->lo[s->n] = p->lo;
			s->hi[s->n] = p->hi;
			s->driver[s->n] = p->driver;
			s->headway_m[s->n++] = p->headway_m;
		}
	}
	return 0;
}

/* ---- where they differ ------------------------------------------------------------------------- */

static int32_t level_at(const struct compare_run *r, double t_s)
{
	int32_t level = LEVEL_NONE;

	for (uint32_t i = 0; i < r->head.n_changes && r->change[i].time_s <= t_s; i++) {
		level = r->change[i].level;
	}
	return level;
}

static double next_change_s(const struct compare_run *r, double t_s)
{
	uint32_t i = 0;

	while (i < r->head.n_changes && r->change[i].time_s <= t_s) {
		i++;
	}
	return i < r->head.n_changes ? r->change[i].time_s : r->head.log_s;
}

/* From before the first moment at which the stages differ to after the last. */
static struct svg_axis window(const struct compare_run run[SIDES])
{
	const struct compare_run *a = &run[SIDE_A], *b = &run[SIDE_B];
	double from_s = a->head.log_s, to_s = 0, next_s;

	for (double t_s = 0; t_s < a->head.log_s; t_s = next_s) {
		next_s = fmin(next_change_s(a, t_s), next_change_s(b, t_s));
		if (level_at(a, t_s) != level_at(b, t_s)) {
			from_s = fmin(from_s, t_s);
			to_s = next_s;
		}
	}
	return (struct svg_axis){.label = "time [s]",
				 .min = fmax(from_s - MARGIN_S, 0),
				 .max = fmin(to_s + MARGIN_S, a->head.log_s)};
}

/* ---- panels ------------------------------------------------------------------------------------ */

static void draw_distance(struct svg *s, const struct svg_axis *time, const struct series t[SIDES])
{
	struct svg_panel p = {.title = "Distance to the lead",
			      .x = {.min = time->min, .max = time->max, .gap = time->gap},
			      .y = {.label = "[m]"}};

	svg_cover(t[SIDE_A].headway_m, t[SIDE_A].n, &p.y.min, &p.y.max);
	svg_cover(t[SIDE_B].headway_m, t[SIDE_B].n, &p.y.min, &p.y.max);
	p.y.min = 0;
	svg_round_out(&p.y);
	svg_panel(s, &p);
	for (int side = 0; side < SIDES; side++) {
		svg_line(s, side_colour[side], side ? SVG_DASHED : SVG_SOLID, t[side].time_s,
			 t[side].headway_m, t[side].n);
	}
}

static void draw_driver(struct svg *s, const struct svg_axis *time, const struct series t[SIDES])
{
	const struct svg_panel p = {
		.title = "Risk if the driver brakes after reacting: the warning",
		.x = {.min = time->min, .max = time->max, .gap = time->gap},
		.y = {.label = "[%]", .scale = SVG_LOG, .unit = 0.01, .min = 0.0001, .max = 1}};

	svg_panel(s, &p);
	for (int side = 0; side < SIDES; side++) {
		svg_line(s, side_colour[side], side ? SVG_DASHED : SVG_SOLID, t[side].time_s,
			 t[side].driver, t[side].n);
	}
}

static void draw_risk(struct svg *s, const struct svg_axis *time, const struct series t[SIDES])
{
	static const struct svg_key key[] = {{SVG_BLUE, SVG_KEY_LINE, "A"},
					     {SVG_RED, SVG_KEY_DASHED, "B"}};
	const struct svg_panel p = {
		.title = "Risk of waiting one period, with its 95 % interval: the request",
		.x = {.min = time->min, .max = time->max, .gap = time->gap},
		.y = {.label = "[%]", .scale = SVG_LOG, .unit = 0.01, .min = 0.0001, .max = 1},
		.key = key,
		.keys = SIDES};

	svg_panel(s, &p);
	for (int side = 0; side < SIDES; side++) {
		svg_band(s, side_colour[side], t[side].time_s, t[side].lo, t[side].hi, t[side].n);
		svg_line(s, side_colour[side], side ? SVG_DASHED : SVG_SOLID, t[side].time_s,
			 t[side].p, t[side].n);
	}
}

static void draw_stages(struct svg *s, const struct svg_axis *time, const struct compare_log *l)
{
	const struct svg_panel p = {.title = "Stage",
				    .x = *time,
				    .y = {.scale = SVG_NAMES, .name = side_name, .n = SIDES},
				    .share = 0.6};

	svg_panel(s, &p);
	for (int side = 0; side < SIDES; side++) {
		const struct compare_run *r = &l->run[side];

		for (uint32_t i = 0; i < r->head.n_changes; i++) {
			const struct compare_change *c = &r->change[i];
			const double to = i + 1 < r->head.n_changes ? c[1].time_s : r->head.log_s;

			if (c->level > LEVEL_NONE) {
				svg_span(s, level_colour[c->level], side, c->time_s, to,
					 level_name[c->level]);
			}
		}
	}
}

static void draw(FILE *out, const struct replay_args *a, const struct compare_log *l,
		 const struct svg_axis *time, const struct series t[SIDES])
{
	char subtitle[512];
	const struct svg_page page = {.width_px = 900,
				      .height_px = 640,
				      .shares = 3.6,
				      .title = l->path,
				      .subtitle = subtitle};

	snprintf(subtitle, sizeof(subtitle), "A %.200s, B %.200s; %.1f to %.1f s of %.1f s",
		 a->compare[SIDE_A], a->compare[SIDE_B], time->min, time->max,
		 l->run[SIDE_A].head.log_s);
	struct svg s = svg_start(out, &page);

	draw_distance(&s, time, t);
	draw_driver(&s, time, t);
	draw_risk(&s, time, t);
	draw_stages(&s, time, l);
	svg_end(&s);
}

int compare_picture(const char *name, const struct replay_args *a, const struct compare_log *l)
{
	struct series t[SIDES] = {{0}};
	struct svg_axis time = window(l->run);
	int code = 0;

	if (unfold(&l->run[SIDE_A], &time, &t[SIDE_A]) ||
	    unfold(&l->run[SIDE_B], &time, &t[SIDE_B])) {
		code = cli_error(CLI_FAILED, name, "out of memory");
	} else {
		time.gap = fmax(svg_gap(t[SIDE_A].time_s, t[SIDE_A].n),
				svg_gap(t[SIDE_B].time_s, t[SIDE_B].n));
		FILE *out = cli_create(name, l->picture);

		if (out) {
			draw(out, a, l, &time, t);
		}
		code = out ? cli_close(name, l->picture, out) : CLI_FAILED;
	}
	free(t[SIDE_A].time_s);
	free(t[SIDE_B].time_s);
	return code;
}
