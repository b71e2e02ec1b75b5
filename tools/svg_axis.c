/* SPDX-License-Identifier: MIT
 * Charts as SVG: scales, round numbers, frame and grid.
 */
#include <math.h>
#include <string.h>
#include "svg_priv.h"

/* The smallest of 1, 2 and 5 times a power of ten that is not below @least. */
static double round_step(double least)
{
	const double decade = pow(10, floor(log10(least)));
	const double m = least / decade;

	return decade * (m <= 1.0000001 ? 1 : m <= 2.0000001 ? 2 : m <= 5.0000001 ? 5 : 10);
}

static double decades(const struct svg_axis *a)
{
	return log10(a->max) - log10(a->min);
}

/* ---- scales ------------------------------------------------------------------------------------ */

double svg_axis_part(const struct svg_axis *a, double v)
{
	switch (a->scale) {
	case SVG_LOG:
		return isnan(v) ? NAN : v > 0 ? log10(v / a->min) / decades(a) : -1;
	case SVG_NAMES:
		return (v + 0.5) / a->n;
	default:
		return (v - a->min) / (a->max - a->min);
	}
}

/* Viewers lose far coordinates. */
static double near(double px)
{
	return px < -1e4 ? -1e4 : px > 1e4 ? 1e4 : px;
}

double svg_at_x(const struct svg *s, double x)
{
	return near(svg_axis_part(&s->x, x) * s->w_px);
}

double svg_at_y(const struct svg *s, double y)
{
	const double part = svg_axis_part(&s->y, y);

	return near((s->y.scale == SVG_NAMES ? part : 1 - part) * s->h_px);
}

void svg_cover(const double *v, size_t n, double *min, double *max)
{
	for (size_t i = 0; i < n; i++) {
		if (isfinite(v[i])) {
			*min = fmin(*min, v[i]);
			*max = fmax(*max, v[i]);
		}
	}
}

/* Halving needs no room, as sorting would. */
double svg_gap(const double *x, size_t n)
{
	double lo = 0, hi = n ? x[n - 1] - x[0] : 0;

	for (int k = 0; k < 48; k++) {
		const double mid = (lo + hi) / 2;
		size_t longer = 0;

		for (size_t i = 1; i < n; i++) {
			longer += x[i] - x[i - 1] > mid;
		}
		*(2 * longer >= n ? &lo : &hi) = mid;
	}
	return 4 * hi;
}

void svg_round_out(struct svg_axis *a)
{
	if (a->scale == SVG_LOG && a->min <= 0 && a->max > 0) {
		a->min = a->max * 1e-6; /* no logarithm of what is there */
	}
	if (!(a->min <= a->max) || (a->scale == SVG_LOG && a->max <= 0)) {
		a->min = a->scale == SVG_LOG ? 0.1 : 0;
		a->max = 1;
	}
	if (a->scale == SVG_LOG) {
		a->min = pow(10, floor(log10(a->min) + 1e-9));
		a->max = pow(10, ceil(log10(a->max) - 1e-9));
		a->max = a->max > a->min ? a->max : a->min * 10;
		return;
	}
	if (a->max - a->min <= 1e-9 * fabs(a->max)) {
		a->max += fmax(fabs(a->max) * 0.1, 0.5);
	}
	const double step = round_step((a->max - a->min) / 10);

	a->min = floor(a->min / step + 1e-9) * step;
	a->max = ceil(a->max / step - 1e-9) * step;
}

struct svg_axis svg_axis_sane(const struct svg_axis *a)
{
	struct svg_axis sane = *a;

	if (a->scale != SVG_NAMES && !(isfinite(a->min) && isfinite(a->max) && a->min < a->max &&
				       (a->scale == SVG_LINEAR || a->min > 0))) {
		sane.min = a->scale == SVG_LOG ? 0.1 : 0;
		sane.max = 1;
	}
	return sane;
}

/* ---- ticks ------------------------------------------------------------------------------------- */

static int linear_ticks(const struct svg_axis *a, double most, double at[SVG_TICKS])
{
	const double unit = a->unit > 0 ? a->unit : 1;
	const double step = unit * round_step((a->max - a->min) / unit / fmin(most, SVG_TICKS - 2));
	int n = 0;

	for (double i = ceil(a->min / step - 1e-6);
	     i * step <= a->max + 1e-6 * step && n < SVG_TICKS; i++) {
		at[n++] = i * step;
	}
	return n;
}

