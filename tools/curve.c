/* SPDX-License-Identifier: MIT
 * aebmc curve: the risk against the headway, and the headways at 5, 1 and 0.1 % risk with their time to collision.
 * One histogram of `need` (mc_ops.h) is the whole curve.
 */
#include <math.h>
#include <string.h>
#include "compute.h"
#include "cli.h"
#include "cmd.h"
#include "request.h"
#include "stats.h"
#include "timed_run.h"

#define ROWS_TEXT 30                                        /* most rows of the table */
#define ROWS_DATA 400                                       /* and of CSV and JSON */
#define BAR       30                                        /* characters of a full bar */
#define ZERO      ((int)(MC_HIST_NEED_OFF / MC_HIST_BIN_M)) /* bin of headway 0 */
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
	const uint64_t *need;
};

struct row {
	double headway_m, ttc_s, p, lo, hi;
	int bound; /* no hit: p is hi */
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

static struct row row_at(const struct curve *c, int bin)
{
	struct row r = {.headway_m = bin * MC_HIST_BIN_M - MC_HIST_NEED_OFF};
	uint64_t hits = 0;

	for (int i = bin; i < MC_HIST_BINS; i++) {
		hits += c->need[i];
	}
	stats_wilson(hits, c->res.n, &r.lo, &r.hi);
	r.bound = hits == 0;
	r.p = (double)hits / (double)c->res.n;
	r.ttc_s = ttc_s(&c->req, r.headway_m);
	return r;
}

/* Bins between which something happens: from a risk of 99.9 % (or headway 0) to none. */
static void span(const struct curve *c, int *first, int *last)
{
	uint64_t below = 0;
	int i = 0;

	while (i < MC_HIST_BINS - 1 && (below + c->need[i]) * 1000 < c->res.n) {
		below += c->need[i++];
	}
	*first = i > ZERO ? i : ZERO;
	for (i = MC_HIST_BINS - 1; i > *first && !c->need[i - 1];) {
		i--;
	}
	*last = i;
}

/* The smallest round step, in bins, with at most @rows rows. */
static int step_for(int bins, int rows)
{
	static const int steps[] = {1, 2, 4, 8, 16, 40, 80, 160, 400, 800};
	size_t i = 0;

	while (i + 1 < sizeof(steps) / sizeof(steps[0]) && bins / steps[i] + 2 > rows) {
		i++;
	}
	return steps[i];
}

static void each_row(const struct curve *c, int rows, void (*emit)(void *arg, const struct row *r),
		     void *arg)
{
	int first, last;

	span(c, &first, &last);
	int step = step_for(last - first, rows);

	first = ZERO + (first - ZERO) / step * step; /* round headways */
	for (int bin = first; bin < last + step && bin < MC_HIST_BINS; bin += step) {
		struct row r = row_at(c, bin);

		emit(arg, &r);
	}
}

/* ---- CSV --------------------------------------------------------------------------------------- */

static void csv_row(void *arg, const struct row *r)
{
	fprintf(arg, "%.3f,%.9g,%.9g,%.9g,%d\n", r->headway_m, r->p, r->lo, r->hi, r->bound);
}

static int write_csv(const char *name, const struct curve *c)
{
	FILE *f = cli_create(name, c->args->csv);

	if (!f) {
		return CLI_FAILED;
	}
	fputs("headway_m,risk,risk_lo,risk_hi,below_hi\n", f);
	each_row(c, ROWS_DATA, csv_row, f);
	return cli_close(name, c->args->csv, f);
}

/* ---- JSON -------------------------------------------------------------------------------------- */

static void json_row(void *arg, const struct row *r)
{
	struct json *j = arg;

	json_open(j, NULL, '{');
	json_num(j, "headway_m", r->headway_m);
	json_num(j, "ttc_s", r->ttc_s);
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
	each_row(c, ROWS_DATA, json_row, &j);
	json_close(&j, ']');
	json_close(&j, '}');
}

/* ---- words ------------------------------------------------------------------------------------- */

static void text_row(void *arg, const struct row *r)
{
	double decades = *(const double *)arg; /* from no hit to certainty */
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

static void print_words(const struct curve *c)
{
	double decades = log10((double)c->res.n);

	if (c->res.flags & MC_RES_CUT) {
		printf("Interrupted after %llu of %u samples.\n", (unsigned long long)c->res.n,
		       c->req.n);
	}
	printf("%llu samples, %s draws, seed %llu, %s\n\n", (unsigned long long)c->res.n,
	       c->args->compute.params.kind == MC_SOBOL ? "Sobol" : "Philox",
	       (unsigned long long)c->args->compute.params.seed, c->variant);
	printf("    headway               risk   (95 %% interval)                bar: log scale to "
	       "1/N\n");
	each_row(c, ROWS_TEXT, text_row, &decades);
	printf("\nStopping distance: mean %.2f m, standard deviation %.2f m\n", c->res.stop_mean_m,
	       c->res.stop_sd_m);
	print_levels(c);
	print_risk(c);
}

static int output(const char *name, const struct curve *c)
{
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
	c.need = ops->hist(b)->need;
	if (error || !c.res.n) {
		code = cli_error(CLI_FAILED, name, "%s", error ? strerror(-error) : "interrupted");
	} else {
		code = output(name, &c);
	}
	ops->close(b);
	return code;
}
