/* SPDX-License-Identifier: MIT
 * Percentiles, runs of misses, the worst cycles, and whether it adds up. See report.h.
 */
#include "report.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <time.h>
#include "clock.h"
#include "hist.h"
#include "sort.h"

const char *const report_sub_name[SUBS] = {[SUB_WAKE] = "wake",
					   [SUB_BATCH] = "batch",
					   [SUB_GPU] = "gpu",
					   [SUB_VERIFY] = "verify",
					   [SUB_BACK] = "back"};
const char *const report_sub_doc[SUBS] = {[SUB_WAKE] = "handed over to taken by the compute thread",
					  [SUB_BATCH] = "taken to result in the mailbox",
					  [SUB_GPU] = "of it, launched to answered by the GPU",
					  [SUB_VERIFY] = "of it, checking the answer",
					  [SUB_BACK] =
						  "result in the mailbox to read by the pipeline"};

/* ---- durations ----------------------------------------------------------------------------------------- */

int64_t report_stage_ns(const struct report *r, const struct report_cycle *c, enum stage s)
{
	const int computed = s == STAGE_REQUEST || s == STAGE_MC || s == STAGE_DECIDE;

	if (r->replay && s != STAGE_INPUT) {
		return computed ? stage_ns(s, c->seen_ns) : -1;
	}
	return stage_ns(s, c->t_ns);
}

int64_t report_cycle_ns(const struct report *r, const struct report_cycle *c)
{
	int64_t sum_ns = -1;

	for (int e = EDGES - 1; e > EDGE_INPUT && !r->replay && c->t_ns[EDGE_INPUT]; e--) {
		if (c->t_ns[e]) {
			return c->t_ns[e] - c->t_ns[EDGE_INPUT];
		}
	}
	for (int s = 0; s < STAGE_DECISION && r->replay; s++) {
		const int64_t ns = report_stage_ns(r, c, (enum stage)s);

		sum_ns = ns < 0 ? sum_ns : ns + (sum_ns < 0 ? 0 : sum_ns);
	}
	return sum_ns;
}

int64_t report_sub_ns(const struct report_cycle *c, enum report_sub s)
{
	const int64_t *b = c->batch_ns, submit = c->t_ns[EDGE_SUBMIT],
		      result = c->t_ns[EDGE_RESULT];

	switch (s) {
	case SUB_WAKE:
		return submit && b[MC_EDGE_TAKEN] ? b[MC_EDGE_TAKEN] - submit : -1;
	case SUB_BATCH:
		return b[MC_EDGE_TAKEN] && b[MC_EDGE_DONE] ? b[MC_EDGE_DONE] - b[MC_EDGE_TAKEN]
							   : -1;
	case SUB_GPU:
		return b[MC_EDGE_ANSWERED] ? c->gpu_ns : -1;
	case SUB_VERIFY:
		return b[MC_EDGE_VERIFIED] ? c->verify_ns : -1;
	default:
		return result && b[MC_EDGE_DONE] ? result - b[MC_EDGE_DONE] : -1;
	}
}

static int64_t duration(const struct report *r, const struct report_cycle *c, int which)
{
	return which < STAGES ? report_stage_ns(r, c, (enum stage)which)
			      : report_sub_ns(c, (enum report_sub)(which - STAGES));
}

static int64_t percentile(const struct report_stage *s, double q)
{
	return s->n ? s->sorted_ns[hist_rank(s->n, q) - 1] : -1;
}

static int measure(const struct report *r, int which, struct report_stage *s)
{
	s->sorted_ns = calloc(r->n_cycles + 1, sizeof(*s->sorted_ns));
	if (!s->sorted_ns) {
		return -ENOMEM;
	}
	for (size_t i = 0; i < r->n_cycles; i++) {
		const int64_t ns = duration(r, &r->cycle[i], which);

		if (ns >= 0) {
			s->sorted_ns[s->n++] = ns;
		}
		s->over += which < STAGES && r->cycle[i].missed >> which & 1;
	}
	sort_times(s->sorted_ns, s->n);
	s->p50_ns = percentile(s, 0.5);
	s->p95_ns = percentile(s, 0.95);
	s->p99_ns = percentile(s, 0.99);
	s->p99_9_ns = percentile(s, 0.999);
	s->max_ns = percentile(s, 1);
	return 0;
}

struct length {
	int64_t ns;
	const struct report_cycle *cycle;
};

