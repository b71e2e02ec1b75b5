/* SPDX-License-Identifier: MIT
 * mc: the mailbox around a backend that is good, slow, failing or stuck, inline and with a worker.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include "mc_ops.h"

/* What the fake does with a request: its number of samples says. */
enum { RUN_GOOD = 1000, RUN_GATED, RUN_UNTIL_CUT, RUN_FAILING, RUN_STUCK };

struct mc_backend {
	sem_t started, gate; /* every run posts one, RUN_GATED and RUN_STUCK wait for the other */
	uint32_t runs;
	int signals_blocked;
};

/* The backend of the test that is running, and how many are open. */
static struct mc_backend *fake;
static int fakes_open;

static int fake_open(const struct mc_params *p, struct mc_backend **ret)
{
	if (p->n_resident == 0) {
		return -ENODEV;
	}
	fake = calloc(1, sizeof(*fake));
	assert_non_null(fake);
	sem_init(&fake->started, 0, 0);
	sem_init(&fake->gate, 0, 0);
	fakes_open++;
	*ret = fake;
	return 0;
}

static void fake_close(struct mc_backend *b)
{
	if (b) {
		fakes_open--;
		free(b);
	}
}

static int fake_run(struct mc_backend *b, const struct mc_request *req, const uint64_t *cut,
		    struct mc_result *res)
{
	sigset_t mask;

	pthread_sigmask(SIG_BLOCK, NULL, &mask);
	b->signals_blocked = sigismember(&mask, SIGTERM) && sigismember(&mask, SIGUSR1);
	b->runs++;
	sem_post(&b->started);
	if (req->n == RUN_FAILING) {
		return -EIO;
	}
	if (req->n == RUN_GATED || req->n == RUN_STUCK) {
		sem_wait(&b->gate);
	}
	while (req->n == RUN_UNTIL_CUT && __atomic_load_n(cut, __ATOMIC_ACQUIRE) < req->id) {
		sched_yield();
	}
	res->id = req->id;
	res->n = (uint64_t)req->mean[MODEL_HEADWAY];
	res->req_hash = mc_request_hash(req);
	return 0;
}

static const struct mc_ops fake_ops = {
	.name = "fake", .open = fake_open, .run = fake_run, .close = fake_close};

static struct mc *opened(int worker)
{
	const struct mc_params p = {.n_resident = 1, .threads = 1};
	struct mc *mc = NULL;

	assert_int_equal(mc_open(&fake_ops, &p, worker, &mc), 0);
	assert_int_equal(fakes_open, 1);
	return mc;
}

/* Tests with a worker run twice, with one that sleeps and one that spins. */
static int sleeps = MC_WORKER, spins = MC_WORKER_SPINS;

static int kind(void **arg)
{
	return *(int *)*arg;
}

static struct mc_request request(uint64_t id, uint32_t what)
{
	struct mc_request r;

	mc_preset_paper(&r, 100.0f, what);
	r.id = id;
	return r;
}

static int submit(struct mc *mc, uint64_t id, uint32_t what)
{
	struct mc_request r = request(id, what);

	return mc_submit(mc, &r);
}

/* Sleeps until a result is announced, then fetches it. */
static int fetch(struct mc *mc, struct mc_result *res)
{
	struct pollfd fd = {.fd = mc_eventfd(mc), .events = POLLIN};

	assert_int_equal(poll(&fd, 1, -1), 1);
	return mc_poll(mc, res);
}

static int announced(const struct mc *mc)
{
	struct pollfd fd = {.fd = mc_eventfd(mc), .events = POLLIN};

	return poll(&fd, 1, 0);
}

static void test_open_fails(void **arg)
{
	const struct mc_params p = {.n_resident = 0};
	struct mc *mc = (struct mc *)&p;

	(void)arg;
	assert_int_equal(mc_open(&fake_ops, &p, 0, &mc), -ENODEV);
	assert_int_equal(mc_open(&fake_ops, &p, 1, &mc), -ENODEV);
	assert_ptr_equal(mc, &p);
	assert_int_equal(fakes_open, 0);
	mc_close(NULL);
}

