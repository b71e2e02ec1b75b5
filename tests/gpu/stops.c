/* SPDX-License-Identifier: MIT
 * The stopping distances that the GPU finds for the paper's first samples (Sec. IV), in full, for the figure of CPU
 * against GPU (Sec. VI): whoever has a CPU can hold its own against them.
 */
#include "mc_ops.h"
#include "tap.h"

#define N 256

int main(void)
{
	const struct mc_params p = {.kind = MC_PHILOX, .seed = 1, .n_resident = N, .threads = 1};
	struct model_out cpu[N], gpu[N];
	struct mc_backend *c = NULL, *g = NULL;
	struct mc_request req;
	int differ = 0;

	mc_preset_paper(&req, 100.0f, N);
	int err = mc_cpu_ops.open(&p, &c) | mc_cuda_ops.open(&p, &g);

	err = err ? err : mc_cpu_ops.samples(c, &req, MC_REFERENCE, 0, N, cpu);
	err = err ? err : mc_cuda_ops.samples(g, &req, MC_REFERENCE, 0, N, gpu);
	tap_ok(err == 0, "%d samples on both", N);
	for (int i = 0; i < N && !err; i++) {
		differ += memcmp(&cpu[i].stop_m, &gpu[i].stop_m, sizeof(float)) != 0;
		printf("# STOP %d %a\n", i, (double)gpu[i].stop_m);
	}
	tap_ok(!err && !differ, "%d of the stopping distances differ from the CPU's", differ);
	mc_cpu_ops.close(c);
	mc_cuda_ops.close(g);
	return tap_end();
}
