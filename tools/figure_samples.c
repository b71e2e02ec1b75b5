/* SPDX-License-Identifier: MIT
 * The pictures of how well samples agree: Table I as a picture, and one processor's samples against another's.
 */
#include <math.h>
#include <stdlib.h>
#include "figure.h"

#define Z_95 1.96

/* ---- Table I ----------------------------------------------------------------------------------- */

struct half {
	const char *title, *y_label, *x_label;
	const double *paper, *ours, *se;
};

static void draw_half(struct svg *s, const struct figure_converge *c, const struct half *h)
{
	static const struct svg_key key[] = {
		{SVG_BLUE, SVG_KEY_LINE, "ours"},
		{SVG_BLUE, SVG_KEY_AREA, "95 % interval"},
		{SVG_PURPLE, SVG_KEY_DOT, "the paper, Table I"},
	};
	struct svg_panel panel = {
		.title = h->title,
		.x = {.label = h->x_label, .scale = SVG_LOG, .min = INFINITY, .max = -INFINITY},
		.y = {.label = h->y_label, .min = INFINITY, .max = -INFINITY},
		.share = h->x_label ? 1.16 : 1,
		.key = key,
		.keys = 3};
	double *lo = calloc(c->n, 2 * sizeof(*lo)), *hi = lo ? lo + c->n : NULL;

	for (size_t i = 0; i < c->n && lo; i++) {
		lo[i] = h->ours[i] - Z_95 * h->se[i];
		hi[i] = h->ours[i] + Z_95 * h->se[i];
	}
	const size_t n = lo ? c->n : 0;

	svg_cover(c->samples, c->n, &panel.x.min, &panel.x.max);
	svg_cover(h->paper, c->n, &panel.y.min, &panel.y.max);
	svg_cover(lo, n, &panel.y.min, &panel.y.max);
	svg_cover(hi, n, &panel.y.min, &panel.y.max);
	panel.x.min /= 1.2; /* no dot on the frame */
	panel.x.max *= 1.2;
	svg_round_out(&panel.y);
	svg_panel(s, &panel);
	svg_band(s, SVG_BLUE, c->samples, lo, hi, n);
	svg_line(s, SVG_BLUE, SVG_SOLID, c->samples, h->ours, c->n);
	svg_dots(s, SVG_BLUE, c->samples, h->ours, c->n);
	svg_dots(s, SVG_PURPLE, c->samples, h->paper, c->n);
	free(lo);
}

void figure_converge(FILE *out, const void *converge)
{
	const struct figure_converge *c = converge;
	const struct svg_page page = {.width_px = 720,
				      .height_px = 520,
				      .shares = 2.16,
				      .title = c->text.title,
				      .subtitle = c->text.subtitle,
				      .note = c->text.note};
	const struct half mean = {"Mean", "[m]", NULL, c->paper_mean_m, c->mean_m, c->mean_se_m};
	const struct half sd = {"Standard deviation", "[m]",   "number of samples",
				c->paper_sd_m,        c->sd_m, c->sd_se_m};
	struct svg s = svg_start(out, &page);

	draw_half(&s, c, &mean);
	draw_half(&s, c, &sd);
	svg_end(&s);
}

/* ---- CPU against GPU --------------------------------------------------------------------------- */

static void draw_difference(struct svg *s, const struct figure_scatter *f, const struct svg_axis *x)
{
	double most_m = 1e-6;

	for (size_t i = 0; i < f->n; i++) {
		most_m = fmax(most_m, fabs(f->gpu_m[i] - f->cpu_m[i]));
	}
	struct svg_panel panel = {
		.x = *x,
		.y = {.label = "[\302\265m]", .unit = 1e-6, .min = -most_m, .max = most_m},
		.title = "Difference, GPU less CPU",
		.share = 0.28};

	panel.x.label = f->cpu;
	svg_round_out(&panel.y);
	svg_panel(s, &panel);
	for (size_t i = 0; i < f->n; i++) {
		const double dev_m = f->gpu_m[i] - f->cpu_m[i];

		svg_dots(s, SVG_BLUE, &f->cpu_m[i], &dev_m, 1);
	}
}

void figure_scatter(FILE *out, const void *scatter)
{
	const struct figure_scatter *f = scatter;
	const struct svg_page page = {.width_px = 560,
				      .height_px = 700,
				      .shares = 1.28,
				      .title = f->text.title,
				      .subtitle = f->text.subtitle,
				      .note = f->text.note};
	struct svg_axis axis = {.min = INFINITY, .max = -INFINITY};

	svg_cover(f->cpu_m, f->n, &axis.min, &axis.max);
	svg_cover(f->gpu_m, f->n, &axis.min, &axis.max);
	svg_round_out(&axis);
	struct svg_panel panel = {.x = axis, .y = axis};
	const double ends[] = {axis.min, axis.max};

	panel.y.label = f->gpu;
	struct svg s = svg_start(out, &page);

	svg_panel(&s, &panel);
	svg_line(&s, SVG_GREY, SVG_DASHED, ends, ends, 2);
	svg_dots(&s, SVG_BLUE, f->cpu_m, f->gpu_m, f->n);
	draw_difference(&s, f, &axis);
	svg_end(&s);
}
