/* SPDX-License-Identifier: MIT
 * The pictures of the report's page: how long each stage took, the worst cycles, the risk over time. See report.h.
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include "decision.h"
#include "fault.h"
#include "figure.h"
#include "report.h"
#include "svg.h"

#define WIDTH_PX 960

static double ms(int64_t ns)
{
	return (double)ns / 1e6;
}

/* ---- histograms --------------------------------------------------------------------------------------------- */

/* In buckets of an eighth of a doubling: what the eye can tell apart on a logarithmic axis. */
#define BARS_MAX 256
struct bars {
	double low_ms, high_ms, most;
	double count[BARS_MAX];
	int n;
};

#define STEP 1.0905077326652577 /* 2^(1/8) */

static void count_bars(const struct report_stage *s, double low_ms, double high_ms, struct bars *b)
{
	*b = (struct bars){.low_ms = low_ms, .high_ms = high_ms};
	b->n = (int)ceil(log(high_ms / low_ms) / log(STEP));
	b->n = b->n < BARS_MAX ? b->n : BARS_MAX;
	for (uint64_t i = 0; i < s->n; i++) {
		const double at = log(fmax(ms(s->sorted_ns[i]), low_ms) / low_ms) / log(STEP);
		double *bar = &b->count[at < b->n ? (int)at : b->n - 1];

		b->most = ++*bar > b->most ? *bar : b->most;
	}
}

static void draw_hist(struct svg *svg, const struct stage_row *row, const struct report_stage *s,
		      int last)
{
	const double low_ms = 0.001, high_ms = 1024;
	struct bars b;
	struct svg_panel p = {.title = row->name,
			      .x = {.label = last ? "[ms]" : NULL,
				    .scale = SVG_LOG,
				    .min = low_ms,
				    .max = high_ms},
			      .y = {.label = "evaluations", .min = 0.7, .scale = SVG_LOG}};

	count_bars(s, low_ms, high_ms, &b);
	p.y.max = fmax(10, b.most * 1.5);
	svg_panel(svg, &p);
	for (int i = 0; i < b.n; i++) {
		if (b.count[i] > 0) {
			const double from = low_ms * pow(STEP, i), to = from * STEP;
			const double x = (from + to) / 2;

			svg_bars(svg, SVG_BLUE, &x, &b.count[i], 1, to - from);
		}
	}
	svg_mark(svg, SVG_RED, ms(row->budget_ns), "budget");
	svg_mark(svg, SVG_GREY, ms(s->p99_ns), "p99");
}

void report_draw_stages(const struct report *r, FILE *out)
{
	static const enum stage shown[] = {STAGE_INPUT, STAGE_MC, STAGE_DECISION, STAGE_TOTAL};
	const int n = sizeof(shown) / sizeof(shown[0]);
	struct svg svg;
	int panels = 0, drawn = 0;

	for (int i = 0; i < n; i++) {
		panels += r->stage[shown[i]].n > 0;
	}
	const struct svg_page page = {.width_px = WIDTH_PX,
				      .height_px = 60 + 150 * panels,
				      .title = "How long each stage took",
				      .shares = panels,
				      .embedded = 1};

	if (!panels) {
		return;
	}
	fputs("<h2>How it is spread</h2>\n", out);
	svg = svg_start(out, &page);
	for (int i = 0; i < n; i++) {
		if (r->stage[shown[i]].n) {
			drawn++;
			draw_hist(&svg, &stage_table[shown[i]], &r->stage[shown[i]],
				  drawn == panels);
		}
	}
	svg_end(&svg);
}

/* ---- worst cycles ------------------------------------------------------------------------------------------- */

static const enum svg_colour stage_colour[STAGE_DECISION] = {
	[STAGE_INPUT] = SVG_GREY,    [STAGE_SCENE] = SVG_SKY,  [STAGE_REQUEST] = SVG_AMBER,
	[STAGE_MC] = SVG_BLUE,       [STAGE_DECIDE] = SVG_RED, [STAGE_SEND] = SVG_GREEN,
	[STAGE_CONFIRM] = SVG_PURPLE};

/* Of a replay one after the other: the log's time and this machine's have no common zero. */
static void draw_cycle(struct svg *svg, const struct report *r, const struct report_cycle *c,
		       int lane)
{
	char text[96];
	double sum_ms = 0;

	for (int s = 0; s < STAGE_DECISION; s++) {
		const int64_t ns = report_stage_ns(r, c, (enum stage)s);
		const int64_t at_ns = c->t_ns[stage_table[s].from] - c->t_ns[EDGE_INPUT];
		const double from_ms = r->replay ? sum_ms : ms(at_ns);

		if (ns > 0) {
			snprintf(text, sizeof(text), "%s %.3f ms", stage_table[s].name, ms(ns));
			svg_span(svg, stage_colour[s], lane, from_ms, from_ms + ms(ns), text);
			sum_ms += ms(ns);
		}
	}
}