/* Powers of ten, every second one, and so on; 1, 2 and 5 of each where there is room. */
static int log_ticks(const struct svg_axis *a, double most, double at[SVG_TICKS])
{
	static const double thirds[] = {1, 2, 5};
	const int per = 3 * decades(a) + 1 < fmin(most, 8) ? 3 : 1;
	const int every = (int)ceil((decades(a) + 1) / fmin(most, SVG_TICKS - 2) - 1e-9);
	const int first = (int)floor(log10(a->min) + 1e-9);
	int n = 0;

	for (int e = first; e <= log10(a->max) + 1e-9; e += every > 1 ? every : 1) {
		for (int i = 0; i < per && n < SVG_TICKS; i++) {
			at[n] = thirds[i] * pow(10, e);
			n += at[n] >= a->min * (1 - 1e-9) && at[n] <= a->max * (1 + 1e-9);
		}
	}
	return n;
}

int svg_ticks(const struct svg_axis *a, double px, double gap_px, double at[SVG_TICKS])
{
	const double most = fmax(px / gap_px, 1);

	if (a->scale == SVG_NAMES) {
		const int n = a->n < SVG_TICKS ? a->n : SVG_TICKS;

		for (int i = 0; i < n; i++) {
			at[i] = i;
		}
		return n;
	}
	return a->scale == SVG_LOG ? log_ticks(a, most, at) : linear_ticks(a, most, at);
}

static void power_text(int exponent, char *text)
{
	static const char *const digit[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
	const int e = exponent < 0 ? -exponent : exponent;

	snprintf(text, SVG_TICK_MAX, "10%s%s%s", exponent < 0 ? "⁻" : "",
		 e > 9 ? digit[e / 10 % 10] : "", digit[e % 10]);
}

/* Only powers of ten have numbers. */
static int is_wide(const struct svg_axis *a)
{
	return decades(a) > 3;
}

void svg_tick_text(const struct svg_axis *a, double v, double step, char text[SVG_TICK_MAX])
{
	const double u = v / (a->unit > 0 ? a->unit : 1);

	if (a->scale == SVG_LOG) {
		const double e = log10(u);

		if (fabs(e - round(e)) < 1e-9 && (e < -4.5 || e > 3.5) && is_wide(a)) {
			power_text((int)round(e), text);
		} else {
			snprintf(text, SVG_TICK_MAX, "%g", u);
		}
		return;
	}
	const int digits = (int)-floor(log10(step / (a->unit > 0 ? a->unit : 1)) + 1e-9);

	snprintf(text, SVG_TICK_MAX, "%.*f", digits > 0 ? digits : 0,
		 fabs(u) < 1e-12 ? 0 : u); /* no -0 */
}

/* ---- drawing ----------------------------------------------------------------------------------- */

static void number_at(const struct svg *s, const struct svg_axis *a, int is_x, double v,
		      double step)
{
	char number[SVG_TICK_MAX];
	const char *text = number;

	if (a->scale == SVG_NAMES) {
		text = a->name[(int)v];
	} else {
		svg_tick_text(a, v, step, number);
	}
	if (is_x) {
		svg_text(s->out, "n", s->x_px + svg_at_x(s, v), s->y_px + s->h_px + 15, 'm', text);
	} else {
		svg_text(s->out, "n", s->x_px - 6, s->y_px + svg_at_y(s, v) + 4, 'e', text);
	}
}

static void draw_axis(const struct svg *s, const struct svg_axis *a, int is_x)
{
	double at[SVG_TICKS];
	const int n = is_x ? svg_ticks(a, s->w_px, 64, at) : svg_ticks(a, s->h_px, 26, at);

	fputs("<path class=\"g\" d=\"", s->out);
	for (int i = 0; i < n && a->scale != SVG_NAMES; i++) {
		if (is_x) {
			fprintf(s->out, "M%.1f %.1fv%.1f", s->x_px + svg_at_x(s, at[i]), s->y_px,
				s->h_px);
		} else {
			fprintf(s->out, "M%.1f %.1fh%.1f", s->x_px, s->y_px + svg_at_y(s, at[i]),
				s->w_px);
		}
	}
	fputs("\"/>\n", s->out);
	for (int i = 0; i < n && (!is_x || a->label); i++) {
		number_at(s, a, is_x, at[i], n > 1 ? at[1] - at[0] : 1);
	}
}

void svg_draw_axes(const struct svg *s)
{
	const double middle_px = s->y_px + s->h_px / 2;

	draw_axis(s, &s->x, 1);
	draw_axis(s, &s->y, 0);
	fprintf(s->out,
		"<rect class=\"fr\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
		s->x_px, s->y_px, s->w_px, s->h_px);
	if (s->x.label) {
		svg_text(s->out, "s", s->x_px + s->w_px / 2, s->y_px + s->h_px + 32, 'm',
			 s->x.label);
	}
	if (s->y.label) {
		fprintf(s->out, "<g transform=\"translate(14 %.1f) rotate(-90)\">", middle_px);
		svg_text(s->out, "s", 0, 0, 'm', s->y.label);
		fputs("</g>\n", s->out);
	}
}
