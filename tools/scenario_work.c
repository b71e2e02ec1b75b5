/* SPDX-License-Identifier: MIT
 * From arguments to a plan. See scenario_work.h.
 */
#include "scenario_work.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "cli.h"

static int is_wanted(const struct scenario_args *a, const struct scenario *s)
{
	return (!a->is_short || s->in_short) && (!a->only || strstr(s->name, a->only)) &&
	       (!a->log_run || !strcmp(s->name, a->log_run));
}

/* What stands on how sure the radar is cannot be asked of one that does not say. */
static int is_knowable(const struct mapping *map, const struct scenario *s)
{
	int says = 0, doubtful = 0;

	for (int i = 0; i < map->n_tracks; i++) {
		says |= map->track[i].existence.sig != NULL;
	}
	for (int i = 0; i < s->drive.n; i++) {
		doubtful |= s->drive.target[i].existence > 0;
	}
	return says || !doubtful;
}

static int add_log(struct scenario *s, const char *path)
{
	*s = (struct scenario){
		.name = "recorded-drive", .goal = GOAL_NO_REQUEST, .in_short = 1, .log = path};
	return 1;
}

static int open_rows(struct scenario_work *w)
{
	int n, kept = 0;

	w->row = calloc(SCENARIO_ROWS_MAX, sizeof(*w->row));
	n = w->row ? w->args->suite->rows(w->row, SCENARIO_ROWS_MAX) : -ENOMEM;
	n += n > 0 && w->args->log ? add_log(&w->row[n], w->args->log) : 0;
	for (int i = 0; i < n; i++) {
		w->row[i].number = i;
		w->row[i].goal = is_knowable(w->map, &w->row[i]) ? w->row[i].goal : GOAL_UNKNOWABLE;
		if (is_wanted(w->args, &w->row[i])) {
			w->row[kept++] = w->row[i];
		}
	}
	w->plan.rows = kept;
	w->plan.of_rows = n;
	if (n < 0) {
		return cli_error(CLI_FAILED, w->name, "%s", strerror(-n));
	}
	return kept ? 0
		    : cli_error(CLI_USAGE, w->name, "%s has no such row; aebmc scenario %s --list",
				w->args->suite->name, w->args->suite->name);
}

/* What the daemon knows of each row's sensors. */
static int tell(struct scenario_work *w)
{
	char err[512];

	for (int i = 0; i < w->plan.rows; i++) {
		const struct scenario_fault *f = w->row[i].fault;

		w->told[i] = w->cfg;
		for (int k = 0; f && k < SCENARIO_SETS_MAX && f->set[k]; k++) {
			if (config_set(&w->told[i], f->set[k], err, sizeof(err))) {
				return cli_error(CLI_CONFIG, w->name, "%s", err);
			}
		}
	}
	return 0;
}

static int allocate(struct scenario_work *w)
{
	const size_t rows = (size_t)w->plan.rows, cars = (size_t)w->plan.cars;

	w->told = calloc(rows, sizeof(*w->told));
	w->latest_s = calloc(rows, sizeof(*w->latest_s));
	w->result = calloc(rows * cars, sizeof(*w->result));
	return w->told && w->latest_s && w->result
		       ? 0
		       : cli_error(CLI_FAILED, w->name, "%s", strerror(ENOMEM));
}

int scenario_work_open(struct scenario_work *w)
{
	const struct scenario_args *a = w->args;
	int code = setup_load(w->name, &a->setup, &w->cfg, &w->map);

	if (a->samples) {
		w->cfg.mc_samples = a->samples;
	}
	w->plan.cars = a->cars ? (int)a->cars : 1;
	code = code ? code : open_rows(w);
	code = code ? code : allocate(w);
	code = code ? code : tell(w);
	w->plan = (struct scenario_plan){
		.name = w->name,
		.suite = a->suite,
		.row = w->row,
		.rows = w->plan.rows,
		.of_rows = w->plan.of_rows,
		.first_car = a->cars > 0,
		.cars = w->plan.cars,
		.seed = (uint64_t)a->seed,
		.cfg = &w->cfg,
		.told = w->told,
		.map = w->map,
		.rule = a->rule,
		.live = a->live != NULL,
		.threads = a->threads ? (int)a->threads : (int)cli_cpus(),
		.latest_s = w->latest_s,
	};
	return code;
}

void scenario_work_close(struct scenario_work *w)
{
	free(w->row);
	free(w->told);
	free(w->latest_s);
	free(w->result);
	config_mapping_free(w->map);
}
