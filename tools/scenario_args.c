/* SPDX-License-Identifier: MIT
 * The command line of aebmc scenario. See scenario_args.h.
 */
#include "scenario_args.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include "cli.h"
#include "rules.h"
#include "text.h"

#define CONFIG_DEFAULT "generic-objects.conf"

/* What the suites set unless the user does: the surface and the brakes of the regulations' tests. */
static const char *const regulation[] = {
	"brake.accel=-9.5",
	"vehicle.bound=friction",
	"road.mu=1.02",
};
#define SETTINGS (sizeof(regulation) / sizeof(regulation[0]))

enum preset { PRESET_REGULATION, PRESET_NONE };
static const char *const preset_name[] = {"regulation", "none"};

enum {
	KEY_VEHICLES = 0x100,
	KEY_SAMPLES,
	KEY_SHORT,
	KEY_SEED,
	KEY_PRESET,
	KEY_ONLY,
	KEY_RULE,
	KEY_COMPARE,
	KEY_JSON,
	KEY_CSV,
	KEY_HTML,
	KEY_LIST,
	KEY_LOG,
	KEY_LIVE,
	KEY_LOG_RUN,
	KEY_CAR,
	KEY_OUT
};

static const struct argp_option options[] = {
	{"vehicles", KEY_VEHICLES, "K", 0,
	 "repeat each row with K drawn cars, sensors and drivers (otherwise the nominal ones)", 1},
	{"samples", KEY_SAMPLES, "N", 0, "samples of one evaluation (mc.samples)", 1},
	{"short", KEY_SHORT, NULL, 0,
	 "the fewest rows that still mean something; their samples stay", 1},
	{"only", KEY_ONLY, "TEXT", 0, "those rows alone whose name has TEXT in it", 1},
	{"preset", KEY_PRESET, "NAME", 0,
	 "regulation (the default): brake.accel=-9.5, vehicle.bound=friction, road.mu=1.02; none: "
	 "the configuration as it is",
	 1},
	{"threads", 't', "N", 0, "runs at a time (all processors); no output depends on it", 1},
	{"seed", KEY_SEED, "N", 0, "of the drawn cars and of all noise (1)", 1},
	{"rule", KEY_RULE, "NAME", 0,
	 "brake by another rule and warn as ever: ttc, autoware, ad-rss or paper", 2},
	{"compare", KEY_COMPARE, NULL, 0, "the same runs decided by each rule, and by ours", 2},
	{"json", KEY_JSON, NULL, 0, "one JSON object on standard output", 3},
	{"csv", KEY_CSV, "FILE", 0, "one line for each run, - for standard output", 3},
	{"html", KEY_HTML, "FILE", 0, "a page with the table and a picture", 3},
	{"list", KEY_LIST, NULL, 0, "name SUITE's rows", 3},
	{"log", KEY_LOG, "LOG", 0,
	 "false-activation: a recorded drive of the configured car as one more row", 4},
	{"live", KEY_LIVE, "IFACE", 0, "in real time against a daemon on this interface", 4},
	{"log-run", KEY_LOG_RUN, "ROW", 0,
	 "this row alone: write what the car sends as a candump log, for aebmc replay", 4},
	{"car", KEY_CAR, "K", 0, "with --log-run: the K-th car of --vehicles (0, the nominal one)",
	 4},
	{"out", KEY_OUT, "FILE", 0, "with --log-run: where to; - is standard output, the default",
	 4},
	{0},
};
static const struct argp_child children[] = {{&setup_argp, 0, NULL, 0}, {0}};

static error_t parse_suite(struct scenario_args *a, const char *arg, const struct argp_state *st)
{
	size_t n = 0;

	if (a->suite) {
		return cli_bad(st, "'%s': one SUITE at a time", arg);
	}
	while (scenario_suites[n].name && strcmp(scenario_suites[n].name, arg) != 0) {
		n++;
	}
	a->suite = &scenario_suites[n];
	if (a->suite->name) {
		return 0;
	}
	return cli_bad(st, "no suite '%s'; nearest is '%s'", arg,
		       text_nearest(arg, &scenario_suites[0].name, n, sizeof(scenario_suites[0])));
}

static error_t parse_rule(struct scenario_args *a, const char *arg, const struct argp_state *st)
{
	size_t n = 0;

	while (rule_table[n].name) {
		n++;
	}
	a->rule = rule_find(arg);
	return a->rule ? 0
		       : cli_bad(st, "--rule: no rule '%s'; nearest is '%s'", arg,
				 text_nearest(arg, &rule_table[0].name, n, sizeof(rule_table[0])));
}

/* As if --set bus.interfaces had been given last. */
static error_t apply_live(struct scenario_args *a, const struct argp_state *st)
{
	const int n = snprintf(a->interfaces, sizeof(a->interfaces), "bus.interfaces=%s", a->live);

	if (a->setup.n_set == SETUP_SETS_MAX || n >= (int)sizeof(a->interfaces)) {
		return cli_bad(st, "--live: too many --set, or no name of an interface");
	}
	a->setup.set[a->setup.n_set++] = a->interfaces;
	return 0;
}

