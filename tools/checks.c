/* SPDX-License-Identifier: MIT
 * The measurements of aebmc verify.
 */
#include "checks.h"
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include "cli.h"
#include "clock.h"

#define GROUP       256 /* scenes that share vehicle, future and horizon */
#define THREADS_MAX 64
#define TRUTH       256 /* times as many samples as the resident set are held to be the truth */
#define POLL_NS     (CLOCK_NS_PER_S / 10)

const uint32_t checks_threads[CHECKS_THREADS] = {1, 2, 4};

/* ---- rollouts ---------------------------------------------------------------------------------- */

/* What the threads share; the counters are atomic. */
struct field {
	struct checks *c;
	uint64_t groups; /* of one kind */
	uint64_t next, done;
	int error;
	pthread_mutex_t lock; /* of c's results */
};

struct worker {
	struct field *field;
	struct mc_backend *backend[CHECKS_CONTENDERS_MAX];
	float in[MODEL_INPUTS * GROUP];
	struct model_out ref[GROUP], fast[GROUP], other[GROUP];
	struct verify_tally tally[CHECKS_KINDS];
	uint64_t differing;
};

static int roll(const struct worker *w, int i, enum mc_rollout which, const struct verify_group *g,
		struct model_out *out)
{
	const struct mc_ops *ops = w->field->c->contender[i].ops;

	return ops->roll(w->backend[i], which, &g->vehicle, &g->future, g->horizon_s, g->in,
			 g->count, out);
}

static int roll_group(struct worker *w, enum verify_kind kind, uint64_t group)
{
	const struct checks *c = w->field->c;
	uint64_t left = c->samples - group * GROUP;
	struct verify_group g = {.count = left < GROUP ? (uint32_t)left : GROUP, .in = w->in};

	verify_scenes(kind, c->params.seed, group, &g);
	int error = roll(w, 0, MC_REFERENCE, &g, w->ref);

	error = error ? error : roll(w, 0, MC_FAST, &g, w->fast);
	for (int i = 1; i < c->n && !error; i++) {
		error = roll(w, i, MC_FAST, &g, w->other);
		for (uint32_t k = 0; k < g.count; k++) {
			w->differing += memcmp(&w->fast[k], &w->other[k], sizeof(w->fast[k])) != 0;
		}
	}
	if (!error) {
		verify_compare(&g, w->fast, w->ref, &w->tally[kind]);
	}
	return error;
}

static int open_contender(const struct checks *c, int i, uint32_t threads, uint32_t n_resident,
			  struct mc_backend **ret)
{
	struct mc_params p = c->params;

	p.threads = threads;
	p.n_resident = n_resident;
	p.variant = c->contender[i].variant;
	return c->contender[i].ops->open(&p, ret);
}

static int open_worker(struct worker *w)
{
	const struct checks *c = w->field->c;
	int error = 0;

	for (int i = 0; i < c->n && !error; i++) {
		error = open_contender(c, i, 1, 1,
				       &w->backend[i]); /* no draws: scenes are explicit */
	}
	return error;
}

static void report(struct worker *w, int error)
{
	struct field *f = w->field;

	pthread_mutex_lock(&f->lock);
	for (int k = 0; k < CHECKS_KINDS; k++) {
		verify_add(&f->c->tally[k], &w->tally[k]);
	}
	f->c->differing += w->differing;
	f->error = f->error ? f->error : error;
	pthread_mutex_unlock(&f->lock);
}

static void *work(void *arg)
{
	struct worker *w = arg;
	struct field *f = w->field;
	int error = open_worker(w);

	while (!error && !cli_interrupted()) {
		uint64_t i = __atomic_fetch_add(&f->next, 1, __ATOMIC_RELAXED);

		if (i >= f->groups * CHECKS_KINDS) {
			break;
		}
		error = roll_group(w, (enum verify_kind)(i % CHECKS_KINDS), i / CHECKS_KINDS);
		__atomic_fetch_add(&f->done, 1, __ATOMIC_RELEASE);
	}
	for (int i = 0; i < f->c->n; i++) {
		f->c->contender[i].ops->close(w->backend[i]);
	}
	report(w, error);
	return NULL;
}

