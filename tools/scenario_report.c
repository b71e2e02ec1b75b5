/* SPDX-License-Identifier: MIT
 * What came of a suite: the figures, and in words.
 */
#include "scenario_report.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include "cli.h"
#include "hist.h"
#include "rules.h"
#include "sort.h"
#include "stats.h"

#define ADDED_MPS2 \
	(0.25 * 9.81) /* FMVSS 127: peak additional deceleration in its tests of false activation */

/* ---- figures ---------------------------------------------------------------------------------- */

/* Of @v[@n], which is put in order; the nearest rank. */
static double quantile(double *v, size_t n, double q)
{
	if (!n) {
		return NAN;
	}
	sort_doubles(v, n);
	return v[hist_rank(n, q) - 1];
}

/* Finite values of one figure over a row's cars. */
static size_t collect(const struct scenario_plan *p, const struct scenario_result *r,
		      double (*of)(const struct scenario_result *), double less, double *v)
{
	size_t n = 0;

	for (int i = 0; i < p->cars; i++) {
		const double x = of(&r[i]);

		if (isfinite(x)) {
			v[n++] = x - less;
		}
	}
	return n;
}

static double warn_of(const struct scenario_result *r)
{
	return r->warn_s;
}

/* Of a log nobody's deceleration is noted. */
static int is_calm(const struct scenario *s)
{
	return s->goal == GOAL_NO_REQUEST && !s->log;
}

/* NaN where none was unwanted. */
static double added_of(const struct scenario *s, const struct scenario_result *r)
{
	return is_calm(s) && isfinite(scenario_first(r)) ? r->peak_after_mps2 - r->peak_before_mps2
							 : NAN;
}

static void add_run(struct scenario_row *row, const struct scenario *s,
		    const struct scenario_result *r, double latest_s)
{
	const double request_s = scenario_first(r);
	const double spare_s = latest_s + s->onset_s - request_s;

	row->runs++;
	row->contacts += r->contact;
	row->requests += isfinite(request_s);
	row->warned += r->warn > 0;
	row->failed += !scenario_passed(s, r);
	row->evaluated += r->evaluations > 0;
	row->impact_mps = fmax(row->impact_mps, r->impact_mps);
	row->closest_m = fmin(row->closest_m, r->closest_m); /* of NaN and a number: the number */
	row->spare_s = fmin(row->spare_s, spare_s);          /* of NaN and a number: the number */
	row->added_mps2 = fmax(row->added_mps2, added_of(s, r)); /* as closest_m */
	row->before_mps2 = fmax(row->before_mps2, r->peak_before_mps2);
	row->after_mps2 = fmax(row->after_mps2, r->peak_after_mps2);
}

struct scenario_row scenario_row_of(const struct scenario_plan *p, int row,
				    const struct scenario_result *r)
{
	const struct scenario *s = &p->row[row];
	struct scenario_row out = {.closest_m = NAN,
				   .added_mps2 = NAN,
				   .spare_s = NAN,
				   .warn_s = NAN,
				   .request_s = NAN,
				   .request99_s = NAN};
	double *v = malloc((size_t)p->cars * sizeof(*v));

	for (int i = 0; i < p->cars; i++) {
		add_run(&out, s, &r[i], p->first_car ? NAN : p->latest_s[row]);
	}
	if (v) {
		size_t n = collect(p, r, warn_of, s->onset_s, v);

		out.warn_s = quantile(v, n, 0.5);
		n = collect(p, r, scenario_first, s->onset_s, v);
		out.request_s = quantile(v, n, 0.5);
		out.request99_s = quantile(v, n, 0.99);
	}
	free(v);
	return out;
}

static void add_judged(struct scenario_share *share, int failed)
{
	share->judged++;
	share->failed += (uint64_t)failed;
}

static void bound(struct scenario_share *share)
{
	share->hi = 1;
	if (share->judged) {
		stats_wilson(share->failed, share->judged, &share->lo, &share->hi);
	}
}

