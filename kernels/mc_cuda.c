/* SPDX-License-Identifier: MIT
 * The CUDA backend at run time: a request is cut into chunks, each is written to mapped memory, launched as a graph,
 * waited for by its number in mapped memory, and verified. No allocation, no copy call, nothing that blocks in the driver.
 */
#include "mc_cuda_host.h"
#include "stats.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define WAIT_SPINS (1u << 20) /* looks at a word: about a millisecond */
#define WAIT_SLEEPS \
	30000u /* of 50 us at least, 100 us as a rule: 3 s, the driver's own limit for a hung kernel */
#define WAIT_NS 50000

void mc_cuda_job(struct cuda_job *job, const struct mc_request *req)
{
	memset(job, 0, sizeof(*job));
	job->hash = mc_request_hash(req);
	job->flags = req->flags;
	job->n_futures = req->n_futures;
	job->hist_future = req->hist_future;
	job->centre = stats_centre(req);
	job->horizon_s = req->horizon_s;
	job->vehicle = req->vehicle;
	sample_plan(req, &job->sample);
	for (uint32_t f = 0; f < req->n_futures; f++) {
		job->future[f] = req->future[f];
		job->roll[f] = rollout_plan(&req->vehicle, &req->future[f], req->horizon_s);
	}
}

/* ---- one chunk ----------------------------------------------------------------------------------- */

static int answered(const struct mc_backend *b, uint64_t seq)
{
	return __atomic_load_n(&b->out->seq, __ATOMIC_ACQUIRE) == seq;
}

/* Counts looks and sleeps: this room reads no clock. The query is there for errors; the answer is the word. */
static int wait_for(struct mc_backend *b, uint64_t seq)
{
	const struct timespec pause = {.tv_nsec = WAIT_NS};

	for (uint32_t i = 0; i < b->spins; i++) {
		if (answered(b, seq)) {
			return 0;
		}
	}
	for (uint32_t i = 0; i < b->sleeps; i++) {
		const int err = CUDA_CALL(QUERY, cudaStreamQuery(b->stream));

		if (answered(b, seq)) {
			return 0;
		}
		if (err != -EAGAIN) {
			return err ? err : -EBADMSG; /* it ended without an answer */
		}
		nanosleep(&pause, NULL);
	}
	b->pending = seq;
	return -ETIMEDOUT;
}

static uint64_t digest(const struct cuda_job *job)
{
	uint64_t sum = 0;

	for (uint32_t i = 0; i < sizeof(*job) / sizeof(uint32_t); i++) {
		uint32_t word;

		memcpy(&word, (const char *)job + i * sizeof(word), sizeof(word));
		sum += cuda_digest_word(word, i);
	}
	return sum;
}

static int sums_hold(const struct cuda_out *out, const struct cuda_job *job)
{
	const int hist = (job->flags & MC_WANT_HIST) != 0;
	uint64_t check = 0, stop = 0, need = 0;

	for (uint32_t f = 0; f < MC_FUTURES_MAX; f++) {
		for (uint32_t i = 0; i < CUDA_SUMS; i++) {
			check += out->sum[f][i] * cuda_check_weight(f, i);
		}
	}
	for (uint32_t i = out->lo; hist && i < out->hi && i < MC_HIST_BINS; i++) {
		stop += out->stop[i];
		need += out->need[i];
	}
	return check == out->check && out->sum[0][CUDA_N] == job->count &&
	       (!hist || (stop == job->count && need == job->count && out->hi <= MC_HIST_BINS));
}

static int verify(const struct mc_backend *b, const struct cuda_job *job)
{
	const struct cuda_out *out = b->out;
	const int good = out->hash == job->hash && out->digest == digest(job) &&
			 out->slice_sum == b->slice_sum[job->slice] &&
			 !memcmp(out->canary, b->canary, sizeof(b->canary)) && sums_hold(out, job);

	return good ? 0 : -EBADMSG;
}

static void pass(const struct mc_backend *b, enum mc_edge e)
{
	if (b->watch) {
		b->watch->edge(b->watch->arg, e, b->id);
	}
}

int mc_cuda_chunk(struct mc_backend *b, enum cuda_kernel k, struct cuda_job *job)
{
	int err;

	job->seq = ++b->seq;
	job->slice = (uint32_t)(b->seq % b->slices);
	*b->job = *job;
	err = CUDA_CALL(LAUNCH, cudaGraphLaunch(b->graph[k], b->stream));
	pass(b, MC_EDGE_LAUNCHED);
	err = err ? err : wait_for(b, job->seq);
	pass(b, MC_EDGE_ANSWERED);
	if (err && err != -ETIMEDOUT) {
		b->failed = err;
	}
	err = err ? err : verify(b, job);
	pass(b, MC_EDGE_VERIFIED);
	return err;
}

/* ---- a batch --------------------------------------------------------------------------------------- */

static enum cuda_kernel pick(const struct mc_backend *b, const struct cuda_job *job)
{
	const int hist = (job->flags & MC_WANT_HIST) != 0;

	if (job->first < b->n_resident) {
		return hist ? CUDA_KERNEL_HIST : CUDA_KERNEL_BATCH;
	}
	return hist ? CUDA_KERNEL_DRAW_HIST : CUDA_KERNEL_DRAW;
}

/* Chunks end where the resident draws do: a kernel reads draws or makes them, never both. Threads count in 32 bits and,
 * with histograms, blocks in 16. */
