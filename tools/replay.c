/* SPDX-License-Identifier: MIT
 * aebmc replay: a candump log through the daemon's pipeline, with the batches run inline. The log's own time drives
 * everything, so that the same log, configuration and seed give the same output log, byte for byte.
 */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "cli.h"
#include "clock.h"
#include "cmd.h"
#include "compare.h"
#include "csv.h"
#include "engine.h"
#include "foreign.h"
#include "replay.h"
#include "requests.h"

/* ---- arguments --------------------------------------------------------------------------------- */

enum { BACKEND_AUTO, BACKEND_CPU }; /* of mc.backend in config.def */
enum { KEY_OUT = 0x100, KEY_CSV, KEY_JSON, KEY_REQUESTS, KEY_COMPARE, KEY_PICTURES, KEY_JOBS };

static const struct argp_option options[] = {
	{"out", KEY_OUT, "FILE", 0, "write our frames as a candump log, - for standard output", 1},
	{"csv", KEY_CSV, "FILE", 0, "one row per evaluation, - for standard output", 1},
	{"threads", 't', "N", 0, "compute threads, 1..64; no output depends on it", 1},
	{"json", KEY_JSON, NULL, 0, "one JSON object on standard output", 1},
	{"requests", KEY_REQUESTS, "FILE", 0,
	 "no LOG: rerun the requests of an event and compare the results bit for bit", 1},
	{"compare", KEY_COMPARE, "A.conf B.conf", 0,
	 "every LOG under both: warnings and requests that B gains and loses", 2},
	{"pictures", KEY_PICTURES, "DIR", 0,
	 "with --compare: draw logs that differ, as DIR/LOG.svg", 2},
	{"jobs", KEY_JOBS, "N", 0, "with --compare: replays at a time (one for each processor)", 2},
	{0},
};
static const struct argp_child children[] = {{&setup_argp, 0, NULL, 0}, {0}};

static int is_stdout(const char *path)
{
	return path && !strcmp(path, "-");
}

/* The first word after --compare A.conf is B.conf, the others are logs. */
static error_t check_compare(const struct argp_state *st, struct replay_args *a)
{
	if (a->setup.path || a->out || a->csv || a->requests) {
		return cli_bad(st, "--compare goes without --config, --out, --csv and --requests");
	}
	if (a->n_logs < 2) {
		return cli_bad(st, "--compare A.conf B.conf LOG...: %s is missing",
			       a->n_logs ? "LOG" : "B.conf");
	}
	a->compare[1] = *a->logs++;
	a->n_logs--;
	for (int i = 0; i < a->n_logs; i++) {
		if (!strcmp(a->logs[i], "-")) {
			return cli_bad(st, "--compare reads each log twice: no standard input");
		}
	}
	return 0;
}

static error_t check(const struct argp_state *st, struct replay_args *a)
{
	if (a->compare[0]) {
		return check_compare(st, a);
	}
	if (a->pictures || a->jobs) {
		return cli_bad(st, "--pictures and --jobs go with --compare");
	}
	if (a->n_logs > 1) {
		return cli_bad(st, "'%s': one LOG at a time", a->logs[1]);
	}
	a->log = a->n_logs ? a->logs[0] : NULL;
	if (a->requests) {
		return a->log || a->out || a->csv
			       ? cli_bad(st, "--requests goes without LOG, --out and --csv")
			       : 0;
	}
	if (!a->log) {
		return cli_bad(st, "which LOG? a file from candump -L, or - for standard input");
	}
	if (!a->setup.path) {
		return cli_bad(st, "--config FILE is needed: it says which signals the car sends");
	}
	if (is_stdout(a->out) + is_stdout(a->csv) + a->json > 1) {
		return cli_bad(st,
			       "only one of --json, --csv - and --out - can have standard output");
	}
	return 0;
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct replay_args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->setup;
		return 0;
	case KEY_OUT:
		a->out = arg;
		return 0;
	case KEY_CSV:
		a->csv = arg;
		return 0;
	case 't':
		return cli_count(st, "--threads", arg, 1, 64, &a->threads);
	case KEY_JSON:
		a->json = 1;
		return 0;
	case KEY_REQUESTS:
		a->requests = arg;
		return 0;
	case KEY_COMPARE:
		a->compare[0] = arg;
		return 0;
	case KEY_PICTURES:
		a->pictures = arg;
		return 0;
	case KEY_JOBS:
		return cli_count(st, "--jobs", arg, 1, 1024, &a->jobs);
	case ARGP_KEY_ARG:
		a->logs[a->n_logs++] = arg;
		return 0;
	case ARGP_KEY_END:
		return check(st, a);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 "LOG\n--requests FILE\n--compare A.conf B.conf LOG...",
				 "Replays a candump log through the daemon's pipeline and tells "
				 "what it would have done and when.",
				 children,
				 NULL,
				 NULL};

