/* SPDX-License-Identifier: MIT
 * aebmc replay --compare: every log under both configurations, each in a process of its own, as many at once as there are
 * processors. A process leaves what happened in an unnamed file.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include "cli.h"
#include "compare.h"

#define WAIT_US 20000

/* ---- in the process of one replay -------------------------------------------------------------- */

/* What happened so far, growing. */
struct notes {
	struct compare_run run;
	size_t changes, points; /* room for */
	int full;               /* out of memory */
};

/* Room for one more element of an array. */
static void *more(struct notes *s, void *array, size_t n, size_t *room, size_t size)
{
	void *larger = array;

	if (n == *room) {
		*room = *room ? 2 * *room : 1024;
		larger = realloc(array, *room * size);
		s->full |= !larger;
	}
	return larger ? larger : array;
}

static void note_cycle(void *arg, double time_s, const struct cycle *c)
{
	struct notes *s = arg;
	struct compare_run *r = &s->run;
	const struct mc_risk *defer = &c->res.risk[FUTURE_DEFER];

	r->point = more(s, r->point, r->head.n_points, &s->points, sizeof(*r->point));
	if (!s->full) {
		r->point[r->head.n_points++] = (struct compare_point){
			.time_s = time_s,
			.p = defer->p,
			.lo = defer->lo,
			.hi = defer->hi,
			.driver = c->res.risk[FUTURE_DRIVER].p,
			.headway_m = c->scene.lead_valid ? c->scene.x[SCENE_HEADWAY] : NAN,
		};
	}
}

static void note_level(void *arg, double time_s, enum stage_level level)
{
	struct notes *s = arg;
	struct compare_run *r = &s->run;

	r->change = more(s, r->change, r->head.n_changes, &s->changes, sizeof(*r->change));
	if (!s->full) {
		r->change[r->head.n_changes++] =
			(struct compare_change){.time_s = time_s, .level = (int32_t)level};
	}
}

/* An array that never grew is NULL. 0 if all was written. */
static int put(const void *array, size_t size, size_t n, FILE *to)
{
	return n > 0 && fwrite(array, size, n, to) != n;
}

static int write_notes(const struct compare_run *r, FILE *to)
{
	return put(&r->head, sizeof(r->head), 1, to) ||
	       put(r->change, sizeof(*r->change), r->head.n_changes, to) ||
	       put(r->point, sizeof(*r->point), r->head.n_points, to) || fflush(to);
}

/* One replay; its notes into @to. Returns its exit code. */
static int replay_one(const char *name, const struct replay_args *all, const char *config,
		      const char *log, FILE *to)
{
	struct replay_args a = {.setup = all->setup, .log = log, .threads = all->threads};
	struct notes s = {0};
	const struct replay_watch watch = {note_cycle, note_level, &s};
	struct replay_figures f;

	a.setup.path = config;
	const int code = replay_watched(name, &a, &watch, &f);

	if (code) {
		return code;
	}
	s.run.head.evaluations = f.evaluations;
	s.run.head.hash = f.hash;
	s.run.head.log_s = f.log_s;
	s.run.head.risk_max = f.risk_max;
	return s.full || write_notes(&s.run, to)
		       ? cli_error(CLI_FAILED, name, "%s: %s", log,
				   s.full ? strerror(ENOMEM) : "no room for temporary files")
		       : 0;
}

/* ---- here -------------------------------------------------------------------------------------- */

/* A replay that is on its way. */
struct job {
	pid_t pid;
	FILE *notes, *errors;
	struct compare_run *run;
	char *said;
};

struct work {
	const char *name;
	const struct replay_args *args;
	struct compare_log *log;
	struct job *job; /* [jobs] */
	int jobs, running, next, total, done;
	struct progress line;
};

