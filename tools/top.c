/* SPDX-License-Identifier: MIT
 * aebmc top: what a running aebmcd sees and does, from its status socket. A screen on a terminal, else a line a second.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include "ask.h"
#include "cli.h"
#include "cmd.h"
#include "json_path.h"

#define SCREEN_MS 250
#define LINES_MS  1000
#define TEXT_MAX  64

struct top_row {
	const char *label, *path, *unit;
};

static const struct top_row rows[] = {
#define TOP(label, path, unit) {label, path, unit},
#include "top.def"
#undef TOP
};
#define ROWS (sizeof(rows) / sizeof(rows[0]))

/* Of the plain line; without a label the unit says what it is. */
static const struct top_row line_rows[] = {
	{"", "state", ""},
	{"", "level", ""},
	{"ego", "scene.ego_speed_mps", "m/s"},
	{"headway", "scene.headway_m", "m"},
	{"P(defer)", "risk.defer.p", ""},
	{"mc", "last_ms.mc", "ms"},
	{"", "counters.evaluations", "evaluations"},
	{"", "counters.period_misses", "missed periods"},
	{"", "counters.stage_misses", "missed stages"},
	{"", "counters.skipped_scans", "skipped scans"},
};
#define LINE_ROWS (sizeof(line_rows) / sizeof(line_rows[0]))

/* Of a controller; a virtual interface has none. */
static const struct top_row link_rows[] = {
	{"", "links.0.state", ""},
	{"tx", "links.0.tx_errors", "errors"},
	{"rx", "links.0.rx_errors", "errors"},
	{"", "links.0.bitrate", "bit/s"},
	{"sample point", "links.0.sample_point", ""},
	{"restart", "links.0.restart_ms", "ms"},
};
#define LINK_ROWS (sizeof(link_rows) / sizeof(link_rows[0]))

struct args {
	struct ask_args ask;
	int once, json;
};

enum { KEY_ONCE = 0x100, KEY_JSON };

static const struct argp_option options[] = {
	{"once", KEY_ONCE, NULL, 0, "show it once and end", 1},
	{"json", KEY_JSON, NULL, 0, "the daemon's own JSON, one object a line", 1},
	{0},
};
static const struct argp_child children[] = {{&ask_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	(void)arg;
	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->ask;
		return 0;
	case KEY_ONCE:
		a->once = 1;
		return 0;
	case KEY_JSON:
		a->json = 1;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {
	options,  parse, "[NAME]", "Shows what aebmcd@NAME sees and does, until Ctrl-C.",
	children, NULL,  NULL};

/* ---- one status -------------------------------------------------------------------------------- */

/* What is not known is a dash; figures are cut to what can be read at a glance. */
static const char *value_of(const char *status, const char *path, char text[TEXT_MAX])
{
	char *end;
	double v;

	if (json_path_text(status, path, text, TEXT_MAX) || !text[0]) {
		return "-";
	}
	v = strtod(text, &end);
	if (!*end && strpbrk(text, ".e")) {
		snprintf(text, TEXT_MAX, "%.4g", v);
	}
	return text;
}

static void show_list(const char *status, const char *path)
{
	char at[TEXT_MAX], text[TEXT_MAX];

	for (int i = 0;; i++) {
		snprintf(at, sizeof(at), "%s.%d", path, i);
		if (json_path_text(status, at, text, sizeof(text))) {
			return;
		}
		printf("%s%s", i ? ", " : "", text);
	}
}

static int show_link(const char *status, int i)
{
	char path[TEXT_MAX], text[TEXT_MAX];

	snprintf(path, sizeof(path), "links.%d.name", i);
	if (json_path_text(status, path, text, sizeof(text))) {
		return 0;
	}
	printf("%-12s", text);
	snprintf(path, sizeof(path), "links.%d.up", i);
	printf(" %s", strcmp(value_of(status, path, text), "true") ? "down" : "up");
	snprintf(path, sizeof(path), "links.%d.known", i);
	const int known = !strcmp(value_of(status, path, text), "true");

	for (size_t k = 0; known && k < LINK_ROWS; k++) {
		snprintf(path, sizeof(path), "links.%d.%s", i,
			 link_rows[k].path + strlen("links.0."));
		printf(", %s%s%s %s", link_rows[k].label, link_rows[k].label[0] ? " " : "",
		       value_of(status, path, text), link_rows[k].unit);
	}
	putchar('\n');
	return 1;
}

static void show_block(const char *status)
{
	char text[TEXT_MAX];

	for (size_t i = 0; i < ROWS; i++) {
		const struct top_row *r = &rows[i];

		if (r->label[0]) {
			printf("%s%-12s", i ? "\n" : "", r->label);
		}
		printf(" %s %s", value_of(status, r->path, text), r->unit);
	}
	printf("\n%-12s ", "reasons");
	show_list(status, "reasons");
	putchar('\n');
	for (int i = 0; show_link(status, i);) {
		i++;
	}
}

static void show_line(const char *status)
{
	char text[TEXT_MAX];

	for (size_t i = 0; i < LINE_ROWS; i++) {
		const struct top_row *r = &line_rows[i];

		printf("%s%s%s%s%s%s", i ? ", " : "", r->label, r->label[0] ? " " : "",
		       value_of(status, r->path, text), r->unit[0] ? " " : "", r->unit);
	}
	fputs("; ", stdout);
	show_list(status, "reasons");
	putchar('\n');
}

static void show(const struct args *a, const char *status)
{
	const int screen = isatty(STDOUT_FILENO);

	if (a->json) {
		puts(status);
	} else if (a->once) {
		show_block(status);
	} else if (screen) {
		fputs("\033[H\033[J", stdout); /* home, clear to the end */
		show_block(status);
	} else {
		show_line(status);
	}
	fflush(stdout);
}

/* ---- until Ctrl-C ------------------------------------------------------------------------------ */

static void pause_ms(long ms)
{
	const struct timespec t = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000};

	nanosleep(&t, NULL);
}

static int watch(const char *who, const struct args *args, struct ask *a)
{
	const long wait_ms = isatty(STDOUT_FILENO) && !args->json ? SCREEN_MS : LINES_MS;
	int code = 0;

	cli_catch_interrupt();
	do {
		code = ask(who, a, "status");
		if (!code) {
			show(args, a->reply);
		}
		code = code || ferror(stdout);
		if (!code && !args->once) {
			pause_ms(wait_ms);
		}
	} while (!code && !args->once && !cli_interrupted());
	return code;
}

int cmd_top(int argc, char **argv)
{
	struct args args = {0};
	struct ask a;
	int code = cli_parse(&argp, argc, argv, &args);

	code = code ? code : ask_open(argv[0], &args.ask, &a);
	if (code) {
		return code;
	}
	code = watch(argv[0], &args, &a);
	ask_close(&a);
	return code;
}
