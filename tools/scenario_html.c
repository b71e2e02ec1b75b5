/* SPDX-License-Identifier: MIT
 * What came of a suite as one page that needs nothing else: when it warned and braked beside the physical limit, and the
 * table.
 */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include "cli.h"
#include "page.h"
#include "rules.h"
#include "scenario_report.h"
#include "svg.h"

#define LANE_PX  15.0
#define FRAME_PX 120.0 /* title, axis and legend */

struct column {
	const char *name;
	int digits; /* after the point */
	double (*of)(const struct scenario_plan *p, int row, const struct scenario_row *r);
};

static double contacts_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)p, (void)row;
	return r->contacts;
}

static double impact_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)p, (void)row;
	return r->contacts ? r->impact_mps : NAN;
}

static double closest_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)p, (void)row;
	return r->closest_m;
}

static double warn_column(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)p, (void)row;
	return r->warn_s;
}

static double request_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)p, (void)row;
	return r->request_s;
}

static double request99_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)p, (void)row;
	return r->request99_s;
}

static double latest_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)r;
	return p->latest_s[row];
}

static double before_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)p, (void)row;
	return r->before_mps2;
}

static double after_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)p, (void)row;
	return r->after_mps2;
}

static double evaluated_of(const struct scenario_plan *p, int row, const struct scenario_row *r)
{
	(void)row;
	return p->live ? NAN : r->evaluated;
}

static const struct column column[] = {
	{"contacts", 0, contacts_of},  {"impact, m/s", 2, impact_of},
	{"closest, m", 2, closest_of}, {"warning, s", 2, warn_column},
	{"request, s", 2, request_of}, {"99 %, s", 2, request99_of},
	{"latest, s", 2, latest_of},   {"before, m/s2", 2, before_of},
	{"after, m/s2", 2, after_of},  {"evaluated", 0, evaluated_of},
};
#define COLUMNS (sizeof(column) / sizeof(column[0]))

/* ---- table ------------------------------------------------------------------------------------- */

static void table(FILE *out, const struct scenario_plan *p, const struct scenario_row *r)
{
	fputs("<div class=wide><table><tr><th>row", out);
	for (size_t i = 0; i < COLUMNS; i++) {
		fprintf(out, "<th>%s", column[i].name);
	}
	fputs("<th></tr>\n", out);
	for (int row = 0; row < p->rows; row++) {
		fputs("<tr><td>", out);
		svg_escape(out, p->row[row].name);
		for (size_t i = 0; i < COLUMNS; i++) {
			const double v = column[i].of(p, row, &r[row]);

			fprintf(out, isfinite(v) ? "<td>%.*f" : "<td>", column[i].digits, v);
		}
		fprintf(out, "<td class=\"text%s\">%s</tr>\n", r[row].failed ? " bad" : "",
			scenario_verdict(&p->row[row], &r[row]));
	}
	fputs("</table></div>\n", out);
}

/* ---- picture ----------------------------------------------------------------------------------- */

static double end_s(const struct scenario_plan *p, const struct scenario_row *r)
{
	double end = 1;

	for (int i = 0; i < p->rows; i++) {
		end = fmax(end, fmax(r[i].warn_s, r[i].request99_s));
		end = isfinite(p->latest_s[i]) ? fmax(end, p->latest_s[i]) : end;
	}
	return ceil(end);
}

static void lanes(struct svg *s, const struct scenario_plan *p, const struct scenario_row *r)
{
	for (int i = 0; i < p->rows; i++) {
		const double lane = i;

		if (isfinite(r[i].request_s)) {
			svg_span(s, SVG_AMBER, i, fmin(r[i].warn_s, r[i].request_s), r[i].request_s,
				 "");
		}
		svg_dots(s, SVG_AMBER, &r[i].warn_s, &lane, 1);
		svg_dots(s, SVG_RED, &r[i].request_s, &lane, 1);
		svg_dots(s, SVG_GREY, &p->latest_s[i], &lane, 1);
	}
}

static void picture(FILE *out, const struct scenario_plan *p, const struct scenario_row *r,
		    const char **name)
{
	static const struct svg_key key[] = {
		{SVG_AMBER, SVG_KEY_AREA, "warning to request (median)"},
		{SVG_RED, SVG_KEY_DOT, "request"},
		{SVG_GREY, SVG_KEY_DOT, "physical latest moment"},
	};
	const struct svg_page page = {
		.width_px = 1000,
		.height_px = FRAME_PX + LANE_PX * p->rows,
		.title = p->suite->doc,
		.left_px = 260,
		.embedded = 1,
	};
	const struct svg_panel panel = {
		.x = {.label = "from the lead's onset, or from the start, s",
		      .min = 0,
		      .max = end_s(p, r)},
		.y = {.scale = SVG_NAMES, .name = name, .n = p->rows},
		.key = key,
		.keys = 3,
	};
	struct svg s = svg_start(out, &page);

	svg_panel(&s, &panel);
	lanes(&s, p, r);
	svg_end(&s);
}

/* ---- page -------------------------------------------------------------------------------------- */

static void share(FILE *out, const struct scenario_share *s, const char *of)
{
	fprintf(out, "%" PRIu64 " of %" PRIu64 " %s missed it (95 %% interval %.3g .. %.3g %%); ",
		s->failed, s->judged, of, s->lo * 100, s->hi * 100);
}

static void head(FILE *out, const struct scenario_plan *p, const struct scenario_sum *s)
{
	char title[64], cpu[128];

	snprintf(title, sizeof(title), "aebmc scenario %s", p->suite->name);
	cli_cpu_name(cpu, sizeof(cpu));
	page_open(out, title);
	fputs("<p>", out);
	scenario_rows(out, p);
	fprintf(out,
		", %" PRIu64 " runs; full braking %g m/s<sup>2</sup>, %lld "
		"samples, configuration %016" PRIx64 "%s%s; ",
		s->runs, p->cfg->brake_accel, (long long)p->cfg->mc_samples,
		config_hash(p->cfg, p->map), p->rule ? ", decided by " : "",
		p->rule ? p->rule->name : "");
	svg_escape(out, cpu);
	fputs("</p><p>", out);
	share(out, &s->all, "with a goal");
	if (!p->live) {
		fprintf(out, "%" PRIu64 " had an evaluation; ", s->evaluated);
		share(out, &s->in_evaluated, "with a goal and an evaluation");
	}
	fprintf(out,
		"%" PRIu64 " with contact, %" PRIu64 " with a request, of which %" PRIu64
		" without a warning before</p>\n",
		s->contacts, s->requests, s->unwarned);
}

int scenario_html(FILE *out, const struct scenario_plan *p, const struct scenario_result *r)
{
	const struct scenario_sum sum = scenario_sum_of(p, r);
	struct scenario_row *row = calloc((size_t)p->rows, sizeof(*row));
	const char **name = calloc((size_t)p->rows, sizeof(*name));
	const int ok = row && name;

	for (int i = 0; ok && i < p->rows; i++) {
		row[i] = scenario_row_of(p, i, r + i * p->cars);
		name[i] = p->row[i].name;
	}
	if (ok) {
		head(out, p, &sum);
		scenario_faults(out, p, "<p>", "</p>\n");
		picture(out, p, row, name);
		table(out, p, row);
		page_close(out);
	}
	free(row);
	free(name);
	return ok ? 0 : -ENOMEM;
}