/* The numbers that say how long the arrays are come from our own child. */
static int read_notes(struct compare_run *r, FILE *from)
{
	rewind(from);
	if (fread(&r->head, sizeof(r->head), 1, from) != 1) {
		return -EIO;
	}
	r->change = calloc(r->head.n_changes + 1, sizeof(*r->change));
	r->point = calloc(r->head.n_points + 1, sizeof(*r->point));
	if (!r->change || !r->point) {
		return -ENOMEM;
	}
	return fread(r->change, sizeof(*r->change), r->head.n_changes, from) != r->head.n_changes ||
			       fread(r->point, sizeof(*r->point), r->head.n_points, from) !=
				       r->head.n_points
		       ? -EIO
		       : 0;
}

static int begin(struct work *w, struct job *j)
{
	const int at = w->next++;
	struct compare_log *log = &w->log[at / SIDES];

	j->run = &log->run[at % SIDES];
	j->said = log->said[at % SIDES];
	j->notes = tmpfile();
	j->errors = tmpfile();
	j->pid = j->notes && j->errors ? fork() : -1;
	if (j->pid < 0) {
		return cli_error(CLI_FAILED, w->name, "%s: %s", log->path, strerror(errno));
	}
	if (j->pid == 0) {
		dup2(fileno(j->errors), STDERR_FILENO);
		_exit(replay_one(w->name, w->args, w->args->compare[at % SIDES], log->path,
				 j->notes));
	}
	w->running++;
	return 0;
}

static int end(struct work *w, struct job *j, int status)
{
	const int code = WIFEXITED(status) ? WEXITSTATUS(status) : CLI_FAILED;
	int error = code ? 0 : read_notes(j->run, j->notes);

	j->run->head.code = code;
	rewind(j->errors);
	if (!fgets(j->said, COMPARE_SAID, j->errors)) {
		*j->said = '\0';
	}
	fclose(j->notes);
	fclose(j->errors);
	j->pid = 0;
	w->running--;
	w->done++;
	return error ? cli_error(CLI_FAILED, w->name, "temporary file: %s", strerror(-error)) : 0;
}

/* Takes in whoever has finished, without waiting for anybody. */
static int take_in(struct work *w)
{
	int code = 0;

	for (int i = 0; i < w->jobs; i++) {
		int status;

		if (w->job[i].pid > 0 && waitpid(w->job[i].pid, &status, WNOHANG) > 0) {
			code = end(w, &w->job[i], status) ? CLI_FAILED : code;
		}
	}
	return code;
}

static int fill_up(struct work *w)
{
	int code = 0;

	for (int i = 0; i < w->jobs && w->next < w->total && !code; i++) {
		code = w->job[i].pid > 0 ? 0 : begin(w, &w->job[i]);
	}
	return code;
}

static int run_all(struct work *w)
{
	char words[48];
	int code = 0;

	cli_catch_interrupt();
	while (w->running || (!code && !cli_interrupted() && w->next < w->total)) {
		if (!code && !cli_interrupted()) {
			code = fill_up(w);
		}
		usleep(WAIT_US);
		code = take_in(w) ? CLI_FAILED : code;
		snprintf(words, sizeof(words), "%d of %d replays", w->done, w->total);
		progress_update(&w->line, (double)w->done / w->total, words);
	}
	progress_clear(&w->line);
	return cli_interrupted() ? cli_error(CLI_FAILED, w->name, "interrupted") : code;
}

/* ---- after the replays ------------------------------------------------------------------------- */

static int is_good(const struct compare_log *l)
{
	return !l->run[SIDE_A].head.code && !l->run[SIDE_B].head.code;
}

/* A name for the picture: the log's, and its number where two logs have the same. */
static char *picture_path(const struct replay_args *a, int at)
{
	const char *slash = strrchr(a->logs[at], '/'), *base = slash ? slash + 1 : a->logs[at];
	char *path = NULL;
	int twin = 0;

	for (int i = 0; i < at; i++) {
		const char *s = strrchr(a->logs[i], '/');

		twin += !strcmp(s ? s + 1 : a->logs[i], base);
	}
	if (asprintf(&path, twin ? "%s/%s.%d.svg" : "%s/%s.svg", a->pictures, base, twin) < 0) {
		return NULL;
	}
	return path;
}