void report_draw_worst(const struct report *r, FILE *out)
{
	char name[REPORT_WORST][48];
	const char *names[REPORT_WORST];
	struct svg_key key[STAGE_DECISION];
	struct svg_panel p = {.x = {.label = r->replay
						     ? "age of the inputs in the log, then what "
						       "this machine computed [ms]"
						     : "since the oldest input was received [ms]"},
			      .y = {.scale = SVG_NAMES, .name = names, .n = r->n_worst},
			      .key = key,
			      .keys = STAGE_DECISION};
	const struct svg_page page = {
		.width_px = WIDTH_PX,
		.height_px = 110 + 26 * r->n_worst,
		.title = r->replay ? "The longest cycles, from the oldest input to the decision"
				   : "The longest cycles, from the oldest input to the bus",
		.left_px = 110,
		.embedded = 1};
	struct svg svg;

	if (!r->n_worst) {
		return;
	}
	for (int i = 0; i < r->n_worst; i++) {
		snprintf(name[i], sizeof(name[i]), "cycle %" PRIu64 "%s", r->worst[i]->id,
			 r->worst[i]->late ? ", late" : "");
		names[i] = name[i];
	}
	for (int s = 0; s < STAGE_DECISION; s++) {
		key[s] = (struct svg_key){stage_colour[s], SVG_KEY_DOT, stage_table[s].name};
	}
	p.x.max = ms(report_cycle_ns(r, r->worst[0]));
	svg_round_out(&p.x);
	fputs("<h2>The worst cycles</h2>\n", out);
	svg = svg_start(out, &page);
	svg_panel(&svg, &p);
	for (int i = 0; i < r->n_worst; i++) {
		draw_cycle(&svg, r, r->worst[i], i);
	}
	if (p.x.max >= ms(stage_table[STAGE_TOTAL].budget_ns)) {
		svg_mark(&svg, SVG_RED, ms(stage_table[STAGE_TOTAL].budget_ns), "budget");
	}
	svg_end(&svg);
}

/* ---- risk ------------------------------------------------------------------------------------------------------ */

enum column { TIME, EGO, LEAD_SPEED, HEADWAY, SAFE, P, LO, HI, ACCEL, LEAD, COLUMNS };

static void fill(const struct report *r, double *v, const char **level, const char **state)
{
	const size_t n = r->n_evaluations;

	for (size_t i = 0; i < n; i++) {
		const struct report_evaluation *e = &r->evaluation[i];
		const double row[COLUMNS] = {[TIME] = e->t_s - (double)r->first_mono_ns / 1e9,
					     [EGO] = e->speed_mps,
					     [LEAD_SPEED] = e->lead_speed_mps,
					     [HEADWAY] = e->headway_m,
					     [SAFE] = e->safe_m,
					     [P] = e->p,
					     [LO] = e->lo,
					     [HI] = e->hi,
					     [ACCEL] = e->accel_mps2,
					     [LEAD] = e->lead};

		for (int c = 0; c < COLUMNS; c++) {
			v[(size_t)c * n + i] = row[c];
		}
		level[i] = e->level < 0 ? "none" : level_name[e->level];
		state[i] = e->state < 0 ? state_name[STATE_INIT] : state_name[e->state];
	}
}

void report_draw_risk(const struct report *r, FILE *out)
{
	const size_t n = r->n_evaluations;
	double *v = calloc(n * COLUMNS + 1, sizeof(*v));
	const char **word = calloc(2 * n + 1, sizeof(*word));

	if (v && word && n > 1) {
		fill(r, v, word, word + n);
		const struct figure_timeline t = {.text = {.title = "Risk and what led to it"},
						  .n = n,
						  .from_s = v[0],
						  .to_s = v[n - 1],
						  .time_s = v + TIME * n,
						  .ego_mps = v + EGO * n,
						  .lead_mps = v + LEAD_SPEED * n,
						  .headway_m = v + HEADWAY * n,
						  .safe_m = v + SAFE * n,
						  .p = v + P * n,
						  .lo = v + LO * n,
						  .hi = v + HI * n,
						  .accel_mps2 = v + ACCEL * n,
						  .lead = v + LEAD * n,
						  .level = word,
						  .state = word + n};

		fputs("<h2>Risk over time</h2>\n", out);
		figure_timeline(out, &t);
	}
	free(word);
	free(v);
}
