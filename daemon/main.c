/* SPDX-License-Identifier: MIT
 * aebmcd: the rooms opened in order, the loop, the rooms closed in reverse.
 * The only file of the daemon that prints errors and chooses an exit code.
 */
#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "args.h"
#include "bus.h"
#include "engine.h"
#include "config.h"
#include "live.h"
#include "mapping.h"
#include "pipeline.h"
#include "streams.h"

enum exit_code { EXIT_GOOD = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_CONFIG = 78 };

/* ---- instead of running ---- */

static int fail(int code, const char *what)
{
	fprintf(stderr, "aebmcd: %s\n", what);
	return code;
}

/* printed - did what was printed arrive? */
static int printed(void)
{
	return fflush(stdout) || ferror(stdout)
		       ? fail(EXIT_FAILED, "cannot write to standard output")
		       : EXIT_GOOD;
}

static int check_config(const struct args *a)
{
	struct config cfg;
	struct mapping *map;
	char err[1024];

	if (config_load(a->config, a->set, a->n_set, &cfg, &map, err, sizeof(err))) {
		return fail(EXIT_CONFIG, err);
	}
	printf("%s: good; %d targets in %d messages on %s; hash %016" PRIx64 "\n", a->config,
	       map->n_tracks, map->n_messages, cfg.bus_interfaces, config_hash(&cfg, map));
	config_mapping_free(map);
	return printed();
}

static int print_config(const struct args *a)
{
	struct config cfg;
	struct mapping *map = NULL;
	char err[1024];
	int rc = 0;

	config_defaults(&cfg);
	if (a->config) {
		rc = config_load(a->config, a->set, a->n_set, &cfg, &map, err, sizeof(err));
	}
	for (int i = 0; !a->config && !rc && i < a->n_set; i++) {
		rc = config_set(&cfg, a->set[i], err, sizeof(err));
	}
	if (rc) {
		return fail(EXIT_CONFIG, err);
	}
	config_print(&cfg, map, stdout);
	config_mapping_free(map);
	return printed();
}

static int print_options(const struct args *a)
{
	(void)a;
	config_print_options(stdout);
	return printed();
}

/* ---- running ---- */

struct daemon {
	const struct args *args;
	struct config cfg;
	struct mapping *map;
	struct bus *bus;
	struct mc *mc;
	enum publish_backend backend;
	struct pipeline *pipeline;
	const struct trace_ops *trace;
};

static int open_config(struct daemon *d, char *err, int err_len)
{
	return config_load(d->args->config, d->args->set, d->args->n_set, &d->cfg, &d->map, err,
			   err_len);
}

static void close_config(struct daemon *d)
{
	config_mapping_free(d->map);
}

static int open_bus(struct daemon *d, char *err, int err_len)
{
	const char *iface[BUS_IFACES_MAX];

	for (int i = 0; i < d->map->n_ifaces; i++) {
		iface[i] = d->map->iface[i];
	}
	return bus_log_open(d->args->log, d->args->out, iface, d->map->n_ifaces, &d->bus, err,
			    err_len);
}

static void close_bus(struct daemon *d)
{
	d->bus->ops->close(d->bus);
}

/* On a log the batches run inline: results must not depend on how fast this machine is. */
static int open_mc(struct daemon *d, char *err, int err_len)
{
	return engine_open(&d->cfg, MC_INLINE, &d->mc, &d->backend, err, err_len);
}

static void close_mc(struct daemon *d)
{
	mc_close(d->mc);
}

/* A short run is to be recorded from its first event on. */
static int open_trace(struct daemon *d, char *err, int err_len)
{
	return trace_load((enum trace_provider)d->cfg.trace_provider, 0, &d->trace, err, err_len);
}

static void close_trace(struct daemon *d)
{
	(void)d;
}

static int open_pipeline(struct daemon *d, char *err, int err_len)
{
	const struct pipeline_open o = {.cfg = &d->cfg,
					.map = d->map,
					.bus = d->bus,
					.mc = d->mc,
					.backend = d->backend,
					.trace = d->trace};
	int rc = pipeline_open(&o, &d->pipeline);

	if (rc) {
		snprintf(err, (size_t)err_len, "cannot open the pipeline: %s", strerror(-rc));
	}
	return rc;
}

