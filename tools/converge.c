/* SPDX-License-Identifier: MIT
 * aebmc converge: Table I of the paper (Sec. VI) beside the same figures from this program, with standard errors, so
 * that one sees which differences are chance. Independent draws (Philox) by default, as in the paper.
 */
#include <math.h>
#include <string.h>
#include "compute.h"
#include "cli.h"
#include "cmd.h"

struct paper_row {
	uint32_t n;
	double mean_m, sd_m;
};

/* Table I: stopping distance over the number of samples. */
static const struct paper_row paper_table[] = {
	{1000, 79.23, 12.35},   {4000, 79.20, 12.11},   {8000, 79.22, 12.15},
	{12000, 79.22, 12.21},  {25000, 79.20, 12.16},  {37000, 79.25, 12.18},
	{65000, 79.24, 12.15},  {100000, 79.22, 12.09}, {150000, 79.22, 12.13},
	{350000, 79.19, 12.14},
};
#define ROWS (sizeof(paper_table) / sizeof(paper_table[0]))

struct row {
	double mean_m, sd_m, mean_se_m, sd_se_m; /* standard errors for independent samples */
};

static const struct argp_child children[] = {{&compute_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = st->input;
		return 0;
	case ARGP_KEY_ARG:
		return cli_bad(st, "'%s': converge takes options alone", arg);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {NULL,
				 parse,
				 NULL,
				 "Mean and standard deviation of the stopping distance over the "
				 "number of samples: Table I of the paper beside ours.",
				 children,
				 NULL,
				 NULL};

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

static struct row row_of(const struct mc_result *res, const struct mc_hist *hist)
{
	double n = (double)res->n, sd = res->stop_sd_m, var = sd * sd;
	double m4 = fourth_moment(hist->stop, res->stop_mean_m);

	return (struct row){res->stop_mean_m, sd, sd / sqrt(n),
			    sqrt((m4 - var * var) / n) / (2 * sd)};
}

/* Fills @rows; *@done is smaller than ROWS after Ctrl-C. */
static int compute(const struct mc_ops *ops, struct mc_backend *b, struct row rows[ROWS],
		   size_t *done)
{
	const uint64_t *cut = cli_catch_interrupt();

	for (*done = 0; *done < ROWS; ++*done) {
		struct mc_request req;
		struct mc_result res;

		mc_preset_paper(&req, 100, paper_table[*done].n);
		int error = ops->run(b, &req, cut, &res);

		if (error || (res.flags & MC_RES_CUT)) {
			return error;
		}
		rows[*done] = row_of(&res, ops->hist(b));
	}
	return 0;
}

/* Difference in units of its own standard error: both sides have one. */
static double z_of(double ours, double paper, double se)
{
	return (ours - paper) / (sqrt(2) * se);
}

static void write_json(const struct compute_args *a, const char *variant, const struct row *rows,
		       size_t n)
{
	struct json j = json_start(stdout);

	json_head(&j, "converge");
	compute_json(&j, a, variant);
	json_open(&j, "rows", '[');
	for (size_t i = 0; i < n; i++) {
		const struct paper_row *p = &paper_table[i];
		const struct row *r = &rows[i];

		json_open(&j, NULL, '{');
		json_uint(&j, "samples", p->n);
		json_num(&j, "paper_mean_m", p->mean_m);
		json_num(&j, "paper_sd_m", p->sd_m);
		json_num(&j, "mean_m", r->mean_m);
		json_num(&j, "sd_m", r->sd_m);
		json_num(&j, "mean_se_m", r->mean_se_m);
		json_num(&j, "sd_se_m", r->sd_se_m);
		json_num(&j, "mean_z", z_of(r->mean_m, p->mean_m, r->mean_se_m));
		json_num(&j, "sd_z", z_of(r->sd_m, p->sd_m, r->sd_se_m));
		json_close(&j, '}');
	}
	json_close(&j, ']');
	json_bool(&j, "interrupted", cli_interrupted());
	json_close(&j, '}');
}

static void print_words(const struct compute_args *a, const char *variant, const struct row *rows,
			size_t n)
{
	printf("Table I of the paper beside ours; %s draws, seed %llu, %s. se: standard error;\n"
	       "z: the difference in units of its standard error (both sides have one).\n\n"
	       "          mean [m]                            standard deviation [m]\n"
	       "      N   paper    ours      se      z        paper    ours      se      z\n",
	       a->params.kind == MC_SOBOL ? "Sobol" : "Philox", (unsigned long long)a->params.seed,
	       variant);
	for (size_t i = 0; i < n; i++) {
		const struct paper_row *p = &paper_table[i];
		const struct row *r = &rows[i];

		printf("%7u   %.2f  %7.3f  %6.3f  %+5.1f        %.2f  %7.3f  %6.3f  %+5.1f\n", p->n,
		       p->mean_m, r->mean_m, r->mean_se_m, z_of(r->mean_m, p->mean_m, r->mean_se_m),
		       p->sd_m, r->sd_m, r->sd_se_m, z_of(r->sd_m, p->sd_m, r->sd_se_m));
	}
}

int cmd_converge(int argc, char **argv)
{
	struct compute_args a = compute_defaults();
	const struct mc_ops *ops;
	struct mc_backend *b;
	struct row rows[ROWS];
	const char *name = argv[0];

	a.params.kind = MC_PHILOX;
	a.params.n_resident = 65536;
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : compute_open(name, &a, &ops, &b);
	if (code) {
		return code;
	}
	size_t done;
	int error = compute(ops, b, rows, &done);

	if (error) {
		code = cli_error(CLI_FAILED, name, "%s", strerror(-error));
	} else if (a.json) {
		write_json(&a, ops->describe(b), rows, done);
	} else {
		print_words(&a, ops->describe(b), rows, done);
	}
	if (!error && done < ROWS) {
		code = cli_error(CLI_FAILED, name, "interrupted");
	}
	ops->close(b);
	return code;
}
