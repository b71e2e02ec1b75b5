/* SPDX-License-Identifier: MIT
 * aebmc map: candidates for each role from a DBC and a log, and a mapping written from those that are clear or chosen. What
 * is not clear is asked for on a terminal, or else listed, and nothing is written.
 */
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "cli.h"
#include "clock.h"
#include "cmd.h"
#include "config.h"
#include "foreign.h"
#include "map.h"

#define BATCH 64

enum { KEY_ROLE = 0x100, KEY_OUT, KEY_FORCE, KEY_INTERFACE };

static const struct argp_option options[] = {
	{"role", KEY_ROLE, "NAME=MESSAGE.SIGNAL[:UNIT]", 0,
	 "decide a role, may be given again; NAME=none: it stays unmapped", 1},
	{"out", KEY_OUT, "FILE", 0, "write the configuration there; - is standard output", 1},
	{"force", KEY_FORCE, NULL, 0, "write over FILE if it is there", 1},
	{"interface", KEY_INTERFACE, "NAME", 0, "of messages that are in no log; default: can0", 1},
	{0},
};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct map_args *a = st->input;

	switch (key) {
	case KEY_ROLE:
		if (a->n_roles == MAP_DECIDED_MAX) {
			return cli_bad(st, "--role: more than %d of them", MAP_DECIDED_MAX);
		}
		a->role[a->n_roles++] = arg;
		return 0;
	case KEY_OUT:
		a->out = arg;
		return 0;
	case KEY_FORCE:
		a->force = 1;
		return 0;
	case KEY_INTERFACE:
		a->iface = arg;
		return 0;
	case ARGP_KEY_ARG:
		if (a->log) {
			return cli_bad(st, "'%s': one DBC and one LOG at a time", arg);
		}
		*(a->dbc ? &a->log : &a->dbc) = arg;
		return 0;
	case ARGP_KEY_END:
		return a->dbc ? 0 : cli_bad(st, "which DBC?");
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 "DBC [LOG]",
				 "Finds the signals that a mapping needs, by name, unit, range and "
				 "by how they behave in a candump log, "
				 "and writes a configuration with the reasons as comments.",
				 NULL,
				 NULL,
				 NULL};

/* ---- the log ----------------------------------------------------------------------------------- */

static int read_log(struct map *p, struct bus *bus)
{
	struct bus_frame f[BATCH];
	int64_t now_ns = 0;
	int n = 0;

	cli_catch_interrupt();
	while (n >= 0 && !cli_interrupted()) {
		n = bus->ops->recv(bus, f, BATCH, CLOCK_NEVER, &now_ns);
		for (int i = 0; i < n; i++) {
			mapper_frame(p->m, &f[i]);
		}
	}
	if (cli_interrupted()) {
		return cli_error(CLI_FAILED, p->name, "interrupted");
	}
	if (n != -ENODATA) {
		return cli_error(CLI_FAILED, p->name, "%s: %s", p->args->log, strerror(-n));
	}
	return p->m->frames ? 0 : foreign_log(p->name, p->args->log);
}

static int take_log(struct map *p)
{
	const char *iface[BUS_IFACES_MAX];
	char err[512];
	struct bus *bus;

	p->m->n_ifaces = census_interfaces(p->args->log, p->m->iface, 0);
	if (!p->m->n_ifaces) {
		strcpy(p->m->iface[0], "can0");
		p->m->n_ifaces = 1;
	}
	for (int i = 0; i < p->m->n_ifaces; i++) {
		iface[i] = p->m->iface[i];
	}
	if (bus_log_open(p->args->log, NULL, iface, p->m->n_ifaces, &bus, err, sizeof(err))) {
		return cli_error(CLI_FAILED, p->name, "%s", err);
	}
	const int code = read_log(p, bus);

	bus->ops->close(bus);
	return code;
}

/* ---- the configuration ------------------------------------------------------------------------- */