/* What is wrong with the log both have found. */
static int tell_failure(const char *name, const struct compare_log *l)
{
	const int same = !strcmp(l->said[SIDE_A], l->said[SIDE_B]);

	for (int side = 0; side < (same ? 1 : SIDES); side++) {
		fputs(l->said[side], stderr);
	}
	return *l->said[SIDE_A] || *l->said[SIDE_B]
		       ? CLI_FAILED
		       : cli_error(CLI_FAILED, name, "%s: a replay ended without a word", l->path);
}

static int finish_log(struct work *w, int at)
{
	struct compare_log *l = &w->log[at];
	int error = 0;

	if (!is_good(l)) {
		return tell_failure(w->name, l);
	}
	for (int k = 0; k < KINDS && !error; k++) {
		error = compare_match(l->run, k, &l->diff[k]);
	}
	if (!error && w->args->pictures && compare_differs(l)) {
		l->picture = picture_path(w->args, at);
		error = l->picture ? 0 : -ENOMEM;
	}
	if (error) {
		return cli_error(CLI_FAILED, w->name, "%s", strerror(-error));
	}
	if (l->picture && compare_picture(w->name, w->args, l)) {
		free(l->picture);
		l->picture = NULL;
		return CLI_FAILED;
	}
	return 0;
}

static void report(const struct work *w)
{
	(w->args->json ? compare_json : compare_words)(w->args, w->log, w->args->n_logs, stdout);
}

static int compare(struct work *w)
{
	int code = run_all(w), failed = 0;

	for (int i = 0; i < w->args->n_logs && !code; i++) {
		failed |= finish_log(w, i);
	}
	if (!code) {
		report(w);
	}
	return code || failed ? CLI_FAILED : CLI_GOOD;
}

static void free_logs(struct compare_log *log, int n)
{
	for (int i = 0; i < n; i++) {
		free(log[i].picture);
		for (int side = 0; side < SIDES; side++) {
			free(log[i].run[side].change);
			free(log[i].run[side].point);
		}
		for (int k = 0; k < KINDS; k++) {
			compare_match_free(&log[i].diff[k]);
		}
	}
	free(log);
}

/* A bad configuration is told once, not once for each log. */
static int check_configs(const char *name, const struct replay_args *a)
{
	for (int side = 0; side < SIDES; side++) {
		struct setup s = a->setup;
		struct mapping *map = NULL;
		struct config cfg;

		s.path = a->compare[side];
		const int code = setup_load(name, &s, &cfg, &map);

		if (code) {
			return code;
		}
		config_mapping_free(map);
	}
	return 0;
}

int compare_main(const char *name, const struct replay_args *a)
{
	struct work w = {.name = name,
			 .args = a,
			 .jobs = (int)(a->jobs ? a->jobs : cli_cpus()),
			 .total = SIDES * a->n_logs,
			 .line = progress_start(name)};
	int code = check_configs(name, a);

	if (code) {
		return code;
	}
	if (a->pictures && mkdir(a->pictures, 0777) && errno != EEXIST) {
		return cli_error(CLI_FAILED, name, "%s: %s", a->pictures, strerror(errno));
	}
	w.log = calloc((size_t)a->n_logs, sizeof(*w.log));
	w.job = calloc((size_t)w.jobs, sizeof(*w.job));
	if (!w.log || !w.job) {
		free(w.log);
		free(w.job);
		return cli_error(CLI_FAILED, name, "%s", strerror(ENOMEM));
	}
	for (int i = 0; i < a->n_logs; i++) {
		w.log[i].path = a->logs[i];
	}
	fflush(stdout);
	code = compare(&w);
	free_logs(w.log, a->n_logs);
	free(w.job);
	return code;
}
