/* SPDX-License-Identifier: MIT
 * Charts as SVG, written as they are drawn: a page, panels one below the other, marks in the current panel.
 * Text stays text; colours follow light and dark through CSS, differ for the colour-blind and never stand alone.
 * Knows nothing of what is drawn. No allocation; write errors stay in ferror(out).
 */
#ifndef AEBMC_SVG_H
#define AEBMC_SVG_H

#include <stddef.h>
#include <stdio.h>

enum svg_colour {
	SVG_BLUE,
	SVG_RED,
	SVG_GREEN,
	SVG_PURPLE,
	SVG_AMBER,
	SVG_SKY,
	SVG_GREY,
	SVG_COLOURS,
};

enum svg_style { SVG_SOLID, SVG_DASHED, SVG_STEP }; /* SVG_STEP: keeps its value until the next */

enum svg_scale { SVG_LINEAR, SVG_LOG, SVG_NAMES };

/* SVG_LOG: 0 < min < max. SVG_NAMES: name[i] stands at i, i in 0..n-1; min and max are not looked at; as y axis from the
 * top downwards. */
struct svg_axis {
	const char *label; /* with its unit; NULL on x: no numbers (upper panels of a stack) */
	double min, max;
	enum svg_scale scale;
	double unit; /* numbers are written as multiples of it, 0: 1; 0.01 with percent in the label */
	double gap; /* on x: marks of several points end before a longer step; 0: they cross all */
	const char *const *name;
	int n;
};

struct svg_page {
	double width_px, height_px;
	const char *title;
	const char *subtitle; /* below it, smaller; NULL: none */
	const char *note;     /* at the foot: machine and date; NULL: none */
	double shares;        /* sum of the shares of the panels; 0: 1 */
	double left_px;       /* room for the numbers or names of the y axis; 0: 64 */
	int embedded;         /* within an HTML page that has svg_css of its own */
};

/* One entry of a legend. */
struct svg_key {
	enum svg_colour colour;
	enum { SVG_KEY_LINE, SVG_KEY_DASHED, SVG_KEY_DOT, SVG_KEY_AREA, SVG_KEY_BAR } mark;
	const char *text;
};

struct svg_panel {
	struct svg_axis x, y;
	const char *title;         /* above it on the left; NULL: none */
	double share;              /* of the page's height; 0: 1 */
	const struct svg_key *key; /* the legend, above it on the right */
	int keys;
};

/* A page in progress. */
struct svg {
	FILE *out;
	struct svg_page page;
	struct svg_axis x, y;          /* of the current panel */
	double top_px;                 /* where the next panel may begin */
	double x_px, y_px, w_px, h_px; /* the current panel's plot */
	int in_panel, words;           /* words: of svg_mark, so far */
};

/** svg_css - the rules every page needs, without <style>; once in an HTML page, svg_start writes them otherwise. */
void svg_css(FILE *out);

/** svg_escape - @text as XML character data: markup escaped; control characters and broken UTF-8 become '?'. */
void svg_escape(FILE *out, const char *text);

/** svg_start - begin a page; @page's strings must outlive it. */
struct svg svg_start(FILE *out, const struct svg_page *page);

/** svg_panel - end the panel before and draw the frame, grid and numbers of the next. */
void svg_panel(struct svg *s, const struct svg_panel *p);

/** svg_end - end the last panel and the page. */
void svg_end(struct svg *s);

/** svg_at_x, svg_at_y - px from the left and the top of the current plot. */
double svg_at_x(const struct svg *s, double x);
double svg_at_y(const struct svg *s, double y);

/** svg_cover - widen *@min..*@max so that it holds every finite one of @v[@n]; start from INFINITY, -INFINITY. */
void svg_cover(const double *v, size_t n, double *min, double *max);

/** svg_gap - the step of @x[@n] (ascending) from which on there is a hole: four times the median. For svg_axis.gap. */
double svg_gap(const double *x, size_t n);

/** svg_goes_on - whether the current panel's lines cross the step between two neighbouring points. */
int svg_goes_on(const struct svg *s, double from_x, double to_x);

/** svg_round_out - the axis's min and max outwards to its next tick; an empty range gets one. */
void svg_round_out(struct svg_axis *a);

/* ---- marks in the current panel. What is not finite leaves a gap; what lies outside is clipped; on a logarithmic axis 0
 * and less lie below the plot. ---- */

/** svg_line - through @n points in order of x; more than the picture can show keep their extremes. */
void svg_line(struct svg *s, enum svg_colour c, enum svg_style style, const double *x,
	      const double *y, size_t n);

/** svg_band - the area between @lo and @hi. */
void svg_band(struct svg *s, enum svg_colour c, const double *x, const double *lo, const double *hi,
	      size_t n);

/** svg_dots - a dot at each of @n points. */
void svg_dots(struct svg *s, enum svg_colour c, const double *x, const double *y, size_t n);

/** svg_bars - @n bars from the x axis (or 0) to @y[i], each @width wide in units of x and centred at @x[i]. */
void svg_bars(struct svg *s, enum svg_colour c, const double *x, const double *y, size_t n,
	      double width);

/** svg_span - from @x0 to @x1 in lane @lane of a y axis of names; @text is written where it fits, and as tooltip. */
void svg_span(struct svg *s, enum svg_colour c, int lane, double x0, double x1, const char *text);

/** svg_level, svg_mark - a dashed line right across at @y, or up at @x, with a word beside it (NULL: none). */
void svg_level(struct svg *s, enum svg_colour c, double y, const char *text);
void svg_mark(struct svg *s, enum svg_colour c, double x, const char *text);

/** svg_words - text at a point; @anchor 's'tart, 'm'iddle or 'e'nd; @dy_px down from it. */
void svg_words(struct svg *s, double x, double y, double dy_px, char anchor, const char *text);

/** svg_legend - a column in the upper left corner of the plot, for names too long for the row above it. */
void svg_legend(struct svg *s, const struct svg_key *key, int n);

#endif
