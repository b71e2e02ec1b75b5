/* SPDX-License-Identifier: MIT
 * aebmc generate: a candump log of a made-up drive, or of a recorded one with another lead.
 */
#include <errno.h>
#include <string.h>
#include <unistd.h>
#include "cli.h"
#include "clock.h"
#include "cmd.h"
#include "setup.h"
#include "splice.h"
#include "text.h"

#define CONFIG_DEFAULT "generic.conf"
#define LINE_SIZE      256
#define FRAMES         16

struct args {
	struct setup setup;
	const char *drive, *splice, *out;
	double at_s, dropout;
	int64_t seed;
	int list;
};

struct output {
	const struct mapping *map;
	FILE *file;
};

/* ---- arguments --------------------------------------------------------------------------------- */

enum { KEY_DRIVE = 0x100, KEY_LIST, KEY_SEED, KEY_DROPOUT, KEY_SPLICE, KEY_AT, KEY_OUT };

static const struct argp_option options[] = {
	{"drive", KEY_DRIVE, "NAME", 0, "which drive; --list names them", 1},
	{"list", KEY_LIST, NULL, 0, "name the drives", 1},
	{"seed", KEY_SEED, "N", 0, "seed of the sensors' noise (1)", 1},
	{"dropout", KEY_DROPOUT, "P", 0, "probability that a scan misses a car (0)", 1},
	{"splice", KEY_SPLICE, "LOG", 0,
	 "instead of a drive: LOG (- for standard input), whose lead is replaced by one that "
	 "brakes at 0.5 g",
	 2},
	{"at", KEY_AT, "S", 0, "when, in seconds from LOG's first frame", 2},
	{"out", KEY_OUT, "FILE", 0, "where to write; - is standard output, the default", 3},
	{0},
};
static const struct argp_child children[] = {{&setup_argp, 0, NULL, 0}, {0}};

static error_t check(const struct args *a, struct argp_state *st)
{
	if (a->list) {
		return 0;
	}
	if (!a->drive == !a->splice) {
		return cli_bad(st, "give either --drive NAME (--list names them) or --splice LOG");
	}
	if (!a->splice != (a->at_s < 0)) {
		return cli_bad(st, "--splice LOG and --at S go together");
	}
	if (cli_same_file(a->splice, STDIN_FILENO, a->out)) {
		return cli_bad(st, "%s: is the input as well; write to another file", a->splice);
	}
	return 0;
}

