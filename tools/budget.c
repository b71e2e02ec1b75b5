/* SPDX-License-Identifier: MIT
 * aebmc budget: how many samples fit the paper's time budgets on this device at p99.9, with the paper's kernel and with
 * the fast one. Kept in a file with the device, its clocks and the CUDA versions; the daemon compares.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "bench_scene.h"
#include "calibration.h"
#include "cli.h"
#include "clock.h"
#include "cmd.h"
#include "compute.h"
#include "mc_cuda.h"
#include "progress.h"
#include "sort.h"

#define RESIDENT (1u << 20)
#define TRIES    5
#define RUNS     1000 /* for p99.9 */
#define FEW      5    /* for the cost of a sample, and to try what was found */

static const double budget_ms[CALIBRATION_BUDGETS] = {CALIBRATION_MS};

static const struct kernel {
	const char *key, *words;
	enum mc_cuda_rung rung;
	uint32_t n_tail, n_small, n_large; /* for the spread; for a straight line */
} kernel_table[CALIBRATION_KERNELS] = {
	{"paper", "the paper's kernel, with copies", MC_CUDA_PAPER, 1u << 16, 1u << 20, 1u << 22},
	{"fast", "the fast rollout, statistics and impact", MC_CUDA_FAST, 1u << 26, 1u << 27,
	 1u << 29},
};

struct found {
	double overhead_ns, sample_ns, spread_ns; /* spread: p99.9 less median */
	uint32_t samples[CALIBRATION_BUDGETS];
	double tried_ms[CALIBRATION_BUDGETS]; /* the longest of a few batches of that many */
};

struct args {
	struct compute_args compute;
	const char *out;
	int64_t runs;
};

/* ---- arguments --------------------------------------------------------------------------------- */

enum { KEY_OUT = 0x100, KEY_RUNS };