/* Neither descriptors nor a thread to be had: what was opened before is closed again. */
static void test_worker_fails(void **arg)
{
	const struct mc_params p = {.n_resident = 1};
	struct rlimit few, many;
	pthread_attr_t huge, usual;
	struct mc *mc = NULL;

	(void)arg;
	getrlimit(RLIMIT_NOFILE, &many);
	few = (struct rlimit){.rlim_cur = 0, .rlim_max = many.rlim_max};
	setrlimit(RLIMIT_NOFILE, &few);
	assert_int_equal(mc_open(&fake_ops, &p, 1, &mc), -EMFILE);
	setrlimit(RLIMIT_NOFILE, &many);
	assert_int_equal(fakes_open, 0);

	pthread_getattr_default_np(&usual);
	pthread_attr_init(&huge);
	pthread_attr_setstacksize(&huge, (size_t)1 << 60);
	pthread_setattr_default_np(&huge);
	assert_int_equal(mc_open(&fake_ops, &p, 1, &mc), -EAGAIN);
	pthread_setattr_default_np(&usual);
	assert_int_equal(fakes_open, 0);
	assert_null(mc);
}

static void test_refused(void **arg)
{
	(void)arg;
	for (int worker = MC_INLINE; worker <= MC_WORKER_SPINS; worker++) {
		struct mc *mc = opened(worker);
		struct mc_request bad = request(1, RUN_GOOD);
		struct mc_result res;

		bad.mean[MODEL_MU] = 0.0f;
		assert_int_equal(mc_submit(mc, &bad), -EINVAL);
		assert_int_equal(submit(mc, 0, RUN_GOOD), -EINVAL);
		assert_int_equal(mc_busy(mc), 0);
		assert_int_equal(mc_poll(mc, &res), 0);
		mc_close(mc);
		assert_int_equal(fakes_open, 0);
	}
}

/* ---- a watch ---------------------------------------------------------------------------------------- */

static struct seen {
	pthread_t thread;
	int hellos, edges;
	enum mc_edge edge[8];
	uint64_t id[8];
} seen;

static void on_hello(const void *arg)
{
	assert_ptr_equal(arg, &seen);
	seen.thread = pthread_self();
	seen.hellos++;
}

static void on_edge(const void *arg, enum mc_edge e, uint64_t id)
{
	(void)arg;
	seen.edge[seen.edges] = e;
	seen.id[seen.edges++] = id;
}

static const struct mc_watch watch = {on_hello, on_edge, &seen};

/* In the thread that runs the batches, before the first of them. */
static void test_watch(void **arg)
{
	struct mc *mc = opened(kind(arg));
	struct mc_result res;

	seen = (struct seen){0};
	assert_int_equal(mc_watch(mc, &watch), 0);
	assert_int_equal(seen.hellos, 1);
	assert_true(pthread_equal(seen.thread, (pthread_t)mc_thread(mc)));
	assert_int_equal(seen.edges, 0);
	assert_int_equal(submit(mc, 3, RUN_GOOD), 0);
	assert_int_equal(fetch(mc, &res), 1);
	mc_close(mc);
	assert_int_equal(seen.edges, 2);
	assert_int_equal(seen.edge[0], MC_EDGE_TAKEN);
	assert_int_equal(seen.edge[1], MC_EDGE_DONE);
	assert_int_equal(seen.id[0], 3);
	assert_int_equal(seen.id[1], 3);
}

static void test_watch_inline(void **arg)
{
	struct mc *mc = opened(MC_INLINE);

	(void)arg;
	seen = (struct seen){0};
	assert_int_equal(mc_watch(mc, &watch), 0);
	assert_int_equal(seen.hellos, 1);
	assert_int_equal(submit(mc, 4, RUN_FAILING), 0);
	assert_int_equal(seen.edges, 2);
	assert_int_equal(seen.edge[1], MC_EDGE_DONE); /* also of a batch that failed */
	mc_close(mc);
}

/* A worker deep in a batch says no hello in time. */
static void test_watch_of_a_busy_worker(void **arg)
{
	struct mc *mc = opened(kind(arg));

	seen = (struct seen){0};
	assert_int_equal(submit(mc, 1, RUN_UNTIL_CUT), 0);
	sem_wait(&fake->started);
	assert_int_equal(mc_watch(mc, &watch), -ETIMEDOUT);
	mc_cut(mc, 1);
	mc_close(mc);
}

