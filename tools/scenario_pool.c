/* SPDX-License-Identifier: MIT
 * All runs of a suite, over threads: each takes the next run that nobody has taken.
 */
#include "scenario_pool.h"
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <string.h>
#include <unistd.h>
#include "cli.h"
#include "engine.h"

#define THREADS_MAX 64
#define REDRAW_US   100000
#define ERROR_MAX   256

struct pool {
	const struct scenario_plan *plan;
	struct scenario_result *result;
	int next, done; /* runs; atomic */
	int error;      /* -errno of a run; atomic */
	int failed;     /* which */
};

struct worker {
	struct pool *pool;
	struct mc *mc;
	pthread_t thread;
};

static int total(const struct scenario_plan *p)
{
	return p->rows * p->cars;
}

static int run(const struct worker *w, int job)
{
	const struct scenario_plan *p = w->pool->plan;
	const int row = job / p->cars, car = p->first_car + job % p->cars;
	const struct scenario *s = &p->row[row];
	const struct scenario_bench bench = {
		.cfg = &p->told[row], .map = p->map, .mc = w->mc, .rule = p->rule};
	const struct scenario_draw draw = scenario_draw(p->cfg, s, p->seed, car);

	if (job % p->cars == 0) {
		p->latest_s[row] = s->goal == GOAL_NO_CONTACT ? scenario_latest(p->cfg, s) : NAN;
	}
	return s->log ? scenario_replay(&bench, s->log, &w->pool->result[job])
		      : scenario_run(&bench, s, &draw, &w->pool->result[job]);
}

static void *work(void *arg)
{
	struct worker *w = arg;
	struct pool *pool = w->pool;
	int job;

	while ((job = __atomic_fetch_add(&pool->next, 1, __ATOMIC_RELAXED)) < total(pool->plan) &&
	       !cli_interrupted()) {
		const int error = run(w, job);

		if (error) {
			pool->failed = job;
			__atomic_store_n(&pool->error, error, __ATOMIC_RELEASE);
			break;
		}
		__atomic_fetch_add(&pool->done, 1, __ATOMIC_RELAXED);
	}
	return NULL;
}

static int is_finished(const struct pool *pool)
{
	return __atomic_load_n(&pool->done, __ATOMIC_RELAXED) == total(pool->plan) ||
	       __atomic_load_n(&pool->error, __ATOMIC_RELAXED) || cli_interrupted();
}

static void show(struct pool *pool)
{
	struct progress line = progress_start(pool->plan->name);
	char words[48];

	while (line.on && !is_finished(pool)) {
		const int done = __atomic_load_n(&pool->done, __ATOMIC_RELAXED);

		snprintf(words, sizeof(words), "%d of %d runs", done, total(pool->plan));
		progress_update(&line, (double)done / total(pool->plan), words);
		usleep(REDRAW_US);
	}
	progress_clear(&line);
}

/* Each has a backend of its own, with the same draws. */
static int start(struct pool *pool, struct worker *w, char *err)
{
	struct config cfg = *pool->plan->cfg;
	enum publish_backend which;

	cfg.mc_threads = 1;
	cfg.mc_backend = 1; /* the CPU: results must not depend on what this machine has */
	w->pool = pool;
	if (engine_open(&cfg, MC_INLINE, &w->mc, &which, err, ERROR_MAX)) {
		return -EIO;
	}
	const int error = pthread_create(&w->thread, NULL, work, w);

	if (error) {
		mc_close(w->mc);
		snprintf(err, ERROR_MAX, "cannot start a thread: %s", strerror(error));
	}
	return -error;
}

int scenario_pool(const struct scenario_plan *p, struct scenario_result *result)
{
	struct pool pool = {.plan = p, .result = result};
	struct worker worker[THREADS_MAX];
	const int most = p->threads < THREADS_MAX ? p->threads : THREADS_MAX;
	char err[ERROR_MAX] = "";
	int n = 0;

	while (n < most && !start(&pool, &worker[n], err)) {
		n++;
	}
	if (n > 0) {
		show(&pool);
	}
	for (int i = 0; i < n; i++) {
		pthread_join(worker[i].thread, NULL);
		mc_close(worker[i].mc);
	}
	if (!n) {
		return cli_error(CLI_FAILED, p->name, "%s", err);
	}
	if (pool.error) {
		return cli_error(
			CLI_FAILED, p->name, "%s: %s", p->row[pool.failed / p->cars].name,
			pool.error == -ENOMSG
				? "nothing in the log could be judged with this configuration"
				: strerror(-pool.error));
	}
	return cli_interrupted() ? cli_error(CLI_FAILED, p->name, "interrupted") : 0;
}
