/* SPDX-License-Identifier: MIT
 * Charts as SVG: what stands in a panel.
 */
#include <math.h>
#include "svg_priv.h"

#define COLUMN_PX 0.5 /* points within one column are drawn by their extremes */
#define WORD_PX   14  /* a line of text */
#define KEY_PX    20  /* the mark of a legend's entry */
#define GAP_PX    16  /* between two entries */

/* ---- lines and bands --------------------------------------------------------------------------- */

/* A path in progress. */
struct pen {
	FILE *out;
	enum svg_style style;
	int down;
};

static void pen_to(struct pen *p, double x_px, double y_px)
{
	if (!p->down) {
		fprintf(p->out, "M%.1f %.1f", x_px, y_px);
	} else if (p->style == SVG_STEP) {
		fprintf(p->out, "H%.1fV%.1f", x_px, y_px);
	} else {
		fprintf(p->out, "L%.1f %.1f", x_px, y_px);
	}
	p->down = 1;
}

int svg_goes_on(const struct svg *s, double from_x, double to_x)
{
	return s->x.gap <= 0 || to_x - from_x <= s->x.gap;
}

static double column(const struct svg *s, double x)
{
	return floor(svg_at_x(s, x) / COLUMN_PX);
}

/* Of more than four points in one column the first, the smallest, the largest and the last, in their order. */
static void draw_column(const struct svg *s, struct pen *pen, const double *x, const double *y,
			size_t begin, size_t end)
{
	size_t least = begin, most = begin;

	for (size_t i = begin; i < end; i++) {
		least = y[i] < y[least] ? i : least;
		most = y[i] > y[most] ? i : most;
	}
	for (size_t i = begin; i < end; i++) {
		if (end - begin <= 4 || i == begin || i == least || i == most || i + 1 == end) {
			pen_to(pen, svg_at_x(s, x[i]), svg_at_y(s, y[i]));
		}
	}
}

void svg_line(struct svg *s, enum svg_colour c, enum svg_style style, const double *x,
	      const double *y, size_t n)
{
	struct pen pen = {s->out, style, 0};

	fprintf(s->out, "<path class=\"c%u l%s\" d=\"", c, style == SVG_DASHED ? " t" : "");
	for (size_t i = 0; i < n;) {
		const size_t begin = i;

		pen.down = pen.down && svg_goes_on(s, x[i - 1], x[i]);
		while (i < n && isfinite(x[i]) && isfinite(y[i]) &&
		       (i == begin || (column(s, x[i]) == column(s, x[begin]) &&
				       svg_goes_on(s, x[i - 1], x[i])))) {
			i++;
		}
		if (i > begin) {
			draw_column(s, &pen, x, y, begin, i);
		} else {
			pen.down = 0; /* a gap */
			i++;
		}
	}
	fputs("\"/>\n", s->out);
}

/* The outermost values of each column, forwards along the upper edge or back along the lower one. */
static void band_edge(const struct svg *s, struct pen *pen, const double *x, const double *v,
		      size_t n, int back)
{
	for (size_t k = 0; k < n;) {
		const size_t first = back ? n - 1 - k : k;
		double most = v[first];

		for (size_t i = first; k < n && column(s, x[i]) == column(s, x[first]);) {
			most = back ? fmin(most, v[i]) : fmax(most, v[i]);
			k++;
			i = back ? i - 1 : i + 1;
		}
		pen_to(pen, svg_at_x(s, x[first]), svg_at_y(s, most));
	}
}

void svg_band(struct svg *s, enum svg_colour c, const double *x, const double *lo, const double *hi,
	      size_t n)
{
	fprintf(s->out, "<path class=\"c%u b\" d=\"", c);
	for (size_t i = 0; i < n;) {
		const size_t begin = i;
		struct pen pen = {s->out, SVG_SOLID, 0};

		while (i < n && isfinite(x[i]) && isfinite(lo[i]) && isfinite(hi[i]) &&
		       (i == begin || svg_goes_on(s, x[i - 1], x[i]))) {
			i++;
		}
		if (i == begin) {
			i++;
			continue;
		}
		band_edge(s, &pen, x + begin, hi + begin, i - begin, 0);
		band_edge(s, &pen, x + begin, lo + begin, i - begin, 1);
		fputc('Z', s->out);
	}
	fputs("\"/>\n", s->out);
}

/* ---- dots and bars ----------------------------------------------------------------------------- */

void svg_dots(struct svg *s, enum svg_colour c, const double *x, const double *y, size_t n)
{
	fprintf(s->out, "<path class=\"c%u d\" d=\"", c);
	for (size_t i = 0; i < n; i++) {
		if (isfinite(x[i]) && isfinite(y[i])) {
			fprintf(s->out, "M%.1f %.1fh0", svg_at_x(s, x[i]), svg_at_y(s, y[i]));
		}
	}
	fputs("\"/>\n", s->out);
}

