/* SPDX-License-Identifier: MIT
 * mc_cpu: the paper's figures, one result for any number of threads, draws beyond the resident ones, cut batches,
 * samples and explicit scenes with both rollouts, refusals.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include "lanes.h"
#include "mc_ops.h"

/* Of the moving scene below. */
#define MOVING_HITS   15379
#define MOVING_IMPACT 125574782

/* Of the same with the rows of mixture[]. */
#define MIXTURE_HITS   12164
#define MIXTURE_IMPACT 167177439

static struct mc_backend *open_backend(uint32_t resident, uint32_t threads, const char *variant)
{
	const struct mc_params p = {.kind = MC_SOBOL,
				    .seed = 1,
				    .n_resident = resident,
				    .threads = threads,
				    .variant = variant};
	struct mc_backend *b = NULL;

	assert_int_equal(mc_cpu_ops.open(&p, &b), 0);
	assert_non_null(b);
	return b;
}

/* A moving lead, every input uncertain, four futures. */
static void moving(struct mc_request *req, uint32_t n)
{
	static const float factor[MC_FACTOR_LEN] = {0.4f,  0.0f, 0.3f, 0.0f, 0.05f,
						    0.3f,  0.1f, 0.1f, 0.0f, 0.4f,
						    0.05f, 0.0f, 0.0f, 0.2f, 0.6f};

	mc_preset_paper(req, 35.0f, n);
	req->flags = MC_WANT_HIST | MC_WANT_IMPACT;
	req->n_futures = 4;
	req->future[1] = (struct model_future){-6.0f, 0.1f};
	req->future[2] = (struct model_future){-4.0f, 1.0f};
	req->future[3] = (struct model_future){-6.0f, 30.0f};
	req->mean[MODEL_EGO_ACCEL] = 0.2f;
	req->mean[MODEL_LEAD_SPEED] = 28.0f;
	req->mean[MODEL_LEAD_ACCEL] = -4.0f;
	req->mean[MODEL_DELAY] = 0.15f;
	req->sigma[MODEL_TAU - MC_STATE_DIM] = 0.02f;
	req->sigma[MODEL_DELAY - MC_STATE_DIM] = 0.03f;
	memcpy(req->factor, factor, sizeof(factor));
}

static void same_result(const struct mc_result *a, const struct mc_result *b)
{
	assert_int_equal(a->n, b->n);
	assert_int_equal(a->floored, b->floored);
	assert_int_equal(a->req_hash, b->req_hash);
	for (uint32_t f = 0; f < a->n_futures; f++) {
		assert_int_equal(a->risk[f].hits, b->risk[f].hits);
		assert_int_equal(a->risk[f].undecided, b->risk[f].undecided);
		assert_memory_equal(&a->risk[f].impact_mps, &b->risk[f].impact_mps, sizeof(double));
	}
	assert_memory_equal(&a->stop_mean_m, &b->stop_mean_m, sizeof(double));
	assert_memory_equal(&a->stop_sd_m, &b->stop_sd_m, sizeof(double));
	assert_memory_equal(a->headway_m, b->headway_m, sizeof(a->headway_m));
}

static void run(struct mc_backend *b, const struct mc_request *req, struct mc_result *res)
{
	memset(res, 0, sizeof(*res));
	assert_int_equal(mc_cpu_ops.run(b, req, NULL, res), 0);
}

static void near(double got, double want, double by)
{
	if (!(fabs(got - want) <= by)) {
		fail_msg("%.12g is not %.12g +- %g", got, want, by);
	}
}

static void test_paper(void **arg)
{
	struct mc_backend *b = open_backend(65536, 1, NULL);
	struct mc_request req;
	struct mc_result res;

	(void)arg;
	mc_preset_paper(&req, 100.0f, 65536);
	run(b, &req, &res);
	assert_int_equal(res.n, 65536);
	near(res.stop_mean_m, 79.22, 0.05);
	near(res.stop_sd_m, 12.27, 0.05);
	near(res.headway_m[0], 100.6, 0.3);
	near(res.headway_m[1], 111.9, 0.4);
	near(res.headway_m[2], 127.7, 1.0);
	assert_int_equal(res.risk[0].undecided, 0);
	mc_cpu_ops.close(b);
}

