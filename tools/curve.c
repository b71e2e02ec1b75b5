/* SPDX-License-Identifier: MIT
 * aebmc curve: the risk against the headway, and the headways at 5, 1 and 0.1 % risk with their time to collision.
 */
#include <math.h>
#include <string.h>
#include "compute.h"
#include "cli.h"
#include "cmd.h"
#include "request.h"
#include "risk_curve.h"
#include "timed_run.h"

#define ROWS_TEXT 30 /* most rows of the table */
#define BAR       30 /* characters of a full bar */
#define RESIDENT  65536

struct args {
	struct compute_args compute;
	struct request_args request;
	const char *csv;
};

struct curve {
	const struct args *args;
	const char *variant;
	struct mc_request req;
	struct mc_result res;
	const struct mc_hist *hist;
	struct risk_row row[RISK_CURVE_ROWS];
	int rows;
};

/* ---- arguments --------------------------------------------------------------------------------- */

enum { KEY_CSV = 0x100 };

static const struct argp_option options[] = {
	{"csv", KEY_CSV, "FILE", 0, "risk against headway as CSV, - for standard output", 1},
	{0},
};
static const struct argp_child children[] = {
	{&request_argp, 0, NULL, 0}, {&compute_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->request;
		st->child_inputs[1] = &a->compute;
		return 0;
	case KEY_CSV:
		a->csv = arg;
		return 0;
	case ARGP_KEY_ARG:
		return cli_bad(st, "'%s': curve takes options alone", arg);
	case ARGP_KEY_END:
		return a->csv && !strcmp(a->csv, "-") && a->compute.json
			       ? cli_bad(st, "--json and --csv - both want standard output")
			       : 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 NULL,
				 "Risk against headway for the paper's preset or any scene, and "
				 "the headways at which the risk is 5, 1 and 0.1 %.",
				 children,
				 NULL,
				 NULL};

/* ---- the curve --------------------------------------------------------------------------------- */

static double ttc_s(const struct mc_request *req, double headway_m)
{
	double closing_mps =
		(double)req->mean[MODEL_EGO_SPEED] - (double)req->mean[MODEL_LEAD_SPEED];

	return closing_mps > 0 ? headway_m / closing_mps : NAN;
}

/* ---- CSV --------------------------------------------------------------------------------------- */

static int write_csv(const char *name, const struct curve *c)
{
	FILE *f = cli_create(name, c->args->csv);

	if (!f) {
		return CLI_FAILED;
	}
	fputs("headway_m,risk,risk_lo,risk_hi,below_hi\n", f);
	for (const struct risk_row *r = c->row; r < c->row + c->rows; r++) {
		fprintf(f, "%.3f,%.9g,%.9g,%.9g,%d\n", r->headway_m, r->p, r->lo, r->hi, r->bound);
	}
	return cli_close(name, c->args->csv, f);
}

/* ---- JSON -------------------------------------------------------------------------------------- */

static void json_row(struct json *j, const struct curve *c, const struct risk_row *r)
{
	json_open(j, NULL, '{');
	json_num(j, "headway_m", r->headway_m);
	json_num(j, "ttc_s", ttc_s(&c->req, r->headway_m));
	json_num(j, "risk", r->p);
	json_num(j, "lo", r->lo);
	json_num(j, "hi", r->hi);
	json_bool(j, "below_hi", r->bound);
	json_close(j, '}');
}

static void json_levels(struct json *j, const struct curve *c, const char *key, int as_ttc)
{
	json_open(j, key, '{');
	for (int i = 0; i < MC_RISKS; i++) {
		char level[16];
		double h = c->res.headway_m[i];

		snprintf(level, sizeof(level), "%g", mc_risk_level[i]);
		json_num(j, level, as_ttc ? ttc_s(&c->req, h) : h);
	}
	json_close(j, '}');
}

static void json_risk(struct json *j, const struct curve *c)
{
	const struct mc_risk *r = &c->res.risk[c->req.hist_future];

	json_open(j, "risk", '{');
	json_num(j, "headway_m", (double)c->req.mean[MODEL_HEADWAY]);
	json_num(j, "p", r->p);
	json_num(j, "lo", r->lo);
	json_num(j, "hi", r->hi);
	json_bool(j, "below_hi", (int)r->p_is_bound);
	json_uint(j, "undecided", r->undecided);
	json_num(j, "impact_mps", r->impact_mps);
	json_close(j, '}');
}

/* Stopping distances by the metre. */
static void json_stops(struct json *j, const struct curve *c)
{
	struct stop_counts s;

	stop_counts(c->hist->stop, &s);
	json_open(j, "stops", '{');
	json_num(j, "first_m", s.first_m);
	json_open(j, "count", '[');
	for (int i = 0; i < s.n; i++) {
		json_uint(j, NULL, s.count[i]);
	}
	json_close(j, ']');
	json_close(j, '}');
}

static void write_json(const struct curve *c)
{
	struct json j = json_start(stdout);

	json_head(&j, "curve");
	compute_json(&j, &c->args->compute, c->variant);
	json_uint(&j, "samples", c->res.n);
	json_bool(&j, "interrupted", (c->res.flags & MC_RES_CUT) != 0);
	json_uint(&j, "floored", c->res.floored);
	json_num(&j, "mean_m", c->res.stop_mean_m);
	json_num(&j, "sd_m", c->res.stop_sd_m);
	json_levels(&j, c, "headway_m", 0);
	json_levels(&j, c, "ttc_s", 1);
	json_risk(&j, c);
	json_open(&j, "curve", '[');
	for (int i = 0; i < c->rows; i++) {
		json_row(&j, c, &c->row[i]);
	}
	json_close(&j, ']');
	json_stops(&j, c);
	json_close(&j, '}');
}

/* ---- words ------------------------------------------------------------------------------------- */

static void text_row(const struct risk_row *r, double decades)
{
	int bar = r->bound ? 0 : (int)(BAR * (1 + log10(r->p) / decades) + 0.5);

	printf("%9.1f m ", r->headway_m);
	if (r->bound) {
		printf("  below %-8.3g %%  %28s", r->hi * 100, "");
	} else {
		printf("  %14.3g %%   (%8.3g .. %8.3g %%)    ", r->p * 100, r->lo * 100,
		       r->hi * 100);
	}
	printf("|%.*s\n", bar, "##############################");
}

static void print_levels(const struct curve *c)
{
	for (int i = 0; i < MC_RISKS; i++) {
		double h = c->res.headway_m[i], ttc = ttc_s(&c->req, h);

		printf("  %4.1f %% risk from ", mc_risk_level[i] * 100);
		if (isnan(h)) {
			puts("   (beyond what these samples can say)");
		} else if (isnan(ttc)) {
			printf("%6.1f m\n", h);
		} else {
			printf("%6.1f m   (%.2f s to collision)\n", h, ttc);
		}
	}
}

static void print_risk(const struct curve *c)
{
	const struct mc_risk *r = &c->res.risk[c->req.hist_future];
	double h = (double)c->req.mean[MODEL_HEADWAY];

	if (r->p_is_bound) {
		printf("Risk at %.1f m: below %.3g %%\n", h, r->hi * 100);
		return;
	}
	printf("Risk at %.1f m: %.3g %%, 95 %% interval %.3g .. %.3g %%", h, r->p * 100,
	       r->lo * 100, r->hi * 100);
	if (isfinite(r->impact_mps)) {
		printf(", mean impact speed %.1f m/s", r->impact_mps);
	}
	putchar('\n');
}

static void print_words(struct curve *c)
{
	const double decades = log10((double)c->res.n); /* from no hit to certainty */

	c->rows = risk_curve(c->hist->need, c->res.n, ROWS_TEXT, c->row);
	if (c->res.flags & MC_RES_CUT) {
		printf("Interrupted after %llu of %u samples.\n", (unsigned long long)c->res.n,
		       c->req.n);
	}
	printf("%llu samples, %s draws, seed %llu, %s\n\n", (unsigned long long)c->res.n,
	       c->args->compute.params.kind == MC_SOBOL ? "Sobol" : "Philox",
	       (unsigned long long)c->args->compute.params.seed, c->variant);
	printf("    headway               risk   (95 %% interval)                bar: log scale to "
	       "1/N\n");
	for (int i = 0; i < c->rows; i++) {
		text_row(&c->row[i], decades);
	}
	printf("\nStopping distance: mean %.2f m, standard deviation %.2f m\n", c->res.stop_mean_m,
	       c->res.stop_sd_m);
	print_levels(c);
	print_risk(c);
}

static int output(const char *name, struct curve *c)
{
	c->rows = risk_curve(c->hist->need, c->res.n, RISK_CURVE_ROWS, c->row);
	int code = c->args->csv ? write_csv(name, c) : 0;

	if (c->args->compute.json) {
		write_json(c);
	} else if (!c->args->csv || strcmp(c->args->csv, "-")) {
		print_words(c);
	}
	return c->res.flags & MC_RES_CUT ? CLI_FAILED : code;
}

int cmd_curve(int argc, char **argv)
{
	struct args a = {compute_defaults(), request_defaults(), NULL};
	struct curve c = {.args = &a};
	const struct mc_ops *ops;
	struct mc_backend *b;
	const char *name = argv[0];
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : request_build(name, &a.request, &c.req);
	a.compute.params.n_resident = c.req.n < RESIDENT ? c.req.n : RESIDENT;
	code = code ? code : compute_open(name, &a.compute, &ops, &b);
	if (code) {
		return code;
	}
	int error = timed_run(name, ops, b, &c.req, &c.res);

	c.variant = ops->describe(b);
	c.hist = ops->hist(b);
	if (error || !c.res.n) {
		code = cli_error(CLI_FAILED, name, "%s", error ? strerror(-error) : "interrupted");
	} else {
		code = output(name, &c);
	}
	ops->close(b);
	return code;
}
