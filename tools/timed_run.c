/* SPDX-License-Identifier: MIT
 * One long batch, with progress on a terminal and an end on Ctrl-C.
 */
#include "timed_run.h"
#include <pthread.h>
#include <unistd.h>
#include "cli.h"
#include "clock.h"
#include "progress.h"

#define LONG_SAMPLES (1u << 24) /* fewer are done before a line would show */
#define PILOT_PARTS  64

struct ticker {
	const char *what;
	double expected_ns;
	pthread_mutex_t lock;
	pthread_cond_t end;
	int ended;
};

static void *tick(void *arg)
{
	struct ticker *t = arg;
	struct progress line = progress_start(t->what);
	int64_t start_ns = clock_now_ns();

	pthread_mutex_lock(&t->lock);
	while (!t->ended) {
		struct timespec until;
		double share = (double)(clock_now_ns() - start_ns) / t->expected_ns;

		progress_update(&line, share < 0.99 ? share : 0.99, "");
		clock_gettime(CLOCK_REALTIME, &until);
		until.tv_nsec += 250000000;
		until.tv_sec += until.tv_nsec / CLOCK_NS_PER_S;
		until.tv_nsec %= CLOCK_NS_PER_S;
		pthread_cond_timedwait(&t->end, &t->lock, &until);
	}
	pthread_mutex_unlock(&t->lock);
	progress_clear(&line);
	return NULL;
}

static void stop(struct ticker *t, pthread_t thread)
{
	pthread_mutex_lock(&t->lock);
	t->ended = 1;
	pthread_cond_signal(&t->end);
	pthread_mutex_unlock(&t->lock);
	pthread_join(thread, NULL);
}

/* A small part of the batch tells how long the whole will take. */
static int pilot(const struct mc_ops *ops, struct mc_backend *b, const struct mc_request *req,
		 const uint64_t *cut, double *expected_ns)
{
	struct mc_request part = *req;
	struct mc_result res;
	int64_t start_ns = clock_now_ns();

	part.n = req->n / PILOT_PARTS;
	int error = ops->run(b, &part, cut, &res);

	*expected_ns = (double)(clock_now_ns() - start_ns) * PILOT_PARTS;
	return error;
}

int timed_run(const char *what, const struct mc_ops *ops, struct mc_backend *b,
	      const struct mc_request *req, struct mc_result *res)
{
	struct ticker t = {what, 0, PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, 0};
	const uint64_t *cut = cli_catch_interrupt();
	pthread_t thread;

	if (req->n < LONG_SAMPLES || !isatty(STDERR_FILENO)) {
		return ops->run(b, req, cut, res);
	}
	int error = pilot(ops, b, req, cut, &t.expected_ns);

	if (error || pthread_create(&thread, NULL, tick, &t)) {
		return error ? error : ops->run(b, req, cut, res);
	}
	error = ops->run(b, req, cut, res);
	stop(&t, thread);
	return error;
}
