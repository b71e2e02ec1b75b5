/* SPDX-License-Identifier: MIT
 * Five batches of a million for a profiler, which is told to look at them alone: paper's scene, moving lead with and
 * without histograms, four futures, draws made on the device. Prints what each is.
 */
#include <cuda_profiler_api.h>
#include "mc_ops.h"
#include "tap.h"
#include "scenes.h"

#define N (1u << 20)

int main(void)
{
	const struct mc_params p = {.kind = MC_SOBOL, .seed = 1, .n_resident = N, .threads = 1};
	struct mc_request req[] = {scene_standing(N), scene_lead(N), scene_lead(N), scene_moving(N),
				   scene_standing(2 * N)};
	struct mc_backend *b;
	struct mc_result res;
	int err = mc_cuda_ops.open(&p, &b);

	req[2].flags = MC_WANT_IMPACT;
	if (!err) {
		cudaProfilerStart();
		for (size_t i = 0; i < sizeof(req) / sizeof(req[0]) && !err; i++) {
			err = mc_cuda_ops.run(b, &req[i], NULL, &res);
		}
		cudaProfilerStop();
		mc_cuda_ops.close(b);
	}
	tap_ok(err == 0, "batches for a profiler");
	return tap_end();
}