static uint32_t chunk_size(const struct mc_backend *b, enum cuda_kernel k,
			   const struct cuda_job *job, uint64_t n)
{
	const uint64_t blocks = (b->grid[k] - 1) / job->n_futures;
	const uint64_t each = job->flags & MC_WANT_HIST
				      ? CUDA_HIST_BLOCK_MAX
				      : (uint64_t)CUDA_THREAD_MAX * cuda_kernel_table[k].block;
	const uint64_t most = blocks * each < CUDA_CHUNK ? blocks * each : CUDA_CHUNK;
	const uint64_t end = job->first < b->n_resident && b->n_resident < n ? b->n_resident : n;

	return (uint32_t)(end - job->first < most ? end - job->first : most);
}

/* Only what the last batch filled. */
static void hist_clear(struct mc_backend *b)
{
	if (b->hist_lo < b->hist_hi) {
		const size_t bytes = (b->hist_hi - b->hist_lo) * sizeof(b->hist.stop[0]);

		memset(&b->hist.stop[b->hist_lo], 0, bytes);
		memset(&b->hist.need[b->hist_lo], 0, bytes);
	}
	b->hist_lo = MC_HIST_BINS;
	b->hist_hi = 0;
}

static void collect(struct mc_backend *b, const struct cuda_job *job, struct stats_sums *sums)
{
	const struct cuda_out *out = b->out;
	struct stats_sums s = {.n = out->sum[0][CUDA_N], .floored = out->sum[0][CUDA_FLOORED]};

	for (uint32_t f = 0; f < job->n_futures; f++) {
		s.hits[f] = out->sum[f][CUDA_HITS];
		s.undecided[f] = out->sum[f][CUDA_UNDECIDED];
		s.impact_units[f] = out->sum[f][CUDA_IMPACT];
	}
	s.stop_sum = (int64_t)out->sum[job->hist_future][CUDA_STOP];
	s.stop_sum2 = out->sum[job->hist_future][CUDA_STOP2];
	stats_add(sums, &s);
	if (job->flags & MC_WANT_HIST) {
		b->hist_lo = out->lo < b->hist_lo ? out->lo : b->hist_lo;
		b->hist_hi = out->hi > b->hist_hi ? out->hi : b->hist_hi;
		for (uint32_t i = out->lo; i < out->hi; i++) {
			b->hist.stop[i] += out->stop[i];
			b->hist.need[i] += out->need[i];
		}
	}
}

/* A chunk that never answered blocks the stream: until its number turns up there is no use in launching more. */
static int ready(struct mc_backend *b)
{
	if (b->pending && answered(b, b->pending)) {
		b->pending = 0;
	}
	return b->failed ? b->failed : b->pending ? -ETIMEDOUT : 0;
}

static int cuda_run(struct mc_backend *b, const struct mc_request *req, const uint64_t *cut,
		    struct mc_result *res)
{
	struct stats_sums sums = {0};
	struct cuda_job job;
	int err = mc_check(req) ? -EINVAL : ready(b);

	if (err) {
		return err;
	}
	b->id = req->id;
	mc_cuda_job(&job, req);
	hist_clear(b);
	while (sums.n < req->n && !(cut && __atomic_load_n(cut, __ATOMIC_ACQUIRE) >= req->id)) {
		job.first = sums.n;
		const enum cuda_kernel k = pick(b, &job);

		job.count = chunk_size(b, k, &job, req->n);
		err = mc_cuda_chunk(b, k, &job);
		if (err) {
			return err;
		}
		collect(b, &job, &sums);
	}
	stats_finish(req, &sums, &b->hist, res);
	return 0;
}

/* ---- open and close ---------------------------------------------------------------------------------- */

static void cuda_close(struct mc_backend *b)
{
	if (b) {
		mc_cuda_teardown(b);
	}
}

/* Every graph once, and every slice of the resident memory: nothing is loaded or seen for the first time later. */
static int warm_up(struct mc_backend *b)
{
	static const enum cuda_kernel kinds[] = {CUDA_KERNEL_BATCH, CUDA_KERNEL_HIST,
						 CUDA_KERNEL_DRAW, CUDA_KERNEL_DRAW_HIST};
	struct mc_request req;
	struct cuda_job job;
	int err = 0;

	mc_preset_paper(&req, 100.0f, 1);
	for (uint32_t i = 0; i < b->slices + 4 && !err; i++) {
		const enum cuda_kernel k = kinds[i % 4];

		req.flags = k == CUDA_KERNEL_HIST || k == CUDA_KERNEL_DRAW_HIST ? MC_WANT_HIST : 0;
		mc_cuda_job(&job, &req);
		job.count = 1;
		job.first = k == CUDA_KERNEL_DRAW || k == CUDA_KERNEL_DRAW_HIST ? b->n_resident : 0;
		err = mc_cuda_chunk(b, k, &job);
	}
	return err;
}

static int cuda_open(const struct mc_params *p, struct mc_backend **ret)
{
	struct mc_backend *b = calloc(1, sizeof(*b));
	int err;

	if (!b) {
		return -ENOMEM;
	}
	b->spins = WAIT_SPINS;
	b->sleeps = WAIT_SLEEPS;
	err = mc_cuda_setup(b, p);
	err = err ? err : warm_up(b);
	if (err) {
		cuda_close(b);
		return err;
	}
	*ret = b;
	return 0;
}

static const struct mc_hist *cuda_hist(const struct mc_backend *b)
{
	return &b->hist;
}

static void cuda_watch(struct mc_backend *b, const struct mc_watch *w)
{
	b->watch = w;
}

static const char *cuda_describe(const struct mc_backend *b)
{
	return b->info.name;
}

const struct mc_ops mc_cuda_ops = {
	.name = "cuda",
	.open = cuda_open,
	.run = cuda_run,
	.samples = mc_cuda_samples,
	.roll = mc_cuda_roll,
	.hist = cuda_hist,
	.watch = cuda_watch,
	.describe = cuda_describe,
	.close = cuda_close,
};
