/* SPDX-License-Identifier: MIT
 * A risk of one in a million: 500,000,000 samples in one batch. The first run's histogram says at which headway the risk
 * is 1e-6, the second is timed there. Usage: rare [SAMPLES]
 */
#include "stats.h"
#include "tap.h"
#include <math.h>
#include <time.h>

static double now_ms(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static void rare(enum mc_draws_kind kind, uint32_t n, const char *name)
{
	const struct mc_params p = {.kind = kind, .seed = 1, .n_resident = 1u << 20, .threads = 1};
	struct mc_backend *b;
	struct mc_request req;
	struct mc_result res;

	if (!tap_ok(mc_cuda_ops.open(&p, &b) == 0, "%s: open", name)) {
		return;
	}
	mc_preset_paper(&req, 150.0f, n);
	req.flags =
		MC_WANT_HIST; /* contact within the horizon: what still rolls then is 7e-5 in this preset */
	int err = mc_cuda_ops.run(b, &req, NULL, &res);
	const double headway_m =
		stats_quantile(mc_cuda_ops.hist(b)->need, -MC_HIST_NEED_OFF, 1.0 - 1e-6);

	tap_ok(err == 0 && headway_m > 100.0, "%s: the risk is 1e-6 at %.2f m", name, headway_m);
	req.mean[MODEL_HEADWAY] = (float)headway_m;
	req.flags = 0;
	const double start = now_ms();

	err = mc_cuda_ops.run(b, &req, NULL, &res);
	const double ms = now_ms() - start, rse = 1.0 / sqrt((double)res.risk[0].hits);

	tap_ok(err == 0 && res.n == n, "%s: all samples", name);
	tap_ok(rse < 0.05, "%s: relative standard error %.2f %% below 5 %%", name, 100.0 * rse);
	printf("# RARE %s %u samples in %.1f ms: p = %.3e, 95 %% interval %.3e .. %.3e\n", name, n,
	       ms, res.risk[0].p, res.risk[0].lo, res.risk[0].hi);
	mc_cuda_ops.close(b);
}

int main(int argc, char **argv)
{
	const uint32_t n = argc > 1 ? (uint32_t)atol(argv[1]) : 500000000u;

	rare(MC_PHILOX, n, "philox");
	rare(MC_SOBOL, n, "sobol");
	return tap_end();
}
