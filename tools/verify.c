/* SPDX-License-Identifier: MIT
 * aebmc verify: does the fast rollout compute what the reference computes, do all variants, backends and numbers of
 * threads give the same bits, and how large is the error that the resident set of draws has all day?
 */
#include <errno.h>
#include <math.h>
#include <string.h>
#include "checks.h"
#include "cli.h"
#include "cmd.h"
#include "compute.h"
#include "lanes.h"
#include "progress.h"

#define SAMPLES  100000
#define RESIDENT 16384 /* what the daemon keeps on a CPU */

struct args {
	struct compute_args compute;
	int64_t samples, resident;
};

static const char *const kind_key[CHECKS_KINDS] = {"paper", "moving"};
static const char *const kind_words[CHECKS_KINDS] = {
	[VERIFY_PAPER] = "the paper's preset",
	[VERIFY_MOVING] = "random scenes with a moving lead",
};

/* ---- arguments --------------------------------------------------------------------------------- */

enum { KEY_RESIDENT = 0x100 };

static const struct argp_option options[] = {
	{"samples", 'n', "N", 0, "scenes of each kind (100000)", 1},
	{"resident", KEY_RESIDENT, "N", 0, "size of the resident set looked at (16384)", 1},
	{0},
};
static const struct argp_child children[] = {{&compute_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->compute;
		return 0;
	case 'n':
		return cli_count(st, "--samples", arg, 1, 1u << 30, &a->samples);
	case KEY_RESIDENT:
		return cli_count(st, "--resident", arg, 1, 1u << 22, &a->resident);
	case ARGP_KEY_ARG:
		return cli_bad(st, "'%s': verify takes options alone", arg);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 NULL,
				 "Fast rollout against the 1 ms reference on hard scenes; the same "
				 "bits from every variant and number of threads.",
				 children,
				 NULL,
				 NULL};

/* ---- who takes part ---------------------------------------------------------------------------- */

/* The backend asked for first, then every variant of the CPU that this processor can run. */
static void contenders(struct checks *c, const struct mc_ops *ops, const char *variant)
{
	if (ops != &mc_cpu_ops) {
		c->contender[c->n++] = (struct contender){ops->name, ops, NULL};
	}
	variant = lanes_pick(variant)->name;
	c->contender[c->n++] = (struct contender){variant, &mc_cpu_ops, variant};
	for (unsigned int i = 0; lanes_name(i) && c->n < CHECKS_CONTENDERS_MAX; i++) {
		const char *name = lanes_name(i);

		if (strcmp(name, variant) && lanes_pick(name)) {
			c->contender[c->n++] = (struct contender){name, &mc_cpu_ops, name};
		}
	}
}

static void on_progress(void *arg, double share)
{
	progress_update(arg, share, "");
}

static int measure(struct checks *c)
{
	struct progress line = progress_start("verify");

	c->progress = on_progress;
	c->arg = &line;
	cli_catch_interrupt();
	int error = checks_batches(c);

	error = error ? error : checks_resident(c);
	error = error ? error : checks_rollouts(c);
	progress_clear(&line);
	return error;
}

/* ---- output ------------------------------------------------------------------------------------ */

/* Equal bits after half of the comparisons say nothing; different ones do. */
static int is_known(const struct checks *c)
{
	return !cli_interrupted() || c->differing;
}

static void json_tally(struct json *j, const char *key, const struct verify_tally *t)
{
	json_open(j, key, '{');
	json_uint(j, "scenes", t->scenes);
	json_uint(j, "contacts", t->contacts);
	json_uint(j, "grazing", t->grazing);
	json_uint(j, "verdict_mismatches", t->verdict_mismatches);
	json_uint(j, "in_band", t->in_band);
	json_uint(j, "at_horizon", t->at_horizon);
	json_uint(j, "not_finite", t->not_finite);
	json_num(j, "max_stop_dev_m", t->stop_dev_m);
	json_num(j, "max_need_dev_m", t->need_dev_m);
	json_num(j, "max_impact_dev_mps", t->impact_dev_mps);
	json_close(j, '}');
}

static void json_variants(struct json *j, const struct checks *c)
{
	json_open(j, "variants", '[');
	for (int i = 0; i < c->n; i++) {
		json_str(j, NULL, c->contender[i].name);
	}
	json_close(j, ']');
	json_open(j, "variants_skipped", '[');
	for (unsigned int i = 0; lanes_name(i); i++) {
		if (!lanes_pick(lanes_name(i))) {
			json_str(j, NULL, lanes_name(i));
		}
	}
	json_close(j, ']');
}

static void json_resident(struct json *j, const struct checks *c)
{
	json_open(j, "resident_set", '{');
	json_uint(j, "samples", c->params.n_resident);
	for (int i = 0; i < MC_RISKS; i++) {
		char level[16];

		snprintf(level, sizeof(level), "%g", mc_risk_level[i]);
		json_open(j, level, '{');
		json_num(j, "p", c->set_p[i]);
		json_num(j, "error", c->set_p[i] - mc_risk_level[i]);
		json_num(j, "lo", c->set_lo[i]);
		json_num(j, "hi", c->set_hi[i]);
		json_close(j, '}');
	}
	json_close(j, '}');
}

static void write_json(const struct args *a, const struct checks *c)
{
	const struct verify_tally *paper = &c->tally[VERIFY_PAPER],
				  *moving = &c->tally[VERIFY_MOVING];
	struct json j = json_start(stdout);

	json_head(&j, "verify");
	compute_json(&j, &a->compute, c->contender[0].name);
	json_num(&j, "max_stop_dev_m", fmax(paper->stop_dev_m, moving->stop_dev_m));
	json_num(&j, "max_impact_dev_mps", fmax(paper->impact_dev_mps, moving->impact_dev_mps));
	json_uint(&j, "verdict_mismatches", paper->verdict_mismatches + moving->verdict_mismatches);
	if (is_known(c)) {
		json_bool(&j, "bits_equal", c->differing == 0);
	}
	json_open(&j, "threads_used", '[');
	for (int i = 0; i < CHECKS_THREADS; i++) {
		json_uint(&j, NULL, checks_threads[i]);
	}
	json_close(&j, ']');
	json_variants(&j, c);
	for (int k = 0; k < CHECKS_KINDS; k++) {
		json_tally(&j, kind_key[k], &c->tally[k]);
	}
	if (!cli_interrupted()) {
		json_resident(&j, c);
	}
	json_bool(&j, "interrupted", cli_interrupted());
	json_bool(&j, "passed", !cli_interrupted() && checks_good(c));
	json_close(&j, '}');
}

static void print_tally(const char *what, const struct verify_tally *t)
{
	printf("%s: %llu scenes, %llu in contact, %llu within 0.11 m of it\n", what,
	       (unsigned long long)t->scenes, (unsigned long long)t->contacts,
	       (unsigned long long)t->grazing);
	printf("  stopping distance within %.3f mm (limit %g), closest approach %.3f mm, impact "
	       "speed %.2g m/s (limit %g)\n",
	       t->stop_dev_m * 1e3, CHECKS_STOP_MAX_M * 1e3, t->need_dev_m * 1e3, t->impact_dev_mps,
	       CHECKS_IMPACT_MAX_MPS);
	printf("  verdicts that differ: %llu (%llu within 0.5 mm of contact and %llu at the "
	       "horizon not counted); not finite: %llu\n",
	       (unsigned long long)t->verdict_mismatches, (unsigned long long)t->in_band,
	       (unsigned long long)t->at_horizon, (unsigned long long)t->not_finite);
}

static void print_bits(const struct checks *c)
{
	printf("Same bits from");
	for (int i = 0; i < c->n; i++) {
		printf(" %s", c->contender[i].name);
	}
	printf(" with 1, 2 and 4 threads: %s", c->differing ? "NO" : "yes");
	if (c->differing) {
		printf(", %llu differ", (unsigned long long)c->differing);
	}
	putchar('\n');
	for (unsigned int i = 0; lanes_name(i); i++) {
		if (!lanes_pick(lanes_name(i))) {
			printf("Skipped, this processor lacks it: %s\n", lanes_name(i));
		}
	}
}

static void print_resident(const struct checks *c)
{
	printf("The resident set (%u %s draws, seed %llu) has an error of its own, the same all "
	       "day:\n",
	       c->params.n_resident, c->params.kind == MC_SOBOL ? "Sobol" : "Philox",
	       (unsigned long long)c->params.seed);
	for (int i = 0; i < MC_RISKS; i++) {
		printf("  where the risk is %4.1f %% it says %s%.4f %%; its 95 %% interval is %.4f "
		       ".. %.4f %%\n",
		       mc_risk_level[i] * 100, c->set_p[i] > 0 ? "" : "below ",
		       (c->set_p[i] > 0 ? c->set_p[i] : c->set_hi[i]) * 100, c->set_lo[i] * 100,
		       c->set_hi[i] * 100);
	}
}

static const char *verdict(const struct checks *c)
{
	if (cli_interrupted()) {
		return checks_bad(c) ? "interrupted; so far: FAILED" : "interrupted, not judged";
	}
	return checks_good(c) ? "passed" : "FAILED";
}

static void print_words(const struct checks *c)
{
	for (int k = 0; k < CHECKS_KINDS; k++) {
		print_tally(kind_words[k], &c->tally[k]);
	}
	if (is_known(c)) {
		print_bits(c);
	}
	if (!cli_interrupted()) {
		print_resident(c);
	}
	puts(verdict(c));
}

int cmd_verify(int argc, char **argv)
{
	struct args a = {compute_defaults(), SAMPLES, RESIDENT};
	const char *name = argv[0];
	const struct mc_ops *ops;
	struct mc_backend *b;
	int code = cli_parse(&argp, argc, argv, &a);

	a.compute.params.n_resident = (uint32_t)a.resident;
	code = code ? code : compute_open(name, &a.compute, &ops, &b);
	if (code) {
		return code;
	}
	ops->close(b);
	struct checks c = {.params = a.compute.params, .samples = (uint32_t)a.samples};

	contenders(&c, ops, a.compute.params.variant);
	int error = measure(&c);

	if (error && error != -EINTR) {
		return cli_error(CLI_FAILED, name, "%s", strerror(-error));
	}
	if (a.compute.json) {
		write_json(&a, &c);
	} else {
		print_words(&c);
	}
	return cli_interrupted() || !checks_good(&c) ? CLI_FAILED : CLI_GOOD;
}