static void test_inline(void **arg)
{
	struct mc *mc = opened(MC_INLINE);
	struct mc_request r = request(5, RUN_GOOD);
	struct mc_result res;

	(void)arg;
	assert_int_equal(mc_eventfd(mc), -1);
	assert_int_equal(mc_thread(mc), 0);
	assert_int_equal(mc_poll(mc, &res), 0);
	assert_int_equal(mc_submit(mc, &r), 0);
	assert_int_equal(mc_busy(mc), 0);
	assert_int_equal(mc_poll(mc, &res), 1);
	assert_int_equal(res.id, 5);
	assert_true(res.req_hash == mc_request_hash(&r));
	assert_int_equal(mc_poll(mc, &res), 0);
	for (uint64_t id = 2; id < 7;
	     id++) { /* through all slots: the failed one must not show old figures */
		assert_int_equal(submit(mc, id, RUN_GOOD), 0);
	}
	assert_int_equal(submit(mc, 7, RUN_FAILING), 0);
	assert_int_equal(mc_poll(mc, &res), -EIO);
	assert_int_equal(res.id, 7);
	assert_int_equal(res.n, 0);
	assert_int_equal(mc_poll(mc, &res), 0);
	mc_cut(mc, 8);
	assert_int_equal(submit(mc, 8, RUN_UNTIL_CUT), 0);
	assert_int_equal(mc_poll(mc, &res), 1);
	assert_int_equal(fake->runs, 8);
	mc_close(mc);
	assert_int_equal(fakes_open, 0);
}

static void test_worker(void **arg)
{
	struct mc *mc = opened(kind(arg));
	struct mc_result res;

	assert_true(mc_thread(mc) != 0);
	assert_true(mc_thread(mc) != (unsigned long)pthread_self());
	for (uint64_t id = 1; id <= 100; id++) {
		assert_int_equal(submit(mc, id, RUN_GOOD), 0);
		assert_int_equal(fetch(mc, &res), 1);
		assert_int_equal(res.id, id);
		assert_int_equal(mc_poll(mc, &res), 0);
	}
	mc_close(mc);
	assert_int_equal(fakes_open, 0);
}

static void test_signals(void **arg)
{
	struct mc *mc = opened(kind(arg));
	struct mc_result res;
	sigset_t mask;

	assert_int_equal(submit(mc, 1, RUN_GOOD), 0);
	assert_int_equal(fetch(mc, &res), 1);
	assert_int_equal(fake->signals_blocked, 1);
	pthread_sigmask(SIG_BLOCK, NULL, &mask);
	assert_int_equal(sigismember(&mask, SIGTERM), 0);
	mc_close(mc);
}

static void test_newest_wins(void **arg)
{
	struct mc *mc = opened(kind(arg));
	struct mc_result res;

	assert_int_equal(mc_busy(mc), 0);
	assert_int_equal(submit(mc, 1, RUN_GATED), 0);
	sem_wait(&fake->started);
	assert_int_equal(mc_busy(mc), 1);
	assert_int_equal(mc_poll(mc, &res), 0);
	assert_int_equal(submit(mc, 2, RUN_GOOD), 0);
	assert_int_equal(submit(mc, 3, RUN_GOOD), 1);
	assert_int_equal(submit(mc, 4, RUN_GATED), 1);
	sem_post(&fake->gate);
	sem_wait(&fake->started);
	assert_int_equal(fetch(mc, &res), 1);
	assert_int_equal(res.id, 1);
	assert_int_equal(mc_busy(mc), 1);
	sem_post(&fake->gate);
	assert_int_equal(fetch(mc, &res), 1);
	assert_int_equal(res.id, 4);
	assert_int_equal(fake->runs, 2);
	assert_int_equal(mc_busy(mc), 0);
	assert_int_equal(announced(mc), 0);
	mc_close(mc);
}

/* A result that nobody fetched gives way to the next one, and both announcements are taken by one poll. */
static void test_newest_result(void **arg)
{
	struct mc *mc = opened(kind(arg));
	struct mc_result res;

	assert_int_equal(submit(mc, 1, RUN_GOOD), 0);
	while (mc_busy(mc)) {
		sched_yield();
	}
	assert_int_equal(submit(mc, 2, RUN_GOOD), 0);
	while (mc_busy(mc)) {
		sched_yield();
	}
	assert_int_equal(mc_poll(mc, &res), 1);
	assert_int_equal(res.id, 2);
	assert_int_equal(mc_poll(mc, &res), 0);
	mc_close(mc);
}

