/* SPDX-License-Identifier: MIT
 * aebmc converge: Table I of the paper (Sec. VI) beside the same figures from this program, with standard errors, so
 * that one sees which differences are chance. Independent draws (Philox) by default, as in the paper.
 */
#include <string.h>
#include "compute.h"
#include "cli.h"
#include "cmd.h"
#include "table1.h"

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

static void write_json(const struct compute_args *a, const char *variant,
		       const struct table1_row *rows, size_t n)
{
	struct json j = json_start(stdout);

	json_head(&j, "converge");
	compute_json(&j, a, variant);
	json_open(&j, "rows", '[');
	for (const struct table1_row *r = rows; r < rows + n; r++) {
		json_open(&j, NULL, '{');
		json_uint(&j, "samples", r->n);
		json_num(&j, "paper_mean_m", r->paper_mean_m);
		json_num(&j, "paper_sd_m", r->paper_sd_m);
		json_num(&j, "mean_m", r->mean_m);
		json_num(&j, "sd_m", r->sd_m);
		json_num(&j, "mean_se_m", r->mean_se_m);
		json_num(&j, "sd_se_m", r->sd_se_m);
		json_num(&j, "mean_z", r->mean_z);
		json_num(&j, "sd_z", r->sd_z);
		json_close(&j, '}');
	}
	json_close(&j, ']');
	json_bool(&j, "interrupted", cli_interrupted());
	json_close(&j, '}');
}

static void print_words(const struct compute_args *a, const char *variant,
			const struct table1_row *rows, size_t n)
{
	printf("Table I of the paper beside ours; %s draws, seed %llu, %s. se: standard error;\n"
	       "z: the difference in units of its standard error (both sides have one).\n\n",
	       a->params.kind == MC_SOBOL ? "Sobol" : "Philox", (unsigned long long)a->params.seed,
	       variant);
	table1_words(stdout, rows, n);
}

int cmd_converge(int argc, char **argv)
{
	struct compute_args a = compute_defaults();
	const struct mc_ops *ops;
	struct mc_backend *b;
	struct table1_row rows[TABLE1_ROWS];
	const char *name = argv[0];

	a.params.kind = MC_PHILOX;
	a.params.n_resident = 65536;
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : compute_open(name, &a, &ops, &b);
	if (code) {
		return code;
	}
	size_t done;
	int error = table1_compute(ops, b, cli_catch_interrupt(), rows, &done);

	if (error) {
		code = cli_error(CLI_FAILED, name, "%s", strerror(-error));
	} else if (a.json) {
		write_json(&a, ops->describe(b), rows, done);
	} else {
		print_words(&a, ops->describe(b), rows, done);
	}
	if (!error && done < TABLE1_ROWS) {
		code = cli_error(CLI_FAILED, name, "interrupted");
	}
	ops->close(b);
	return code;
}