static const struct argp_option options[] = {
	{"out", 'o', "FILE", 0, "keep the figures for the daemon's option mc.calibration", 1},
	{"runs", KEY_RUNS, "N", 0, "batches from which p99.9 is taken (1000)", 1},
	{0},
};
static const struct argp_child children[] = {{&compute_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->compute;
		return 0;
	case 'o':
		a->out = arg;
		return 0;
	case KEY_RUNS:
		return cli_count(st, "--runs", arg, 10, 100000, &a->runs);
	case ARGP_KEY_ARG:
		return cli_bad(st, "'%s': budget takes options alone", arg);
	case ARGP_KEY_END:
		return strcmp(a->compute.backend, "cuda")
			       ? cli_bad(st, "budget measures the backend cuda")
			       : 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {
	options,  parse, NULL, "How many samples fit 400, 530 and 800 ms at p99.9 on this GPU.",
	children, NULL,  NULL};

/* ---- measuring --------------------------------------------------------------------------------- */

/* Total times of @runs batches of @n, sorted [ns]. */
static int batches(struct mc_backend *b, const struct kernel *k, uint32_t n, uint32_t runs,
		   double *ns)
{
	struct mc_cuda_time *t = calloc(runs, sizeof(*t));
	struct mc_request req;
	int error = t ? 0 : -ENOMEM;

	bench_scene_paper(&req, n);
	req.flags |= MC_WANT_IMPACT;
	error = error ? error : mc_cuda_time(b, k->rung, &req, 1e-3, runs, t);
	for (uint32_t i = 0; i < runs && !error; i++) {
		ns[i] = t[i].total_ns;
	}
	sort_doubles(ns, runs);
	free(t);
	return error ? error : cli_interrupted() ? -EINTR : 0;
}

static uint32_t fits(const struct found *f, double ms)
{
	const double n = (ms * 1e6 - f->overhead_ns - f->spread_ns) / f->sample_ns;

	return n < 0 ? 0 : n < UINT32_MAX ? (uint32_t)n : UINT32_MAX;
}

/* The line is not quite straight: take fewer until a few batches stay within the budget. */
static int try_out(struct mc_backend *b, const struct kernel *k, double ms, double *ns, uint32_t *n,
		   double *longest_ms)
{
	int error = 0;

	for (int i = 0; i < TRIES && *n && !error; i++) {
		error = batches(b, k, *n, FEW, ns);
		*longest_ms = ns[FEW - 1] * 1e-6;
		if (*longest_ms <= ms) {
			break;
		}
		*n = (uint32_t)(*n * 0.995 * ms / *longest_ms);
	}
	return error;
}

static int measure(struct mc_backend *b, const struct kernel *k, uint32_t runs, double *ns,
		   struct found *f)
{
	double small_ns, large_ns;
	int error = batches(b, k, k->n_small, FEW, ns);

	small_ns = ns[FEW / 2];
	error = error ? error : batches(b, k, k->n_large, FEW, ns);
	large_ns = ns[FEW / 2];
	f->sample_ns = (large_ns - small_ns) / (double)(k->n_large - k->n_small);
	f->overhead_ns = fmax(small_ns - f->sample_ns * k->n_small, 0);
	error = error ? error : batches(b, k, k->n_tail, runs, ns);
	f->spread_ns = ns[(uint64_t)runs * 999 / 1000] - ns[runs / 2];
	for (int i = 0; i < CALIBRATION_BUDGETS && !error; i++) {
		f->samples[i] = fits(f, budget_ms[i]);
		error = try_out(b, k, budget_ms[i], ns, &f->samples[i], &f->tried_ms[i]);
	}
	return error;
}

static int measure_all(struct mc_backend *b, uint32_t runs, struct found f[CALIBRATION_KERNELS])
{
	struct progress line = progress_start("budget");
	double *ns = calloc(runs, sizeof(*ns));
	int error = ns ? 0 : -ENOMEM;

	cli_catch_interrupt();
	for (int k = 0; k < CALIBRATION_KERNELS && !error; k++) {
		progress_update(&line, (double)k / CALIBRATION_KERNELS, kernel_table[k].words);
		error = measure(b, &kernel_table[k], runs, ns, &f[k]);
	}
	progress_clear(&line);
	free(ns);
	return error;
}

/* ---- output ------------------------------------------------------------------------------------ */

static struct calibration to_keep(const struct mc_cuda_info *info, const struct found *f)
{
	struct calibration c = {.device = *info};

	for (int k = 0; k < CALIBRATION_KERNELS; k++) {
		for (int i = 0; i < CALIBRATION_BUDGETS; i++) {
			c.samples[k][i] = f[k].samples[i];
		}
	}
	return c;
}

static void write_json(const struct calibration *c, const struct found *f, uint32_t runs)
{
	struct json j = json_start(stdout);
	char key[48];

	json_head(&j, "budget");
	json_str(&j, "device", c->device.name);
	json_uint(&j, "clock_khz", (uint64_t)c->device.clock_khz);
	json_uint(&j, "memory_clock_khz", (uint64_t)c->device.memory_clock_khz);
	json_uint(&j, "cuda_driver", (uint64_t)c->device.driver);
	json_uint(&j, "cuda_runtime", (uint64_t)c->device.runtime);
	json_uint(&j, "runs", runs);
	for (int k = 0; k < CALIBRATION_KERNELS; k++) {
		json_open(&j, kernel_table[k].key, '{');
		json_num(&j, "sample_ns", f[k].sample_ns);
		json_num(&j, "overhead_ns", f[k].overhead_ns);
		json_num(&j, "p999_less_p50_ns", f[k].spread_ns);
		for (int i = 0; i < CALIBRATION_BUDGETS; i++) {
			snprintf(key, sizeof(key), "samples_%.0f_ms", budget_ms[i]);
			json_uint(&j, key, c->samples[k][i]);
			snprintf(key, sizeof(key), "longest_of_%d_for_%.0f_ms", FEW, budget_ms[i]);
			json_num(&j, key, f[k].tried_ms[i]);
		}
		json_close(&j, '}');
	}
	json_close(&j, '}');
}

static void print_words(const struct calibration *c, const struct found *f, uint32_t runs)
{
	printf("%s, %d MHz, memory %d MHz, CUDA driver %d, runtime %d\n"
	       "Samples that fit at p99.9 (%u batches), and the longest of %d batches of that "
	       "size, ms:\n\n%-42s",
	       c->device.name, c->device.clock_khz / 1000, c->device.memory_clock_khz / 1000,
	       c->device.driver, c->device.runtime, runs, FEW, "");
	for (int i = 0; i < CALIBRATION_BUDGETS; i++) {
		printf("      %5.0f ms          ", budget_ms[i]);
	}
	printf("  ns a sample\n");
	for (int k = 0; k < CALIBRATION_KERNELS; k++) {
		printf("%-42s", kernel_table[k].words);
		for (int i = 0; i < CALIBRATION_BUDGETS; i++) {
			printf(" %12u (%7.1f)", c->samples[k][i], f[k].tried_ms[i]);
		}
		printf(" %12.4f\n", f[k].sample_ns);
	}
}

static int keep(const char *name, const char *path, const struct calibration *c)
{
	FILE *f = cli_create(name, path);

	if (!f) {
		return CLI_FAILED;
	}
	calibration_write(c, f);
	return cli_close(name, path, f);
}

int cmd_budget(int argc, char **argv)
{
	struct args a = {compute_defaults(), NULL, RUNS};
	struct found f[CALIBRATION_KERNELS] = {{0}};
	struct mc_cuda_info info;
	const struct mc_ops *ops;
	struct mc_backend *b;
	const char *name = argv[0];

	a.compute.backend = "cuda";
	a.compute.params.n_resident = RESIDENT;
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : compute_open(name, &a.compute, &ops, &b);
	if (code) {
		return code;
	}
	int error = mc_cuda_info(&info);

	error = error ? error : measure_all(b, (uint32_t)a.runs, f);
	ops->close(b);
	if (error) {
		return cli_error(CLI_FAILED, name, "%s",
				 error == -EINTR ? "interrupted" : strerror(-error));
	}
	const struct calibration c = to_keep(&info, f);

	if (a.compute.json) {
		write_json(&c, f, (uint32_t)a.runs);
	} else {
		print_words(&c, f, (uint32_t)a.runs);
	}
	return a.out ? keep(name, a.out, &c) : CLI_GOOD;
}