/* ---- opening ----------------------------------------------------------------------------------- */

static int open_log(struct replay *r)
{
	const char *iface[BUS_IFACES_MAX];
	char err[512];

	for (int i = 0; i < r->map->n_ifaces; i++) {
		iface[i] = r->map->iface[i];
	}
	if (bus_log_open(r->args->log, r->args->out, iface, r->map->n_ifaces, &r->log, err,
			 sizeof(err))) {
		return cli_error(CLI_FAILED, r->name, "%s", err);
	}
	stamped_init(&r->bus, r->log);
	return 0;
}

/* Not `auto`: the frames must not depend on what this machine has. */
static int open_mc(struct replay *r)
{
	char err[256];

	r->cfg.mc_threads = r->args->threads ? r->args->threads : r->cfg.mc_threads;
	if (r->cfg.mc_backend == BACKEND_AUTO) {
		r->cfg.mc_backend = BACKEND_CPU;
	}
	return engine_open(&r->cfg, MC_INLINE, &r->mc, &r->backend, err, sizeof(err))
		       ? cli_error(CLI_FAILED, r->name, "%s", err)
		       : 0;
}

static void on_cycle(void *arg, const struct cycle *c, enum state state)
{
	struct replay *r = arg;

	if (r->csv) {
		csv_row(r->csv, c, state, r->bus.first_ns);
	}
	if (r->watch) {
		r->watch->cycle(r->watch->arg, replay_time_s(r, c->scene.scan_ns), c);
	}
}

static int open_pipeline(struct replay *r)
{
	const struct pipeline_open o = {.cfg = &r->cfg,
					.map = r->map,
					.bus = &r->bus.bus,
					.mc = r->mc,
					.backend = r->backend,
					.on_cycle = on_cycle,
					.on_change = replay_change,
					.arg = r};
	int error = pipeline_open(&o, &r->pipe);

	return error ? cli_error(CLI_FAILED, r->name, "cannot open the pipeline: %s",
				 strerror(-error))
		     : 0;
}

static int open_csv(struct replay *r)
{
	if (!r->args->csv) {
		return 0;
	}
	r->csv = cli_create(r->name, r->args->csv);
	if (!r->csv) {
		return CLI_FAILED;
	}
	csv_head(r->csv);
	return 0;
}

/* Opening an output empties it. */
static int check_files(const struct replay *r)
{
	const struct replay_args *a = r->args;
	const char *const in[] = {a->log, a->setup.path, r->cfg.dbc_file};

	for (size_t i = 0; i < sizeof(in) / sizeof(in[0]); i++) {
		if (cli_same_file(in[i], STDIN_FILENO, a->out) ||
		    cli_same_file(in[i], STDIN_FILENO, a->csv)) {
			return cli_error(CLI_USAGE, r->name,
					 "%s: is the input as well; write to another file", in[i]);
		}
	}
	return cli_same_file(a->out, STDOUT_FILENO, a->csv)
		       ? cli_error(CLI_USAGE, r->name, "%s: --out and --csv need a file each",
				   a->csv)
		       : 0;
}

static int open_all(struct replay *r)
{
	int code = setup_load(r->name, &r->args->setup, &r->cfg, &r->map);

	code = code ? code : check_files(r);
	code = code ? code : open_log(r);
	code = code ? code : check_files(r); /* again, --out exists now */
	code = code ? code : open_csv(r);
	code = code ? code : open_mc(r);
	return code ? code : open_pipeline(r);
}

static int close_all(struct replay *r)
{
	int code = r->csv ? cli_close(r->name, r->args->csv, r->csv) : 0;

	pipeline_close(r->pipe);
	mc_close(r->mc);
	if (r->log) {
		r->log->ops->close(r->log);
	}
	config_mapping_free(r->map);
	return code;
}

