/* SPDX-License-Identifier: MIT
 * The CPU backend: a batch is cut into chunks, chunk i is the work of thread i mod threads, and the integer counts of
 * all threads add up to the same result whatever their number. The calling thread is thread 0.
 */
#include "draws.h"
#include "lanes.h"
#include "mc_ops.h"
#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK       2048 /* samples between two looks at the deadline */
#define THREADS_MAX 256

/* What all threads do at the moment. */
struct task {
	struct lanes_job job; /* as for the whole; a chunk gets its own z, count and outputs */
	struct sample_plan sample;
	struct model_vehicle vehicle;
	struct model_future future[MC_FUTURES_MAX];
	float horizon_s;
	enum mc_rollout which;
	uint64_t first, n; /* samples, or columns of job.z where that is given */
	uint64_t id;
	const uint64_t *cut;
};

struct worker {
	struct mc_backend *backend;
	uint32_t index;
	pthread_t thread;
	int started;
	sem_t go;
	struct lanes_work *work;
	struct lanes_hist *hist;
	float *fill; /* [MC_DIM][CHUNK]: draws beyond the resident ones */
	struct stats_sums sums;
};

struct mc_backend {
	const struct lanes *lanes;
	struct draws *draws;
	uint32_t n_resident, threads;
	struct worker *worker; /* [threads] */
	sem_t done;
	int stop;
	uint64_t batches;
	struct task task;
	struct mc_hist hist;
};

/* Draws first..first+count-1, resident or made now. */
static const float *get_draws(const struct mc_backend *b, struct worker *w, uint64_t first,
			      uint32_t count, uint32_t *stride)
{
	if (first + count <= b->n_resident) {
		return draws_table(b->draws, stride) + first;
	}
	draws_fill(b->draws, first, count, w->fill, CHUNK);
	*stride = CHUNK;
	return w->fill;
}

static void roll_reference(const struct task *t, const struct lanes_job *job)
{
	float in[MODEL_INPUTS];

	for (uint32_t i = 0; i < job->count; i++) {
		for (uint32_t d = 0; !job->sample && d < MODEL_INPUTS; d++) {
			in[d] = job->z[(size_t)d * job->stride + i];
		}
		if (job->sample) {
			sample_draw(job->sample, job->z + i, job->stride, in, 1);
		}
		for (uint32_t f = 0; f < job->n_futures; f++) {
			job->out[(size_t)f * job->out_stride + i] = model_rollout(
				&t->vehicle, &t->future[f], t->horizon_s, MODEL_STEP_S, in, 1);
		}
	}
}

static void run_chunk(struct mc_backend *b, struct worker *w, uint64_t at, uint32_t count)
{
	const struct task *t = &b->task;
	struct lanes_job job = t->job;

	job.count = count;
	job.z = job.sample ? get_draws(b, w, t->first + at, count, &job.stride) : job.z + at;
	job.out = job.out ? job.out + at : NULL;
	job.sums = job.out ? NULL : &w->sums;
	job.hist = !job.out && job.flags & MC_WANT_HIST ? w->hist : NULL;
	if (t->which == MC_REFERENCE) {
		roll_reference(t, &job);
	} else {
		b->lanes->run(w->work, &job);
	}
}

static int is_cut(const struct task *t)
{
	return t->cut && __atomic_load_n(t->cut, __ATOMIC_ACQUIRE) >= t->id;
}

static void run_share(struct worker *w)
{
	struct mc_backend *b = w->backend;
	const struct task *t = &b->task;

	for (uint64_t i = w->index; i * CHUNK < t->n && !is_cut(t); i += b->threads) {
		const uint64_t left = t->n - i * CHUNK;

		run_chunk(b, w, i * CHUNK, left < CHUNK ? (uint32_t)left : CHUNK);
	}
}

static void wait_for(sem_t *s)
{
	while (sem_wait(s)) {
		/* EINTR: only the calling thread takes signals, and none of them ends a batch */
	}
}

static void *serve(void *arg)
{
	struct worker *w = arg;

	for (;;) {
		wait_for(&w->go);
		if (w->backend->stop) {
			return NULL;
		}
		run_share(w);
		sem_post(&w->backend->done);
	}
}

static void run_task(struct mc_backend *b)
{
	for (uint32_t i = 1; i < b->threads; i++) {
		sem_post(&b->worker[i].go);
	}
	run_share(&b->worker[0]);
	for (uint32_t i = 1; i < b->threads; i++) {
		wait_for(&b->done);
	}
}

/* The part of a task that a request gives. */
static void task_from_request(struct task *t, const struct mc_request *req)
{
	memset(t, 0, sizeof(*t));
	sample_plan(req, &t->sample);
	t->vehicle = req->vehicle;
	t->horizon_s = req->horizon_s;
	t->job.sample = &t->sample;
	t->job.n_futures = req->n_futures;
	t->job.flags = req->flags;
	t->job.hist_future = req->hist_future;
	t->job.centre = stats_centre(req);
	t->job.mean_headway_m = req->mean[MODEL_HEADWAY];
	for (uint32_t f = 0; f < req->n_futures; f++) {
		t->future[f] = req->future[f];
		t->job.future[f] = rollout_plan(&req->vehicle, &req->future[f], req->horizon_s);
	}
	t->n = req->n;
}

static void hist_add(struct mc_hist *a, const struct lanes_hist *b)
{
	for (int i = 0; i < MC_HIST_BINS; i++) {
		a->stop[i] += b->stop[i];
		a->need[i] += b->need[i];
	}
}

