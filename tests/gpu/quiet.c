/* SPDX-License-Identifier: MIT
 * After open nothing is allocated: neither heap nor device memory grows over thousands of batches of every kind.
 */
#include "mc_cuda_host.h"
#include "tap.h"
#include "scenes.h"
#include <malloc.h>

#define N 16384u

static uint64_t heap(void)
{
	const struct mallinfo2 m = mallinfo2();

	return m.uordblks + m.hblkhd;
}

static int batches(struct mc_backend *b, uint32_t count)
{
	struct mc_request req[] = {scene_moving(N), scene_moving(N + 1000), scene_standing(N),
				   scene_lead(1)};
	struct mc_result res;
	int err = 0;

	for (uint32_t i = 0; i < count && !err; i++) {
		struct mc_request *r = &req[i % 4];

		r->flags ^= MC_WANT_HIST;
		err = mc_cuda_ops.run(b, r, NULL, &res);
	}
	return err;
}

int main(void)
{
	const struct mc_params p = {.kind = MC_SOBOL, .seed = 1, .n_resident = N, .threads = 1};
	size_t free_before = 0, free_after = 0, total = 0;
	struct mc_backend *b;

	if (!tap_ok(mc_cuda_ops.open(&p, &b) == 0, "open")) {
		return tap_end();
	}
	cudaMemGetInfo(&free_before, &total);
	const uint64_t before = heap();
	const int err = batches(b, 8);
	const uint64_t first = heap();
	const int later = batches(b, 20000);
	const uint64_t after = heap();

	cudaMemGetInfo(&free_after, &total);
	tap_ok(err == 0 && later == 0, "20,008 batches of every kind");
	tap_ok(first == before, "heap after the first eight: %+lld bytes",
	       (long long)(first - before));
	tap_ok(after == first, "heap after 20,000 more: %+lld bytes", (long long)(after - first));
	tap_ok(free_after == free_before, "device memory: %+lld bytes",
	       (long long)(free_before - free_after));
	mc_cuda_ops.close(b);
	return tap_end();
}
