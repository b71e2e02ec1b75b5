/* SPDX-License-Identifier: MIT
 * The report as one page that needs nothing else: tables and pictures, for light and dark. See report.h.
 */
#include <inttypes.h>
#include <math.h>
#include "clock.h"
#include "page.h"
#include "report.h"
#include "svg.h"

static double ms(int64_t ns)
{
	return (double)ns / 1e6;
}

/* ---- tables ----------------------------------------------------------------------------------------------- */

static void cell_ms(FILE *out, int64_t ns)
{
	if (ns < 0) {
		fputs("<td>\342\200\223</td>", out);
	} else {
		fprintf(out, "<td>%.*f</td>", ns < 10 * CLOCK_NS_PER_MS ? 3 : 1, ms(ns));
	}
}

static void cell_count(FILE *out, uint64_t n, int bad)
{
	fprintf(out, bad ? "<td class=bad>%" PRIu64 "</td>" : "<td>%" PRIu64 "</td>", n);
}

static void cell_share(FILE *out, double p)
{
	if (isnan(p)) {
		fputs("<td>\342\200\223</td>", out);
	} else {
		fprintf(out, "<td>%.3g %%</td>", 100 * p);
	}
}

static void figures(FILE *out, const struct report_stage *s)
{
	cell_count(out, s->n, 0);
	cell_ms(out, s->p50_ns);
	cell_ms(out, s->p95_ns);
	cell_ms(out, s->p99_ns);
	cell_ms(out, s->p99_9_ns);
	cell_ms(out, s->max_ns);
}

static void sub_row(const struct report *r, int sub, FILE *out)
{
	if (r->sub[sub].n) {
		fprintf(out, "<tr class=part><td>&emsp;%s</td>", report_sub_name[sub]);
		figures(out, &r->sub[sub]);
		fprintf(out, "<td></td><td></td><td class=\"text faint\">%s</td></tr>\n",
			report_sub_doc[sub]);
	}
}

static void stage_table_html(const struct report *r, FILE *out)
{
	fputs("<h2>Where the time goes</h2><div class=wide><table><tr><th>stage "
	      "[ms]<th>n<th>p50<th>p95<th>p99"
	      "<th>p99.9<th>max<th>budget<th>over<th></tr>\n",
	      out);
	for (int s = 0; s < STAGES; s++) {
		const struct stage_row *row = &stage_table[s];

		fprintf(out, "<tr%s><td>%s</td>", s >= STAGE_DECISION ? " class=sum" : "",
			row->name);
		figures(out, &r->stage[s]);
		cell_ms(out, row->budget_ns ? row->budget_ns : -1);
		if (row->budget_ns) {
			cell_count(out, r->stage[s].over, r->stage[s].over > 0);
		} else {
			fputs("<td></td>", out);
		}
		fprintf(out, "<td class=\"text faint\">%s</td></tr>\n", row->doc);
		for (int k = 0; k < SUBS && s == STAGE_MC; k++) {
			sub_row(r, k, out);
		}
	}
	fputs("</table></div>\n", out);
}

static void miss_table_html(const struct report *r, FILE *out)
{
	static const char *const unit[MISSES] = {"evaluations", "evaluations", "periods", "scans"};

	fputs("<h2>What was missed</h2><div "
	      "class=wide><table><tr><th>kind<th>n<th>of<th>runs<th>longest run"
	      "<th>chance<th>after a miss<th></tr>\n",
	      out);
	for (int k = 0; k < MISSES; k++) {
		const struct report_runs *u = &r->runs[k];

		fprintf(out, "<tr><td>%s</td>", miss_name[k]);
		cell_count(out, r->missed[k], r->missed[k] > 0);
		cell_count(out, u->n, 0);
		cell_count(out, u->runs, 0);
		cell_count(out, u->longest, 0);
		cell_share(out, report_chance(u));
		cell_share(out, report_chance_again(u));
		fprintf(out, "<td class=\"text faint\">%s</td></tr>\n", unit[k]);
	}
	fprintf(out,
		"</table></div><p>%" PRIu64 " request frames in time + %" PRIu64 " missed, %" PRIu64
		" were due: <span class=%s</span></p>\n",
		r->published - r->published_late, r->runs[MISS_PERIOD].misses, report_ticks(r),
		report_adds_up(r) ? "good>adds up" : "bad>does not add up, events are missing");
}

static void miss_list_html(const struct report *r, FILE *out)
{
	if (!r->n_misses) {
		return;
	}
	fprintf(out,
		"<details><summary>Each of them (%zu)</summary><div class=wide><table>"
		"<tr><th>after [s]<th>kind<th>stage<th>cycle<th>count<th>over by [ms]</tr>\n",
		r->n_misses);
	for (size_t i = 0; i < r->n_misses; i++) {
		const struct report_miss *m = &r->miss[i];

		fprintf(out, "<tr><td>%.3f</td><td>%s</td><td>%s</td><td>%" PRIu64 "</td>",
			(double)(m->t_ns - r->first_ns) / 1e9, miss_name[m->kind],
			m->stage < 0 ? "" : stage_table[m->stage].name, m->cycle);
		cell_count(out, m->count, 0);
		cell_ms(out, m->late_ns ? m->late_ns : -1);
		fputs("</tr>\n", out);
	}
	fputs("</table></div></details>\n", out);
}

static void worst_table_html(const struct report *r, FILE *out)
{
	char when[32];

	if (!r->n_worst) {
		return;
	}
	fputs("<div class=wide><table><tr><th>cycle<th>UTC<th>all [ms]", out);
	for (int s = 0; s < STAGE_DECISION; s++) {
		fprintf(out, "<th>%s", stage_table[s].name);
	}
	fputs("</tr>\n", out);
	for (int i = 0; i < r->n_worst; i++) {
		const struct report_cycle *c = r->worst[i];

		report_when(r, c->t_ns[EDGE_INPUT], when, sizeof(when));
		fprintf(out, "<tr><td>%" PRIu64 "</td><td>%s</td>", c->id, when);
		cell_ms(out, report_cycle_ns(r, c));
		for (int s = 0; s < STAGE_DECISION; s++) {
			cell_ms(out, report_stage_ns(r, c, (enum stage)s));
		}
		fputs("</tr>\n", out);
	}
	fputs("</table></div>\n", out);
}

/* ---- page ------------------------------------------------------------------------------------------------------ */

static void head(const struct report *r, const char *dir, FILE *out)
{
	char when[32];

	report_when(r, r->first_mono_ns, when, sizeof(when));
	page_open(out, "aebmc report");
	fputs("<p class=faint>", out);
	svg_escape(out, dir);
	fprintf(out,
		"</p>\n<p>%.1f s from %s UTC, %zu evaluations, %" PRIu64 " events, %" PRIu64
		" lost.</p>\n",
		report_seconds(r), when, r->n_cycles, r->events, r->lost.events);
	if (r->replay) {
		fputs("<p class=bad>A replay: input is the log's time; request, mc and decide "
		      "are what this machine took; nothing was waited for or sent.</p>\n",
		      out);
	}
}

void report_html(const struct report *r, const char *dir, FILE *out)
{
	head(r, dir, out);
	stage_table_html(r, out);
	report_draw_stages(r, out);
	miss_table_html(r, out);
	miss_list_html(r, out);
	report_draw_worst(r, out);
	worst_table_html(r, out);
	report_draw_risk(r, out);
	page_close(out);
}
