/* SPDX-License-Identifier: MIT
 * aebmc explain: which uncertain inputs drive the risk at one moment of a log, and the samples that end worst there.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "cli.h"
#include "cmd.h"
#include "explain.h"
#include "recorder.h"
#include "replay.h"

#define WORST 3 /* unless told */

struct args {
	struct setup setup;
	const char *log, *requests;
	double at_s;
	size_t future;
	int64_t worst;
	int json;
};

/* The last evaluation at or before the moment asked for. */
struct found {
	double at_s, first_s; /* first_s: of the first evaluation at all, NaN without one */
	int any;
	struct explain *x;
};

/* ---- arguments --------------------------------------------------------------------------------- */

enum { KEY_AT = 0x100, KEY_FUTURE, KEY_WORST, KEY_REQUESTS, KEY_JSON };

static const struct argp_option options[] = {
	{"at", KEY_AT, "S", 0,
	 "when, in seconds from LOG's first frame; the last evaluation by then", 1},
	{"future", KEY_FUTURE, "NAME", 0, "whose risk: defer (default), now, driver or nobody", 1},
	{"worst", KEY_WORST, "N", 0, "how many of the worst samples to show, 0..100 (3)", 1},
	{"requests", KEY_REQUESTS, "FILE", 0,
	 "write them as requests that replay --requests runs again, - for standard output", 1},
	{"json", KEY_JSON, NULL, 0, "one JSON object on standard output", 1},
	{0},
};
static const struct argp_child children[] = {{&setup_argp, 0, NULL, 0}, {0}};

static error_t check(const struct argp_state *st, const struct args *a)
{
	if (!a->log) {
		return cli_bad(st, "which LOG? a file from candump -L, or - for standard input");
	}
	if (isnan(a->at_s)) {
		return cli_bad(
			st,
			"--at S is needed: seconds from LOG's first frame, as replay tells them");
	}
	if (!a->setup.path) {
		return cli_bad(st, "--config FILE is needed: it says which signals the car sends");
	}
	if (a->requests && !strcmp(a->requests, "-") && a->json) {
		return cli_bad(st, "--json and --requests - both want standard output");
	}
	if (cli_same_file(a->log, STDIN_FILENO, a->requests)) {
		return cli_bad(st, "%s: is the input as well; write to another file", a->log);
	}
	return 0;
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->setup;
		return 0;
	case KEY_AT:
		return cli_number(st, "--at", arg, 0, 1e6, &a->at_s);
	case KEY_FUTURE:
		return cli_choice(st, "--future", arg, explain_future_name, FUTURES, &a->future);
	case KEY_WORST:
		return cli_count(st, "--worst", arg, 0, EXPLAIN_WORST_MAX, &a->worst);
	case KEY_REQUESTS:
		a->requests = arg;
		return 0;
	case KEY_JSON:
		a->json = 1;
		return 0;
	case ARGP_KEY_ARG:
		if (a->log) {
			return cli_bad(st, "'%s': one LOG at a time", arg);
		}
		a->log = arg;
		return 0;
	case ARGP_KEY_END:
		return check(st, a);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {
	options,
	parse,
	"LOG",
	"Names the uncertain inputs that drive the risk at one moment of a "
	"candump log, and the samples that end worst there.",
	children,
	NULL,
	NULL};

/* ---- work -------------------------------------------------------------------------------------- */

static void on_cycle(void *arg, double time_s, const struct cycle *c)
{
	struct found *f = arg;

	f->first_s = isnan(f->first_s) ? time_s : f->first_s;
	if (time_s <= f->at_s) {
		f->any = 1;
		f->x->cycle = *c;
		f->x->time_s = time_s;
	}
}

static void on_level(void *arg, double time_s, enum stage_level level)
{
	(void)arg;
	(void)time_s;
	(void)level;
}

static int find(const char *name, const struct args *a, struct explain *x, uint64_t *hash)
{
	const struct replay_args replay = {.setup = a->setup, .log = a->log};
	struct found f = {.at_s = a->at_s, .first_s = NAN, .x = x};
	const struct replay_watch watch = {.cycle = on_cycle, .level = on_level, .arg = &f};
	struct replay_figures figures = {0};
	const int code = replay_watched(name, &replay, &watch, &figures);

	*hash = figures.hash;
	if (code || f.any) {
		return code;
	}
	return isnan(f.first_s) ? cli_error(CLI_FAILED, name,
					    "%s: no evaluation in it: no lead was followed", a->log)
				: cli_error(CLI_FAILED, name,
					    "%s: no evaluation by %g s; the first is at %.3f s",
					    a->log, a->at_s, f.first_s);
}

static int write_requests(const char *name, const struct args *a, const struct explain *x, FILE *f)
{
	if (!f) {
		return CLI_GOOD;
	}
	recorder_write_head(f);
	for (int i = 0; i < x->n_worst; i++) {
		recorder_write(f, x->cycle.scene.scan_ns, &x->worst[i].req,
			       x->worst[i].result_hash);
	}
	return cli_close(name, a->requests, f);
}

static void tell(const struct args *a, const struct explain *x, uint64_t hash)
{
	if (a->json) {
		explain_json(x, hash);
	} else if (!a->requests || strcmp(a->requests, "-")) {
		explain_words(stdout, x);
	}
}

static int explain(const char *name, const struct args *a, struct explain *x)
{
	struct config cfg;
	uint64_t hash;
	int code = find(name, a, x, &hash);

	code = code ? code : setup_load(name, &a->setup, &cfg, NULL);
	if (code) {
		return code;
	}
	x->future = (int)a->future;
	const int error = explain_run(&cfg, (int)a->worst, x);
	FILE *requests = error || !a->requests ? NULL : cli_create(name, a->requests);

	if (error) {
		return cli_error(CLI_FAILED, name, "%s", strerror(-error));
	}
	if (a->requests && !requests) {
		return CLI_FAILED;
	}
	tell(a, x, hash);
	return write_requests(name, a, x, requests);
}

int cmd_explain(int argc, char **argv)
{
	struct args a = {.at_s = NAN, .future = FUTURE_DEFER, .worst = WORST};
	const char *name = argv[0];
	int code = cli_parse(&argp, argc, argv, &a);

	if (code) {
		return code;
	}
	struct explain *x = calloc(1, sizeof(*x));

	code = x ? explain(name, &a, x) : cli_error(CLI_FAILED, name, "%s", strerror(ENOMEM));
	free(x);
	return code;
}
