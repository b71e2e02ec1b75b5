/* SPDX-License-Identifier: MIT
 * What came of a suite, for machines: one object or line for each run.
 */
#include <inttypes.h>
#include <math.h>
#include "json.h"
#include "rules.h"
#include "scenario_report.h"

/* As a figure: NaN where nothing is known of them. */
static double evaluations(const struct scenario_plan *p, const struct scenario_result *r)
{
	return p->live ? NAN : (double)r->evaluations;
}

/* ---- CSV --------------------------------------------------------------------------------------- */

static void field(FILE *out, double v)
{
	if (isfinite(v)) {
		fprintf(out, ",%.9g", v);
	} else {
		fputc(',', out);
	}
}

void scenario_csv(FILE *out, const struct scenario_plan *p, const struct scenario_result *r)
{
	fputs("row,car,contact,impact_mps,closest_m,warn_s,partial_s,full_s,warn,partial,full,"
	      "onset_s,"
	      "latest_s,peak_before_mps2,peak_after_mps2,passed,evaluations\n",
	      out);
	for (int i = 0; i < p->rows * p->cars; i++) {
		const struct scenario *s = &p->row[i / p->cars];

		fprintf(out, "%s,%d,%d,%.9g", s->name, p->first_car + i % p->cars, r[i].contact,
			r[i].impact_mps);
		field(out, r[i].closest_m);
		field(out, r[i].warn_s);
		field(out, r[i].partial_s);
		field(out, r[i].full_s);
		fprintf(out, ",%u,%u,%u", r[i].warn, r[i].partial, r[i].full);
		field(out, s->onset_s > 0 ? s->onset_s : NAN);
		field(out, p->latest_s[i / p->cars]);
		fprintf(out, ",%.9g,%.9g,%d", r[i].peak_before_mps2, r[i].peak_after_mps2,
			scenario_passed(s, &r[i]));
		field(out, evaluations(p, &r[i]));
		fputc('\n', out);
	}
}

/* ---- JSON --------------------------------------------------------------------------------------- */

static const char *const goal_name[] = {
	[GOAL_NO_CONTACT] = "no contact",
	[GOAL_NO_REQUEST] = "no request",
	[GOAL_STATED] = "stated",
	[GOAL_UNKNOWABLE] = "unknowable",
};

/* ---- the rows ----------------------------------------------------------------------------------- */

/* What the radar makes of the target whose existence it doubts; "" of none. */
static void radar_words(const struct scenario *s, char *text, size_t size)
{
	*text = '\0';
	for (int i = 0; i < s->drive.n && !*text; i++) {
		const struct drive_target *t = &s->drive.target[i];

		if (t->existence > 0) {
			snprintf(text, size,
				 "the radar's target: existence %g, from %g m to %g m, missed in "
				 "%g %% of the scans",
				 t->existence, t->seen_m, t->lost_m, t->missed * 100);
		}
	}
}

static void list_json(FILE *out, const struct scenario_plan *p)
{
	struct json j = json_start(out);
	char text[128];

	json_head(&j, "scenario_list");
	json_str(&j, "suite", p->suite->name);
	json_open(&j, "rows", '[');
	for (int i = 0; i < p->rows; i++) {
		radar_words(&p->row[i], text, sizeof(text));
		json_open(&j, NULL, '{');
		json_str(&j, "row", p->row[i].name);
		json_str(&j, "goal", goal_name[p->row[i].goal]);
		json_str(&j, "radar", *text ? text : NULL);
		json_close(&j, '}');
	}
	json_close(&j, ']');
	json_close(&j, '}');
}

void scenario_list(FILE *out, int as_json, const struct scenario_plan *p)
{
	char text[128];

	if (as_json) {
		list_json(out, p);
		return;
	}
	for (int i = 0; i < p->rows; i++) {
		radar_words(&p->row[i], text, sizeof(text));
		fprintf(out, *text ? "%-40s  %s\n" : "%s%s\n", p->row[i].name, text);
	}
}

/* ---- the runs ----------------------------------------------------------------------------------- */

