/* SPDX-License-Identifier: MIT
 * The report as one JSON object, schema "aebmc.report.1". See report.h.
 */
#include <math.h>
#include "decision.h"
#include "fault.h"
#include "json.h"
#include "report.h"

static double ms(int64_t ns)
{
	return ns < 0 ? NAN : (double)ns / 1e6;
}

static void put_stage(struct json *j, const char *name, const struct report_stage *s,
		      int64_t budget_ns)
{
	json_open(j, name, '{');
	json_uint(j, "n", s->n);
	json_num(j, "p50_ms", ms(s->p50_ns));
	json_num(j, "p95_ms", ms(s->p95_ns));
	json_num(j, "p99_ms", ms(s->p99_ns));
	json_num(j, "p99_9_ms", ms(s->p99_9_ns));
	json_num(j, "max_ms", ms(s->max_ns));
	if (budget_ns) {
		json_num(j, "budget_ms", ms(budget_ns));
		json_uint(j, "misses", s->over);
	}
	json_close(j, '}');
}

static void put_stages(struct json *j, const struct report *r)
{
	json_open(j, "stages", '{');
	for (int s = 0; s < STAGES; s++) {
		put_stage(j, stage_table[s].name, &r->stage[s], stage_table[s].budget_ns);
	}
	json_close(j, '}');
	json_open(j, "batch", '{');
	for (int s = 0; s < SUBS; s++) {
		put_stage(j, report_sub_name[s], &r->sub[s], 0);
	}
	json_close(j, '}');
}

static void put_runs(struct json *j, const struct report *r)
{
	json_open(j, "misses", '{');
	for (int k = 0; k < MISSES; k++) {
		const struct report_runs *u = &r->runs[k];

		json_open(j, miss_name[k], '{');
		json_uint(j, "count", r->missed[k]);
		json_uint(j, "of", u->n);
		json_uint(j, "runs", u->runs);
		json_uint(j, "longest_run", u->longest);
		json_num(j, "chance", report_chance(u));
		json_num(j, "chance_after_one", report_chance_again(u));
		json_close(j, '}');
	}
	json_close(j, '}');
}

static void put_missed(struct json *j, const struct report *r)
{
	json_open(j, "missed", '[');
	for (size_t i = 0; i < r->n_misses; i++) {
		const struct report_miss *m = &r->miss[i];

		json_open(j, NULL, '{');
		json_num(j, "time_s", (double)(m->t_ns - r->first_ns) / 1e9);
		json_str(j, "kind", miss_name[m->kind]);
		json_str(j, "stage", m->stage < 0 ? NULL : stage_table[m->stage].name);
		json_uint(j, "cycle", m->cycle);
		json_uint(j, "count", m->count);
		json_num(j, "late_ms", ms(m->late_ns));
		json_close(j, '}');
	}
	json_close(j, ']');
}

static void put_published(struct json *j, const struct report *r)
{
	json_open(j, "request_frames", '{');
	json_num(j, "period_ms", ms(r->period_ns));
	json_uint(j, "in_time", r->published - r->published_late);
	json_uint(j, "missed", r->runs[MISS_PERIOD].misses);
	json_uint(j, "due", report_ticks(r));
	json_bool(j, "adds_up", report_adds_up(r));
	json_close(j, '}');
}

static void put_worst(struct json *j, const struct report *r)
{
	char when[32];

	json_open(j, "worst", '[');
	for (int i = 0; i < r->n_worst; i++) {
		const struct report_cycle *c = r->worst[i];

		report_when(r, c->t_ns[EDGE_INPUT], when, sizeof(when));
		json_open(j, NULL, '{');
		json_uint(j, "cycle", c->id);
		json_str(j, "utc", when);
		json_num(j, "all_ms", ms(report_cycle_ns(r, c)));
		json_bool(j, "late", c->late);
		for (int s = 0; s < STAGES; s++) {
			json_num(j, stage_table[s].name, ms(report_stage_ns(r, c, (enum stage)s)));
		}
		json_close(j, '}');
	}
	json_close(j, ']');
}

static void put_evaluations(struct json *j, const struct report *r)
{
	json_open(j, "evaluations", '[');
	for (size_t i = 0; i < r->n_evaluations; i++) {
		const struct report_evaluation *v = &r->evaluation[i];

		json_open(j, NULL, '{');
		json_num(j, "time_s", v->t_s - (double)r->first_mono_ns / 1e9);
		json_num(j, "ego_speed_mps", v->speed_mps);
		json_num(j, "headway_m", v->headway_m);
		json_num(j, "lead_speed_mps", v->lead_speed_mps);
		json_num(j, "p", v->p);
		json_num(j, "lo", v->lo);
		json_num(j, "hi", v->hi);
		json_num(j, "accel_mps2", v->accel_mps2);
		json_str(j, "level", v->level < 0 ? NULL : level_name[v->level]);
		json_str(j, "state", v->state < 0 ? NULL : state_name[v->state]);
		json_close(j, '}');
	}
	json_close(j, ']');
}

void report_json(const struct report *r, const char *dir, FILE *out)
{
	struct json j = json_start(out);
	char when[32];

	report_when(r, r->first_mono_ns, when, sizeof(when));
	json_head(&j, "report");
	json_str(&j, "trace", dir);
	json_str(&j, "utc", when);
	json_num(&j, "real_minus_monotonic_s", (double)r->real_minus_mono_ns / 1e9);
	json_num(&j, "seconds", report_seconds(r));
	json_bool(&j, "replay", r->replay);
	json_uint(&j, "events", r->events);
	json_uint(&j, "events_unknown", r->foreign);
	json_uint(&j, "events_lost", r->lost.events);
	json_uint(&j, "packets_lost", r->lost.packets);
	json_uint(&j, "cycles", r->n_cycles);
	put_stages(&j, r);
	put_runs(&j, r);
	put_missed(&j, r);
	put_published(&j, r);
	put_worst(&j, r);
	put_evaluations(&j, r);
	json_close(&j, '}');
}
