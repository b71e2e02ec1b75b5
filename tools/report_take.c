/* SPDX-License-Identifier: MIT
 * Events of provider aebmc to cycles, misses and evaluations. See report.h.
 */
#include "report.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "decision.h"
#include "fault.h"

/* ---- fields ------------------------------------------------------------------------------------------ */

static const struct ctf_field none;

static const struct ctf_field *field(const struct ctf_record *r, const char *name)
{
	for (int i = 0; i < r->n; i++) {
		if (!strcmp(r->field[i].name, name)) {
			return &r->field[i];
		}
	}
	return &none;
}

static int64_t whole(const struct ctf_record *r, const char *name)
{
	return field(r, name)->i;
}

static double number(const struct ctf_record *r, const char *name)
{
	return field(r, name)->f;
}

/* Its place among @names, or -1. */
static int name_of(const struct ctf_record *r, const char *name, const char *const *names, int n)
{
	const char *text = field(r, name)->text;

	for (int i = 0; text && i < n; i++) {
		if (!strcmp(text, names[i])) {
			return i;
		}
	}
	return -1;
}

/* ---- room ---------------------------------------------------------------------------------------------- */

static void *append(void **array, size_t *n, size_t *room, size_t size)
{
	if (*n == *room) {
		const size_t more = *room ? *room * 2 : 1024;
		void *bigger = reallocarray(*array, more, size);

		if (!bigger) {
			return NULL;
		}
		*array = bigger;
		*room = more;
	}
	return memset((char *)*array + (*n)++ * size, 0, size);
}

/* Numbers rise within a run of the daemon; a smaller one with a later stamp begins another. */
static struct report_cycle *cycle_of(struct report *r, uint64_t id, int starts, int64_t t_ns)
{
	struct report_cycle *c = r->n_cycles ? &r->cycle[r->n_cycles - 1] : NULL;

	if (c && starts && id <= c->id && t_ns > c->t_ns[EDGE_INPUT]) {
		r->run_start = r->n_cycles;
	}
	for (size_t i = r->n_cycles; i > r->run_start && r->cycle[i - 1].id >= id; i--) {
		if (r->cycle[i - 1].id == id) {
			return &r->cycle[i - 1];
		}
	}
	c = append((void **)&r->cycle, &r->n_cycles, &r->cycles_room, sizeof(*c));
	if (c) {
		c->id = id;
	}
	return c;
}

/* ---- events -------------------------------------------------------------------------------------------- */

static int take_edge(struct report *r, const struct ctf_record *e, int edge)
{
	const int64_t t_ns = whole(e, "t_ns");
	struct report_cycle *c = cycle_of(r, (uint64_t)whole(e, "cycle"), edge == EDGE_INPUT, t_ns);

	if (!c) {
		return -ENOMEM;
	}
	c->t_ns[edge] = t_ns;
	c->seen_ns[edge] = e->t_ns;
	if (edge == EDGE_SCAN) {
		report_runs_add(&r->runs[MISS_SKIPPED], 1, 0);
	}
	return 0;
}

static int take_batch(struct report *r, const struct ctf_record *e, int edge)
{
	const int64_t t_ns = whole(e, "t_ns");
	struct report_cycle *c = cycle_of(r, (uint64_t)whole(e, "cycle"), 0, 0);

	if (!c) {
		return -ENOMEM;
	}
	if (!c->batch_ns[edge]) {
		c->batch_ns[edge] = t_ns;
	}
	if (edge == MC_EDGE_ANSWERED) {
		c->gpu_ns += t_ns - c->chunk_ns;
	} else if (edge == MC_EDGE_VERIFIED) {
		c->verify_ns += t_ns - c->chunk_ns;
	}
	c->chunk_ns = t_ns;
	return 0;
}

static int stage_of(const struct ctf_record *e)
{
	const char *names[STAGES];

	for (int s = 0; s < STAGES; s++) {
		names[s] = stage_table[s].name;
	}
	return name_of(e, "stage", names, STAGES);
}

static int take_miss(struct report *r, const struct ctf_record *e)
{
	const int kind = name_of(e, "kind", miss_name, MISSES);
	struct report_miss *m;
	struct report_cycle *c;

	if (kind < 0) {
		r->foreign++;
		return 0;
	}
	m = append((void **)&r->miss, &r->n_misses, &r->misses_room, sizeof(*m));
	c = kind == MISS_STAGE || kind == MISS_LATE ? cycle_of(r, (uint64_t)whole(e, "cycle"), 0, 0)
						    : NULL;
	if (!m || (!c && (kind == MISS_STAGE || kind == MISS_LATE))) {
		return -ENOMEM;
	}
	*m = (struct report_miss){.kind = (enum miss)kind,
				  .stage = stage_of(e),
				  .cycle = (uint64_t)whole(e, "cycle"),
				  .count = (uint64_t)whole(e, "count"),
				  .t_ns = e->t_ns,
				  .late_ns = whole(e, "late_ns")};
	if (kind == MISS_LATE) {
		c->late = 1;
	} else if (kind == MISS_STAGE && m->stage >= 0) {
		c->missed |= 1u << m->stage;
	} else if (kind == MISS_SKIPPED || (kind == MISS_PERIOD && r->published_n)) {
		report_runs_add(&r->runs[kind], m->count, 1);
	}
	return 0;
}