static void json_run(struct json *j, const struct scenario_plan *p, int i,
		     const struct scenario_result *r)
{
	const struct scenario *s = &p->row[i / p->cars];

	json_open(j, NULL, '{');
	json_str(j, "row", s->name);
	json_uint(j, "car", (uint64_t)(p->first_car + i % p->cars));
	json_bool(j, "contact", r->contact);
	json_num(j, "impact_mps", r->impact_mps);
	json_num(j, "closest_m", r->closest_m);
	json_num(j, "warn_s", r->warn_s);
	json_num(j, "partial_s", r->partial_s);
	json_num(j, "full_s", r->full_s);
	json_uint(j, "warn", r->warn);
	json_uint(j, "partial", r->partial);
	json_uint(j, "full", r->full);
	json_num(j, "onset_s", s->onset_s > 0 ? s->onset_s : NAN);
	json_num(j, "latest_s", p->latest_s[i / p->cars]);
	json_num(j, "peak_before_mps2", r->peak_before_mps2);
	json_num(j, "peak_after_mps2", r->peak_after_mps2);
	json_str(j, "goal", goal_name[s->goal]);
	json_bool(j, "passed", scenario_passed(s, r));
	json_num(j, "evaluations", evaluations(p, r));
	json_close(j, '}');
}

static void json_faults(struct json *j, const struct scenario_plan *p)
{
	char hash[20];

	json_open(j, "faults", '[');
	for (int i = 0; i < p->rows; i++) {
		const struct scenario_fault *f = scenario_fault_of(p, i);

		if (!f) {
			continue;
		}
		snprintf(hash, sizeof(hash), "%016" PRIx64, config_hash(&p->told[i], p->map));
		json_open(j, NULL, '{');
		json_str(j, "fault", f->name);
		json_str(j, "doc", f->doc);
		json_open(j, "set", '[');
		for (int k = 0; k < SCENARIO_SETS_MAX && f->set[k]; k++) {
			json_str(j, NULL, f->set[k]);
		}
		json_close(j, ']');
		json_str(j, "config_hash", hash);
		json_close(j, '}');
	}
	json_close(j, ']');
}

static void json_sum(struct json *j, const struct scenario_plan *p, const struct scenario_sum *s)
{
	const struct scenario_share *in = &s->in_evaluated;

	json_open(j, "sum", '{');
	json_uint(j, "runs", s->runs);
	json_uint(j, "judged", s->all.judged);
	json_uint(j, "failed", s->all.failed);
	json_num(j, "failed_lo", s->all.lo);
	json_num(j, "failed_hi", s->all.hi);
	if (!p->live) {
		json_uint(j, "runs_evaluated", s->evaluated);
		json_uint(j, "judged_evaluated", in->judged);
		json_uint(j, "failed_evaluated", in->failed);
		json_num(j, "failed_evaluated_lo", in->lo);
		json_num(j, "failed_evaluated_hi", in->hi);
	}
	json_uint(j, "contacts", s->contacts);
	json_uint(j, "requests", s->requests);
	json_uint(j, "requests_unwarned", s->unwarned);
	json_num(j, "warning_before_request_median_s", s->lead_s);
	json_num(j, "warning_before_request_least_s", s->lead_least_s);
	json_num(j, "added_deceleration_mps2", s->added_mps2);
	json_close(j, '}');
}

void scenario_json(FILE *out, const struct scenario_plan *p, const struct scenario_result *r)
{
	const struct scenario_sum sum = scenario_sum_of(p, r);
	struct json j = json_start(out);
	char hash[20];

	snprintf(hash, sizeof(hash), "%016" PRIx64, config_hash(p->cfg, p->map));
	json_head(&j, "scenario");
	json_str(&j, "suite", p->suite->name);
	json_uint(&j, "rows", (uint64_t)p->rows);
	json_uint(&j, "suite_rows", (uint64_t)p->of_rows);
	json_str(&j, "rule", p->rule ? p->rule->name : "aebmc");
	json_faults(&j, p);
	json_open(&j, "runs", '[');
	for (int i = 0; i < p->rows * p->cars; i++) {
		json_run(&j, p, i, &r[i]);
	}
	json_close(&j, ']');
	json_sum(&j, p, &sum);
	json_str(&j, "config_hash", hash);
	json_uint(&j, "samples", (uint64_t)p->cfg->mc_samples);
	json_uint(&j, "seed", p->seed);
	json_close(&j, '}');
}
