/* SPDX-License-Identifier: MIT
 * Command line of aebmcd, by argp. --help lists every option of config.def.
 */
#include <argp.h>
#include <errno.h>
#include <stdio.h>

#include "args.h"
#include "build_info.h"

enum {
	KEY_CHECK = 0x100,
	KEY_CONFIG,
	KEY_LOG,
	KEY_OUT,
	KEY_PRINT_CONFIG,
	KEY_PRINT_OPTIONS,
	KEY_SET
};

static const struct argp_option options[] = {
	{"config", KEY_CONFIG, "FILE", 0,
	 "configuration of the car: options, CAN database, mapping", 1},
	{"set", KEY_SET, "NAME=VALUE", 0, "override one option of the file; may be given again", 1},
	{"log", KEY_LOG, "IN", 0,
	 "run on a candump log, - for standard input, instead of live on the buses", 1},
	{"out", KEY_OUT, "OUT", 0, "write our frames as a candump log, - for standard output", 1},
	{"check-config", KEY_CHECK, "FILE", 0, "is this configuration valid? Needs no hardware", 2},
	{"print-config", KEY_PRINT_CONFIG, NULL, 0,
	 "print the whole configuration, every option explained", 2},
	{"print-options", KEY_PRINT_OPTIONS, NULL, 0,
	 "print what a configuration may say, as a manual's section", 2},
	{NULL, 0, NULL, OPTION_DOC, "Names for --set, in sections of the configuration file:", 3},
#define CONFIG(section, key, kind, def, min, max, unit, doc) \
	{#section "." #key, 0, NULL, OPTION_DOC | OPTION_NO_USAGE, doc, 3},
#include "config.def"
#undef CONFIG
	{0},
};

static error_t bad_usage(const struct argp_state *st, const char *what)
{
	fprintf(stderr, "%s: %s\n", st->name, what);
	return EINVAL;
}

static error_t set_action(struct args *a, const struct argp_state *st, enum args_action action)
{
	if (a->action) {
		return bad_usage(
			st,
			"only one of --check-config, --print-config, --print-options at a time");
	}
	a->action = action;
	return 0;
}

static error_t add_set(struct args *a, const struct argp_state *st, const char *assignment)
{
	if (a->n_set == ARGS_SETS_MAX) {
		return bad_usage(st, "more than 64 times --set; write a file");
	}
	a->set[a->n_set++] = assignment;
	return 0;
}

static error_t check_args(const struct args *a, const struct argp_state *st)
{
	if (a->action) {
		return a->log || a->out ? bad_usage(st, "--log and --out are for running") : 0;
	}
	if (!a->config) {
		return bad_usage(st,
				 "--config FILE is needed: it says which signals the car sends");
	}
	if (a->out && !a->log) {
		return bad_usage(st, "--out is for running on a log; live, frames go to the bus");
	}
	return 0;
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->err_stream = NULL; /* else argp adds a line of advice to every error */
		return 0;
	case KEY_CONFIG:
		a->config = arg;
		return 0;
	case KEY_SET:
		return add_set(a, st, arg);
	case KEY_LOG:
		a->log = arg;
		return 0;
	case KEY_OUT:
		a->out = arg;
		return 0;
	case KEY_CHECK:
		a->config = arg;
		return set_action(a, st, ARGS_CHECK_CONFIG);
	case KEY_PRINT_CONFIG:
		return set_action(a, st, ARGS_PRINT_CONFIG);
	case KEY_PRINT_OPTIONS:
		return set_action(a, st, ARGS_PRINT_OPTIONS);
	case ARGP_KEY_ARG:
		return bad_usage(st, "takes no arguments, only options; see --help");
	case ARGP_KEY_END:
		return check_args(a, st);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {
	options,
	parse,
	NULL,
	"Estimates the risk of a collision and asks for braking."
	"\vExit status: 0 good, 1 failed, 2 wrong usage, 78 bad configuration.",
	NULL,
	NULL,
	NULL};

static void print_version(FILE *out, struct argp_state *st)
{
	(void)st;
	build_info_print("aebmcd", out);
}
void (*argp_program_version_hook)(FILE *out, struct argp_state *st) = print_version;

int args_parse(int argc, char **argv, struct args *a)
{
	*a = (struct args){0};
	return argp_parse(&argp, argc, argv, 0, NULL, a) ? -EINVAL : 0;
}