/* ---- running ----------------------------------------------------------------------------------- */

static void show_progress(struct replay *r, int64_t start_ns)
{
	int64_t done, total, now_ns = clock_now_ns();
	char words[48];

	bus_log_progress(r->log, &done, &total);
	snprintf(words, sizeof(words), "%.1f times real time",
		 (double)(r->bus.last_ns - r->bus.first_ns) / (double)(now_ns - start_ns + 1));
	progress_update(&r->line, total > 0 ? (double)done / (double)total : -1, words);
}

/* 0 at the end of the log or on Ctrl-C, -errno. */
static int run(struct replay *r)
{
	int64_t start_ns = clock_now_ns();
	int error = 0;

	cli_catch_interrupt();
	while (!error && !cli_interrupted()) {
		error = pipeline_step(r->pipe);
		error = error == -EINTR ? 0 : error;
		error = !error && r->csv && ferror(r->csv) ? -EIO : error;
		if (r->line.on) {
			show_progress(r, start_ns);
		}
	}
	r->wall_ns = clock_now_ns() - start_ns;
	return error == -ENODATA ? 0 : error;
}

static int no_frame(const struct replay *r)
{
	const uint64_t others = r->log->ops->stats(r->log)->other_iface;

	return others ? cli_error(CLI_FAILED, r->name,
				  "%s: no frame on %s, but %" PRIu64
				  " on other interfaces; see bus.interfaces",
				  r->args->log, r->cfg.bus_interfaces, others)
		      : foreign_log(r->name, r->args->log);
}

static int explain(const struct replay *r, int error)
{
	int lost = bus_log_finish(r->log);

	if (lost) {
		return cli_error(CLI_FAILED, r->name, "%s: %s",
				 is_stdout(r->args->out) ? "standard output" : r->args->out,
				 strerror(-lost));
	}
	if (r->csv && ferror(r->csv)) {
		return CLI_FAILED; /* told when it is closed */
	}
	if (error) {
		return cli_error(CLI_FAILED, r->name, "%s: %s", r->args->log, strerror(-error));
	}
	if (cli_interrupted()) {
		return cli_error(CLI_FAILED, r->name, "interrupted");
	}
	return pipeline_stats(r->pipe)->frames ? CLI_GOOD : no_frame(r);
}

static int replay(struct replay *r)
{
	int taken = is_stdout(r->args->csv) || is_stdout(r->args->out);

	r->words = r->args->json || taken ? NULL : stdout;
	replay_begin(r);
	int error = run(r);

	replay_end(r);
	return explain(r, error);
}

static int watched(struct replay *r, struct replay_figures *f)
{
	int code = explain(r, run(r));

	*f = (struct replay_figures){
		.evaluations = pipeline_stats(r->pipe)->evaluations,
		.hash = config_hash(&r->cfg, r->map),
		.log_s = replay_time_s(r, r->bus.last_ns),
		.risk_max = pipeline_stats(r->pipe)->risk_max,
	};
	return code;
}

int replay_watched(const char *name, const struct replay_args *a, const struct replay_watch *watch,
		   struct replay_figures *f)
{
	struct replay r = {.name = name, .args = a, .watch = watch, .state = STATE_INIT};
	int code = open_all(&r);

	code = code ? code : watched(&r, f);
	close_all(&r);
	return code;
}

static int replay_log(const char *name, const struct replay_args *a)
{
	struct replay r = {.name = name, .args = a};
	int code = open_all(&r);

	code = code ? code : replay(&r);
	int closing = close_all(&r);

	return code ? code : closing;
}

static int dispatch(const char *name, const struct replay_args *a)
{
	if (a->compare[0]) {
		return compare_main(name, a);
	}
	return a->requests ? requests_run(name, a) : replay_log(name, a);
}

int cmd_replay(int argc, char **argv)
{
	const char **words = calloc((size_t)argc, sizeof(*words));
	struct replay_args a = {.logs = words};

	if (!words) {
		return cli_error(CLI_FAILED, argv[0], "%s", strerror(ENOMEM));
	}
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : dispatch(argv[0], &a);
	free(words);
	return code;
}
