/* SPDX-License-Identifier: MIT
 * aebmc trace: an LTTng session with the options that leave real-time threads alone, always recording or keeping a flight
 * recorder for the moment of a miss; and what one event costs here.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include "cli.h"
#include "clock.h"
#include "cmd.h"
#include "hist.h"
#include "sort.h"
#include "trace.h"

#define SESSION   "aebmc"
#define WORDS_MAX 24
#define COST_N    1000000

enum what { START, STOP, ON_MISS, COST, WHATS };
static const char *const what_name[WHATS] = {"start", "stop", "on-miss", "cost"};

struct args {
	int what; /* -1: not said */
	const char *out;
};

enum { KEY_OUT = 0x100 };

static const struct argp_option options[] = {
	{"out", KEY_OUT, "DIR", 0, "where to write (start, on-miss); default aebmc-trace here", 1},
	{0},
};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;
	size_t which;

	switch (key) {
	case KEY_OUT:
		a->out = arg;
		return 0;
	case ARGP_KEY_ARG:
		if (a->what >= 0) {
			return cli_bad(
				st, "one of start, stop, on-miss, cost: '%s' is one too many", arg);
		}
		if (cli_choice(st, "trace", arg, what_name, WHATS, &which)) {
			return EINVAL;
		}
		a->what = (int)which;
		return 0;
	case ARGP_KEY_END:
		return a->what >= 0 ? 0 : cli_bad(st, "which of start, stop, on-miss, cost?");
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {
	options,
	parse,
	"start|stop|on-miss|cost",
	"Records what every running aebmcd with trace.provider = lttng does.\v"
	"start     record everything until stop\n"
	"on-miss   keep the latest half minute in memory; one second after a missed deadline, at "
	"most once in ten, save "
	"it as a snapshot\n"
	"stop      end either\n"
	"cost      what one event costs on this machine, with and without a session\n\n"
	"The trace is a folder for aebmc report. Needs lttng-tools; run it as root, or in group "
	"tracing, to reach a "
	"daemon of another user.",
	NULL,
	NULL,
	NULL};

/* ---- lttng ------------------------------------------------------------------------------------------------- */

/* One command of lttng; its own words go to standard error. An exit code, after one line; @quiet: without a word. */
static int lttng(const char *who, int quiet, const char *const *word)
{
	char *argv[WORDS_MAX] = {(char *)"lttng"};
	int status, n = 1;
	pid_t pid;

	for (; word[n - 1] && n < WORDS_MAX - 1; n++) {
		argv[n] = (char *)word[n - 1];
	}
	pid = fork();
	if (pid == 0) {
		dup2(STDERR_FILENO, STDOUT_FILENO);
		if (quiet) {
			close(STDERR_FILENO);
			close(STDOUT_FILENO);
		}
		execvp(argv[0], argv);
		_exit(errno == ENOENT ? 127 : 126);
	}
	if (pid < 0 || waitpid(pid, &status, 0) < 0) {
		return cli_error(CLI_FAILED, who, "lttng: %s", strerror(errno));
	}
	if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {
		return cli_error(CLI_SKIPPED, who,
				 "there is no lttng: apt-get install lttng-tools");
	}
	if (WIFEXITED(status) && !WEXITSTATUS(status)) {
		return 0;
	}
	return quiet ? CLI_FAILED
		     : cli_error(CLI_FAILED, who, "lttng %s failed, see above", word[0]);
}

/* Read and switch timers wake nobody in the traced threads; a full buffer overwrites its oldest part and never blocks. */
static int record(const char *who, const char *out, int snapshot)
{
	const char *const list[] = {"list", SESSION, NULL};
	const char *const destroy[] = {"destroy", "--no-wait", SESSION, NULL};
	char output[4096];
	const char *const command[][WORDS_MAX] = {
		{"create", SESSION, output, snapshot ? "--snapshot" : NULL, NULL},
		{"enable-channel", "--userspace", "--session=" SESSION, "--subbuf-size=1M",
		 "--num-subbuf=4", "--overwrite", "--switch-timer=0", "--read-timer=200000",
		 SESSION, NULL},
		{"add-context", "--userspace", "--session=" SESSION, "--channel=" SESSION,
		 "--type=vpid", NULL},
		{"enable-event", "--userspace", "--session=" SESSION, "--channel=" SESSION,
		 "aebmc:*", NULL},
		{"start", SESSION, NULL},
		{snapshot ? "add-trigger" : NULL, "--name=" SESSION,
		 "--condition=event-rule-matches", "--type=user:tracepoint",
		 "--name=aebmc:deadline_miss", "--action=snapshot-session", SESSION, NULL},
	};
	int code = lttng(who, 1, list);

	if (code == CLI_SKIPPED || !code) {
		return code ? code
			    : cli_error(CLI_FAILED, who,
					"recording already: end that with aebmc trace stop");
	}
	code = 0;
	snprintf(output, sizeof(output), "--output=%s", out);
	for (size_t i = 0; !code && i < sizeof(command) / sizeof(command[0]); i++) {
		code = command[i][0] ? lttng(who, 0, command[i]) : 0;
	}
	if (code) {
		lttng(who, 1, destroy);
	}
	return code;
}

static int begin(const char *who, const struct args *a)
{
	char *out = a->out && a->out[0] == '/' ? strdup(a->out) : NULL, here[2048];

	if (!out && (!getcwd(here, sizeof(here)) ||
		     asprintf(&out, "%s/%s", here, a->out ? a->out : "aebmc-trace") < 0)) {
		return cli_error(CLI_FAILED, who, "this folder: %s", strerror(errno));
	}
	/* a snapshot is written when nobody looks: whether it can be shows now */
	const int nowhere = a->what == ON_MISS && mkdir(out, 0770) && errno != EEXIST;
	const int code = nowhere ? cli_error(CLI_FAILED, who, "%s: %s", out, strerror(errno))
				 : record(who, out, a->what == ON_MISS);

	if (!code) {
		printf("%s into %s; end it with aebmc trace stop, read it with aebmc report %s\n",
		       a->what == ON_MISS ? "a snapshot at each missed deadline" : "recording", out,
		       out);
	}
	free(out);
	return code;
}

static int end(const char *who)
{
	const char *const trigger[] = {"remove-trigger", SESSION, NULL};
	const char *const destroy[] = {"destroy", SESSION, NULL};
	const int code = lttng(who, 1, trigger);

	return code == CLI_SKIPPED ? code : lttng(who, 0, destroy);
}

/* ---- cost -------------------------------------------------------------------------------------------------- */

/* @ns: [COST_N], sorted */
static void fire(const struct trace_ops *ops, int64_t *ns)
{
	for (uint64_t i = 0; i < COST_N; i++) {
		const int64_t from_ns = clock_now_ns();

		TRACE(ops, edge, i, EDGE_SCENE, from_ns);
		ns[i] = clock_now_ns() - from_ns;
	}
	sort_times(ns, COST_N);
}

static long long at(const int64_t *ns, double q)
{
	return (long long)ns[hist_rank(COST_N, q) - 1];
}

/* In one go, so that reading the clock does not count. */
static double mean_ns(const struct trace_ops *ops)
{
	const int64_t from_ns = clock_now_ns();

	for (uint64_t i = 1; i <= COST_N; i++) {
		TRACE(ops, edge, i, EDGE_SCENE, from_ns);
	}
	return (double)(clock_now_ns() - from_ns) / COST_N;
}

static int cost(const char *who)
{
	int64_t *ns = calloc(COST_N, sizeof(*ns));
	const struct trace_ops *ops;
	char err[512];

	if (!ns || trace_load(TRACE_LTTNG, 0, &ops, err, sizeof(err))) {
		free(ns);
		return cli_error(CLI_SKIPPED, who, "%s", ns ? err : "out of memory");
	}
	TRACE(ops, thread);
	fire(NULL, ns);
	printf("no event, clock read twice: p50 %lld ns\n", at(ns, 0.5));
	fire(ops, ns);
	printf("one event, clock read twice: p50 %lld, p99 %lld, p99.9 %lld, longest of %d %lld "
	       "ns\n",
	       at(ns, 0.5), at(ns, 0.99), at(ns, 0.999), COST_N, at(ns, 1));
	printf("%d events in a row: %.1f ns each\n", COST_N, mean_ns(ops));
	free(ns);
	return 0;
}

int cmd_trace(int argc, char **argv)
{
	struct args a = {.what = -1};
	const int code = cli_parse(&argp, argc, argv, &a);

	if (code) {
		return code;
	}
	switch (a.what) {
	case STOP:
		return end(argv[0]);
	case COST:
		return cost(argv[0]);
	default:
		return begin(argv[0], &a);
	}
}