static void close_pipeline(struct daemon *d)
{
	pipeline_close(d->pipeline);
}

/* Each needs those above it. */
static const struct room {
	int (*open)(struct daemon *d, char *err, int err_len);
	void (*close)(struct daemon *d);
	enum exit_code failed;
} rooms[] = {
	{open_config, close_config, EXIT_CONFIG},
	{open_bus, close_bus, EXIT_FAILED},
	{open_mc, close_mc, EXIT_FAILED},
	{open_trace, close_trace, EXIT_FAILED},
	{open_pipeline, close_pipeline, EXIT_FAILED},
};

#define ROOMS (int)(sizeof(rooms) / sizeof(rooms[0]))

static void report(const struct daemon *d)
{
	const struct pipeline_stats *p = pipeline_stats(d->pipeline);
	const uint64_t *entered = pipeline_decision(d->pipeline)->entered;

	fprintf(stderr,
		"aebmcd: %" PRIu64 " frames (%" PRIu64 " lines malformed), %" PRIu64
		" evaluations; %" PRIu64 " warnings, %" PRIu64 " partial, %" PRIu64
		" full requests\n",
		p->frames, d->bus->ops->stats(d->bus)->malformed, p->evaluations,
		entered[LEVEL_WARN], entered[LEVEL_PARTIAL], entered[LEVEL_FULL]);
}

static int fail_log(const char *path, const char *why)
{
	fprintf(stderr, "aebmcd: %s: %s\n", path, why);
	return EXIT_FAILED;
}

static int loop(struct daemon *d)
{
	int rc, lost;

	do {
		rc = pipeline_step(d->pipeline);
	} while (!rc);
	lost = bus_log_finish(d->bus);
	if (lost) {
		return fail_log(strcmp(d->args->out, "-") ? d->args->out : "standard output",
				strerror(-lost));
	}
	if (rc != -ENODATA) {
		return fail_log(d->args->log, strerror(-rc));
	}
	if (!pipeline_stats(d->pipeline)->frames) {
		return fail_log(d->args->log, "no frame on the configured interfaces");
	}
	report(d);
	return EXIT_GOOD;
}

static int run_log(const struct args *a)
{
	struct daemon d = {.args = a};
	char err[1024] = "";
	int code = EXIT_GOOD, n = 0;

	for (; n < ROOMS; n++) {
		if (rooms[n].open(&d, err, sizeof(err))) {
			code = fail(rooms[n].failed, err);
			break;
		}
	}
	if (n == ROOMS) {
		code = loop(&d);
	}
	while (n > 0) {
		rooms[--n].close(&d);
	}
	return code;
}

/* ---- running live ---- */

static int reload(void *arg, struct config *cfg, struct mapping **map, char *err, int err_len)
{
	const struct args *a = arg;

	return config_load(a->config, a->set, a->n_set, cfg, map, err, err_len);
}

static int run_live(const struct args *a)
{
	struct args copy = *a;
	struct config cfg;
	struct mapping *map;
	char err[1024] = "";
	int rc;

	if (config_load(a->config, a->set, a->n_set, &cfg, &map, err, sizeof(err))) {
		return fail(EXIT_CONFIG, err);
	}
	rc = live_run(&cfg, map, reload, &copy, err, sizeof(err));
	config_mapping_free(map);
	return rc ? fail(EXIT_FAILED, err) : EXIT_GOOD;
}

static int run(const struct args *a)
{
	return a->log ? run_log(a) : run_live(a);
}

int main(int argc, char **argv)
{
	static int (*const action[])(const struct args *) = {
		[ARGS_RUN] = run,
		[ARGS_CHECK_CONFIG] = check_config,
		[ARGS_PRINT_CONFIG] = print_config,
		[ARGS_PRINT_OPTIONS] = print_options,
	};
	struct args a;

	streams_ensure();
	signal(SIGPIPE,
	       SIG_IGN); /* a closed pipe is an error of the write, with a line and a code */
	return args_parse(argc, argv, &a) ? EXIT_USAGE : action[a.action](&a);
}
