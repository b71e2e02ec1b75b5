/* SPDX-License-Identifier: MIT
 * Every row of cuda_calls.def made to fail with the real runtime and a real device: the error comes out, everything is
 * given back, and the next backend works.
 */
#include "../cuda_inject.h"
#include "../../kernels/mc_cuda.c"
#include "../../kernels/mc_cuda_roll.c"
#include "../../kernels/mc_cuda_setup.c"
#include "../../kernels/mc_cuda_time.c"
#include "tap.h"
#include "scenes.h"

#define N 64u

/* One life of a backend that visits every row; the first error of any step. The wait is short enough to query. */
static int live(void)
{
	static struct model_out out[MC_FUTURES_MAX * N];
	static const float in[MODEL_INPUTS * 2];
	const struct mc_params p = {.kind = MC_SOBOL, .seed = 1, .n_resident = N, .threads = 1};
	const struct mc_request req = scene_moving(N);
	struct mc_backend *b;
	struct mc_result res;
	struct mc_cuda_time t;
	int err = mc_cuda_ops.open(&p, &b);

	if (err) {
		return err;
	}
	b->spins = 0;
	err = mc_cuda_ops.run(b, &req, NULL, &res);
	err = err ? err : mc_cuda_ops.samples(b, &req, MC_FAST, 0, N, out);
	err = err ? err
		  : mc_cuda_ops.roll(b, MC_REFERENCE, &req.vehicle, &req.future[0], 10.0f, in, 2,
				     out);
	for (int rung = 0; rung < MC_CUDA_RUNGS && !err; rung++) {
		err = mc_cuda_time(b, (enum mc_cuda_rung)rung, &req, 1e-3, 1, &t);
	}
	mc_cuda_ops.close(b);
	return err;
}

int main(void)
{
	tap_ok(live() == 0, "a life without a fault");
	for (int site = 0; site < CUDA_SITES; site++) {
		const int closing = !strcmp(inject_table[site].phase, "CLOSE");
		const int want = closing ? 0 : -EIO;

		inject.site = site;
		inject.after = 0;
		inject.error = cudaErrorLaunchFailure;
		const int err = live();

		tap_ok(err == want && inject.failed[site] == 1 && inject.reached[site] > 1,
		       "%s fails: %d, wanted %d", inject_table[site].name, err, want);
		inject.site = -1;
	}
	tap_ok(live() == 0, "a life after all of them");
	return tap_end();
}