/* What the ego may meet, one row of the prior each: the lead, one that brakes harder, a nearer object, one that stands
 * behind it, none. */
static const struct mc_prior mixture[] = {
	{0.4f, 1.0f, 0.0f, 0.0f, 0.0f},      {0.2f, 1.0f, -2.0f, 0.0f, 0.0f},
	{0.1f, 1.0f, 4.0f, -10.0f, -4.0f},   {0.1f, 0.0f, 0.0f, 10.0f, -28.0f},
	{0.2f, 0.0f, 0.0f, 1000.0f, 200.0f},
};
#define ROWS (sizeof(mixture) / sizeof(mixture[0]))

/* Threads, variants, and how many draws are resident change nothing. */
static struct mc_result same_everywhere(uint32_t n_rows)
{
	static const uint32_t threads[] = {1, 2, 3, 4};
	static const uint32_t resident[] = {1, 20000, 6000, 9000};
	struct mc_request req;
	struct mc_result want, got;
	struct mc_hist hist;

	moving(&req, 20000);
	req.n_priors = n_rows;
	memcpy(req.prior, mixture, sizeof(mixture));
	for (unsigned int v = 0; lanes_name(v); v++) {
		for (size_t i = 0; lanes_pick(lanes_name(v)) && i < 4; i++) {
			struct mc_backend *b = open_backend(resident[i], threads[i], lanes_name(v));

			assert_string_equal(mc_cpu_ops.describe(b), lanes_name(v));
			run(b, &req, &got);
			want = v == 0 && i == 0 ? got : want;
			hist = v == 0 && i == 0 ? *mc_cpu_ops.hist(b) : hist;
			same_result(&got, &want);
			assert_memory_equal(mc_cpu_ops.hist(b), &hist, sizeof(hist));
			mc_cpu_ops.close(b);
		}
	}
	assert_true(want.risk[0].hits < want.risk[1].hits && want.risk[1].hits < want.risk[2].hits);
	return want;
}

/* The figures are those of x86-64 and aarch64. */
static void test_same_everywhere(void **arg)
{
	struct mc_result r = same_everywhere(0);

	(void)arg;
	assert_true(r.risk[3].hits > 19000 && r.risk[3].impact_mps > r.risk[2].impact_mps);
	assert_int_equal(r.risk[2].hits, MOVING_HITS);
	near(r.risk[2].impact_mps * (double)r.risk[2].hits * 1024.0, MOVING_IMPACT, 0.01);
	r = same_everywhere(ROWS);
	assert_int_equal(r.risk[2].hits, MIXTURE_HITS);
	near(r.risk[2].impact_mps * (double)r.risk[2].hits * 1024.0, MIXTURE_IMPACT, 0.01);
}

/* The risk of a mixture is the weighted sum of its rows' risks; what is never met is neither contact nor undecided. */
static void test_mixture(void **arg)
{
	struct mc_backend *b = open_backend(20000, 2, NULL);
	struct mc_request req;
	struct mc_result all, one;
	double want[MC_FUTURES_MAX] = {0};

	(void)arg;
	moving(&req, 20000);
	req.n_priors = ROWS;
	memcpy(req.prior, mixture, sizeof(mixture));
	run(b, &req, &all);
	for (size_t i = 0; i < ROWS; i++) {
		req.n_priors = 1;
		req.prior[0] = mixture[i];
		req.prior[0].weight = 1.0f;
		run(b, &req, &one);
		for (int f = 0; f < MC_FUTURES_MAX; f++) {
			want[f] += (double)mixture[i].weight * one.risk[f].p;
		}
	}
	for (int f = 0; f < MC_FUTURES_MAX; f++) {
		assert_int_equal(one.risk[f].hits + one.risk[f].undecided, 0); /* the last row */
		near(all.risk[f].p, want[f], 4 * sqrt(want[f] * (1 - want[f]) / 20000));
	}
	assert_true(want[1] > 0.01 && want[1] < 0.99);
	mc_cpu_ops.close(b);
}

