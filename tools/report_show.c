/* SPDX-License-Identifier: MIT
 * The report as tables of words. See report.h.
 */
#include <inttypes.h>
#include <math.h>
#include "clock.h"
#include "report.h"

#define MISSES_SHOWN 12

static double ms(int64_t ns)
{
	return (double)ns / 1e6;
}

static void show_ms(FILE *out, int64_t ns)
{
	if (ns < 0) {
		fprintf(out, " %9s", "-");
	} else {
		fprintf(out, " %9.3f", ms(ns));
	}
}

static void show_figures(FILE *out, const struct report_stage *s)
{
	const int64_t ns[] = {s->p50_ns, s->p95_ns, s->p99_ns, s->p99_9_ns, s->max_ns};

	fprintf(out, " %8" PRIu64, s->n);
	for (size_t i = 0; i < sizeof(ns) / sizeof(ns[0]); i++) {
		show_ms(out, ns[i]);
	}
}

static void head(const struct report *r, const char *dir, FILE *out)
{
	char when[32];

	report_when(r, r->first_mono_ns, when, sizeof(when));
	fprintf(out, "%s: %.1f s from %s UTC, %zu evaluations, %" PRIu64 " events", dir,
		report_seconds(r), when, r->n_cycles, r->events);
	if (r->lost.events || r->lost.packets) {
		fprintf(out, "; the tracer lost %" PRIu64 " events and %" PRIu64 " packets",
			r->lost.events, r->lost.packets);
	}
	fputc('\n', out);
	if (r->foreign) {
		fprintf(out, "%" PRIu64 " events are not known to this program\n", r->foreign);
	}
	if (r->replay) {
		fputs("A replay: input is the log's time; request, mc and decide are what this "
		      "machine "
		      "took; nothing was waited for or sent.\n",
		      out);
	}
}

static void show_sub(const struct report *r, int sub, FILE *out)
{
	if (r->sub[sub].n) {
		fprintf(out, "  %-8s", report_sub_name[sub]);
		show_figures(out, &r->sub[sub]);
		fprintf(out, " %9s %6s  %s\n", "", "", report_sub_doc[sub]);
	}
}

static void stages(const struct report *r, FILE *out)
{
	fprintf(out, "\n%-10s %8s %9s %9s %9s %9s %9s %9s %6s  %s\n", "stage [ms]", "n", "p50",
		"p95", "p99", "p99.9", "max", "budget", "over", "what it is");
	for (int s = 0; s < STAGES; s++) {
		const struct stage_row *row = &stage_table[s];

		fprintf(out, "%-10s", row->name);
		show_figures(out, &r->stage[s]);
		show_ms(out, row->budget_ns ? row->budget_ns : -1);
		if (row->budget_ns) {
			fprintf(out, " %6" PRIu64, r->stage[s].over);
		} else {
			fprintf(out, " %6s", "-");
		}
		fprintf(out, "  %s\n", row->doc);
		for (int k = 0; k < SUBS && s == STAGE_MC; k++) {
			show_sub(r, k, out);
		}
	}
}

/* How much of a budget is used where nearly all evaluations stay. */
static void headroom(const struct report *r, FILE *out)
{
	static const enum stage judged[] = {STAGE_MC, STAGE_TOTAL};

	for (size_t i = 0; i < sizeof(judged) / sizeof(judged[0]); i++) {
		const struct stage_row *row = &stage_table[judged[i]];
		const struct report_stage *s = &r->stage[judged[i]];

		if (s->n) {
			fprintf(out, "%s%s: longest %.3f ms of %.0f ms, %.3g %%", i ? "; " : "",
				row->name, ms(s->max_ns), ms(row->budget_ns),
				100 * (double)s->max_ns / (double)row->budget_ns);
		}
	}
	fputc('\n', out);
}

static void show_chance(FILE *out, double p)
{
	if (isnan(p)) {
		fprintf(out, " %10s", "-");
	} else {
		fprintf(out, " %8.3g %%", 100 * p);
	}
}

static void misses(const struct report *r, FILE *out)
{
	static const char *const unit[MISSES] = {"evaluations", "evaluations", "periods", "scans"};

	fprintf(out, "\n%-8s %8s %8s %8s %8s %10s %10s\n", "missed", "n", "of", "runs", "longest",
		"chance", "after one");
	for (int k = 0; k < MISSES; k++) {
		const struct report_runs *u = &r->runs[k];

		fprintf(out, "%-8s %8" PRIu64 " %8" PRIu64 " %8" PRIu64 " %8" PRIu64, miss_name[k],
			r->missed[k], u->n, u->runs, u->longest);
		show_chance(out, report_chance(u));
		show_chance(out, report_chance_again(u));
		fprintf(out, "  %s\n", unit[k]);
	}
}

static void reconcile(const struct report *r, FILE *out)
{
	fprintf(out,
		"%" PRIu64 " request frames in time + %" PRIu64 " missed = %" PRIu64
		", due in this time at a period of %.0f ms: %" PRIu64 "%s\n",
		r->published - r->published_late, r->runs[MISS_PERIOD].misses,
		r->published - r->published_late + r->runs[MISS_PERIOD].misses, ms(r->period_ns),
		report_ticks(r),
		report_adds_up(r) ? ", adds up" : ", does NOT add up: events are missing");
}

static void each_miss(const struct report *r, FILE *out)
{
	size_t i = 0;

	for (; i < r->n_misses && i < MISSES_SHOWN; i++) {
		const struct report_miss *m = &r->miss[i];

		fprintf(out, "%s%10.3f s  %s%s%s", i ? "" : "\n",
			(double)(m->t_ns - r->first_ns) / 1e9, miss_name[m->kind],
			m->stage < 0 ? "" : " ", m->stage < 0 ? "" : stage_table[m->stage].name);
		fprintf(out, ", %" PRIu64 " at cycle %" PRIu64, m->count, m->cycle);
		if (m->late_ns) {
			fprintf(out, ", %.3f ms over", ms(m->late_ns));
		}
		fputc('\n', out);
	}
	if (r->n_misses > i) {
		fprintf(out, "... and %zu more; --json has all\n", r->n_misses - i);
	}
}

static void worst(const struct report *r, FILE *out)
{
	char when[32];

	fprintf(out, "\n%-14s %-23s %9s", "worst cycles", "UTC", "all [ms]");
	for (int s = 0; s < STAGE_DECISION; s++) {
		fprintf(out, " %9s", stage_table[s].name);
	}
	fputc('\n', out);
	for (int i = 0; i < r->n_worst; i++) {
		const struct report_cycle *c = r->worst[i];

		report_when(r, c->t_ns[EDGE_INPUT], when, sizeof(when));
		fprintf(out, "%-14" PRIu64 " %-23s", c->id, when);
		show_ms(out, report_cycle_ns(r, c));
		for (int s = 0; s < STAGE_DECISION; s++) {
			show_ms(out, report_stage_ns(r, c, (enum stage)s));
		}
		fputs(c->late ? "  late\n" : c->missed ? "  over budget\n" : "\n", out);
	}
}

void report_show(const struct report *r, const char *dir, FILE *out)
{
	head(r, dir, out);
	stages(r, out);
	headroom(r, out);
	misses(r, out);
	reconcile(r, out);
	each_miss(r, out);
	worst(r, out);
}