static error_t parse_drive(struct args *a, const char *arg, struct argp_state *st)
{
	size_t n = 0;

	while (drive_table[n].name) {
		n++;
	}
	a->drive = arg;
	return drive_find(arg)
		       ? 0
		       : cli_bad(st, "--drive: no drive '%s'; nearest is '%s', --list names all",
				 arg,
				 text_nearest(arg, &drive_table[0].name, n,
					      sizeof(drive_table[0])));
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->setup;
		return 0;
	case KEY_DRIVE:
		return parse_drive(a, arg, st);
	case KEY_LIST:
		a->list = 1;
		return 0;
	case KEY_SEED:
		return cli_count(st, "--seed", arg, 0, INT64_MAX, &a->seed);
	case KEY_DROPOUT:
		return cli_number(st, "--dropout", arg, 0, 1, &a->dropout);
	case KEY_SPLICE:
		a->splice = arg;
		return 0;
	case KEY_AT:
		return cli_number(st, "--at", arg, 0, 1e6, &a->at_s);
	case KEY_OUT:
		a->out = arg;
		return 0;
	case ARGP_KEY_ARG:
		return cli_bad(st, "'%s': generate takes options alone", arg);
	case ARGP_KEY_END:
		return check(a, st);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {
	options,
	parse,
	NULL,
	"A candump log of a made-up drive, through any car's mapping (without "
	"--config: the bundled " CONFIG_DEFAULT ").",
	children,
	NULL,
	NULL};

/* ---- work -------------------------------------------------------------------------------------- */

static int write_frame(void *arg, const struct bus_frame *f, const struct drive_truth *now)
{
	const struct output *o = arg;
	char line[LINE_SIZE];

	(void)now;
	bus_log_format(f, o->map->iface[f->iface], line, sizeof(line));
	return fprintf(o->file, "%s\n", line) < 0;
}

static int write_drive(const char *name, const struct args *a, const struct config *cfg,
		       const struct mapping *map)
{
	struct output o = {map, cli_create(name, a->out)};
	const struct drive_options opt = {
		.seed = (uint64_t)a->seed,
		.dropout = a->dropout,
		.emit = write_frame,
		.arg = &o,
	};

	if (!o.file) {
		return CLI_FAILED;
	}
	drive_run(drive_find(a->drive), cfg, map, &opt);
	return cli_close(name, a->out, o.file);
}

/* Frame by frame until the log or the drive ends. Returns -errno: -ENODATA at the log's end, 0 at contact. */
static int write_spliced(struct splice *s, struct bus *log)
{
	struct bus_frame f[FRAMES];
	int64_t now_ns;
	int n;

	while ((n = log->ops->recv(log, f, FRAMES, CLOCK_NEVER, &now_ns)) > 0) {
		for (int i = 0; i < n; i++) {
			const int contact = splice_frame(s, &f[i]);
			const int error = log->ops->send(log, &f[i]);

			if (contact || error) {
				return error;
			}
		}
	}
	return n;
}

static int splice(const char *name, const struct args *a, const struct config *cfg,
		  const struct mapping *map)
{
	const char *iface[BUS_IFACES_MAX];
	char err[512] = "";
	struct bus *log;
	struct splice s;

	for (int i = 0; i < map->n_ifaces; i++) {
		iface[i] = map->iface[i];
	}
	if (bus_log_open(a->splice, a->out, iface, map->n_ifaces, &log, err, sizeof(err))) {
		return cli_error(CLI_FAILED, name, "%s", err);
	}
	int error = splice_open(&s, cfg, map, a->at_s, (uint64_t)a->seed);

	if (!error) {
		error = write_spliced(&s, log);
		splice_close(&s);
	}
	int lost = bus_log_finish(log);

	error = lost ? lost : error;
	log->ops->close(log);
	if (error && error != -ENODATA) {
		return cli_error(CLI_FAILED, name, "%s to %s: %s", a->splice, a->out,
				 strerror(-error));
	}
	return s.scans ? CLI_GOOD
		       : cli_error(CLI_FAILED, name, "%s: no lead to replace after %g s", a->splice,
				   a->at_s);
}

static int make(const char *name, const struct args *a, const struct config *cfg,
		const struct mapping *map)
{
	if (!a->splice) {
		return write_drive(name, a, cfg, map);
	}
	return map->list.header < 0
		       ? splice(name, a, cfg, map)
		       : cli_error(
				 CLI_CONFIG, name,
				 "%s: a lead is replaced in a radar's slots; this one sends a list",
				 a->setup.path);
}

static int list(void)
{
	for (const struct drive *d = drive_table; d->name; d++) {
		printf("%-8s  %s\n", d->name, d->doc);
	}
	return CLI_GOOD;
}

int cmd_generate(int argc, char **argv)
{
	struct args a = {.out = "-", .seed = 1, .at_s = -1};
	const char *name = argv[0];
	struct mapping *map = NULL;
	struct config cfg;

	setup_bundled(&a.setup, CONFIG_DEFAULT);

	int code = cli_parse(&argp, argc, argv, &a);

	if (code || a.list) {
		return code ? code : list();
	}
	code = setup_load(name, &a.setup, &cfg, &map);
	if (code) {
		return code;
	}
	code = make(name, &a, &cfg, map);
	config_mapping_free(map);
	return code;
}