static int take_evaluation(struct report *r, const struct ctf_record *e)
{
	struct report_evaluation *v = append((void **)&r->evaluation, &r->n_evaluations,
					     &r->evaluations_room, sizeof(*v));

	if (!v) {
		return -ENOMEM;
	}
	*v = (struct report_evaluation){.t_s = (double)whole(e, "t_ns") / 1e9,
					.speed_mps = number(e, "speed_mps"),
					.headway_m = number(e, "headway_m"),
					.lead_speed_mps = number(e, "lead_speed_mps"),
					.safe_m = number(e, "safe_m"),
					.lead = number(e, "lead"),
					.p = number(e, "p"),
					.lo = number(e, "lo"),
					.hi = number(e, "hi"),
					.accel_mps2 = number(e, "accel_mps2"),
					.level = name_of(e, "level", level_name, LEVELS),
					.state = name_of(e, "state", state_name, STATES)};
	return 0;
}

static void take_clock(struct report *r, const struct ctf_record *e)
{
	const int64_t mono_ns = whole(e, "mono_ns");

	if (!r->clocks++) {
		r->first_mono_ns = mono_ns;
		r->real_minus_mono_ns = whole(e, "real_ns") - mono_ns;
	}
	r->period_ns = whole(e, "period_ns");
	r->replay |= !whole(e, "live");
}

/* Frames due between the first and the last of each run of the daemon. */
static void take_published(struct report *r, const struct ctf_record *e)
{
	const uint64_t n = (uint64_t)whole(e, "n");
	const int64_t due_ns = whole(e, "due_ns");
	const int late = whole(e, "missed") != 0;

	if (n <= r->published_n) {
		r->ticks_before = report_ticks(r);
		r->published_n = 0;
	}
	if (!r->published_n) {
		r->due_first_ns = due_ns;
	}
	r->due_last_ns = due_ns;
	r->published_n = n;
	r->published++;
	r->published_late += (uint64_t)late;
	if (!late) {
		report_runs_add(&r->runs[MISS_PERIOD], 1, 0);
	}
}

/* ---- by name ------------------------------------------------------------------------------------------- */

/* The row of a table whose events are called PREFIX_ROW, or -1. */
static int row_of(const char *name, const char *prefix, const char *const *rows, int n)
{
	const size_t len = strlen(prefix);

	for (int i = 0; !strncmp(name, prefix, len) && i < n; i++) {
		if (!strcmp(name + len, rows[i])) {
			return i;
		}
	}
	return -1;
}

static int take_row(struct report *r, const struct ctf_record *e, const char *name)
{
	const int edge = row_of(name, "edge_", edge_name, EDGES);
	const int batch = row_of(name, "batch_", mc_edge_name, MC_EDGES);

	if (edge < 0 && batch < 0) {
		r->foreign++;
		return 0;
	}
	return edge >= 0 ? take_edge(r, e, edge) : take_batch(r, e, batch);
}

static int take(struct report *r, const struct ctf_record *e)
{
	const char *name = !strncmp(e->name, "aebmc:", 6) ? e->name + 6 : "";

	r->first_ns = r->events ? r->first_ns : e->t_ns;
	r->last_ns = e->t_ns;
	r->events++;
	if (!strcmp(name, "miss")) {
		return take_miss(r, e);
	}
	if (!strcmp(name, "evaluation")) {
		return take_evaluation(r, e);
	}
	if (!strcmp(name, "clock")) {
		take_clock(r, e);
	} else if (!strcmp(name, "published")) {
		take_published(r, e);
	} else if (!strcmp(name, "fault")) {
		r->faults += whole(e, "on") != 0;
	} else if (!strcmp(name, "state")) {
		r->states++;
	} else if (strcmp(name, "deadline_miss") != 0) {
		return take_row(r, e, name);
	}
	return 0;
}

static int take_process(struct report *r, const struct ctf_record *e)
{
	struct report_process *p;
	size_t i = 0;

	while (i < r->n_processes && r->process[i].pid != e->pid) {
		i++;
	}
	if (i == r->n_processes) {
		p = append((void **)&r->process, &r->n_processes, &r->processes_room, sizeof(*p));
		if (!p) {
			return -ENOMEM;
		}
		*p = (struct report_process){.pid = e->pid, .first_ns = e->t_ns};
	}
	r->process[i].last_ns = e->t_ns;
	r->process[i].evaluations += !strcmp(e->name, "aebmc:evaluation");
	return 0;
}

int report_event(void *arg, const struct ctf_record *e)
{
	struct report *r = arg;
	const int status = take_process(r, e);

	if (status || (r->pid && r->pid != e->pid)) {
		return status;
	}
	if (r->taken_pid != e->pid) { /* numbers begin anew */
		r->run_start = r->n_cycles;
		r->ticks_before = report_ticks(r);
		r->published_n = 0;
		r->taken_pid = e->pid;
	}
	return take(r, e);
}

void report_free(struct report *r)
{
	for (int i = 0; i < STAGES; i++) {
		free(r->stage[i].sorted_ns);
	}
	for (int i = 0; i < SUBS; i++) {
		free(r->sub[i].sorted_ns);
	}
	free(r->cycle);
	free(r->miss);
	free(r->evaluation);
	free(r->process);
}
