/* SPDX-License-Identifier: MIT
 * aebmc plot: pictures of what the other commands write. Which picture it is follows from the file.
 */
#include "plot.h"
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "cli.h"
#include "cmd.h"
#include "json_path.h"
#include "text.h"

/* The first kind of a schema, or of the beginning of a CSV file, is what is drawn if none is named. */
static const struct kind {
	const char *name, *schema;
	int (*draw)(const struct plot *p);
} kind_table[] = {
	{"risk", "aebmc.curve.1", plot_risk},
	{"distribution", "aebmc.curve.1", plot_distribution},
	{"time", "aebmc.bench.1", plot_time_cpu},
	{"speedup", "aebmc.bench.1", plot_speedup_cpu},
	{"time", "aebmc.bench-cuda.1", plot_time_cuda},
	{"speedup", "aebmc.bench-cuda.1", plot_speedup_cuda},
	{"budget", "aebmc.budget.1", plot_budget},
	{"converge", "aebmc.converge.1", plot_converge},
	{"risk", "headway_m,risk,", plot_risk_csv},
	{"timeline", "time_s,evaluation,", plot_timeline},
};
#define KINDS (sizeof(kind_table) / sizeof(kind_table[0]))

/* ---- arguments --------------------------------------------------------------------------------- */

enum { KEY_TITLE = 0x100, KEY_FROM, KEY_TO };

static const struct argp_option options[] = {
	{"out", 'o', "FILE", 0,
	 "picture.svg, or picture.png by rsvg-convert; - for SVG on standard output", 1},
	{"title", KEY_TITLE, "TEXT", 0, "another title", 1},
	{"from", KEY_FROM, "S", 0, "begin of a timeline", 1},
	{"to", KEY_TO, "S", 0, "end of a timeline", 1},
	{0},
};

struct args {
	struct plot plot;
	const char *word[2]; /* [KIND] FILE */
	int words;
};

static error_t check(const struct argp_state *st, const struct args *a)
{
	if (!a->words) {
		return cli_bad(st,
			       "which FILE? JSON of curve, bench, budget or converge, or CSV of "
			       "curve or replay; - for standard input");
	}
	if (!a->plot.out) {
		return cli_bad(st, "--out FILE is needed: picture.svg or picture.png");
	}
	return a->plot.from_s < a->plot.to_s ? 0 : cli_bad(st, "--from is not before --to");
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case 'o':
		a->plot.out = arg;
		return 0;
	case KEY_TITLE:
		a->plot.title = arg;
		return 0;
	case KEY_FROM:
		return cli_number(st, "--from", arg, 0, 1e9, &a->plot.from_s);
	case KEY_TO:
		return cli_number(st, "--to", arg, 0, 1e9, &a->plot.to_s);
	case ARGP_KEY_ARG:
		if (a->words == 2) {
			return cli_bad(st, "'%s': one FILE at a time", arg);
		}
		a->word[a->words++] = arg;
		return 0;
	case ARGP_KEY_END:
		return check(st, a);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 "[KIND] FILE",
				 "Draws what curve, bench, budget and converge write with --json, "
				 "or curve and replay with --csv. "
				 "KIND: risk, distribution, time, speedup, budget, converge or "
				 "timeline; without it the file's "
				 "first.",
				 NULL,
				 NULL,
				 NULL};

/* ---- the file ---------------------------------------------------------------------------------- */

int plot_bad(const struct plot *p, const char *fmt, ...)
{
	char words[512];
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(words, sizeof(words), fmt, ap);
	va_end(ap);
	return cli_error(CLI_FAILED, p->name, "%s: %s",
			 strcmp(p->path, "-") ? p->path : "standard input", words);
}

/* All of a file, with a NUL behind it. Returns 0 or -errno. */
static int read_all(FILE *f, char **ret, size_t *length)
{
	size_t size = 1 << 16, n = 0;
	char *text = malloc(size), *more = text;

	while (more && (n += fread(text + n, 1, size - 1 - n, f)) == size - 1) {
		size *= 2;
		more = realloc(text, size);
		text = more ? more : text;
	}
	if (!more || ferror(f)) {
		free(text);
		return more ? -errno : -ENOMEM;
	}
	text[n] = '\0';
	*ret = text;
	*length = n;
	return 0;
}