/* Until all groups are done or a thread gave up; joining would keep the progress line waiting. */
static void wait_all(struct field *f, const pthread_t *thread, uint32_t n)
{
	const struct timespec nap = {0, POLL_NS};
	const uint64_t all = f->groups * CHECKS_KINDS;
	uint64_t done = 0;

	for (uint32_t i = 0; i < n; i++) {
		while (pthread_tryjoin_np(thread[i], NULL) == EBUSY) {
			done = __atomic_load_n(&f->done, __ATOMIC_ACQUIRE);
			f->c->progress(f->c->arg, (double)done / (double)all);
			nanosleep(&nap, NULL);
		}
	}
}

int checks_rollouts(struct checks *c)
{
	struct field f = {.c = c,
			  .groups = (c->samples + GROUP - 1) / GROUP,
			  .lock = PTHREAD_MUTEX_INITIALIZER};
	uint32_t n = c->params.threads < THREADS_MAX ? c->params.threads : THREADS_MAX, started = 0;
	struct worker *worker = calloc(n, sizeof(*worker));
	pthread_t thread[THREADS_MAX];

	if (!worker) {
		return -ENOMEM;
	}
	for (; started < n; started++) {
		worker[started].field = &f;
		if (pthread_create(&thread[started], NULL, work, &worker[started])) {
			break;
		}
	}
	wait_all(&f, thread, started);
	free(worker);
	if (!started) {
		return -EAGAIN;
	}
	return f.error || !cli_interrupted() ? f.error : -EINTR;
}

/* ---- batches ----------------------------------------------------------------------------------- */

/* A scene with everything in it: all inputs drawn and correlated, four futures, two priors. */
static void scene_full(struct mc_request *req, uint32_t n)
{
	static const struct model_future futures[MC_FUTURES_MAX] = {
		{-6, 0.05f}, {-6, 0}, {-3.92f, 1}, {0, 30}};
	static const float mean[MC_STATE_DIM] = {20, 30, -0.2f, 28, -5};

	mc_preset_paper(req, 100, n);
	req->flags = MC_WANT_HIST | MC_WANT_IMPACT;
	req->n_futures = MC_FUTURES_MAX;
	memcpy(req->future, futures, sizeof(futures));
	memcpy(req->mean, mean, sizeof(mean));
	for (int i = 0; i < MC_FACTOR_LEN; i++) {
		req->factor[i] = 0.15f + 0.02f * (float)i;
	}
	req->sigma[MODEL_TAU - MC_STATE_DIM] = 0.01f;
	req->mean[MODEL_DELAY] = 0.1f;
	req->sigma[MODEL_DELAY - MC_STATE_DIM] = 0.02f;
	req->n_priors = 4;
	req->prior[0] = (struct mc_prior){0.5f, 1, 0, 0, 0};
	req->prior[1] = (struct mc_prior){0.3f, 0.5f, -1, 0, 0};
	req->prior[2] = (struct mc_prior){0.1f, 1, 4, -6, -3};    /* a nearer object */
	req->prior[3] = (struct mc_prior){0.1f, 0, 0, 1000, 200}; /* none */
}

/* Field by field, for there are holes between them. */
static int same_result(const struct mc_result *a, const struct mc_result *b)
{
	const size_t head = offsetof(struct mc_result, risk),
		     tail = offsetof(struct mc_result, stop_mean_m);
	int same = !memcmp(a, b, head) &&
		   !memcmp((const char *)a + tail, (const char *)b + tail, sizeof(*a) - tail);

	for (uint32_t i = 0; i < a->n_futures; i++) {
		same &= !memcmp(&a->risk[i], &b->risk[i], offsetof(struct mc_risk, p_is_bound)) &&
			a->risk[i].p_is_bound == b->risk[i].p_is_bound;
	}
	return same;
}

struct batch {
	struct mc_result res;
	struct mc_hist hist;
};

