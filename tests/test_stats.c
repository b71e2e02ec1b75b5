/* SPDX-License-Identifier: MIT
 * stats: intervals against 50 digits, quantiles by hand, sums at the ends of their range, every field of a result.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>
#include "kat.h"
#include "stats.h"

static struct mc_hist hist;

static void test_wilson(void **arg)
{
	FILE *f = kat_open("wilson.txt");
	char line[160];
	int n = 0;

	(void)arg;
	while (kat_line(f, line, sizeof(line))) {
		unsigned long long k, of;
		double want_lo, want_hi, lo, hi;

		assert_int_equal(sscanf(line, "%llu %llu %la %la", &k, &of, &want_lo, &want_hi), 4);
		stats_wilson(k, of, &lo, &hi);
		assert_true(fabs(lo - want_lo) <= 1e-14 * want_hi);
		assert_true(fabs(hi - want_hi) <= 1e-14 * want_hi);
		n++;
	}
	assert_int_equal(n, 45);
}

static void test_wilson_ends(void **arg)
{
	double lo, hi;

	(void)arg;
	for (uint64_t n = 1; n <= 3; n++) {
		stats_wilson(0, n, &lo, &hi);
		assert_true(lo == 0.0 && hi == 1.0);
		stats_wilson(n, n, &lo, &hi);
		assert_true(lo == 0.0 && hi == 1.0);
	}
	stats_wilson(0, 12000, &lo, &hi);
	assert_true(lo == 0.0 && hi == 3.0 / 12000);
	stats_wilson(12000, 12000, &lo, &hi);
	assert_true(lo == 1.0 - 3.0 / 12000 && hi == 1.0);
}

static void test_quantile(void **arg)
{
	uint64_t *h = hist.stop;

	(void)arg;
	memset(&hist, 0, sizeof(hist));
	assert_true(isnan(stats_quantile(h, 0.0, 0.5)));
	h[8] = 100; /* 1.0 .. 1.125 m */
	assert_true(stats_quantile(h, 0.0, 0.0) == 1.0);
	assert_true(stats_quantile(h, 0.0, 0.5) == 1.0625);
	assert_true(stats_quantile(h, 0.0, 1.0) == 1.125);
	assert_true(stats_quantile(h, -128.0, 0.5) == -126.9375);
	h[16] = 300; /* 2.0 .. 2.125 m */
	assert_true(stats_quantile(h, 0.0, 0.25) == 1.125);
	assert_true(stats_quantile(h, 0.0, 0.5) == 2.0 + 0.125 / 3);
	assert_true(stats_quantile(h, 0.0, 1.0) == 2.125);
	h[0] = 400;
	assert_true(stats_quantile(h, 0.0, 0.25) == 0.0625);
	h[MC_HIST_BINS - 1] = 800; /* beyond the last edge: half of all */
	assert_true(stats_quantile(h, 0.0, 0.5) == 2.125);
	assert_true(isnan(stats_quantile(h, 0.0, 0.501)));
}

/* The definition, bin by bin. */
static double plain_quantile(const uint64_t *h, double q)
{
	uint64_t total = 0, below = 0;
	int bin = 0;

	for (int i = 0; i < MC_HIST_BINS; i++) {
		total += h[i];
	}
	while (h[bin] == 0 || (double)(below + h[bin]) < q * (double)total) {
		below += h[bin++];
	}
	return MC_HIST_BIN_M * (bin + (q * (double)total - (double)below) / (double)h[bin]);
}

/* Sparse and dense histograms that end anywhere below the last bin. */
static void test_quantile_plain(void **arg)
{
	uint32_t x = 1;

	(void)arg;
	for (int round = 0; round < 200; round++) {
		memset(&hist, 0, sizeof(hist));
		for (int i = 0; i < 1 + round * 10; i++) {
			x = x * 1664525u + 1013904223u;
			hist.stop[(x >> 16) % (MC_HIST_BINS - 1)] += x >> 30;
		}
		hist.stop[round * 40] += 1;
		for (double q = 0.0; q <= 1.0; q += 0.0625) {
			assert_true(stats_quantile(hist.stop, 0.0, q) ==
				    plain_quantile(hist.stop, q));
		}
	}
}