static int load(struct plot *p)
{
	FILE *f = strcmp(p->path, "-") ? fopen(p->path, "r") : stdin;
	size_t length = 0;
	int error = f ? 0 : -errno;

	errno = 0;
	error = error ? error : read_all(f, &p->text, &length);
	if (f && f != stdin) {
		fclose(f);
	}
	if (error) {
		return plot_bad(p, "%s", strerror(-error));
	}
	return strlen(p->text) == length ? 0 : plot_bad(p, "is no text");
}

/* ---- which picture ----------------------------------------------------------------------------- */

static int is_json(const struct plot *p)
{
	return p->text[strspn(p->text, " \t\r\n")] == '{';
}

/* The schema, or the beginning of the CSV's names. */
static int find_schema(const struct plot *p, char *schema, size_t size)
{
	*schema = '\0';
	if (!*p->text) {
		return plot_bad(p, "is empty");
	}
	if (is_json(p)) {
		if (!json_path_whole(p->text)) {
			return plot_bad(p, "is no whole JSON object: cut off?");
		}
		json_path_text(p->text, "schema", schema, size);
		return 0;
	}
	for (size_t i = 0; i < KINDS; i++) {
		if (!strncmp(p->text, kind_table[i].schema, strlen(kind_table[i].schema))) {
			snprintf(schema, size, "%s", kind_table[i].schema);
		}
	}
	return 0;
}

static int unknown(const struct plot *p, const char *kind, const char *schema)
{
	char have[128] = "";

	for (size_t i = 0; i < KINDS; i++) {
		if (!strcmp(schema, kind_table[i].schema)) {
			const size_t n = strlen(have);

			snprintf(have + n, sizeof(have) - n, "%s%s", n ? ", " : "",
				 kind_table[i].name);
		}
	}
	if (*have) {
		return plot_bad(p, "there is no picture '%s' of it, but %s", kind, have);
	}
	return plot_bad(
		p,
		"%s%s is nothing that plot draws: JSON of curve, bench, budget or converge, "
		"CSV of curve or replay",
		*schema ? "schema " : "this", schema);
}

static int draw(const struct plot *p, const char *kind)
{
	char schema[64];
	int code = find_schema(p, schema, sizeof(schema));

	if (code) {
		return code;
	}
	for (size_t i = 0; i < KINDS; i++) {
		const struct kind *k = &kind_table[i];

		if (!strcmp(schema, k->schema) && (!kind || !strcmp(kind, k->name))) {
			return k->draw(p);
		}
	}
	return unknown(p, kind, schema);
}

static int check_kind(const char *name, const char *kind)
{
	for (size_t i = 0; i < KINDS; i++) {
		if (!strcmp(kind, kind_table[i].name)) {
			return 0;
		}
	}
	return cli_error(CLI_USAGE, name, "KIND: '%s' is not known; nearest is '%s'", kind,
			 text_nearest(kind, &kind_table[0].name, KINDS, sizeof(kind_table[0])));
}

int cmd_plot(int argc, char **argv)
{
	struct args a = {.plot = {.name = argv[0], .from_s = -INFINITY, .to_s = INFINITY}};
	int code = cli_parse(&argp, argc, argv, &a);
	const char *kind = a.words == 2 ? a.word[0] : NULL;

	code = code || !kind ? code : check_kind(argv[0], kind);
	if (code) {
		return code;
	}
	a.plot.path = a.word[a.words - 1];
	if (cli_same_file(a.plot.path, STDIN_FILENO, a.plot.out)) {
		return cli_error(CLI_USAGE, argv[0],
				 "%s: is the input as well; write to another file", a.plot.path);
	}
	code = load(&a.plot);
	code = code ? code : draw(&a.plot, kind);
	free(a.plot.text);
	return code;
}
