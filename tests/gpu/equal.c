/* SPDX-License-Identifier: MIT
 * GPU = CPU, bit for bit: per-sample results of both rollouts, batch statistics and histograms, within the resident
 * draws and beyond them, Sobol and Philox, truncated and not. Usage: equal [SAMPLES [REFERENCE_SAMPLES]]
 */
#include "mc_ops.h"
#include "tap.h"
#include "scenes.h"
#include <unistd.h>

#define BEYOND 65536u /* samples made on the fly on top of the resident ones */

struct pair {
	struct mc_backend *cpu, *gpu;
};

static uint32_t first_difference(const struct model_out *a, const struct model_out *b, uint32_t n)
{
	uint32_t i = 0;

	while (i < n && !memcmp(&a[i], &b[i], sizeof(a[i]))) {
		i++;
	}
	return i;
}

static void show(const char *who, const struct model_out *o)
{
	printf("# %s stop %a need %a impact %a flags %u\n", who, o->stop_m, o->need_m,
	       o->impact_mps, o->flags);
}

static void same_samples(const struct pair *p, const struct mc_request *req, enum mc_rollout which,
			 uint64_t first, uint32_t count, const char *name)
{
	const uint32_t n = count * req->n_futures;
	struct model_out *c = calloc(n, sizeof(*c)), *g = malloc(n * sizeof(*g));
	int cpu, gpu;
	uint32_t i;

	memset(g, 0x5a, n * sizeof(*g));
	cpu = mc_cpu_ops.samples(p->cpu, req, which, first, count, c);
	gpu = mc_cuda_ops.samples(p->gpu, req, which, first, count, g);
	i = first_difference(c, g, n);
	tap_ok(!cpu && !gpu && i == n,
	       "%s, %s rollout: %u samples x %u futures from %llu equal by memcmp", name,
	       which == MC_FAST ? "fast" : "reference", count, req->n_futures,
	       (unsigned long long)first);
	if (i < n) {
		printf("# errors %d %d, first difference at %u\n", cpu, gpu, i);
		show("cpu", &c[i]);
		show("gpu", &g[i]);
	}
	free(c);
	free(g);
}

static void same_batch(const struct pair *p, const struct mc_request *req, const char *name)
{
	struct mc_result c, g;
	int cpu, gpu;

	memset(&c, 0, sizeof(c));
	memset(&g, 0xff, sizeof(g));
	cpu = mc_cpu_ops.run(p->cpu, req, NULL, &c);
	gpu = mc_cuda_ops.run(p->gpu, req, NULL, &g);
	tap_ok(!cpu && !gpu && !memcmp(&c, &g, sizeof(c)),
	       "%s: result of %u samples equal by memcmp", name, req->n);
	if (cpu || gpu || memcmp(&c, &g, sizeof(c))) {
		printf("# errors %d %d, hits %llu %llu, n %llu %llu, mean %a %a sd %a %a\n", cpu,
		       gpu, (unsigned long long)c.risk[0].hits, (unsigned long long)g.risk[0].hits,
		       (unsigned long long)c.n, (unsigned long long)g.n, c.stop_mean_m,
		       g.stop_mean_m, c.stop_sd_m, g.stop_sd_m);
	}
	if (req->flags & MC_WANT_HIST) {
		tap_ok(!memcmp(mc_cpu_ops.hist(p->cpu), mc_cuda_ops.hist(p->gpu),
			       sizeof(struct mc_hist)),
		       "%s: histograms equal by memcmp", name);
	}
}

static int open_pair(struct pair *p, struct mc_params params)
{
	const int cpu = mc_cpu_ops.open(&params, &p->cpu), gpu = mc_cuda_ops.open(&params, &p->gpu);

	return tap_ok(!cpu && !gpu, "open: cpu %d, cuda %d", cpu, gpu);
}

static void close_pair(struct pair *p)
{
	mc_cpu_ops.close(p->cpu);
	mc_cuda_ops.close(p->gpu);
}

static void all_scenes(struct mc_params params, uint32_t n, uint32_t n_reference, const char *name)
{
	struct mc_request standing = scene_standing(n), moving = scene_moving(n);
	struct pair p;

	if (!open_pair(&p, params)) {
		return;
	}
	printf("# %s: %s against %s, %u threads\n", name, mc_cuda_ops.describe(p.gpu),
	       mc_cpu_ops.describe(p.cpu), params.threads);
	same_samples(&p, &standing, MC_FAST, 0, n, "standing lead");
	same_samples(&p, &moving, MC_FAST, 0, n, "moving lead");
	same_samples(&p, &moving, MC_FAST, n, BEYOND, "moving lead, drawn on the device");
	same_samples(&p, &moving, MC_FAST, (1ull << 32) - 1000, 4096, "moving lead, past 2^32");
	if (n_reference) {
		same_samples(&p, &standing, MC_REFERENCE, 0, n_reference, "standing lead");
		same_samples(&p, &moving, MC_REFERENCE, 0, n_reference, "moving lead");
	}
	same_batch(&p, &standing, "standing lead");
	same_batch(&p, &moving, "moving lead");
	standing.n = moving.n = n + BEYOND;
	same_batch(&p, &standing, "standing lead, beyond the resident draws");
	same_batch(&p, &moving, "moving lead, beyond the resident draws");
	moving.flags = 0;
	same_batch(&p, &moving, "moving lead, counts alone");
	moving.n = 1;
	same_batch(&p, &moving, "one sample");
	close_pair(&p);
}

int main(int argc, char **argv)
{
	const uint32_t n = argc > 1 ? (uint32_t)atol(argv[1]) : 1u << 20;
	const uint32_t n_reference = argc > 2 ? (uint32_t)atol(argv[2]) : n;
	const long cpus = sysconf(_SC_NPROCESSORS_ONLN);
	struct mc_params params = {.kind = MC_SOBOL,
				   .seed = 1,
				   .n_resident = n,
				   .threads = cpus < 64 ? (uint32_t)cpus : 64};

	all_scenes(params, n, n_reference, "sobol");
	params.kind = MC_PHILOX;
	params.seed = 0x123456789abcdefull;
	for (int d = 0; d < MODEL_INPUTS; d++) {
		params.truncate[d] = 2.0f + 0.3f * (float)d;
	}
	all_scenes(params, n, 0, "philox, truncated");
	return tap_end();
}
