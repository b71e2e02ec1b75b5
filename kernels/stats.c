/* SPDX-License-Identifier: MIT
 * Figures from counts. Everything that depends on the order of samples is an integer and was summed before this.
 */
#include "stats.h"
#include <string.h>

#define Z95 1.959963984540054 /* 97.5 % quantile of the standard normal */

int32_t stats_centre(const struct mc_request *req)
{
	return (int32_t)floor((double)req->centre_m * STATS_UNIT_PER_M + 0.5);
}

void stats_add(struct stats_sums *a, const struct stats_sums *b)
{
	a->n += b->n;
	a->floored += b->floored;
	for (int i = 0; i < MC_FUTURES_MAX; i++) {
		a->hits[i] += b->hits[i];
		a->undecided[i] += b->undecided[i];
		a->impact_units[i] += b->impact_units[i];
	}
	a->stop_sum += b->stop_sum;
	a->stop_sum2 += b->stop_sum2;
}

/* Wilson, "Probable inference, the law of succession, and statistical inference", JASA 22 (1927); the ends by the rule
 * of three: (1 - 3/n)^n is 5 %. */
void stats_wilson(uint64_t k, uint64_t n, double *lo, double *hi)
{
	double nn = (double)n, kk = (double)k, three = n > 3 ? 3.0 / nn : 1.0;
	double mid = (kk + Z95 * Z95 / 2) / (nn + Z95 * Z95);
	double half = Z95 * sqrt(kk * ((nn - kk) / nn) + Z95 * Z95 / 4) / (nn + Z95 * Z95);

	*lo = k == 0 ? 0.0 : k == n ? 1.0 - three : mid - half;
	*hi = k == n ? 1.0 : k == 0 ? three : mid + half;
}

#define GROUP  64 /* bins summed up first, so that a quantile need not look at every bin */
#define GROUPS (MC_HIST_BINS / GROUP)

static void group_sums(const uint64_t h[MC_HIST_BINS], uint64_t sum[GROUPS])
{
	for (int g = 0; g < GROUPS; g++) {
		sum[g] = 0;
		for (int i = 0; i < GROUP; i++) {
			sum[g] += h[g * GROUP + i];
		}
	}
}

/* Does what is counted up to here and in @next end below @want? Empty bins are passed over. */
static int ends_below(uint64_t below, uint64_t next, double want)
{
	return next == 0 || (double)(below + next) < want;
}

static double quantile(const uint64_t h[MC_HIST_BINS], const uint64_t sum[GROUPS], double off_m,
		       double q)
{
	uint64_t total = 0, below = 0;
	int group = 0, bin;
	double want;

	for (int g = 0; g < GROUPS; g++) {
		total += sum[g];
	}
	want = q * (double)total;
	while (group < GROUPS - 1 && ends_below(below, sum[group], want)) {
		below += sum[group++];
	}
	bin = group * GROUP;
	while (bin < MC_HIST_BINS - 1 && ends_below(below, h[bin], want)) {
		below += h[bin++];
	}
	if (bin == MC_HIST_BINS - 1) {
		return NAN;
	}
	return off_m + MC_HIST_BIN_M * (bin + (want - (double)below) / (double)h[bin]);
}

double stats_quantile(const uint64_t h[MC_HIST_BINS], double off_m, double q)
{
	uint64_t sum[GROUPS];

	group_sums(h, sum);
	return quantile(h, sum, off_m, q);
}

static struct mc_risk finish_risk(const struct mc_request *req, const struct stats_sums *s, int i)
{
	struct mc_risk r = {.hits = s->hits[i], .undecided = s->undecided[i]};
	double unused;

	r.p_is_bound = r.hits == 0;
	r.impact_mps = req->flags & MC_WANT_IMPACT && r.hits
			       ? (double)s->impact_units[i] / STATS_UNIT_PER_M / (double)r.hits
			       : NAN;
	if (s->n == 0) {
		r.p = NAN;
		r.hi = 1.0;
		return r;
	}
	r.p = (double)r.hits / (double)s->n;
	stats_wilson(r.hits, s->n, &r.lo, &unused);
	stats_wilson(r.hits + r.undecided, s->n, &unused, &r.hi);
	return r;
}

static double finish_sd(const struct stats_sums *s)
{
	unsigned __int128 sum = (unsigned __int128)(s->stop_sum < 0 ? -s->stop_sum : s->stop_sum);
	double n = (double)s->n, num = (double)(s->n * s->stop_sum2 - sum * sum);

	return s->n > 1 ? sqrt(num / (n * (n - 1))) / STATS_UNIT_PER_M : NAN;
}

void stats_finish(const struct mc_request *req, const struct stats_sums *sums,
		  const struct mc_hist *hist, struct mc_result *res)
{
	int want = req->flags & MC_WANT_HIST && sums->n > 0;
	uint64_t need[GROUPS];

	memset(res, 0, sizeof(*res));
	res->id = req->id;
	res->req_hash = mc_request_hash(req);
	res->n = sums->n;
	res->floored = sums->floored;
	res->flags = sums->n < req->n ? MC_RES_CUT : 0;
	res->n_futures = req->n_futures;
	for (uint32_t i = 0; i < req->n_futures; i++) {
		res->risk[i] = finish_risk(req, sums, (int)i);
	}
	res->stop_mean_m = want ? (stats_centre(req) + (double)sums->stop_sum / (double)sums->n) /
					   STATS_UNIT_PER_M
				: NAN;
	res->stop_sd_m = want ? finish_sd(sums) : NAN;
	if (want) {
		group_sums(hist->need, need);
	}
	for (int i = 0; i < MC_RISKS; i++) {
		res->headway_m[i] =
			want ? quantile(hist->need, need, -MC_HIST_NEED_OFF, 1.0 - mc_risk_level[i])
			     : NAN;
	}
}