static void test_cut(void **arg)
{
	struct mc *mc = opened(kind(arg));
	struct mc_result res;

	assert_int_equal(submit(mc, 10, RUN_UNTIL_CUT), 0);
	mc_cut(mc, 9);
	poll(NULL, 0, 20);
	assert_int_equal(mc_busy(mc), 1);
	mc_cut(mc, 10);
	assert_int_equal(fetch(mc, &res), 1);
	assert_int_equal(res.id, 10);
	mc_cut(mc, 3); /* an older one does not take the newer back */
	assert_int_equal(submit(mc, 10, RUN_UNTIL_CUT), 0);
	assert_int_equal(fetch(mc, &res), 1);
	mc_close(mc);
}

static void test_failing(void **arg)
{
	struct mc *mc = opened(kind(arg));
	struct mc_result res;

	assert_int_equal(submit(mc, 1, RUN_FAILING), 0);
	assert_int_equal(fetch(mc, &res), -EIO);
	assert_int_equal(res.id, 1);
	assert_int_equal(mc_poll(mc, &res), 0);
	assert_int_equal(submit(mc, 2, RUN_GOOD), 0);
	assert_int_equal(fetch(mc, &res), 1);
	assert_int_equal(res.id, 2);
	mc_close(mc);
}

static void test_close_cuts(void **arg)
{
	struct mc *mc = opened(kind(arg));

	assert_int_equal(submit(mc, 1, RUN_UNTIL_CUT), 0);
	sem_wait(&fake->started);
	mc_close(mc);
	assert_int_equal(fakes_open, 0);
}

/* The stuck worker comes back after it was given up: all it touches must still be there. */
static void test_stuck(void **arg)
{
	static struct mc *kept[2]; /* reachable, so that no leak checker minds */
	struct pollfd done = {.events = POLLIN};
	struct mc *abandoned = kept[kind(arg) == MC_WORKER] = opened(kind(arg));

	done.fd = mc_eventfd(abandoned);
	assert_int_equal(submit(abandoned, 1, RUN_STUCK), 0);
	sem_wait(&fake->started);
	mc_close(abandoned);
	assert_int_equal(fakes_open, 1);
	assert_int_equal(poll(&done, 1, 0), 0);
	sem_post(&fake->gate);
	assert_int_equal(poll(&done, 1, -1), 1);
	assert_int_equal(done.revents, POLLIN);
	fakes_open = 0;
}

/* Submits without pause and reads along: what comes out is whole, in order, and ends with the last. */
static void test_stress(void **arg)
{
	struct mc *mc = opened(kind(arg));
	struct mc_request r = request(1, RUN_GOOD);
	struct mc_result res;
	uint64_t last = 0;

	for (uint64_t id = 1; id <= 20000; id++) {
		r.id = id;
		r.mean[MODEL_HEADWAY] = (float)id;
		assert_true(mc_submit(mc, &r) >= 0);
		if (mc_poll(mc, &res)) {
			assert_true(res.id > last && res.id <= id);
			assert_true(res.n == res.id);
			last = res.id;
		}
	}
	while (last < 20000) {
		assert_int_equal(fetch(mc, &res) & ~1, 0);
		last = res.id;
	}
	assert_int_equal(res.n, 20000);
	assert_true(res.req_hash == mc_request_hash(&r));
	assert_int_equal(mc_busy(mc), 0);
	mc_close(mc);
}

#define WITH_WORKER(test)                                   \
	{#test " sleeping", test, NULL, NULL, &sleeps},     \
	{                                                   \
#test " spinning", test, NULL, NULL, &spins \
	}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_open_fails),
		cmocka_unit_test(test_worker_fails),
		cmocka_unit_test(test_refused),
		cmocka_unit_test(test_inline),
		cmocka_unit_test(test_watch_inline),
		WITH_WORKER(test_watch),
		WITH_WORKER(test_watch_of_a_busy_worker),
		WITH_WORKER(test_worker),
		WITH_WORKER(test_signals),
		WITH_WORKER(test_newest_wins),
		WITH_WORKER(test_newest_result),
		WITH_WORKER(test_cut),
		WITH_WORKER(test_failing),
		WITH_WORKER(test_close_cuts),
		WITH_WORKER(test_stuck),
		WITH_WORKER(test_stress),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
