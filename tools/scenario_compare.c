/* SPDX-License-Identifier: MIT
 * The same runs decided by each rule and by the daemon.
 */
#include "scenario_compare.h"
#include <inttypes.h>
#include <math.h>
#include "cli.h"
#include "json.h"
#include "rules.h"

static const struct rule ours = {"aebmc", "this daemon", NULL};

/* What users feel: crashes not prevented, and brakes they did not need. */
struct outcome {
	const struct rule *rule;
	uint64_t runs, contacts, judged, failed;
	uint64_t
		early; /* requests more than a second before the physical limit, or where none is called for */
	double impact_mps, impact_sum_mps; /* largest; of all contacts */
};

static struct outcome outcome_of(const struct scenario_plan *p, const struct rule *rule,
				 const struct scenario_result *r)
{
	const struct scenario_sum sum = scenario_sum_of(p, r);
	struct outcome o = {.rule = rule,
			    .runs = sum.runs,
			    .contacts = sum.contacts,
			    .judged = sum.all.judged,
			    .failed = sum.all.failed};

	for (int i = 0; i < p->rows * p->cars; i++) {
		const struct scenario *s = &p->row[i / p->cars];
		const double request_s = scenario_first(&r[i]) - s->onset_s;
		const double latest_s = p->latest_s[i / p->cars];

		o.early +=
			s->goal == GOAL_NO_CONTACT ? request_s < latest_s - 1 : isfinite(request_s);
		o.impact_mps = fmax(o.impact_mps, r[i].impact_mps);
		o.impact_sum_mps += r[i].impact_mps;
	}
	return o;
}

static void words(FILE *out, const struct outcome *o)
{
	fprintf(out, "%-9s %6" PRIu64 " %9" PRIu64 " %10.1f %10.1f %14" PRIu64 "   %s\n",
		o->rule->name, o->runs, o->contacts, o->impact_mps,
		o->contacts ? o->impact_sum_mps / (double)o->contacts : 0, o->early, o->rule->doc);
}

static void json(struct json *j, const struct outcome *o)
{
	json_open(j, NULL, '{');
	json_str(j, "rule", o->rule->name);
	json_str(j, "doc", o->rule->doc);
	json_uint(j, "runs", o->runs);
	json_uint(j, "contacts", o->contacts);
	json_uint(j, "judged", o->judged);
	json_uint(j, "failed", o->failed);
	json_uint(j, "early_requests", o->early);
	json_num(j, "impact_largest_mps", o->impact_mps);
	json_num(j, "impact_mean_mps", o->contacts ? o->impact_sum_mps / (double)o->contacts : NAN);
	json_close(j, '}');
}

static void head(FILE *out, const struct scenario_plan *p)
{
	char hash[20];

	snprintf(hash, sizeof(hash), "%016" PRIx64, config_hash(p->cfg, p->map));
	fprintf(out, "%s, ", p->suite->name);
	scenario_rows(out, p);
	fprintf(out,
		" of %d cars, full braking %g m/s2, configuration %s\n"
		"early: requested more than 1 s before the physical limit, or where nothing calls "
		"for "
		"it\n\n%-9s %6s %9s %10s %10s %14s\n%-9s %6s %9s %10s %10s %14s\n",
		p->cars, p->cfg->brake_accel, hash, "", "", "", "impact", "impact", "", "rule",
		"runs", "contacts", "most m/s", "mean m/s", "early");
}

/* Returns the pool's code; the daemon's own way comes last. */
int scenario_compare(FILE *out, int as_json, const struct scenario_plan *p,
		     struct scenario_result *result)
{
	const struct rule *rule = rule_table;
	struct scenario_plan plan = *p;
	struct json j = json_start(out);
	char hash[20];
	int code = 0;

	snprintf(hash, sizeof(hash), "%016" PRIx64, config_hash(p->cfg, p->map));
	if (as_json) {
		json_head(&j, "scenario_compare");
		json_str(&j, "suite", p->suite->name);
		json_uint(&j, "rows", (uint64_t)p->rows);
		json_uint(&j, "suite_rows", (uint64_t)p->of_rows);
		json_str(&j, "config_hash", hash);
		json_open(&j, "rules", '[');
	} else {
		head(out, p);
	}
	do {
		plan.rule = rule->name ? rule : NULL;
		code = scenario_pool(&plan, result);
		if (!code) {
			const struct outcome o =
				outcome_of(&plan, plan.rule ? plan.rule : &ours, result);

			if (as_json) {
				json(&j, &o);
			} else {
				words(out, &o);
			}
		}
	} while (!code && (rule++)->name);
	if (as_json) {
		json_close(&j, ']');
		json_bool(&j, "interrupted", cli_interrupted());
		json_close(&j, '}');
	}
	return code;
}
