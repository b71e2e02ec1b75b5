/* SPDX-License-Identifier: MIT
 * aebmc scenario: a suite of closed loops, the daemon's pipeline against cars, sensors and drivers, in virtual time.
 */
#include "scenario.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "cli.h"
#include "cmd.h"
#include "engine.h"
#include "rules.h"
#include "scenario_compare.h"
#include "scenario_live.h"
#include "scenario_report.h"
#include "setup.h"
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

struct args {
	struct setup setup;
	const struct scenario_suite *suite;
	const char *csv, *html, *only, *log_run, *out, *log, *live;
	const struct rule *rule;
	int64_t cars, samples, threads, seed;
	size_t preset;
	char interfaces[64];
	int json, is_short, compare, list;
};

/* Everything that a suite needs, opened. */
struct work {
	const char *name;
	const struct args *args;
	struct config cfg;
	struct mapping *map;
	struct scenario *row;           /* [rows] */
	struct config *told;            /* [rows] */
	double *latest_s;               /* [rows] */
	struct scenario_result *result; /* [rows][cars] */
	struct scenario_plan plan;
};

/* ---- arguments --------------------------------------------------------------------------------- */

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
	KEY_OUT
};

static const struct argp_option options[] = {
	{"vehicles", KEY_VEHICLES, "K", 0,
	 "repeat each row with K drawn cars, sensors and drivers (otherwise the nominal ones)", 1},
	{"samples", KEY_SAMPLES, "N", 0, "samples of one evaluation (mc.samples)", 1},
	{"short", KEY_SHORT, NULL, 0, "the fewest rows that still mean something", 1},
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
	{"out", KEY_OUT, "FILE", 0, "where to; - is standard output, the default", 4},
	{0},
};
static const struct argp_child children[] = {{&setup_argp, 0, NULL, 0}, {0}};

static error_t parse_suite(struct args *a, const char *arg, const struct argp_state *st)
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

static error_t parse_rule(struct args *a, const char *arg, const struct argp_state *st)
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
static error_t apply_live(struct args *a, const struct argp_state *st)
{
	const int n = snprintf(a->interfaces, sizeof(a->interfaces), "bus.interfaces=%s", a->live);

	if (a->setup.n_set == SETUP_SETS_MAX || n >= (int)sizeof(a->interfaces)) {
		return cli_bad(st, "--live: too many --set, or no name of an interface");
	}
	a->setup.set[a->setup.n_set++] = a->interfaces;
	return 0;
}

/* The user's settings come after the suites'. */
static error_t apply_preset(struct args *a, const struct argp_state *st)
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

static error_t check(struct args *a, const struct argp_state *st)
{
	if (!a->suite) {
		return cli_bad(st, "which SUITE? fmvss127, ncap-ccr, false-activation or degraded");
	}
	if (is_stdout(a->csv) + is_stdout(a->html) + a->json > 1) {
		return cli_bad(st,
			       "only one of --json, --csv - and --html - can have standard output");
	}
	if (a->compare && (a->rule || a->csv || a->html || a->log_run)) {
		return cli_bad(st, "--compare goes without --rule, --csv, --html and --log-run");
	}
	if (a->log && (a->cars || strcmp(a->suite->name, "false-activation") != 0)) {
		return cli_bad(st, "--log goes with false-activation, and without --vehicles");
	}
	if (a->live && (a->log || a->rule || a->compare || a->log_run)) {
		return cli_bad(st, "--live goes without --log, --rule, --compare and --log-run");
	}
	return a->live && apply_live(a, st) ? EINVAL : apply_preset(a, st);
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

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
	"). Suites: fmvss127, ncap-ccr, false-activation, degraded.",
	children,
	NULL,
	NULL};

/* ---- opening ------------------------------------------------------------------------------------ */

static int is_wanted(const struct args *a, const struct scenario *s)
{
	return (!a->is_short || s->in_short) && (!a->only || strstr(s->name, a->only)) &&
	       (!a->log_run || !strcmp(s->name, a->log_run));
}

/* What stands on how sure the radar is cannot be asked of one that does not say. */
static int is_knowable(const struct mapping *map, const struct scenario *s)
{
	int says = 0, doubtful = 0;

	for (int i = 0; i < map->n_tracks; i++) {
		says |= map->track[i].existence.sig != NULL;
	}
	for (int i = 0; i < s->drive.n; i++) {
		doubtful |= s->drive.target[i].existence > 0;
	}
	return says || !doubtful;
}

static int add_log(struct scenario *s, const char *path)
{
	*s = (struct scenario){
		.name = "recorded-drive", .goal = GOAL_NO_REQUEST, .in_short = 1, .log = path};
	return 1;
}

static int open_rows(struct work *w)
{
	int n, kept = 0;

	w->row = calloc(SCENARIO_ROWS_MAX, sizeof(*w->row));
	n = w->row ? w->args->suite->rows(w->row, SCENARIO_ROWS_MAX) : -ENOMEM;
	n += n > 0 && w->args->log ? add_log(&w->row[n], w->args->log) : 0;
	for (int i = 0; i < n; i++) {
		w->row[i].number = i;
		w->row[i].goal = is_knowable(w->map, &w->row[i]) ? w->row[i].goal : GOAL_UNKNOWABLE;
		if (is_wanted(w->args, &w->row[i])) {
			w->row[kept++] = w->row[i];
		}
	}
	w->plan.rows = kept;
	if (n < 0) {
		return cli_error(CLI_FAILED, w->name, "%s", strerror(-n));
	}
	return kept ? 0
		    : cli_error(CLI_USAGE, w->name, "%s has no such row; aebmc scenario %s --list",
				w->args->suite->name, w->args->suite->name);
}

