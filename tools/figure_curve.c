/* SPDX-License-Identifier: MIT
 * The pictures of one scene: risk against headway, and how stopping distances are spread.
 */
#include <math.h>
#include "figure.h"

#define WIDTH_PX  720
#define HEIGHT_PX 430
#define PERCENT   0.01

/* The safe headways of Sec. VI, from 12,000 samples. */
static const double paper_at_m[MC_RISKS] = {100.6, 111.1, 122.7};

/* ---- risk -------------------------------------------------------------------------------------- */

static void draw_levels(struct svg *s, const struct figure_risk *r)
{
	for (int i = 0; i < MC_RISKS; i++) {
		const double level = mc_risk_level[i];
		char words[64];
		int n = snprintf(words, sizeof(words), "%.1f m", r->at_m[i]);

		svg_level(s, SVG_GREY, level, NULL);
		if (isfinite(r->ttc_s[i])) {
			snprintf(words + n, sizeof(words) - (size_t)n, ", %.2f s to collision",
				 r->ttc_s[i]);
		}
		if (isfinite(r->at_m[i])) {
			svg_dots(s, SVG_RED, &r->at_m[i], &level, 1);
			svg_words(s, r->at_m[i], level, -7, 's', words);
		}
	}
	if (r->paper) {
		svg_dots(s, SVG_PURPLE, paper_at_m, mc_risk_level, MC_RISKS);
	}
}

void figure_risk(FILE *out, const void *risk)
{
	static const struct svg_key key[] = {
		{SVG_BLUE, SVG_KEY_LINE, "risk"},
		{SVG_BLUE, SVG_KEY_AREA, "95 % interval"},
		{SVG_RED, SVG_KEY_DOT, "5, 1 and 0.1 %"},
		{SVG_PURPLE, SVG_KEY_DOT, "the paper, N = 12,000"},
	};
	const struct figure_risk *r = risk;
	const struct svg_page page = {.width_px = WIDTH_PX,
				      .height_px = HEIGHT_PX,
				      .title = r->text.title,
				      .subtitle = r->text.subtitle,
				      .note = r->text.note};
	struct svg_panel panel = {.x = {.label = "headway [m]", .min = INFINITY, .max = -INFINITY},
				  .y = {.label = "risk of a collision [%]",
					.scale = SVG_LOG,
					.unit = PERCENT,
					.max = 1},
				  .key = key,
				  .keys = r->paper ? 4 : 3};

	svg_cover(r->headway_m, r->n, &panel.x.min, &panel.x.max);
	svg_round_out(&panel.x);
	panel.y.min = fmin(r->n ? r->hi[r->n - 1] : 1, mc_risk_level[MC_RISKS - 1] / 2);
	svg_round_out(&panel.y);
	struct svg s = svg_start(out, &page);

	svg_panel(&s, &panel);
	svg_band(&s, SVG_BLUE, r->headway_m, r->lo, r->hi, r->n);
	svg_line(&s, SVG_BLUE, SVG_SOLID, r->headway_m, r->p, r->n);
	draw_levels(&s, r);
	svg_end(&s);
}

/* ---- distribution ------------------------------------------------------------------------------ */

static void draw_bars(struct svg *s, const struct figure_distribution *d)
{
	for (size_t i = 0; i < d->n; i++) {
		const double middle_m = d->first_m + (double)i + 0.5;

		svg_bars(s, SVG_BLUE, &middle_m, &d->share[i], 1, 0.86);
	}
}

void figure_distribution(FILE *out, const void *distribution)
{
	const struct figure_distribution *d = distribution;
	const struct svg_page page = {.width_px = WIDTH_PX,
				      .height_px = HEIGHT_PX,
				      .title = d->text.title,
				      .subtitle = d->text.subtitle,
				      .note = d->text.note};
	struct svg_panel panel = {
		.x = {.label = "stopping distance [m]",
		      .min = d->first_m,
		      .max = d->first_m + (double)d->n},
		.y = {.label = "share of the samples in each metre [%]", .unit = PERCENT}};
	char words[80];
	const struct svg_key key = {SVG_RED, SVG_KEY_DASHED, words};

	snprintf(words, sizeof(words),
		 "mean %.2f m and one standard deviation, %.2f m, either side", d->mean_m, d->sd_m);
	panel.key = &key;
	panel.keys = 1;
	svg_cover(d->share, d->n, &panel.y.min, &panel.y.max);
	svg_round_out(&panel.x);
	svg_round_out(&panel.y);
	struct svg s = svg_start(out, &page);

	svg_panel(&s, &panel);
	draw_bars(&s, d);
	for (int i = -1; i <= 1; i++) {
		svg_mark(&s, SVG_RED, d->mean_m + i * d->sd_m, NULL);
	}
	svg_end(&s);
}
