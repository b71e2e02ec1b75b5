/* SPDX-License-Identifier: MIT
 * Ten thousand changed bits, one at a time, in everything that the device holds or hands over: which are found at once,
 * which within one round of the checksum, which change a result and are not found. Usage: flips [COUNT]
 */
#include "../../kernels/mc_cuda.c"
#include "tap.h"
#include "scenes.h"

#define N 4096u

enum place { DRAWS, HEAD, MAPPED_JOB, DEVICE_JOB, ACCUMULATORS, RESULTS, PLACES };
static const char *const place_name[PLACES] = {"resident draws", "resident tables",
					       "job, mapped",    "job, device",
					       "accumulators",   "results, mapped"};

struct tally {
	uint32_t flips, at_once, in_round, harmless, silent;
	uint64_t batches;      /* until found, summed */
	uint32_t wrong_before; /* flips with a wrong result before they were found */
};

struct fixture {
	struct mc_backend *b;
	struct cuda_job job;
	struct mc_request req;
	struct cuda_out *right;
	uint64_t random;
};

static uint32_t below(struct fixture *f, uint32_t n)
{
	f->random = f->random * 6364136223846793005ull + 1442695040888963407ull;
	return (uint32_t)((f->random >> 33) % n);
}

static int kernel(struct mc_backend *b, enum cuda_kernel k)
{
	const struct cuda_kernel_row *row = &cuda_kernel_table[k];
	void *args[] = {&b->args};
	const uint32_t blocks = k == CUDA_KERNEL_FETCH ? 1 : b->grid[k];

	return cudaLaunchKernel(row->function, (dim3){blocks, 1, 1}, (dim3){row->block, 1, 1}, args,
				row->shared, b->stream) ||
	       cudaStreamSynchronize(b->stream);
}

static void flip_host(struct fixture *f, void *p, size_t bytes)
{
	const uint32_t bit = below(f, (uint32_t)bytes * 8);

	((unsigned char *)p)[bit / 8] ^= (unsigned char)(1u << bit % 8);
}

static int flip_byte(void *device, size_t byte, unsigned int mask)
{
	unsigned char c;
	int err = cudaMemcpy(&c, (char *)device + byte, 1, cudaMemcpyDeviceToHost);

	c ^= (unsigned char)mask;
	return err || cudaMemcpy((char *)device + byte, &c, 1, cudaMemcpyHostToDevice);
}

static int flip_device(struct fixture *f, void *device, size_t bytes)
{
	const uint32_t bit = below(f, (uint32_t)bytes * 8);

	return flip_byte(device, bit / 8, 1u << bit % 8);
}

/* One chunk by hand, with a bit changed in the place that is not resident; 0, or what verify() says. */
static int chunk(struct fixture *f, enum place place)
{
	struct mc_backend *b = f->b;
	int broken;

	f->job.seq = ++b->seq;
	f->job.slice = (uint32_t)(b->seq % b->slices);
	*b->job = f->job;
	if (place == MAPPED_JOB) {
		flip_host(f, (char *)b->job + 8, sizeof(*b->job) - 8);
		b->job->count = b->job->count > 2 * N ? f->job.count
						      : b->job->count; /* stay inside the table */
		b->job->first = f->job.first;
	}
	broken = kernel(b, CUDA_KERNEL_FETCH);
	if (place == DEVICE_JOB) {
		broken |= flip_device(f, &b->work->job.sample,
				      sizeof(*b->job) - offsetof(struct cuda_job, sample));
	} else if (place == ACCUMULATORS) {
		broken |= flip_device(f, b->work->sum, sizeof(b->work->sum));
	}
	broken |= kernel(b, CUDA_KERNEL_HIST);
	if (place == RESULTS) {
		flip_host(f, b->out, offsetof(struct cuda_out, stop));
	}
	return broken ? -EIO : verify(b, &f->job);
}

/* Bins outside lo..hi count as empty, whatever stands there. */
static uint32_t bin(const struct cuda_out *o, const uint32_t *h, uint32_t i)
{
	return i >= o->lo && i < o->hi ? h[i] : 0;
}

