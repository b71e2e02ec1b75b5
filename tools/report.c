/* SPDX-License-Identifier: MIT
 * aebmc report: where the time went, what was missed, what happened around it, from a trace of aebmcd.
 */
#include "report.h"
#include <errno.h>
#include <string.h>
#include "cli.h"
#include "cmd.h"

struct args {
	const char *dir, *html;
	int json;
	int64_t pid;
};

enum { KEY_HTML = 0x100, KEY_JSON, KEY_PID };

static const struct argp_option options[] = {
	{"html", KEY_HTML, "FILE", 0, "one page with pictures, needs nothing else", 1},
	{"json", KEY_JSON, NULL, 0, "the figures, every miss and evaluation as JSON", 1},
	{"pid", KEY_PID, "N", 0, "of several processes at once, this one alone", 1},
	{0},
};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case KEY_HTML:
		a->html = arg;
		return 0;
	case KEY_JSON:
		a->json = 1;
		return 0;
	case KEY_PID:
		return cli_count(st, "--pid", arg, 1, INT32_MAX, &a->pid);
	case ARGP_KEY_ARG:
		if (a->dir) {
			return cli_bad(st, "one trace at a time: '%s' is one too many", arg);
		}
		a->dir = arg;
		return 0;
	case ARGP_KEY_END:
		return a->dir ? 0 : cli_bad(st, "which trace? A folder that aebmc trace wrote");
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 "TRACE-DIR",
				 "Where the time of each evaluation went, which deadlines were "
				 "missed and how they cluster, and the "
				 "worst cycles, from what aebmc trace recorded.",
				 NULL,
				 NULL,
				 NULL};

/* Which processes there are, if one has to be chosen or the chosen one is none of them. */
static int check_process(const char *who, const char *dir, const struct report *r)
{
	char words[512] = "";
	int known = !r->pid;

	for (size_t i = 0; i < r->n_processes; i++) {
		const struct report_process *p = &r->process[i];
		const size_t n = strlen(words);

		snprintf(words + n, sizeof(words) - n, "%s%lld (%llu evaluations)", n ? ", " : "",
			 (long long)p->pid, (unsigned long long)p->evaluations);
		known |= p->pid == r->pid;
	}
	if (!known) {
		return cli_error(CLI_FAILED, who, "%s: no process %lld in this trace, but %s", dir,
				 (long long)r->pid, words);
	}
	return report_mixed(r) ? cli_error(CLI_FAILED, who,
					   "%s: several processes in one trace, %s: choose one "
					   "with --pid",
					   dir, words)
			       : 0;
}

static int read_trace(const char *who, const char *dir, struct report *r)
{
	char err[1200];
	const int status = ctf_read(dir, report_event, r, &r->lost, err, sizeof(err));

	if (status) {
		return cli_error(status == -ENOTSUP ? CLI_SKIPPED : CLI_FAILED, who, "%s",
				 status == -ENOMEM ? "out of memory" : err);
	}
	const int code = check_process(who, dir, r);

	if (code) {
		return code;
	}
	if (!r->clocks) {
		return cli_error(
			CLI_FAILED, who,
			"%s: no aebmcd in this trace (%llu events, none of both clocks): was it "
			"running with trace.provider = lttng?",
			dir, (unsigned long long)r->events);
	}
	return report_figures(r) ? cli_error(CLI_FAILED, who, "out of memory") : 0;
}

static int write_html(const char *who, const struct args *a, const struct report *r)
{
	FILE *out = a->html ? cli_create(who, a->html) : NULL;

	if (a->html && !out) {
		return CLI_FAILED;
	}
	if (!out) {
		return 0;
	}
	report_html(r, a->dir, out);
	return cli_close(who, a->html, out);
}

int cmd_report(int argc, char **argv)
{
	struct args a = {0};
	int code = cli_parse(&argp, argc, argv, &a);
	struct report r = {.pid = a.pid};

	code = code ? code : read_trace(argv[0], a.dir, &r);
	code = code ? code : write_html(argv[0], &a, &r);
	if (!code) {
		(a.json ? report_json : report_show)(&r, a.dir, stdout);
	}
	report_free(&r);
	return code;
}
