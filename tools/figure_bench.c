/* SPDX-License-Identifier: MIT
 * The pictures of what was measured: time and speedup against the number of samples, and what fits a budget.
 */
#include <math.h>
#include "figure.h"

#define WIDTH_PX  760
#define HEIGHT_PX 460
#define LINES_MAX 6
#define KERNELS   2
#define BAR       0.28 /* of the distance between two budgets */
#define BETWEEN   0.28 /* the two bars of a budget: room for what the paper prints */

/* ---- lines against N --------------------------------------------------------------------------- */

struct line {
	const char *name;
	enum svg_colour colour;
	enum svg_style style;
	size_t n;
	const double *x;
	double y[FIGURE_SIZES_MAX];
};

struct level {
	double y;
	const char *text; /* at the right end, or from @x on */
	double x;
};

struct picture {
	const struct figure_text *text;
	const char *y_label;
	struct line line[LINES_MAX];
	const struct level *level; /* dashed, right across */
	const struct figure_point *point;
	int lines, levels, points;
	double from, to; /* an area right across; 0: none */
};

static void cover(const struct picture *f, struct svg_axis *x, struct svg_axis *y)
{
	x->min = y->min = INFINITY;
	x->max = y->max = -INFINITY;
	for (int i = 0; i < f->lines; i++) {
		svg_cover(f->line[i].x, f->line[i].n, &x->min, &x->max);
		svg_cover(f->line[i].y, f->line[i].n, &y->min, &y->max);
	}
	for (int i = 0; i < f->levels; i++) {
		svg_cover(&f->level[i].y, 1, &y->min, &y->max);
	}
	for (int i = 0; i < f->points; i++) {
		svg_cover(&f->point[i].x, 1, &x->min, &x->max);
		svg_cover(&f->point[i].y, 1, &y->min, &y->max);
	}
	x->min /= 1.2; /* no dot on the frame */
	x->max *= 1.2;
	svg_round_out(y);
}

static void draw_area(struct svg *s, const struct picture *f)
{
	const double x[] = {s->x.min, s->x.max}, lo[] = {f->from, f->from}, hi[] = {f->to, f->to};

	if (f->to > 0) {
		svg_band(s, SVG_GREY, x, lo, hi, 2);
	}
}

static void draw_points(struct svg *s, const struct figure_point *p, int n)
{
	for (int i = 0; i < n; i++) {
		svg_dots(s, SVG_PURPLE, &p[i].x, &p[i].y, 1);
		svg_words(s, p[i].x, p[i].y, i % 2 ? -7 : 16, 'm', p[i].text); /* below, above */
	}
}

static void draw_lines(struct svg *s, const struct picture *f)
{
	struct svg_key key[LINES_MAX + 1];
	int keys = 0;

	for (const struct line *l = f->line; l < f->line + f->lines; l++) {
		svg_line(s, l->colour, l->style, l->x, l->y, l->n);
		if (l->style == SVG_SOLID) {
			svg_dots(s, l->colour, l->x, l->y, l->n);
		}
		key[keys++] = (struct svg_key){
			l->colour, l->style == SVG_DASHED ? SVG_KEY_DASHED : SVG_KEY_LINE, l->name};
	}
	if (f->points) {
		key[keys++] = (struct svg_key){SVG_PURPLE, SVG_KEY_DOT, "as the paper prints it"};
	}
	svg_legend(s, key, keys);
}

static void draw_picture(FILE *out, const struct picture *f)
{
	const struct svg_page page = {.width_px = WIDTH_PX,
				      .height_px = HEIGHT_PX,
				      .title = f->text->title,
				      .subtitle = f->text->subtitle,
				      .note = f->text->note};
	struct svg_panel panel = {.x = {.label = "number of samples", .scale = SVG_LOG},
				  .y = {.label = f->y_label, .scale = SVG_LOG}};

	cover(f, &panel.x, &panel.y);
	struct svg s = svg_start(out, &page);

	svg_panel(&s, &panel);
	draw_area(&s, f);
	for (int i = 0; i < f->levels; i++) {
		const struct level *l = &f->level[i];

		svg_level(&s, SVG_GREY, l->y, l->x > 0 ? NULL : l->text);
		if (l->x > 0) {
			svg_words(&s, l->x, l->y, -4, 's', l->text);
		}
	}
	draw_lines(&s, f);
	draw_points(&s, f->point, f->points);
	svg_end(&s);
}

/* ---- time and speedup -------------------------------------------------------------------------- */

enum what { TIME_MS, SPEEDUP };

static void add_line(struct picture *f, const struct line *like, const struct figure_series *s,
		     enum what what, double scalar_ns)
{
	struct line *l = &f->line[f->lines];

	if (!s->n) {
		return;
	}
	*l = *like;
	l->n = s->n;
	l->x = s->samples;
	for (size_t i = 0; i < s->n; i++) {
		l->y[i] = what == TIME_MS ? s->ns[i] * 1e-6 : scalar_ns * s->samples[i] / s->ns[i];
	}
	f->lines++;
}

