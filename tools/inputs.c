/* SPDX-License-Identifier: MIT
 * aebmc inputs: every mapped signal, live or from a log, and whether the mapping reads it right. A live table on a terminal,
 * plain lines at the end.
 */
#include "inputs.h"
#include <errno.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include "cli.h"
#include "clock.h"
#include "cmd.h"
#include "foreign.h"
#include "progress.h"
#include "setup.h"

#define BATCH       64
#define REDRAW_NS   (CLOCK_NS_PER_S / 4)
#define SECONDS_MAX 86400

struct args {
	struct setup setup;
	const char *source;
	double seconds;
	int json;
};

enum { KEY_JSON = 0x100, KEY_SECONDS };

static const struct argp_option options[] = {
	{"json", KEY_JSON, NULL, 0, "one JSON object on standard output", 1},
	{"seconds", KEY_SECONDS, "S", 0, "watch for so long; default: to the end, or Ctrl-C", 1},
	{0},
};
static const struct argp_child children[] = {{&setup_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->setup;
		return 0;
	case KEY_JSON:
		a->json = 1;
		return 0;
	case KEY_SECONDS:
		return cli_number(st, "--seconds", arg, 0.1, SECONDS_MAX, &a->seconds);
	case ARGP_KEY_ARG:
		if (a->source) {
			return cli_bad(st, "'%s': one interface or log at a time", arg);
		}
		a->source = arg;
		return 0;
	case ARGP_KEY_END:
		if (!a->setup.path) {
			return cli_bad(st, "which car? --config FILE; `aebmc map` writes one");
		}
		return a->source ? 0 : cli_bad(st, "which interface or LOG? - is standard input");
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 "IFACE|LOG",
				 "Decodes every mapped signal, from the bus or from a candump log, "
				 "and says what looks wrong in the "
				 "mapping and what to change. Exit code 1 if something is wrong.",
				 children,
				 NULL,
				 NULL};

/* ---- sources ----------------------------------------------------------------------------------- */

static int is_interface(const struct mapping *map, const char *name)
{
	for (int i = 0; i < map->n_ifaces; i++) {
		if (!strcmp(map->iface[i], name)) {
			return access(name, F_OK) != 0;
		}
	}
	return 0;
}

static void name_interfaces(const struct inputs *in, const char *iface[BUS_IFACES_MAX])
{
	for (int i = 0; i < in->n_ifaces; i++) {
		iface[i] = in->iface[i];
	}
}

static int open_log(struct inputs *in, const char *path, struct bus **ret, char *err, int err_len)
{
	const char *iface[BUS_IFACES_MAX];

	in->n_ifaces = census_interfaces(path, in->iface, in->n_ifaces);
	name_interfaces(in, iface);
	return bus_log_open(path, NULL, iface, in->n_ifaces, ret, err, err_len);
}

static int open_live(struct inputs *in, struct bus **ret, char *err, int err_len)
{
	const char *iface[BUS_IFACES_MAX];
	struct bus_id id[MAP_MESSAGES_MAX];
	const struct bus_socketcan_params p = {.ifaces = iface,
					       .n_ifaces = in->n_ifaces,
					       .input = id,
					       .n_input = in->map->n_messages,
					       .allow_local = 1};

	name_interfaces(in, iface);
	for (int i = 0; i < in->map->n_messages; i++) {
		id[i] = (struct bus_id){in->map->message[i].iface, in->map->message[i].msg->id};
	}
	in->is_live = 1;
	return bus_socketcan_open(&p, ret, err, err_len);
}

/* ---- watching ---------------------------------------------------------------------------------- */

struct watch {
	const char *name;
	const struct args *args;
	struct inputs *in;
	struct bus *bus;
	int64_t start_ns, end_ns; /* live */
	struct progress line;
};

static void draw(struct watch *w)
{
	struct winsize size = {.ws_row = 24};

	ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);
	fputs("\033[H\033[J", stdout); /* home, clear to the end */
	inputs_table(w->in, size.ws_row > 5 ? size.ws_row : 5, stdout);
	fflush(stdout);
}

static void show_progress(struct watch *w)
{
	int64_t done, total;

	bus_log_progress(w->bus, &done, &total);
	progress_update(&w->line, total > 0 ? (double)done / (double)total : -1, "");
}