static void add_to_sum(struct scenario_sum *sum, const struct scenario *s,
		       const struct scenario_result *r, double *lead, size_t *leads)
{
	const double request_s = scenario_first(r);
	const int requested = isfinite(request_s);

	sum->runs++;
	sum->evaluated += r->evaluations > 0;
	sum->contacts += (uint64_t)r->contact;
	sum->requests += (uint64_t)requested;
	if (s->goal == GOAL_NO_CONTACT || s->goal == GOAL_NO_REQUEST) {
		add_judged(&sum->all, !scenario_passed(s, r));
		if (r->evaluations) {
			add_judged(&sum->in_evaluated, !scenario_passed(s, r));
		}
	}
	sum->calm += is_calm(s);
	sum->added_mps2 =
		fmax(sum->added_mps2, added_of(s, r)); /* of NaN and a number: the number */
	if (requested && !(r->warn_s < request_s)) {
		sum->unwarned++;
	} else if (requested && lead) {
		lead[(*leads)++] = request_s - r->warn_s;
	}
}

struct scenario_sum scenario_sum_of(const struct scenario_plan *p, const struct scenario_result *r)
{
	struct scenario_sum sum = {.lead_s = NAN, .lead_least_s = NAN};
	const int n = p->rows * p->cars;
	double *lead = malloc((size_t)n * sizeof(*lead));
	size_t leads = 0;

	for (int i = 0; i < n; i++) {
		add_to_sum(&sum, &p->row[i / p->cars], &r[i], lead, &leads);
	}
	bound(&sum.all);
	bound(&sum.in_evaluated);
	if (leads) {
		sum.lead_s = quantile(lead, leads, 0.5);
		sum.lead_least_s = lead[0];
	}
	free(lead);
	return sum;
}

const struct scenario_fault *scenario_fault_of(const struct scenario_plan *p, int row)
{
	const struct scenario_fault *f = p->row[row].fault;

	return row > 0 && p->row[row - 1].fault == f ? NULL : f;
}

/* ---- words ------------------------------------------------------------------------------------- */

static void cell(FILE *out, int width, const char *fmt, double v)
{
	char text[32] = "-";

	if (isfinite(v)) {
		snprintf(text, sizeof(text), fmt, v);
	}
	fprintf(out, "%*s", width, text);
}

const char *scenario_verdict(const struct scenario *s, const struct scenario_row *r)
{
	switch (s->goal) {
	case GOAL_STATED:
		return r->contacts ? "contact (stated)" : "stated";
	case GOAL_UNKNOWABLE:
		return r->failed ? "not passed: the sensors say it is a car" : "passed";
	default:
		return r->failed ? s->goal == GOAL_NO_CONTACT ? "CONTACT" : "REQUEST" : "passed";
	}
}

void scenario_faults(FILE *out, const struct scenario_plan *p, const char *before,
		     const char *after)
{
	for (int i = 0; i < p->rows; i++) {
		const struct scenario_fault *f = scenario_fault_of(p, i);

		if (!f) {
			continue;
		}
		fprintf(out, "%s%s: %s; ", before, f->name, f->doc);
		for (int k = 0; k < SCENARIO_SETS_MAX && f->set[k]; k++) {
			fprintf(out, "%s, ", f->set[k]);
		}
		fprintf(out, "configuration %016" PRIx64 "%s", config_hash(&p->told[i], p->map),
			after);
	}
}

void scenario_rows(FILE *out, const struct scenario_plan *p)
{
	if (p->rows < p->of_rows) {
		fprintf(out, "%d of ", p->rows);
	}
	fprintf(out, "%d rows", p->of_rows);
}