static void add_lines(struct picture *f, const struct figure_bench *b, enum what what)
{
	static const struct line
		paper = {"the paper's kernel on the GPU, with copies",
			 SVG_RED,
			 SVG_SOLID,
			 0,
			 NULL,
			 {0}},
		fast = {"the fast rollout on the GPU", SVG_BLUE, SVG_SOLID, 0, NULL, {0}},
		cpu = {"the fast rollout on one core", SVG_GREEN, SVG_SOLID, 0, NULL, {0}};
	const struct line here = {b->here, SVG_AMBER, SVG_SOLID, 0, NULL, {0}};

	add_line(f, &paper, &b->paper, what, b->scalar_ns);
	add_line(f, &here, &b->here_cpu, what, b->here_scalar_ns);
	add_line(f, &cpu, &b->cpu, what, b->scalar_ns);
	add_line(f, &fast, &b->fast, what, b->scalar_ns);
}

void figure_time(FILE *out, const void *bench)
{
	static const struct level level[] = {{530, "530 ms (400 to 800)", 2e5}};
	static const struct figure_point point[] = {{8000, 530, "Orin Nano"},
						    {25000, 530, "AGX Orin"}};
	static const struct line scalar = {
		"f64 reference on one core, scaled", SVG_GREY, SVG_DASHED, 0, NULL, {0}};
	const struct figure_bench *b = bench;
	const struct figure_series *longest = b->fast.n ? &b->fast : &b->cpu;
	double ns[FIGURE_SIZES_MAX];
	struct picture f = {.text = &b->text,
			    .y_label = "time of a batch [ms]",
			    .level = level,
			    .levels = 1,
			    .point = point,
			    .points = b->prints ? 2 : 0,
			    .from = 400,
			    .to = 800};

	for (size_t i = 0; i < longest->n; i++) {
		ns[i] = b->scalar_ns * longest->samples[i];
	}
	add_line(&f, &scalar, &(struct figure_series){longest->n, longest->samples, ns}, TIME_MS,
		 0);
	add_lines(&f, b, TIME_MS);
	draw_picture(out, &f);
}

void figure_speedup(FILE *out, const void *bench)
{
	static const struct level level[] = {{13.33, "Orin Nano 13.3 (the paper)", 0},
					     {29.79, NULL, 0},
					     {31.20, "GTX 1650 29.8, AGX Orin 31.2", 0},
					     {54.57, "RTX 5070 54.6", 0}};
	const struct figure_bench *b = bench;
	struct picture f = {
		.text = &b->text,
		.y_label = "times faster than the f64 reference on one core of its own machine",
		.level = level,
		.levels = b->prints ? 4 : 0};

	add_lines(&f, b, SPEEDUP);
	draw_picture(out, &f);
}

/* ---- budgets ----------------------------------------------------------------------------------- */

/* 7047674 as "7.05 million". */
static void count_text(double n, char *text, size_t size)
{
	static const struct {
		double unit;
		const char *word;
	} row[] = {{1e9, " billion"}, {1e6, " million"}, {1e3, ",000"}};

	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		if (n >= row[i].unit) {
			snprintf(text, size, "%.*f%s", row[i].unit > 1e3 ? 2 : 0, n / row[i].unit,
				 row[i].word);
			return;
		}
	}
	snprintf(text, size, "%.0f", n);
}

static void draw_kernel(struct svg *s, const struct figure_budget *b, int k)
{
	for (int i = 0; i < FIGURE_BUDGETS; i++) {
		const double x = i + (k - (KERNELS - 1) / 2.0) * (BAR + BETWEEN);
		const double n = b->kernel[k].samples[i];
		char words[32];

		count_text(n, words, sizeof(words));
		svg_bars(s, b->kernel[k].colour, &x, &n, 1, BAR);
		svg_words(s, x, n, -5, 'm', words);
	}
}

void figure_budget(FILE *out, const void *budget)
{
	const struct figure_budget *b = budget;
	const struct svg_page page = {.width_px = WIDTH_PX,
				      .height_px = HEIGHT_PX,
				      .title = b->text.title,
				      .subtitle = b->text.subtitle,
				      .note = b->text.note};
	const struct svg_key key[] = {
		{b->kernel[0].colour, SVG_KEY_BAR, b->kernel[0].name},
		{b->kernel[1].colour, SVG_KEY_BAR, b->kernel[1].name},
		{SVG_PURPLE, SVG_KEY_DOT, "as the paper prints it"},
	};
	struct svg_panel panel = {
		.x = {.label = "time for the Monte Carlo stage",
		      .scale = SVG_NAMES,
		      .name = b->budget,
		      .n = FIGURE_BUDGETS},
		.y = {.label = "samples", .scale = SVG_LOG, .min = INFINITY, .max = -INFINITY},
		.key = key,
		.keys = b->points ? 3 : 2};

	for (int k = 0; k < KERNELS; k++) {
		svg_cover(b->kernel[k].samples, FIGURE_BUDGETS, &panel.y.min, &panel.y.max);
	}
	for (int i = 0; i < b->points; i++) {
		svg_cover(&b->point[i].y, 1, &panel.y.min, &panel.y.max);
	}
	panel.y.min = fmax(panel.y.min / 10, 1);
	panel.y.max = panel.y.max * 3; /* room for the words */
	svg_round_out(&panel.y);
	struct svg s = svg_start(out, &page);

	svg_panel(&s, &panel);
	for (int k = 0; k < KERNELS; k++) {
		draw_kernel(&s, b, k);
	}
	draw_points(&s, b->point, b->points);
	svg_end(&s);
}