/* A second batch does not see the first; one that wants no histogram leaves none of its figures. */
static void test_again(void **arg)
{
	struct mc_backend *b = open_backend(5000, 2, NULL);
	struct mc_request req;
	struct mc_result first, second;

	(void)arg;
	moving(&req, 5000);
	run(b, &req, &first);
	req.flags = MC_WANT_IMPACT;
	run(b, &req, &second);
	assert_true(isnan(second.stop_mean_m) && isnan(second.headway_m[0]));
	assert_int_equal(second.risk[2].hits, first.risk[2].hits);
	req.flags = MC_WANT_HIST;
	run(b, &req, &second);
	assert_true(isnan(second.risk[2].impact_mps));
	req.flags = MC_WANT_HIST | MC_WANT_IMPACT;
	run(b, &req, &second);
	same_result(&first, &second);
	mc_cpu_ops.close(b);
}

/* The paper's verdict counts what rolls at the horizon; ours leaves it undecided. */
static void test_rolling(void **arg)
{
	struct mc_backend *b = open_backend(4096, 1, NULL);
	struct mc_request req;
	struct mc_result paper, ours;

	(void)arg;
	mc_preset_paper(&req, 500.0f, 4096);
	req.future[0].accel_cmd_mps2 = -2.5f;
	run(b, &req, &paper);
	assert_true(paper.risk[0].hits > 3000);
	assert_int_equal(paper.risk[0].undecided, 0);
	assert_int_equal(mc_cpu_ops.hist(b)->need[MC_HIST_BINS - 1], paper.risk[0].hits);
	req.flags = MC_WANT_HIST;
	run(b, &req, &ours);
	assert_int_equal(ours.risk[0].hits, 0);
	assert_int_equal(ours.risk[0].undecided, paper.risk[0].hits);
	assert_int_equal(mc_cpu_ops.hist(b)->stop[MC_HIST_BINS - 1], paper.risk[0].hits);
	assert_int_equal(mc_cpu_ops.hist(b)->need[MC_HIST_BINS - 1], 0);
	mc_cpu_ops.close(b);
}

static void test_cut(void **arg)
{
	struct mc_backend *b = open_backend(20000, 2, NULL);
	struct mc_request req;
	struct mc_result res;
	uint64_t cut = 7;

	(void)arg;
	mc_preset_paper(&req, 100.0f, 20000);
	req.id = 7;
	assert_int_equal(mc_cpu_ops.run(b, &req, &cut, &res), 0);
	assert_int_equal(res.n, 0);
	assert_true(res.flags & MC_RES_CUT);
	req.id = 8;
	assert_int_equal(mc_cpu_ops.run(b, &req, &cut, &res), 0);
	assert_int_equal(res.n, 20000);
	assert_false(res.flags & MC_RES_CUT);
	mc_cpu_ops.close(b);
}

