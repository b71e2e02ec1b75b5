/* SPDX-License-Identifier: MIT
 * aebmc scenario: a suite of closed loops, the daemon's pipeline against cars, sensors and drivers, in virtual time.
 */
#include "scenario.h"
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "cli.h"
#include "cmd.h"
#include "engine.h"
#include "scenario_compare.h"
#include "scenario_live.h"
#include "scenario_report.h"
#include "scenario_work.h"

static int list(const struct scenario_work *w)
{
	scenario_list(stdout, w->args->json, &w->plan);
	return CLI_GOOD;
}

static int report(const struct scenario_work *w)
{
	const struct scenario_sum sum = scenario_sum_of(&w->plan, w->result);
	const int failed = sum.all.failed && !w->plan.suite->stated && !w->plan.rule;

	if (w->args->json) {
		scenario_json(stdout, &w->plan, w->result);
	} else if (w->args->words) {
		scenario_words(stdout, &w->plan, w->result);
	}
	return failed ? CLI_FAILED : CLI_GOOD;
}

/* Files are opened before the runs: what cannot be written is said at once. */
struct files {
	FILE *csv, *html;
};

static int open_files(const struct scenario_work *w, struct files *f)
{
	const struct scenario_args *a = w->args;

	f->csv = a->csv ? cli_create(w->name, a->csv) : NULL;
	f->html = a->html ? cli_create(w->name, a->html) : NULL;
	return (a->csv && !f->csv) || (a->html && !f->html) ? CLI_FAILED : 0;
}

/* No file is better than one without a figure in it. */
static int discard(const char *name, const char *path, FILE *f)
{
	struct stat st;
	const int is_file = f != stdout && !fstat(fileno(f), &st) && S_ISREG(st.st_mode);
	const int code = cli_close(name, path, f);

	if (is_file) {
		unlink(path);
	}
	return code;
}

static int discard_files(const struct scenario_work *w, const struct files *f)
{
	int code = f->csv ? discard(w->name, w->args->csv, f->csv) : 0;

	code |= f->html ? discard(w->name, w->args->html, f->html) : 0;
	return code;
}

static int write_files(const struct scenario_work *w, const struct files *f)
{
	int code = 0;

	if (f->csv) {
		scenario_csv(f->csv, &w->plan, w->result);
		code = cli_close(w->name, w->args->csv, f->csv);
	}
	if (f->html) {
		const int error = scenario_html(f->html, &w->plan, w->result);
		const int closing = cli_close(w->name, w->args->html, f->html);

		code = error ? cli_error(CLI_FAILED, w->name, "%s", strerror(-error)) : code;
		code = code ? code : closing;
	}
	return code;
}

static int suite(struct scenario_work *w)
{
	struct files f;
	int code = open_files(w, &f);

	if (!code) {
		code = w->args->live ? scenario_live(&w->plan, w->result)
				     : scenario_pool(&w->plan, w->result);
	}

	const int closing = code ? discard_files(w, &f) : write_files(w, &f);

	code = code ? code : report(w);
	return closing ? closing : code;
}

static int log_run(struct scenario_work *w)
{
	const struct config *cfg = &w->told[0];
	const struct scenario_draw d =
		scenario_draw(&w->cfg, w->row, w->plan.seed, (int)w->args->car);
	struct scenario_bench b = {.cfg = cfg, .map = w->map};
	enum publish_backend which;
	struct scenario_result r;
	int code = CLI_FAILED;
	char err[256];

	if (engine_open(cfg, MC_INLINE, &b.mc, &which, err, sizeof(err))) {
		return cli_error(CLI_FAILED, w->name, "%s", err);
	}
	b.log = cli_create(w->name, w->args->out);
	if (b.log) {
		const int error = scenario_run(&b, w->row, &d, &r);

		code = cli_close(w->name, w->args->out, b.log);
		code = error && !code ? cli_error(CLI_FAILED, w->name, "%s", strerror(-error))
				      : code;
	}
	mc_close(b.mc);
	return code;
}

int cmd_scenario(int argc, char **argv)
{
	struct scenario_args a;
	struct scenario_work w = {.name = argv[0], .args = &a};
	int code = scenario_args(argc, argv, &a);

	code = code ? code : scenario_work_open(&w);
	if (!code) {
		cli_catch_interrupt();
		code = a.list      ? list(&w)
		       : a.log_run ? log_run(&w)
		       : a.compare ? scenario_compare(stdout, a.json, &w.plan, w.result)
				   : suite(&w);
	}
	scenario_work_close(&w);
	return code;
}