/* What the daemon knows of each row's sensors. */
static int tell(struct work *w)
{
	char err[512];

	for (int i = 0; i < w->plan.rows; i++) {
		const struct scenario_fault *f = w->row[i].fault;

		w->told[i] = w->cfg;
		for (int k = 0; f && k < SCENARIO_SETS_MAX && f->set[k]; k++) {
			if (config_set(&w->told[i], f->set[k], err, sizeof(err))) {
				return cli_error(CLI_CONFIG, w->name, "%s", err);
			}
		}
	}
	return 0;
}

static int allocate(struct work *w)
{
	const size_t rows = (size_t)w->plan.rows, cars = (size_t)w->plan.cars;

	w->told = calloc(rows, sizeof(*w->told));
	w->latest_s = calloc(rows, sizeof(*w->latest_s));
	w->result = calloc(rows * cars, sizeof(*w->result));
	return w->told && w->latest_s && w->result
		       ? 0
		       : cli_error(CLI_FAILED, w->name, "%s", strerror(ENOMEM));
}

static int open_all(struct work *w)
{
	const struct args *a = w->args;
	int code = setup_load(w->name, &a->setup, &w->cfg, &w->map);

	if (a->samples) {
		w->cfg.mc_samples = a->samples;
	}
	w->plan.cars = a->cars ? (int)a->cars : 1;
	code = code ? code : open_rows(w);
	code = code ? code : allocate(w);
	code = code ? code : tell(w);
	w->plan = (struct scenario_plan){
		.name = w->name,
		.suite = a->suite,
		.row = w->row,
		.rows = w->plan.rows,
		.first_car = a->cars > 0,
		.cars = w->plan.cars,
		.seed = (uint64_t)a->seed,
		.cfg = &w->cfg,
		.told = w->told,
		.map = w->map,
		.rule = a->rule,
		.threads = a->threads ? (int)a->threads : (int)cli_cpus(),
		.latest_s = w->latest_s,
	};
	return code;
}

static void close_all(struct work *w)
{
	free(w->row);
	free(w->told);
	free(w->latest_s);
	free(w->result);
	config_mapping_free(w->map);
}

/* ---- work --------------------------------------------------------------------------------------- */

static int list(const struct work *w)
{
	for (int i = 0; i < w->plan.rows; i++) {
		puts(w->row[i].name);
	}
	return CLI_GOOD;
}

static int report(const struct work *w)
{
	const struct scenario_sum sum = scenario_sum_of(&w->plan, w->result);
	const int failed = sum.failed && !w->plan.suite->stated && !w->plan.rule;

	if (w->args->json) {
		scenario_json(stdout, &w->plan, w->result);
	} else if (!is_stdout(w->args->csv) && !is_stdout(w->args->html)) {
		scenario_words(stdout, &w->plan, w->result);
	}
	return failed ? CLI_FAILED : CLI_GOOD;
}

/* Files are opened before the runs: what cannot be written is said at once. */
struct files {
	FILE *csv, *html;
};

static int open_files(const struct work *w, struct files *f)
{
	const struct args *a = w->args;

	f->csv = a->csv ? cli_create(w->name, a->csv) : NULL;
	f->html = a->html ? cli_create(w->name, a->html) : NULL;
	return (a->csv && !f->csv) || (a->html && !f->html) ? CLI_FAILED : 0;
}

static int close_files(const struct work *w, const struct files *f, int written)
{
	int code = 0;

	if (f->csv) {
		if (written) {
			scenario_csv(f->csv, &w->plan, w->result);
		}
		code = cli_close(w->name, w->args->csv, f->csv);
	}
	if (f->html) {
		const int error = written ? scenario_html(f->html, &w->plan, w->result) : 0;
		const int closing = cli_close(w->name, w->args->html, f->html);

		code = error ? cli_error(CLI_FAILED, w->name, "%s", strerror(-error)) : code;
		code = code ? code : closing;
	}
	return code;
}

static int suite(struct work *w)
{
	struct files f;
	int code = open_files(w, &f);

	if (!code) {
		code = w->args->live ? scenario_live(&w->plan, w->result)
				     : scenario_pool(&w->plan, w->result);
	}

	const int closing = close_files(w, &f, !code);

	code = code ? code : report(w);
	return closing ? closing : code;
}

static int log_run(struct work *w)
{
	const struct config *cfg = &w->told[0];
	const struct scenario_draw d =
		scenario_draw(&w->cfg, w->row, w->plan.seed, w->plan.first_car);
	struct scenario_bench b = {
		.cfg = cfg, .map = w->map, .log = cli_create(w->name, w->args->out)};
	enum publish_backend which;
	struct scenario_result r;
	char err[256];

	if (!b.log) {
		return CLI_FAILED;
	}
	if (engine_open(cfg, MC_INLINE, &b.mc, &which, err, sizeof(err))) {
		return cli_error(CLI_FAILED, w->name, "%s", err);
	}
	const int error = scenario_run(&b, w->row, &d, &r);
	const int code = cli_close(w->name, w->args->out, b.log);

	mc_close(b.mc);
	return error && !code ? cli_error(CLI_FAILED, w->name, "%s", strerror(-error)) : code;
}

int cmd_scenario(int argc, char **argv)
{
	struct args a = {.out = "-", .seed = 1};
	struct work w = {.name = argv[0], .args = &a};

	setup_bundled(&a.setup, CONFIG_DEFAULT);

	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : open_all(&w);
	if (!code) {
		cli_catch_interrupt();
		code = a.list      ? list(&w)
		       : a.log_run ? log_run(&w)
		       : a.compare ? scenario_compare(stdout, a.json, &w.plan, w.result)
				   : suite(&w);
	}
	close_all(&w);
	return code;
}