static struct mc_request request(uint32_t n)
{
	struct mc_request r;

	mc_preset_paper(&r, 100.0f, n);
	r.id = 77;
	r.n_futures = 2;
	r.future[1] = r.future[0];
	r.flags |= MC_WANT_IMPACT;
	return r;
}

static struct mc_result finished(const struct mc_request *req, const struct stats_sums *s)
{
	struct mc_result res;

	memset(&res, 0xff, sizeof(res));
	stats_finish(req, s, req->flags & MC_WANT_HIST ? &hist : NULL, &res);
	return res;
}

static void test_risk(void **arg)
{
	struct mc_request req = request(1000);
	struct stats_sums s = {.n = 1000,
			       .floored = 5,
			       .hits = {100, 0},
			       .undecided = {20, 0},
			       .impact_units = {100 * 3 * 1024 + 50 * 1024}};
	struct mc_result res = finished(&req, &s);
	double lo, hi, unused;

	(void)arg;
	stats_wilson(100, 1000, &lo, &unused);
	stats_wilson(120, 1000, &unused, &hi);
	assert_int_equal(res.id, 77);
	assert_true(res.req_hash == mc_request_hash(&req));
	assert_int_equal(res.n, 1000);
	assert_int_equal(res.floored, 5);
	assert_int_equal(res.flags, 0);
	assert_int_equal(res.n_futures, 2);
	assert_int_equal(res.risk[0].hits, 100);
	assert_int_equal(res.risk[0].undecided, 20);
	assert_true(res.risk[0].p == 0.1 && res.risk[0].lo == lo && res.risk[0].hi == hi);
	assert_true(res.risk[0].impact_mps == 3.5);
	assert_int_equal(res.risk[0].p_is_bound, 0);
	assert_true(res.risk[1].p == 0.0 && res.risk[1].lo == 0.0 && res.risk[1].hi == 0.003);
	assert_true(isnan(res.risk[1].impact_mps));
	assert_int_equal(res.risk[1].p_is_bound, 1);
}

static void test_undecided_only(void **arg)
{
	struct mc_request req = request(1000);
	struct stats_sums s = {.n = 1000, .undecided = {30, 1000}};
	struct mc_result res = finished(&req, &s);
	double unused, hi;

	(void)arg;
	stats_wilson(30, 1000, &unused, &hi);
	assert_true(res.risk[0].p == 0.0 && res.risk[0].lo == 0.0 && res.risk[0].hi == hi);
	assert_int_equal(res.risk[0].p_is_bound, 1);
	assert_true(res.risk[1].hi == 1.0);
}

static void test_not_wanted(void **arg)
{
	struct mc_request req = request(10);
	struct stats_sums s = {.n = 9, .hits = {3, 9}, .impact_units = {1, 1}};
	struct mc_result res;

	(void)arg;
	req.flags = 0;
	res = finished(&req, &s);
	assert_int_equal(res.flags, MC_RES_CUT);
	assert_true(isnan(res.risk[0].impact_mps));
	assert_true(isnan(res.stop_mean_m) && isnan(res.stop_sd_m));
	for (int i = 0; i < MC_RISKS; i++) {
		assert_true(isnan(res.headway_m[i]));
	}
	assert_true(res.risk[1].p == 1.0 && res.risk[1].hi == 1.0);
}

static void test_no_sample(void **arg)
{
	struct mc_request req = request(10);
	struct stats_sums s = {0};
	struct mc_result res;

	(void)arg;
	memset(&hist, 0, sizeof(hist));
	res = finished(&req, &s);
	assert_int_equal(res.flags, MC_RES_CUT);
	assert_true(isnan(res.risk[0].p) && res.risk[0].lo == 0.0 && res.risk[0].hi == 1.0);
	assert_int_equal(res.risk[0].p_is_bound, 1);
	assert_true(isnan(res.stop_mean_m) && isnan(res.stop_sd_m) && isnan(res.headway_m[0]));
}

