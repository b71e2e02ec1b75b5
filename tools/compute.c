/* SPDX-License-Identifier: MIT
 * Which backend a subcommand computes on and how it is opened.
 */
#include "compute.h"
#include <errno.h>
#include <string.h>
#include "cli.h"
#include "lanes.h"

struct backend_row {
	const char *name;
	const struct mc_ops *ops;
};

static const struct backend_row backend_table[] = {
	{"cpu", &mc_cpu_ops},
	{"cuda", &mc_cuda_ops},
};
#define BACKENDS (sizeof(backend_table) / sizeof(backend_table[0]))

static const char *const draws_name[] = {[MC_SOBOL] = "sobol", [MC_PHILOX] = "philox"};

enum { KEY_BACKEND = 0x200, KEY_DRAWS, KEY_SEED, KEY_JSON, KEY_VARIANT };

static const struct argp_option options[] = {
	{"backend", KEY_BACKEND, "NAME", 0, "cpu (default) or cuda", 10},
	{"threads", 't', "N", 0,
	 "threads, 1..64 (default: all processors); no figure depends on it", 10},
	{"variant", KEY_VARIANT, "NAME", 0,
	 "instruction set of the CPU backend (default: the best)", 10},
	{"draws", KEY_DRAWS, "KIND", 0, "sobol or philox", 10},
	{"seed", KEY_SEED, "N", 0, "seed of the draws (default 1)", 10},
	{"json", KEY_JSON, NULL, 0, "one JSON object on standard output", 10},
	{0},
};

static error_t parse_draws(const struct argp_state *st, const char *arg, struct mc_params *p)
{
	size_t i = 0;
	error_t ret = cli_choice(st, "--draws", arg, draws_name, 2, &i);

	p->kind = (enum mc_draws_kind)i;
	return ret;
}

static error_t parse_threads(const struct argp_state *st, const char *arg, struct mc_params *p)
{
	int64_t n = p->threads;
	error_t ret = cli_count(st, "--threads", arg, 1, 64, &n);

	p->threads = (uint32_t)n;
	return ret;
}

static error_t parse_seed(const struct argp_state *st, const char *arg, struct mc_params *p)
{
	int64_t seed = 0;
	error_t ret = cli_count(st, "--seed", arg, 0, INT64_MAX, &seed);

	p->seed = (uint64_t)seed;
	return ret;
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct compute_args *a = st->input;

	switch (key) {
	case KEY_BACKEND:
		a->backend = arg;
		return 0;
	case 't':
		return parse_threads(st, arg, &a->params);
	case KEY_VARIANT:
		a->params.variant = arg;
		return 0;
	case KEY_DRAWS:
		return parse_draws(st, arg, &a->params);
	case KEY_SEED:
		return parse_seed(st, arg, &a->params);
	case KEY_JSON:
		a->json = 1;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

const struct argp compute_argp = {options, parse, NULL, NULL, NULL, NULL, NULL};

struct compute_args compute_defaults(void)
{
	uint32_t cpus = cli_cpus();

	return (struct compute_args){
		.backend = "cpu",
		.params = {.kind = MC_SOBOL, .seed = 1, .threads = cpus < 64 ? cpus : 64},
	};
}

static const struct backend_row *find(const char *name)
{
	for (size_t i = 0; i < BACKENDS; i++) {
		if (!strcmp(backend_table[i].name, name)) {
			return &backend_table[i];
		}
	}
	return NULL;
}

/* A variant that this binary has but this processor lacks is no mistake of the user's. */
static int check_variant(const char *name, const char *variant)
{
	if (!variant || lanes_pick(variant)) {
		return 0;
	}
	for (unsigned int i = 0; lanes_name(i); i++) {
		if (!strcmp(variant, lanes_name(i))) {
			return cli_error(CLI_SKIPPED, name, "this processor lacks %s", variant);
		}
	}
	return cli_error(CLI_USAGE, name, "--variant: '%s' is not built; the best is %s", variant,
			 lanes_pick(NULL)->name);
}

static int refused(const char *name, const char *backend, int error)
{
	static const struct {
		int error, code;
		const char *words;
	} row[] = {
		{-ENOTSUP, CLI_SKIPPED, "is not built into this binary"},
		{-ENOSYS, CLI_SKIPPED, "finds no driver, or one too old"},
		{-ENODEV, CLI_SKIPPED, "finds no device"},
		{-ENOEXEC, CLI_SKIPPED, "has no machine code for this device"},
	};

	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		if (row[i].error == error) {
			return cli_error(row[i].code, name, "backend %s %s", backend, row[i].words);
		}
	}
	return cli_error(CLI_FAILED, name, "cannot open backend %s: %s", backend, strerror(-error));
}

int compute_open(const char *name, const struct compute_args *a, const struct mc_ops **ops,
		 struct mc_backend **ret)
{
	const struct backend_row *row = find(a->backend);

	if (!row) {
		return cli_error(CLI_USAGE, name, "--backend: '%s' is not known; cpu or cuda",
				 a->backend);
	}
	int code = check_variant(name, a->params.variant);

	if (code) {
		return code;
	}
	int error = row->ops->open(&a->params, ret);

	*ops = row->ops;
	return error ? refused(name, row->name, error) : 0;
}

void compute_json(struct json *j, const struct compute_args *a, const char *variant)
{
	char cpu[128];

	cli_cpu_name(cpu, sizeof(cpu));
	json_str(j, "cpu", cpu);
	json_str(j, "backend", a->backend);
	json_str(j, "variant", variant);
	json_uint(j, "threads", a->params.threads);
	json_str(j, "draws", draws_name[a->params.kind]);
	json_uint(j, "seed", a->params.seed);
}