void svg_bars(struct svg *s, enum svg_colour c, const double *x, const double *y, size_t n,
	      double width)
{
	const double foot_px = svg_at_y(s, s->y.scale == SVG_LOG ? s->y.min : 0);

	fprintf(s->out, "<path class=\"c%u f\" d=\"", c);
	for (size_t i = 0; i < n; i++) {
		if (isfinite(x[i]) && isfinite(y[i]) && y[i] != 0) {
			const double left_px = svg_at_x(s, x[i] - width / 2);

			fprintf(s->out, "M%.1f %.1fV%.1fH%.1fV%.1fZ", left_px, foot_px,
				svg_at_y(s, y[i]), svg_at_x(s, x[i] + width / 2), foot_px);
		}
	}
	fputs("\"/>\n", s->out);
}

void svg_span(struct svg *s, enum svg_colour c, int lane, double x0, double x1, const char *text)
{
	const double from_px = fmax(svg_at_x(s, x0), 0), to_px = fmin(svg_at_x(s, x1), s->w_px);
	const double y_px = svg_at_y(s, lane), high_px = s->h_px / s->y.n * 0.76;

	if (!isfinite(x0) || !isfinite(x1) || to_px < from_px) {
		return;
	}
	fprintf(s->out,
		"<rect class=\"c%u sp\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" "
		"height=\"%.1f\"><title>",
		c, from_px, y_px - high_px / 2, fmax(to_px - from_px, 0.8), high_px);
	svg_escape(s->out, text);
	fputs("</title></rect>\n", s->out);
	if (svg_text_px(text) + 6 <= to_px - from_px && high_px >= SVG_TEXT_PX) {
		svg_text(s->out, "h", (from_px + to_px) / 2, y_px + 4, 'm', text);
	}
}

/* ---- words ------------------------------------------------------------------------------------- */

void svg_level(struct svg *s, enum svg_colour c, double y, const char *text)
{
	const double y_px = svg_at_y(s, y);

	fprintf(s->out, "<path class=\"c%u l t\" d=\"M0 %.1fH%.1f\"/>\n", c, y_px, s->w_px);
	if (text) {
		svg_text(s->out, "h", s->w_px - 5, y_px < WORD_PX + 2 ? y_px + 13 : y_px - 4, 'e',
			 text);
	}
}

/* Words of several marks stand one below the other. */
void svg_mark(struct svg *s, enum svg_colour c, double x, const char *text)
{
	const double x_px = svg_at_x(s, x);

	fprintf(s->out, "<path class=\"c%u l t\" d=\"M%.1f 0V%.1f\"/>\n", c, x_px, s->h_px);
	if (text) {
		const int left = x_px + svg_text_px(text) + 5 > s->w_px;

		s->words++;
		svg_text(s->out, "h", left ? x_px - 5 : x_px + 5, s->words * WORD_PX,
			 left ? 'e' : 's', text);
	}
}

void svg_words(struct svg *s, double x, double y, double dy_px, char anchor, const char *text)
{
	svg_text(s->out, "h", svg_at_x(s, x), svg_at_y(s, y) + dy_px, anchor, text);
}

static void key_mark(const struct svg *s, const struct svg_key *k, double x_px, double y_px)
{
	switch (k->mark) {
	case SVG_KEY_DOT:
		fprintf(s->out, "<path class=\"c%u d\" d=\"M%.1f %.1fh0\"/>", k->colour, x_px + 8,
			y_px);
		return;
	case SVG_KEY_AREA:
	case SVG_KEY_BAR:
		fprintf(s->out,
			"<rect class=\"c%u %s\" x=\"%.1f\" y=\"%.1f\" width=\"16\" height=\"9\"/>",
			k->colour, k->mark == SVG_KEY_BAR ? "f" : "b", x_px, y_px - 4.5);
		return;
	default:
		fprintf(s->out, "<path class=\"c%u l%s\" d=\"M%.1f %.1fh16\"/>", k->colour,
			k->mark == SVG_KEY_DASHED ? " t" : "", x_px, y_px);
	}
}

void svg_draw_keys(const struct svg *s, const struct svg_key *key, int n)
{
	double x_px = s->x_px + s->w_px + GAP_PX;

	for (int i = 0; i < n; i++) {
		x_px -= svg_text_px(key[i].text) + KEY_PX + GAP_PX;
	}
	for (int i = 0; i < n; i++) {
		key_mark(s, &key[i], x_px, s->y_px - 12);
		svg_text(s->out, "s", x_px + KEY_PX, s->y_px - 8, 's', key[i].text);
		x_px += svg_text_px(key[i].text) + KEY_PX + GAP_PX;
	}
}

void svg_legend(struct svg *s, const struct svg_key *key, int n)
{
	for (int i = 0; i < n; i++) {
		const double y_px = 12 + i * (WORD_PX + 3);

		key_mark(s, &key[i], 8, y_px);
		svg_text(s->out, "h", 10 + KEY_PX, y_px + 4, 's', key[i].text);
	}
}