static int run_batch(const struct checks *c, int i, uint32_t threads, const struct mc_request *req,
		     struct batch *ret)
{
	const struct mc_ops *ops = c->contender[i].ops;
	struct mc_backend *b;
	int error = open_contender(c, i, threads, c->params.n_resident, &b);

	if (error) {
		return error;
	}
	error = ops->run(b, req, cli_catch_interrupt(), &ret->res);
	if (!error) {
		ret->hist = *ops->hist(b);
	}
	ops->close(b);
	return !error && cli_interrupted() ? -EINTR
					   : error; /* cut short, it must not be compared */
}

static int compare_batches(struct checks *c, const struct mc_request *req, struct batch *first,
			   struct batch *other)
{
	int error = run_batch(c, 0, 1, req, first);

	for (int i = 0; i < c->n * CHECKS_THREADS && !error; i++) {
		error = run_batch(c, i / CHECKS_THREADS, checks_threads[i % CHECKS_THREADS], req,
				  other);
		if (!error) {
			c->differing +=
				!same_result(&first->res, &other->res) ||
				memcmp(&first->hist, &other->hist, sizeof(first->hist)) != 0;
		}
	}
	return error;
}

int checks_batches(struct checks *c)
{
	struct batch *batch = calloc(2, sizeof(*batch));
	struct mc_request req;

	if (!batch) {
		return -ENOMEM;
	}
	mc_preset_paper(&req, 100, c->samples);
	int error = compare_batches(c, &req, &batch[0], &batch[1]);

	scene_full(&req, c->samples);
	error = error ? error : compare_batches(c, &req, &batch[0], &batch[1]);
	free(batch);
	return error;
}

/* ---- the resident set -------------------------------------------------------------------------- */

/* Headways at which a far larger set with another seed has the risks; Sobol, whose error falls nearly as 1/N. */
static int true_headways(const struct checks *c, double headway_m[MC_RISKS])
{
	struct mc_params p = c->params;
	struct mc_request req;
	struct mc_result res;
	struct mc_backend *b;

	p.kind = MC_SOBOL;
	p.seed = c->params.seed + 1;
	p.variant = c->contender[0].variant;
	int error = c->contender[0].ops->open(&p, &b);

	if (error) {
		return error;
	}
	mc_preset_paper(&req, 100, p.n_resident * TRUTH);
	error = c->contender[0].ops->run(b, &req, cli_catch_interrupt(), &res);
	memcpy(headway_m, res.headway_m, sizeof(res.headway_m));
	c->contender[0].ops->close(b);
	return !error && cli_interrupted() ? -EINTR : error;
}

int checks_resident(struct checks *c)
{
	double headway_m[MC_RISKS];
	struct mc_request req;
	struct mc_result res;
	struct mc_backend *b;
	int error = true_headways(c, headway_m);

	error = error ? error : open_contender(c, 0, 1, c->params.n_resident, &b);
	if (error) {
		return error;
	}
	for (int i = 0; i < MC_RISKS && !error; i++) {
		mc_preset_paper(&req, (float)headway_m[i], c->params.n_resident);
		error = c->contender[0].ops->run(b, &req, NULL, &res);
		c->set_p[i] = res.risk[0].p;
		c->set_lo[i] = res.risk[0].lo;
		c->set_hi[i] = res.risk[0].hi;
	}
	c->contender[0].ops->close(b);
	return error;
}

int checks_bad(const struct checks *c)
{
	int bad = c->differing != 0;

	for (int k = 0; k < CHECKS_KINDS; k++) {
		const struct verify_tally *t = &c->tally[k];

		bad |= t->verdict_mismatches != 0 || t->not_finite != 0 ||
		       !(t->stop_dev_m <= CHECKS_STOP_MAX_M) ||
		       !(t->impact_dev_mps <= CHECKS_IMPACT_MAX_MPS);
	}
	return bad;
}

int checks_good(const struct checks *c)
{
	int done = 1;

	for (int k = 0; k < CHECKS_KINDS; k++) {
		done &= c->tally[k].scenes > 0;
	}
	return done && !checks_bad(c);
}