/* What is due between two looks at the bus. 1: the time is up. */
static int between(struct watch *w, int64_t now_ns)
{
	if (w->in->is_live) {
		bus_socketcan_service(w->bus);
		w->in->last_ns = now_ns;
		if (!w->args->json && isatty(STDOUT_FILENO)) {
			draw(w);
		}
	} else if (w->line.on) {
		show_progress(w);
	}
	return w->args->seconds > 0 &&
	       w->in->last_ns - w->in->first_ns >= clock_s_to_ns(w->args->seconds);
}

/* To the end of the log, of the time, or Ctrl-C. 0 or -errno. */
static int watch(struct watch *w)
{
	struct bus_frame f[BATCH];
	int64_t now_ns = w->in->is_live ? clock_now_ns() : 0, next_ns = 0;
	int n = 0;

	w->in->first_ns = w->in->last_ns = now_ns;
	while (!cli_interrupted() && !ferror(stdout)) {
		const int64_t until_ns = w->in->is_live ? now_ns + REDRAW_NS : CLOCK_NEVER;

		n = w->bus->ops->recv(w->bus, f, BATCH, until_ns, &now_ns);
		for (int i = 0; i < n; i++) {
			inputs_frame(w->in, &f[i]);
		}
		if (n < 0 && n != -EINTR) {
			return n == -ENODATA ? 0 : n;
		}
		if (now_ns >= next_ns || !w->in->is_live) {
			next_ns = now_ns + REDRAW_NS;
			if (between(w, now_ns)) {
				return 0;
			}
		}
	}
	return 0;
}

/* ---- the report -------------------------------------------------------------------------------- */

static void report(const struct watch *w, const struct inputs_judge *j)
{
	if (w->args->json) {
		inputs_json(w->in, j, w->args->source, cli_interrupted(), stdout);
		return;
	}
	if (!(w->in->is_live && isatty(STDOUT_FILENO))) {
		inputs_table(w->in, 0, stdout);
	}
	putchar('\n');
	inputs_verdicts(j, stdout);
}

static int judge(const struct watch *w)
{
	struct inputs_judge j;

	if (!w->in->is_live && !w->in->frames) {
		return foreign_log(w->name, w->args->source);
	}
	inputs_judge(&j, w->in);
	report(w, &j);
	return j.n > 0 && j.verdict[0].level == INPUTS_WRONG ? CLI_FAILED : CLI_GOOD;
}

static int run(struct watch *w)
{
	cli_catch_interrupt();
	w->line = progress_start(w->name);

	const int error = watch(w);

	progress_clear(&w->line);
	if (error) {
		return cli_error(CLI_FAILED, w->name, "%s: %s", w->args->source, strerror(-error));
	}
	if (cli_interrupted() && !w->in->is_live && !w->in->frames) {
		return cli_error(CLI_FAILED, w->name, "interrupted");
	}
	return judge(w);
}

/* Neither an interface of the mapping nor a file. */
static int is_neither(const struct mapping *map, const char *name)
{
	return !is_interface(map, name) && strcmp(name, "-") != 0 && access(name, F_OK) &&
	       errno == ENOENT;
}

static int open_and_run(struct watch *w, const struct mapping *map)
{
	char err[512];
	int error;

	if (is_neither(map, w->args->source)) {
		return cli_error(CLI_FAILED, w->name,
				 "%s: no such file, and not one of bus.interfaces: %s",
				 w->args->source, w->in->cfg->bus_interfaces);
	}
	if (is_interface(map, w->args->source)) {
		error = open_live(w->in, &w->bus, err, sizeof(err));
	} else {
		error = open_log(w->in, w->args->source, &w->bus, err, sizeof(err));
	}
	if (error) {
		return cli_error(CLI_FAILED, w->name, "%s", err);
	}
	const int code = run(w);

	w->bus->ops->close(w->bus);
	return code;
}

int cmd_inputs(int argc, char **argv)
{
	struct args a = {0};
	struct config cfg;
	struct mapping *map = NULL;
	struct watch w = {.name = argv[0], .args = &a};
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : setup_load(argv[0], &a.setup, &cfg, &map);
	if (code) {
		return code;
	}
	const int error = inputs_open(&cfg, map, &w.in);

	code = error ? cli_error(CLI_FAILED, argv[0], "%s", strerror(-error))
		     : open_and_run(&w, map);
	inputs_close(w.in);
	config_mapping_free(map);
	return code;
}