static void print_head(FILE *out, const struct scenario_plan *p)
{
	char hash[20], cpu[128];

	snprintf(hash, sizeof(hash), "%016" PRIx64, config_hash(p->cfg, p->map));
	cli_cpu_name(cpu, sizeof(cpu));
	fprintf(out, "%s: %s\n", p->suite->name, p->suite->doc);
	scenario_rows(out, p);
	fprintf(out, ", %d %s; full braking %g m/s2; %lld samples; configuration %s; %s\n", p->cars,
		p->first_car ? "drawn cars each" : "nominal car each", p->cfg->brake_accel,
		(long long)p->cfg->mc_samples, hash, cpu);
	if (p->rule) {
		fprintf(out, "decided by: %s\n", p->rule->doc);
	}
	scenario_faults(out, p, "", "\n");
	fprintf(out,
		"\n%-40s %8s %8s %7s %7s %7s %7s %7s %7s %7s\n%-40s %8s %8s %7s %7s %7s %7s %7s "
		"%7s "
		"%7s\n",
		"", "contact", "closest", "warning", "request", "99 %", "latest", "spare", "decel",
		"decel", "times from the lead's onset, or from the start", "", "m", "s", "s", "s",
		"s", "s", "before", "after");
}

static void print_row(FILE *out, const struct scenario_plan *p, int row,
		      const struct scenario_result *r)
{
	const struct scenario *s = &p->row[row];
	const struct scenario_row a = scenario_row_of(p, row, r);
	char contact[32] = "-";

	if (a.contacts && a.runs > 1) {
		snprintf(contact, sizeof(contact), "%d/%d", a.contacts, a.runs);
	} else if (a.contacts) {
		snprintf(contact, sizeof(contact), "%.1f m/s", a.impact_mps);
	}
	fprintf(out, "%-40s %8s", s->name, contact);
	cell(out, 9, "%.2f", a.closest_m);
	cell(out, 8, "%.2f", a.warn_s);
	cell(out, 8, "%.2f", a.request_s);
	cell(out, 8, "%.2f", a.request99_s);
	cell(out, 8, "%.2f", p->latest_s[row]);
	cell(out, 8, "%.2f", a.spare_s);
	cell(out, 8, "%.2f", a.before_mps2);
	cell(out, 8, "%.2f", a.after_mps2);
	fprintf(out, "  %s%s", scenario_verdict(s, &a),
		a.evaluated || p->live ? "" : ", never evaluated");
	if (a.contacts) {
		fprintf(out, ", worst %.2f m/s", a.impact_mps);
	}
	if (isfinite(a.added_mps2)) {
		fprintf(out, ", added %.2f m/s2", a.added_mps2);
	}
	fputc('\n', out);
}

static void print_share(FILE *out, const struct scenario_share *s, const char *of)
{
	fprintf(out, "%" PRIu64 " of %" PRIu64 " %s missed it: 95 %% interval %.3g .. %.3g %%\n",
		s->failed, s->judged, of, s->lo * 100, s->hi * 100);
}

static void print_sum(FILE *out, const struct scenario_plan *p, const struct scenario_sum *s)
{
	fprintf(out, "\n%" PRIu64 " runs, %" PRIu64 " with contact, %" PRIu64 " with a request",
		s->runs, s->contacts, s->requests);
	if (p->live) {
		fputc('\n', out);
	} else {
		fprintf(out, ", %" PRIu64 " with an evaluation\n", s->evaluated);
	}
	print_share(out, &s->all, "with a goal");
	if (!p->live) {
		print_share(out, &s->in_evaluated, "with a goal and an evaluation");
	}
	if (s->calm) {
		fprintf(out,
			"deceleration that requests added where none was wanted: %.2f m/s2 "
			"(FMVSS 127: below %.2f)\n",
			s->added_mps2, ADDED_MPS2);
	}
	if (s->requests) {
		fprintf(out, "requests without a warning before them: %" PRIu64, s->unwarned);
		fputs("; warning before request: median", out);
		cell(out, 5, "%.2f", s->lead_s);
		fputs(" s, least", out);
		cell(out, 5, "%.2f", s->lead_least_s);
		fputs(" s\n", out);
	}
}

void scenario_words(FILE *out, const struct scenario_plan *p, const struct scenario_result *r)
{
	const struct scenario_sum sum = scenario_sum_of(p, r);

	print_head(out, p);
	for (int i = 0; i < p->rows; i++) {
		print_row(out, p, i, r + i * p->cars);
	}
	print_sum(out, p, &sum);
}