static int by_length(const void *a, const void *b)
{
	const struct length *x = a, *y = b;

	return x->ns != y->ns ? (x->ns < y->ns) - (x->ns > y->ns)
			      : (x->cycle > y->cycle) - (x->cycle < y->cycle);
}

static int find_worst(struct report *r)
{
	struct length *all = calloc(r->n_cycles + 1, sizeof(*all));

	if (!all) {
		return -ENOMEM;
	}
	for (size_t i = 0; i < r->n_cycles; i++) {
		all[i] = (struct length){report_cycle_ns(r, &r->cycle[i]), &r->cycle[i]};
	}
	qsort(all, r->n_cycles, sizeof(*all), by_length);
	for (size_t i = 0; i < r->n_cycles && r->n_worst < REPORT_WORST && all[i].ns >= 0; i++) {
		r->worst[r->n_worst++] = all[i].cycle;
	}
	free(all);
	return 0;
}

/* ---- misses ---------------------------------------------------------------------------------------------- */

void report_runs_add(struct report_runs *runs, uint64_t n, int missed)
{
	if (!n) {
		return;
	}
	runs->after += runs->length ? 1 : 0;
	runs->again += runs->length && missed ? 1 : 0;
	runs->after += missed ? n - 1 : 0;
	runs->again += missed ? n - 1 : 0;
	runs->n += n;
	runs->misses += missed ? n : 0;
	runs->runs += missed && !runs->length;
	runs->length = missed ? runs->length + n : 0;
	runs->longest = runs->length > runs->longest ? runs->length : runs->longest;
}

static double share(uint64_t of, uint64_t n)
{
	return n ? (double)of / (double)n : NAN;
}

double report_chance(const struct report_runs *runs)
{
	return share(runs->misses, runs->n);
}

double report_chance_again(const struct report_runs *runs)
{
	return share(runs->again, runs->after);
}

int report_figures(struct report *r)
{
	int status = 0;

	for (size_t i = 0; i < r->n_cycles; i++) {
		if (r->cycle[i].t_ns[EDGE_RESULT]) {
			report_runs_add(&r->runs[MISS_STAGE], 1, r->cycle[i].missed != 0);
			report_runs_add(&r->runs[MISS_LATE], 1, r->cycle[i].late);
		}
	}
	for (size_t i = 0; i < r->n_misses; i++) {
		r->missed[r->miss[i].kind] += r->miss[i].count;
	}
	for (int s = 0; s < STAGES && !status; s++) {
		status = measure(r, s, &r->stage[s]);
	}
	for (int s = 0; s < SUBS && !status; s++) {
		status = measure(r, STAGES + s, &r->sub[s]);
	}
	return status ? status : find_worst(r);
}

/* ---- processes --------------------------------------------------------------------------------------------- */

int report_mixed(const struct report *r)
{
	int mixed = r->replay && r->n_processes > 1;

	for (size_t i = 1; i < r->n_processes; i++) {
		for (size_t k = 0; k < i; k++) {
			mixed |= r->process[i].first_ns < r->process[k].last_ns;
		}
	}
	return mixed && !r->pid;
}

/* ---- the whole ------------------------------------------------------------------------------------------- */

double report_seconds(const struct report *r)
{
	return r->replay ? (double)(r->due_last_ns - r->due_first_ns) / 1e9
			 : (double)(r->last_ns - r->first_ns) / 1e9;
}

uint64_t report_ticks(const struct report *r)
{
	const int64_t due_ns = r->due_last_ns - r->due_first_ns;

	return r->ticks_before +
	       (r->published_n && r->period_ns
			? (uint64_t)((due_ns + r->period_ns / 2) / r->period_ns) + 1
			: 0);
}

int report_adds_up(const struct report *r)
{
	return r->published - r->published_late + r->runs[MISS_PERIOD].misses == report_ticks(r);
}

void report_when(const struct report *r, int64_t mono_ns, char *text, size_t size)
{
	const int64_t real_ns = mono_ns + r->real_minus_mono_ns;
	const time_t s = (time_t)(real_ns / CLOCK_NS_PER_S);
	struct tm tm;
	size_t n;

	gmtime_r(&s, &tm);
	n = strftime(text, size, "%F %T", &tm);
	snprintf(text + n, size - n, ".%03d", (int)(real_ns % CLOCK_NS_PER_S / CLOCK_NS_PER_MS));
}