static int is_right(const struct fixture *f)
{
	const struct cuda_out *a = f->b->out, *r = f->right;
	int same = !memcmp(a->sum, r->sum, sizeof(a->sum));

	for (uint32_t i = 0; i < MC_HIST_BINS && same; i++) {
		same = bin(a, a->stop, i) == bin(r, r->stop, i) &&
		       bin(a, a->need, i) == bin(r, r->need, i);
	}
	return same;
}

static int restore_draws(struct mc_backend *b)
{
	uint32_t stride;
	const float *z = draws_table(b->draws, &stride);

	return cudaMemcpy(b->resident, &b->head, sizeof(b->head), cudaMemcpyHostToDevice) ||
	       cudaMemcpy(b->resident + 1, z, (size_t)MC_DIM * stride * sizeof(*z),
			  cudaMemcpyHostToDevice);
}

static void one(struct fixture *f, enum place place, struct tally *t)
{
	const size_t head = sizeof(f->b->head), all = (size_t)f->b->head.words * 4;
	const int resident = place == DRAWS || place == HEAD;
	const uint32_t rounds = resident ? f->b->slices : 1;
	int found = 0, wrong = 0;
	uint32_t batches = 0;

	if (resident) {
		const uint32_t byte = place == HEAD
					      ? below(f, (uint32_t)head)
					      : (uint32_t)head + below(f, (uint32_t)(all - head));

		flip_byte(f->b->resident, byte, 1u << below(f, 8));
	}
	while (!found && batches < rounds) {
		found = chunk(f, place) != 0;
		wrong |= !found && !is_right(f);
		batches++;
	}
	if (resident) {
		restore_draws(f->b);
	}
	t->flips++;
	t->at_once += found && batches == 1;
	t->in_round += found && batches > 1;
	t->harmless += !found && !wrong;
	t->silent += !found && wrong;
	t->batches += found ? batches : 0;
	t->wrong_before += found && wrong;
}

static void report(const struct tally *t)
{
	printf("# %-16s %7s %8s %9s %9s %7s %14s %22s\n", "where", "flips", "at once", "in round",
	       "harmless", "silent", "mean batches", "wrong result before");
	for (int p = 0; p < PLACES; p++) {
		const uint32_t found = t[p].at_once + t[p].in_round;

		printf("# %-16s %7u %8u %9u %9u %7u %14.1f %22u\n", place_name[p], t[p].flips,
		       t[p].at_once, t[p].in_round, t[p].harmless, t[p].silent,
		       found ? (double)t[p].batches / found : 0.0, t[p].wrong_before);
	}
}

int main(int argc, char **argv)
{
	const uint32_t count = argc > 1 ? (uint32_t)atol(argv[1]) : 10000;
	const struct mc_params p = {.kind = MC_SOBOL, .seed = 1, .n_resident = N, .threads = 1};
	struct fixture f = {.random = 1};
	struct tally t[PLACES] = {{0}};
	uint32_t silent = 0;

	if (!tap_ok(mc_cuda_ops.open(&p, &f.b) == 0, "open")) {
		return tap_end();
	}
	f.req = scene_moving(N);
	mc_cuda_job(&f.job, &f.req);
	f.job.count = N;
	f.right = malloc(sizeof(*f.right));
	tap_ok(chunk(&f, PLACES) == 0, "a chunk without a flip is good");
	memcpy(f.right, f.b->out, sizeof(*f.right));
	for (uint32_t i = 0; i < count; i++) {
		one(&f, (enum place)(i % PLACES), &t[i % PLACES]);
	}
	report(t);
	for (int i = 0; i < PLACES; i++) {
		silent += t[i].silent;
	}
	tap_ok(silent == 0, "%u flips, %u of them changed a result for good and were not found",
	       count, silent);
	tap_ok(chunk(&f, PLACES) == 0, "without a flip it is good again");
	mc_cuda_ops.close(f.b);
	free(f.right);
	return tap_end();
}