/* The samples of a request, from any index on, and the same scenes given explicitly. */
static void test_samples(void **arg)
{
	static struct model_out all[4 * 3000], part[4 * 700], ref[4 * 700];
	struct mc_backend *b = open_backend(2000, 3, NULL);
	struct mc_request req;
	struct mc_result res;
	uint64_t hits = 0;

	(void)arg;
	moving(&req, 3000);
	assert_int_equal(mc_cpu_ops.samples(b, &req, MC_FAST, 0, 3000, all), 0);
	assert_int_equal(mc_cpu_ops.samples(b, &req, MC_FAST, 1777, 700, part), 0);
	assert_int_equal(mc_cpu_ops.samples(b, &req, MC_REFERENCE, 1777, 700, ref), 0);
	for (uint32_t f = 0; f < 4; f++) {
		assert_memory_equal(part + f * 700, all + f * 3000 + 1777, 700 * sizeof(part[0]));
	}
	for (uint32_t i = 0; i < 4 * 700; i++) {
		near(part[i].stop_m, ref[i].stop_m, 5e-4);
		near(part[i].need_m, ref[i].need_m, 5e-4);
	}
	run(b, &req, &res);
	for (uint32_t i = 0; i < 3000; i++) {
		hits += (all[2 * 3000 + i].flags & MODEL_CONTACT) != 0;
	}
	assert_int_equal(res.risk[2].hits, hits);
	mc_cpu_ops.close(b);
}

static void test_roll(void **arg)
{
	static float in[MODEL_INPUTS * 5000];
	static struct model_out fast[5000], ref[5000];
	const struct model_future fut = {-6.0f, 0.0f};
	struct mc_backend *b = open_backend(16, 2, NULL);
	struct mc_request req;

	(void)arg;
	mc_preset_paper(&req, 80.0f, 1);
	for (uint32_t i = 0; i < 5000; i++) {
		for (int k = 0; k < MODEL_INPUTS; k++) {
			in[k * 5000 + i] = req.mean[k];
		}
		in[MODEL_EGO_SPEED * 5000 + i] = 0.01f * (float)i;
	}
	assert_int_equal(mc_cpu_ops.roll(b, MC_FAST, &req.vehicle, &fut, 10.0f, in, 5000, fast), 0);
	assert_int_equal(mc_cpu_ops.roll(b, MC_REFERENCE, &req.vehicle, &fut, 10.0f, in, 5000, ref),
			 0);
	for (uint32_t i = 0; i < 5000; i++) {
		near(fast[i].stop_m, ref[i].stop_m, 3e-4);
		near(fast[i].impact_mps, ref[i].impact_mps,
		     fabs(80.0 - (double)ref[i].need_m) > 5e-4 ? 0.01 : 0.1);
		assert_true(i == 0 || fast[i].stop_m > fast[i - 1].stop_m);
	}
	mc_cpu_ops.close(b);
}

static void test_refusals(void **arg)
{
	struct mc_backend *b = NULL;
	struct mc_request req;
	struct mc_result res;
	struct model_out out;
	struct mc_params p = {.kind = MC_SOBOL, .n_resident = 64, .threads = 0};

	(void)arg;
	assert_int_equal(mc_cpu_ops.open(&p, &b), -EINVAL);
	p.threads = 100000;
	assert_int_equal(mc_cpu_ops.open(&p, &b), -EINVAL);
	p.threads = 2;
	p.variant = "sse9";
	assert_int_equal(mc_cpu_ops.open(&p, &b), -EINVAL);
	p.variant = NULL;
	p.n_resident = 0;
	assert_int_equal(mc_cpu_ops.open(&p, &b), -EINVAL);
	assert_null(b);
	mc_cpu_ops.close(NULL);
	b = open_backend(64, 2, NULL);
	mc_preset_paper(&req, 100.0f, 64);
	req.mean[MODEL_MU] = NAN;
	assert_int_equal(mc_cpu_ops.run(b, &req, NULL, &res), -EINVAL);
	assert_int_equal(mc_cpu_ops.samples(b, &req, MC_FAST, 0, 1, &out), -EINVAL);
	mc_cpu_ops.close(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_paper),    cmocka_unit_test(test_same_everywhere),
		cmocka_unit_test(test_mixture),  cmocka_unit_test(test_again),
		cmocka_unit_test(test_rolling),  cmocka_unit_test(test_cut),
		cmocka_unit_test(test_samples),  cmocka_unit_test(test_roll),
		cmocka_unit_test(test_refusals),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
