/* SPDX-License-Identifier: MIT
 * Table I of the paper. See table1.h.
 */
#include "table1.h"
#include <math.h>

static const struct {
	uint32_t n;
	double mean_m, sd_m;
} paper_table[TABLE1_ROWS] = {
	{1000, 79.23, 12.35},   {4000, 79.20, 12.11},   {8000, 79.22, 12.15},
	{12000, 79.22, 12.21},  {25000, 79.20, 12.16},  {37000, 79.25, 12.18},
	{65000, 79.24, 12.15},  {100000, 79.22, 12.09}, {150000, 79.22, 12.13},
	{350000, 79.19, 12.14},
};

/* Fourth central moment; the bins are far narrower than the distribution. The last one holds what is off the scale. */
static double fourth_moment(const uint64_t h[MC_HIST_BINS], double mean_m)
{
	double sum = 0, n = 0;

	for (int i = 0; i < MC_HIST_BINS - 1; i++) {
		double d = (i + 0.5) * MC_HIST_BIN_M - mean_m;

		sum += (double)h[i] * d * d * d * d;
		n += (double)h[i];
	}
	return sum / n;
}

static struct table1_row row_of(size_t i, const struct mc_result *res, const struct mc_hist *hist)
{
	const double n = (double)res->n, sd = res->stop_sd_m, var = sd * sd;
	const double m4 = fourth_moment(hist->stop, res->stop_mean_m);
	struct table1_row r = {.n = paper_table[i].n,
			       .paper_mean_m = paper_table[i].mean_m,
			       .paper_sd_m = paper_table[i].sd_m,
			       .mean_m = res->stop_mean_m,
			       .sd_m = sd,
			       .mean_se_m = sd / sqrt(n),
			       .sd_se_m = sqrt((m4 - var * var) / n) / (2 * sd)};

	r.mean_z = (r.mean_m - r.paper_mean_m) / (sqrt(2) * r.mean_se_m);
	r.sd_z = (r.sd_m - r.paper_sd_m) / (sqrt(2) * r.sd_se_m);
	return r;
}

int table1_compute(const struct mc_ops *ops, struct mc_backend *b, const uint64_t *cut,
		   struct table1_row rows[TABLE1_ROWS], size_t *done)
{
	for (*done = 0; *done < TABLE1_ROWS; ++*done) {
		struct mc_request req;
		struct mc_result res;

		mc_preset_paper(&req, 100, paper_table[*done].n);
		int error = ops->run(b, &req, cut, &res);

		if (error || (res.flags & MC_RES_CUT)) {
			return error;
		}
		rows[*done] = row_of(*done, &res, ops->hist(b));
	}
	return 0;
}

void table1_words(FILE *out, const struct table1_row *rows, size_t n)
{
	fputs("          mean [m]                            standard deviation [m]\n"
	      "      N   paper    ours      se      z        paper    ours      se      z\n",
	      out);
	for (const struct table1_row *r = rows; r < rows + n; r++) {
		fprintf(out, "%7u   %.2f  %7.3f  %6.3f  %+5.1f        %.2f  %7.3f  %6.3f  %+5.1f\n",
			r->n, r->paper_mean_m, r->mean_m, r->mean_se_m, r->mean_z, r->paper_sd_m,
			r->sd_m, r->sd_se_m, r->sd_z);
	}
}

void table1_csv(FILE *out, const struct table1_row *rows, size_t n)
{
	fputs("samples,paper_mean_m,mean_m,mean_se_m,mean_z,paper_sd_m,sd_m,sd_se_m,sd_z\n", out);
	for (const struct table1_row *r = rows; r < rows + n; r++) {
		fprintf(out, "%u,%.2f,%.9g,%.9g,%.9g,%.2f,%.9g,%.9g,%.9g\n", r->n, r->paper_mean_m,
			r->mean_m, r->mean_se_m, r->mean_z, r->paper_sd_m, r->sd_m, r->sd_se_m,
			r->sd_z);
	}
}

void table1_markdown(FILE *out, const struct table1_row *rows, size_t n)
{
	fputs("| N | mean, paper [m] | ours [m] | se | z | SD, paper [m] | ours [m] | se | z |\n"
	      "|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
	      out);
	for (const struct table1_row *r = rows; r < rows + n; r++) {
		fprintf(out, "| %u | %.2f | %.3f | %.3f | %+.1f | %.2f | %.3f | %.3f | %+.1f |\n",
			r->n, r->paper_mean_m, r->mean_m, r->mean_se_m, r->mean_z, r->paper_sd_m,
			r->sd_m, r->sd_se_m, r->sd_z);
	}
}