/* As the configuration should name the database: alone if it lies beside it. */
static const char *path_from(const char *dbc, const char *out, char full[PATH_MAX])
{
	const char *slash = strrchr(dbc, '/'), *out_slash = strrchr(out, '/');
	const size_t dir = slash ? (size_t)(slash - dbc) + 1 : 0;
	const size_t out_dir = out_slash ? (size_t)(out_slash - out) + 1 : 0;

	if (strcmp(out, "-") != 0 && dir == out_dir && !strncmp(dbc, out, dir)) {
		return dbc + dir;
	}
	return realpath(dbc, full) ? full : dbc;
}

static int write_file(const struct map *p)
{
	const struct map_args *a = p->args;
	char full[PATH_MAX];
	FILE *out = strcmp(a->out, "-") ? fopen(a->out, a->force ? "w" : "wx") : stdout;

	if (!out) {
		return cli_error(CLI_FAILED, p->name, "%s: %s%s", a->out, strerror(errno),
				 errno == EEXIST ? "; --force writes over it" : "");
	}
	mapper_write(p->m, p->choice, path_from(a->dbc, a->out, full), a->iface ? a->iface : "can0",
		     out);
	return cli_close(p->name, a->out, out);
}

/* Would aebmcd take it? */
static int check_file(const struct map *p)
{
	struct config cfg;
	struct mapping *map;
	char err[512];

	if (!strcmp(p->args->out, "-") || !p->args->out[0]) {
		return 0;
	}
	if (config_load(p->args->out, NULL, 0, &cfg, &map, err, sizeof(err))) {
		return cli_error(CLI_FAILED, p->name, "%s", err);
	}
	config_mapping_free(map);
	fprintf(p->words, "\nwritten: %s; now aebmc inputs %s --config %s\n", p->args->out,
		p->args->log ? p->args->log : "LOG", p->args->out);
	return 0;
}

static int finish(const struct map *p)
{
	mapper_odd_counters(p->m, p->choice, p->words);
	if (p->open) {
		return cli_error(CLI_FAILED, p->name, "%d role%s not clear: decide with --role%s",
				 p->open, p->open > 1 ? "s are" : " is",
				 p->args->log ? "" : ", or give a LOG as well");
	}
	if (!p->args->out) {
		fprintf(p->words, "\n--out FILE writes the configuration\n");
		return 0;
	}
	const int code = write_file(p);

	return code ? code : check_file(p);
}

static int run(struct map *p)
{
	int code = map_check_roles(p);

	code = code || !p->args->log ? code : take_log(p);
	code = code ? code : map_decide(p);
	return code ? code : finish(p);
}

static int check_out(const char *name, const struct map_args *a)
{
	if (cli_same_file(a->dbc, -1, a->out) || cli_same_file(a->log, STDIN_FILENO, a->out)) {
		return cli_error(CLI_USAGE, name, "%s: is the input as well; write to another file",
				 a->out);
	}
	return a->log && !strcmp(a->log, "-")
		       ? cli_error(CLI_USAGE, name, "the log is read twice: give a file")
		       : 0;
}

int cmd_map(int argc, char **argv)
{
	struct map_args a = {0};
	struct map p = {.name = argv[0], .args = &a, .words = stdout};
	struct dbc *dbc;
	char err[512];
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : check_out(argv[0], &a);
	if (code) {
		return code;
	}
	if (dbc_load(a.dbc, &dbc, err, sizeof(err))) {
		return cli_error(CLI_FAILED, argv[0], "%s", err);
	}
	if (a.out && !strcmp(a.out, "-")) {
		p.words = fopen("/dev/null", "w");
	}
	code = !p.words || mapper_open(dbc, &p.m) ? cli_error(CLI_FAILED, argv[0], "out of memory")
						  : run(&p);
	mapper_close(p.m);
	dbc_free(dbc);
	if (p.words && p.words != stdout) {
		fclose(p.words);
	}
	return code;
}