static int cpu_run(struct mc_backend *b, const struct mc_request *req, const uint64_t *cut,
		   struct mc_result *res)
{
	const int want_hist = (req->flags & MC_WANT_HIST) != 0;
	struct stats_sums sums = {0};

	if (mc_check(req)) {
		return -EINVAL;
	}
	task_from_request(&b->task, req);
	b->task.id = req->id;
	b->task.cut = cut;
	for (uint32_t i = 0; i < b->threads; i++) {
		b->worker[i].sums = (struct stats_sums){0};
		memset(b->worker[i].hist, 0, want_hist ? sizeof(*b->worker[i].hist) : 0);
	}
	run_task(b);
	memset(&b->hist, 0, want_hist ? sizeof(b->hist) : 0);
	for (uint32_t i = 0; i < b->threads; i++) {
		stats_add(&sums, &b->worker[i].sums);
		if (want_hist) {
			hist_add(&b->hist, b->worker[i].hist);
		}
	}
	stats_finish(req, &sums, want_hist ? &b->hist : NULL, res);
	return draws_intact(b->draws, b->batches++) ? 0 : -EBADMSG;
}

static int cpu_samples(struct mc_backend *b, const struct mc_request *req, enum mc_rollout which,
		       uint64_t first, uint32_t count, struct model_out *out)
{
	if (mc_check(req)) {
		return -EINVAL;
	}
	task_from_request(&b->task, req);
	b->task.which = which;
	b->task.first = first;
	b->task.n = count;
	b->task.job.flags |= MC_WANT_IMPACT;
	b->task.job.out = out;
	b->task.job.out_stride = count;
	run_task(b);
	return 0;
}

static int cpu_roll(struct mc_backend *b, enum mc_rollout which, const struct model_vehicle *veh,
		    const struct model_future *fut, float horizon_s, const float *in,
		    uint32_t count, struct model_out *out)
{
	struct task *t = &b->task;

	*t = (struct task){.vehicle = *veh,
			   .future = {*fut},
			   .horizon_s = horizon_s,
			   .which = which,
			   .n = count};
	t->job = (struct lanes_job){.z = in,
				    .stride = count,
				    .n_futures = 1,
				    .future = {rollout_plan(veh, fut, horizon_s)},
				    .flags = MC_WANT_IMPACT,
				    .out = out,
				    .out_stride = count};
	run_task(b);
	return 0;
}

static const struct mc_hist *cpu_hist(const struct mc_backend *b)
{
	return &b->hist;
}

static const char *cpu_describe(const struct mc_backend *b)
{
	return b->lanes->name;
}

static void cpu_close(struct mc_backend *b)
{
	if (!b) {
		return;
	}
	b->stop = 1;
	for (uint32_t i = 0; b->worker && i < b->threads; i++) {
		struct worker *w = &b->worker[i];

		if (w->started) {
			sem_post(&w->go);
			pthread_join(w->thread, NULL);
		}
		sem_destroy(&w->go);
		lanes_work_close(w->work);
		free(w->hist);
		free(w->fill);
	}
	sem_destroy(&b->done);
	draws_close(b->draws);
	free(b->worker);
	free(b);
}

static int open_worker(struct mc_backend *b, uint32_t i)
{
	struct worker *w = &b->worker[i];
	sigset_t all, old;
	int err = 0;

	w->backend = b;
	w->index = i;
	w->work = lanes_work_open();
	w->hist = aligned_alloc(64, sizeof(*w->hist));
	w->fill = aligned_alloc(64, sizeof(float) * MC_DIM * CHUNK);
	if (!w->work || !w->hist || !w->fill) {
		return -ENOMEM;
	}
	if (i > 0) { /* signals belong to the threads of the caller */
		sigfillset(&all);
		pthread_sigmask(SIG_SETMASK, &all, &old);
		err = pthread_create(&w->thread, NULL, serve, w);
		pthread_sigmask(SIG_SETMASK, &old, NULL);
		w->started = !err;
	}
	return -err;
}

static int open_workers(struct mc_backend *b, uint32_t threads)
{
	int err = 0;

	b->worker = calloc(threads, sizeof(*b->worker));
	if (!b->worker) {
		return -ENOMEM;
	}
	b->threads = threads;
	for (uint32_t i = 0; i < threads; i++) {
		sem_init(&b->worker[i].go, 0, 0);
	}
	for (uint32_t i = 0; i < threads && !err; i++) {
		err = open_worker(b, i);
	}
	return err;
}

static int cpu_open(const struct mc_params *p, struct mc_backend **ret)
{
	struct mc_backend *b;
	int err;

	if (p->threads < 1 || p->threads > THREADS_MAX || !lanes_pick(p->variant)) {
		return -EINVAL;
	}
	b = calloc(1, sizeof(*b));
	if (!b) {
		return -ENOMEM;
	}
	sem_init(&b->done, 0, 0);
	b->lanes = lanes_pick(p->variant);
	b->n_resident = p->n_resident;
	err = draws_open(p, &b->draws);
	err = err ? err : open_workers(b, p->threads);
	if (err) {
		cpu_close(b);
		return err;
	}
	*ret = b;
	return 0;
}

const struct mc_ops mc_cpu_ops = {
	.name = "cpu",
	.open = cpu_open,
	.run = cpu_run,
	.samples = cpu_samples,
	.roll = cpu_roll,
	.hist = cpu_hist,
	.describe = cpu_describe,
	.close = cpu_close,
};