/* Counts @n samples that all stopped at @q units. */
static void count_stops(struct stats_sums *s, int64_t centre, int64_t q, uint64_t n)
{
	unsigned __int128 square = (unsigned __int128)((q - centre) * (q - centre));

	s->n += n;
	s->stop_sum += (q - centre) * (int64_t)n;
	s->stop_sum2 += square * n;
}

static void test_stops(void **arg)
{
	struct mc_request req = request(4);

	(void)arg;
	for (int i = 0; i < 4; i++) {
		static const float centre_m[] = {79.0f, 0.0f, -1e6f, 1e6f};
		struct stats_sums s = {0};
		struct mc_result res;

		req.centre_m = centre_m[i];
		assert_int_equal(stats_centre(&req), (int64_t)centre_m[i] * 1024);
		count_stops(&s, stats_centre(&req), 50 * 1024, 1);
		count_stops(&s, stats_centre(&req), 60 * 1024 + 512, 1);
		res = finished(&req, &s);
		assert_true(res.stop_mean_m == 55.25);
		assert_true(res.stop_sd_m == 10.5 / sqrt(2.0));
	}
}

/* The largest batch, as spread as it can be and as far from its centre: no sum may wrap. */
static void test_stops_extreme(void **arg)
{
	struct mc_request req = request(UINT32_MAX);
	struct stats_sums s = {0};
	struct mc_result res;

	(void)arg;
	req.centre_m = -1e6f;
	count_stops(&s, stats_centre(&req), 0, UINT32_MAX / 2);
	count_stops(&s, stats_centre(&req), 1023 * 1024, UINT32_MAX / 2);
	res = finished(&req, &s);
	assert_true(fabs(res.stop_mean_m - 511.5) < 1e-9);
	assert_true(fabs(res.stop_sd_m - 511.5) < 1e-6);
	s = (struct stats_sums){0};
	count_stops(&s, stats_centre(&req), 4096, 1);
	res = finished(&req, &s);
	assert_true(res.stop_mean_m == 4.0);
	assert_true(isnan(res.stop_sd_m));
}

static void test_headway(void **arg)
{
	struct mc_request req = request(1000);
	struct stats_sums s = {.n = 1000};
	struct mc_result res;

	(void)arg;
	memset(&hist, 0, sizeof(hist));
	for (int i = 0; i < 1000; i++) { /* needs of 0, 0.125, 0.25 .. m */
		hist.need[MC_HIST_NEED_OFF * 8 + i] = 1;
	}
	res = finished(&req, &s);
	assert_true(fabs(res.headway_m[0] - 950 * 0.125) < 1e-9);
	assert_true(fabs(res.headway_m[1] - 990 * 0.125) < 1e-9);
	assert_true(fabs(res.headway_m[2] - 999 * 0.125) < 1e-9);
}

static void test_add(void **arg)
{
	struct stats_sums a = {.n = 1,
			       .floored = 2,
			       .hits = {3, 4, 5, 6},
			       .undecided = {7, 8, 9, 10},
			       .impact_units = {11, 12, 13, 14},
			       .stop_sum = -15,
			       .stop_sum2 = ((unsigned __int128)1 << 100) + UINT64_MAX};
	struct stats_sums b = a;

	(void)arg;
	stats_add(&a, &b);
	assert_int_equal(a.n, 2);
	assert_int_equal(a.floored, 4);
	for (uint64_t i = 0; i < 4; i++) {
		assert_int_equal(a.hits[i], 2 * (3 + i));
		assert_int_equal(a.undecided[i], 2 * (7 + i));
		assert_int_equal(a.impact_units[i], 2 * (11 + i));
	}
	assert_int_equal(a.stop_sum, -30);
	assert_true(a.stop_sum2 == 2 * b.stop_sum2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_wilson),     cmocka_unit_test(test_wilson_ends),
		cmocka_unit_test(test_quantile),   cmocka_unit_test(test_quantile_plain),
		cmocka_unit_test(test_risk),       cmocka_unit_test(test_undecided_only),
		cmocka_unit_test(test_not_wanted), cmocka_unit_test(test_no_sample),
		cmocka_unit_test(test_stops),      cmocka_unit_test(test_stops_extreme),
		cmocka_unit_test(test_headway),    cmocka_unit_test(test_add),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
