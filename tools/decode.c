/* SPDX-License-Identifier: MIT
 * aebmc decode: our frames of a candump log in words, whatever interface they came on.
 */
#include <errno.h>
#include <string.h>
#include "cli.h"
#include "clock.h"
#include "cmd.h"
#include "json.h"
#include "publish.h"
#include "setup.h"

#define LINE_MAX_BYTES 256 /* a candump line has at most 200 */
#define WORDS_MAX      512

struct args {
	struct setup setup;
	const char *log;
	int json;
};

struct counts {
	uint64_t ours, bad, others, malformed;
};

enum { KEY_JSON = 0x100 };

static const struct argp_option options[] = {
	{"json", KEY_JSON, NULL, 0, "one JSON object on standard output", 1},
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
	case ARGP_KEY_ARG:
		if (a->log) {
			return cli_bad(st, "'%s': one LOG at a time", arg);
		}
		a->log = arg;
		return 0;
	case ARGP_KEY_END:
		return a->log ? 0 : cli_bad(st, "which LOG? a file, or - for standard input");
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 "LOG",
				 "Our frames of a candump log in words. The configuration matters "
				 "only where it moves their identifiers.",
				 children,
				 NULL,
				 NULL};

/* One line without its end; what is too long is cut, which no frame survives. 0 at the end. */
static int next_line(FILE *in, char line[LINE_MAX_BYTES])
{
	size_t n = 0;
	int c;

	while ((c = getc(in)) != EOF && c != '\n') {
		if (n < LINE_MAX_BYTES - 1) {
			line[n++] = (char)(c ? c : '?');
		}
	}
	line[n] = '\0';
	return c != EOF || n > 0;
}

static void emit(struct json *j, const struct bus_frame *f, const char *iface, const char *words,
		 int good)
{
	double time_s = (double)f->t_ns / CLOCK_NS_PER_S;

	if (!j) {
		printf("%.6f  %s  %s\n", time_s, iface, words);
		return;
	}
	json_open(j, NULL, '{');
	json_num(j, "time_s", time_s);
	json_str(j, "interface", iface);
	json_uint(j, "id", f->id & BUS_ID_MASK);
	json_bool(j, "good", good);
	json_str(j, "words", words);
	json_close(j, '}');
}

static void decode_line(const struct publish *p, const char *line, struct json *j, struct counts *n)
{
	char iface[BUS_NAME_MAX], words[WORDS_MAX];
	struct bus_frame f;
	int error = bus_log_parse(line, iface, &f);

	if (error) {
		n->malformed += error == -EBADMSG;
		return;
	}
	error = publish_words(p, &f, words, sizeof(words));
	if (error == -ENOMSG) {
		n->others++;
		return;
	}
	n->ours++;
	n->bad += error == -EBADMSG;
	emit(j, &f, iface, words, !error);
}

static void decode(FILE *in, const struct publish *p, struct json *j, struct counts *n)
{
	char line[LINE_MAX_BYTES];

	cli_catch_interrupt();
	while (!cli_interrupted() && !ferror(stdout) && next_line(in, line)) {
		decode_line(p, line, j, n);
	}
}

static void decode_json(FILE *in, const struct publish *p, struct counts *n)
{
	struct json j = json_start(stdout);

	json_head(&j, "decode");
	json_open(&j, "frames", '[');
	decode(in, p, &j, n);
	json_close(&j, ']');
	json_uint(&j, "ours", n->ours);
	json_uint(&j, "bad", n->bad);
	json_uint(&j, "others", n->others);
	json_uint(&j, "malformed_lines", n->malformed);
	json_bool(&j, "interrupted", cli_interrupted());
	json_close(&j, '}');
}

static int is_packed(const char *path)
{
	size_t n = strlen(path);

	return n > 3 && !strcmp(path + n - 3, ".xz");
}

static int run(const char *name, const struct args *a, const struct publish *p, FILE *in)
{
	struct counts n = {0};

	if (a->json) {
		decode_json(in, p, &n);
	} else {
		decode(in, p, NULL, &n);
	}
	if (cli_interrupted()) {
		return cli_error(CLI_FAILED, name, "interrupted");
	}
	if (ferror(in)) {
		return cli_error(CLI_FAILED, name, "%s: %s", a->log, strerror(errno));
	}
	return n.ours ? CLI_GOOD
		      : cli_error(CLI_FAILED, name, "%s: none of %llu frames is ours%s", a->log,
				  (unsigned long long)n.others,
				  is_packed(a->log)
					  ? "; unpack it first: xz -dc LOG.xz | aebmc decode -"
					  : "");
}

int cmd_decode(int argc, char **argv)
{
	struct args a = {0};
	struct config cfg;
	struct publish *p;
	const char *name = argv[0];
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : setup_load(name, &a.setup, &cfg, NULL);
	if (code) {
		return code;
	}
	FILE *in = strcmp(a.log, "-") ? fopen(a.log, "r") : stdin;

	if (!in) {
		return cli_error(CLI_FAILED, name, "%s: %s", a.log, strerror(errno));
	}
	int error = publish_open(&cfg, &p);

	if (error) {
		code = cli_error(CLI_FAILED, name, "%s", strerror(-error));
	} else {
		code = run(name, &a, p, in);
		publish_close(p);
	}
	fclose(in);
	return code;
}
