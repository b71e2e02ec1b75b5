/* SPDX-License-Identifier: MIT
 * Between svg.c, svg_axis.c and svg_marks.c.
 */
#ifndef AEBMC_SVG_PRIV_H
#define AEBMC_SVG_PRIV_H

#include "svg.h"

#define SVG_TEXT_PX  11.5 /* as in svg_css */
#define SVG_TICKS    64
#define SVG_TICK_MAX 24 /* bytes of a number */

/** svg_text_px - width of @text, roughly. */
double svg_text_px(const char *text);

/** svg_ticks - where numbers stand, at least @gap_px apart on @px; ascending. Returns how many. */
int svg_ticks(const struct svg_axis *a, double px, double gap_px, double at[SVG_TICKS]);

/** svg_tick_text - the number at @v, one of svg_ticks's with @step between two. */
void svg_tick_text(const struct svg_axis *a, double v, double step, char text[SVG_TICK_MAX]);

/** svg_axis_part - 0 at the axis's beginning, 1 at its end; below 0 for what a logarithm does not have. */
double svg_axis_part(const struct svg_axis *a, double v);

/** svg_axis_sane - the axis, or 0..1 (0.1..1 if logarithmic) where its ends can be none. */
struct svg_axis svg_axis_sane(const struct svg_axis *a);

/** svg_draw_axes - frame, grid, numbers, names and labels of the current panel. */
void svg_draw_axes(const struct svg *s);

/** svg_draw_keys - the legend, above the current panel on the right. */
void svg_draw_keys(const struct svg *s, const struct svg_key *key, int n);

/** svg_text - <text> with one class. @anchor as in svg_words. */
void svg_text(FILE *out, const char *class, double x_px, double y_px, char anchor,
	      const char *text);

#endif