/* The user's settings come after the suites'. */
static error_t apply_preset(struct scenario_args *a, const struct argp_state *st)
{
	struct setup *s = &a->setup;

	if (a->preset == PRESET_NONE) {
		return 0;
	}
	if (s->n_set + (int)SETTINGS > SETUP_SETS_MAX) {
		return cli_bad(st, "--set: too many of them; use a file");
	}
	memmove(&s->set[SETTINGS], s->set, (size_t)s->n_set * sizeof(s->set[0]));
	memcpy(s->set, regulation, sizeof(regulation));
	s->n_set += (int)SETTINGS;
	return 0;
}

static int is_stdout(const char *path)
{
	return path && !strcmp(path, "-");
}

/* It writes one run and judges none. */
static error_t check_log_run(struct scenario_args *a, const struct argp_state *st)
{
	if (!a->log_run && (a->out || a->car >= 0)) {
		return cli_bad(st, "--out and --car go with --log-run");
	}
	if (a->log_run && (a->cars || a->rule || a->compare || a->json || a->csv || a->html ||
			   a->list || a->log || a->live)) {
		return cli_bad(st, "--log-run goes without --vehicles, --rule, --compare, --json, "
				   "--csv, --html, --list, --log and --live");
	}
	a->out = a->out ? a->out : "-";
	a->car = a->car < 0 ? 0 : a->car;
	return 0;
}

static error_t check(struct scenario_args *a, const struct argp_state *st)
{
	if (!a->suite) {
		return cli_bad(
			st,
			"which SUITE? fmvss127, ncap-ccr, false-activation, degraded or traffic");
	}
	if (is_stdout(a->csv) + is_stdout(a->html) + a->json > 1) {
		return cli_bad(st,
			       "only one of --json, --csv - and --html - can have standard output");
	}
	if (a->compare && (a->rule || a->csv || a->html)) {
		return cli_bad(st, "--compare goes without --rule, --csv and --html");
	}
	if (a->log && (a->cars || strcmp(a->suite->name, "false-activation") != 0)) {
		return cli_bad(st, "--log goes with false-activation, and without --vehicles");
	}
	if (a->live && (a->log || a->rule || a->compare)) {
		return cli_bad(st, "--live goes without --log, --rule and --compare");
	}
	if (a->list && (a->csv || a->html || a->compare)) {
		return cli_bad(st, "--list goes without --csv, --html and --compare");
	}
	if (check_log_run(a, st)) {
		return EINVAL;
	}
	a->words = !a->json && !is_stdout(a->csv) && !is_stdout(a->html);
	return a->live && apply_live(a, st) ? EINVAL : apply_preset(a, st);
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct scenario_args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->setup;
		return 0;
	case KEY_VEHICLES:
		return cli_count(st, "--vehicles", arg, 1, 100000, &a->cars);
	case KEY_SAMPLES:
		return cli_count(st, "--samples", arg, 256, 1 << 24, &a->samples);
	case KEY_SHORT:
		a->is_short = 1;
		return 0;
	case KEY_ONLY:
		a->only = arg;
		return 0;
	case KEY_PRESET:
		return cli_choice(st, "--preset", arg, preset_name, 2, &a->preset);
	case 't':
		return cli_count(st, "--threads", arg, 1, 64, &a->threads);
	case KEY_SEED:
		return cli_count(st, "--seed", arg, 0, (1 << 24) - 1, &a->seed);
	case KEY_RULE:
		return parse_rule(a, arg, st);
	case KEY_COMPARE:
		a->compare = 1;
		return 0;
	case KEY_JSON:
		a->json = 1;
		return 0;
	case KEY_CSV:
		a->csv = arg;
		return 0;
	case KEY_HTML:
		a->html = arg;
		return 0;
	case KEY_LIST:
		a->list = 1;
		return 0;
	case KEY_LOG:
		a->log = arg;
		return 0;
	case KEY_LIVE:
		a->live = arg;
		return 0;
	case KEY_LOG_RUN:
		a->log_run = arg;
		return 0;
	case KEY_CAR:
		return cli_count(st, "--car", arg, 0, 100000, &a->car);
	case KEY_OUT:
		a->out = arg;
		return 0;
	case ARGP_KEY_ARG:
		return parse_suite(a, arg, st);
	case ARGP_KEY_END:
		return check(a, st);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {
	options,
	parse,
	"SUITE",
	"Closed loops of the daemon's pipeline with cars, sensors and drivers, in virtual time "
	"(without --config: the bundled " CONFIG_DEFAULT
	"). Suites: fmvss127, ncap-ccr, false-activation, degraded, traffic.",
	children,
	NULL,
	NULL};

int scenario_args(int argc, char **argv, struct scenario_args *a)
{
	*a = (struct scenario_args){.seed = 1, .car = -1};
	setup_bundled(&a->setup, CONFIG_DEFAULT);
	return cli_parse(&argp, argc, argv, a);
}
