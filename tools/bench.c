/* SPDX-License-Identifier: MIT
 * aebmc bench: nanoseconds per sample of mc_ops.run, the function that the daemon calls, beside the f64 RK4 reference
 * with 1 ms steps and beside a plain C loop of the same (plain.c). One thread; all measured in turns, so that a noisy
 * machine hits them alike; minima are compared.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "compute.h"
#include "bench_cuda.h"
#include "bench_scene.h"
#include "bench_time.h"
#include "cli.h"
#include "clock.h"
#include "cmd.h"
#include "plain.h"
#include "progress.h"
#include "sort.h"
#include "sample.h"
#include "draws.h"

#define REF_SAMPLES 64 /* of the reference and of the plain loop, a turn */
#define ROUNDS      120
#define SIZES_REPS  5     /* of each number of samples in the figure */
#define SAMPLES     16384 /* what the daemon uses on a CPU */
#define EVALUATION  12288 /* samples of the batch with all perception effects */

struct args {
	struct compute_args compute;
	int64_t samples, rounds;
};

/* What is timed. */
enum timed { REFERENCE, PLAIN, MOVING_REFERENCE, PAPER, MOVING, FUTURES_4, PERCEPTION, TIMED };
static const char *const timed_key[TIMED] = {"reference", "plain_loop", "moving_reference", "paper",
					     "moving",    "futures",    "perception"};
static const char *const timed_words[TIMED] = {
	"f64 RK4 reference, 1 ms, paper's scene",
	"plain C loop of the same",
	"f64 RK4 reference, 1 ms, moving lead",
	"paper's scene, with statistics",
	"moving lead, with statistics and impact speed",
	"moving lead, all four futures, everything",
	"the same with all perception effects",
};

struct bench {
	const struct mc_ops *ops;
	struct mc_backend *b;
	struct mc_request paper, moving, futures, perception;
	float in[MODEL_INPUTS *
		 REF_SAMPLES]; /* [MODEL_INPUTS][REF_SAMPLES], the paper scene's first */
	struct model_out ref[REF_SAMPLES], plain[REF_SAMPLES], out[REF_SAMPLES * MC_FUTURES_MAX];
	double *ns[TIMED]; /* per sample, [rounds] */
	uint32_t rounds;
	struct bench_timing size[BENCH_SIZES_CPU]; /* with --json alone */
	double p_moving, p_futures[MC_FUTURES_MAX];
};

/* ---- arguments --------------------------------------------------------------------------------- */

enum { KEY_ROUNDS = 0x100 };

static const struct argp_option options[] = {
	{"samples", 'n', "N", 0, "samples of a batch (16384, as in the daemon)", 1},
	{"rounds", KEY_ROUNDS, "N", 0, "turns of each measurement (120)", 1},
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
	case 'n':
		return cli_count(st, "--samples", arg, 1, 1u << 24, &a->samples);
	case KEY_ROUNDS:
		return cli_count(st, "--rounds", arg, 1, 100000, &a->rounds);
	case ARGP_KEY_ARG:
		return cli_bad(st, "'%s': bench takes options alone", arg);
	case ARGP_KEY_END:
		return a->compute.params.threads == 1 ? 0 : cli_bad(st, "bench times one thread");
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 NULL,
				 "Nanoseconds per sample of the function that the daemon calls, "
				 "beside the 1 ms reference, one thread.",
				 children,
				 NULL,
				 NULL};

/* ---- the scenes -------------------------------------------------------------------------------- */

static int scenes(struct bench *b, uint32_t n)
{
	bench_scene_paper(&b->paper, n);
	int error = bench_scene_futures(&b->futures, n);

	error = error ? error : bench_scene_perception(&b->perception, EVALUATION);
	return error ? error : bench_scene_moving(&b->moving, n);
}

/* The inputs of the paper scene's first samples, for the plain loop. */
static int plain_inputs(struct bench *b, const struct mc_params *p)
{
	float z[MC_DIM * REF_SAMPLES];
	struct sample_plan plan;
	struct draws *d;
	int error = draws_open(p, &d);

	if (error) {
		return error;
	}
	draws_fill(d, 0, REF_SAMPLES, z, REF_SAMPLES);
	draws_close(d);
	sample_plan(&b->paper, &plan);
	for (int i = 0; i < REF_SAMPLES; i++) {
		sample_draw(&plan, z + i, REF_SAMPLES, b->in + i, REF_SAMPLES);
	}
	return 0;
}

/* ---- measurements ------------------------------------------------------------------------------ */

static int run_batch(struct bench *b, const struct mc_request *req, double *p)
{
	struct mc_result res;
	int error = b->ops->run(b->b, req, NULL, &res);

	for (uint32_t i = 0; !error && i < req->n_futures; i++) {
		p[i] = res.risk[i].p;
	}
	return error;
}

static int run_plain(struct bench *b)
{
	for (int i = 0; i < REF_SAMPLES; i++) {
		plain_rollout(&b->paper.vehicle, b->paper.future[0].accel_cmd_mps2,
			      (double)b->paper.horizon_s, b->in + i, REF_SAMPLES, 0.001,
			      &b->plain[i]);
	}
	return 0;
}

static int run_one(struct bench *b, enum timed which)
{
	double p[MC_FUTURES_MAX];

	switch (which) {
	case REFERENCE:
		return b->ops->samples(b->b, &b->paper, MC_REFERENCE, 0, REF_SAMPLES, b->ref);
	case PLAIN:
		return run_plain(b);
	case MOVING_REFERENCE:
		return b->ops->samples(b->b, &b->moving, MC_REFERENCE, 0, REF_SAMPLES, b->out);
	case PAPER:
		return run_batch(b, &b->paper, p);
	case MOVING:
		return run_batch(b, &b->moving, &b->p_moving);
	case FUTURES_4:
		return run_batch(b, &b->futures, b->p_futures);
	default:
		return run_batch(b, &b->perception, p);
	}
}

static uint32_t samples_of(enum timed which, uint32_t n)
{
	return which == PERCEPTION ? EVALUATION : which >= PAPER ? n : REF_SAMPLES;
}

static int measure_round(struct bench *b, uint32_t n, uint32_t round)
{
	for (int i = 0; i < TIMED; i++) {
		int64_t start_ns = clock_now_ns();
		int error = run_one(b, (enum timed)i);
		int64_t took_ns = clock_now_ns() - start_ns;

		if (error) {
			return error;
		}
		b->ns[i][round] = (double)took_ns / samples_of((enum timed)i, n);
	}
	return 0;
}

/* On Ctrl-C fewer rounds than asked for, but one at least. */
static int measure(struct bench *b, uint32_t n)
{
	struct progress line = progress_start("bench");
	uint32_t done = 0;
	int error = 0;

	while (!error && done < b->rounds && !(done && cli_interrupted())) {
		error = measure_round(b, n, done);
		done += !error;
		progress_update(&line, (double)done / b->rounds, "");
	}
	progress_clear(&line);
	b->rounds = done;
	return error;
}

static void sort_all(struct bench *b)
{
	for (int i = 0; i < TIMED; i++) {
		sort_doubles(b->ns[i], b->rounds);
	}
}

/* Largest distance between the plain loop and the reference: do they time the same thing? */
static double plain_dev_m(const struct bench *b)
{
	double max = 0;

	for (int i = 0; i < REF_SAMPLES; i++) {
		max = fmax(max, fabs((double)b->ref[i].stop_m - (double)b->plain[i].stop_m));
		max = fmax(max, fabs((double)b->ref[i].need_m - (double)b->plain[i].need_m));
	}
	return max;
}

/* ---- output ------------------------------------------------------------------------------------ */

static void json_sizes(struct json *j, const struct bench *b)
{
	json_open(j, "figure", '[');
	for (int i = 0; i < BENCH_SIZES_CPU && b->size[i].p50 > 0; i++) {
		json_open(j, NULL, '{');
		json_uint(j, "n", bench_size[i]);
		json_open(j, "cpu_simd", '{');
		json_num(j, "p50_ns", b->size[i].p50);
		json_num(j, "p99_ns", b->size[i].p99);
		json_close(j, '}');
		json_close(j, '}');
	}
	json_close(j, ']');
}

static void write_json(const struct args *a, const struct bench *b)
{
	struct json j = json_start(stdout);
	char key[48];

	json_head(&j, "bench");
	compute_json(&j, &a->compute, b->ops->describe(b->b));
	json_uint(&j, "samples", (uint64_t)a->samples);
	json_uint(&j, "rounds", b->rounds);
	for (int i = 0; i < TIMED; i++) {
		snprintf(key, sizeof(key), "%s_ns", timed_key[i]);
		json_num(&j, key, b->ns[i][0]);
		snprintf(key, sizeof(key), "%s_median_ns", timed_key[i]);
		json_num(&j, key, b->ns[i][b->rounds / 2]);
	}
	json_num(&j, "evaluation_ms", b->ns[PERCEPTION][0] * EVALUATION * 1e-6);
	json_num(&j, "evaluation_median_ms", b->ns[PERCEPTION][b->rounds / 2] * EVALUATION * 1e-6);
	json_num(&j, "paper_ratio", b->ns[REFERENCE][0] / b->ns[PAPER][0]);
	json_num(&j, "moving_ratio", b->ns[MOVING_REFERENCE][0] / b->ns[MOVING][0]);
	json_num(&j, "futures_ratio", b->ns[REFERENCE][0] / b->ns[FUTURES_4][0]);
	json_num(&j, "reference_to_plain_loop", b->ns[REFERENCE][0] / b->ns[PLAIN][0]);
	json_num(&j, "plain_loop_dev_m", plain_dev_m(b));
	json_num(&j, "p_moving", b->p_moving);
	json_sizes(&j, b);
	json_bool(&j, "interrupted", cli_interrupted());
	json_close(&j, '}');
}

static void print_words(const struct args *a, const struct bench *b)
{
	char cpu[128];

	cli_cpu_name(cpu, sizeof(cpu));
	printf("%s, %s, one thread, batches of %lld, %u rounds; ns per sample\n\n", cpu,
	       b->ops->describe(b->b), (long long)a->samples, b->rounds);
	printf("%-48s %12s %12s %12s\n", "", "minimum", "median", "faster by");
	for (int i = 0; i < TIMED; i++) {
		enum timed base = i == MOVING ? MOVING_REFERENCE : REFERENCE;

		printf("%-48s %12.1f %12.1f", timed_words[i], b->ns[i][0], b->ns[i][b->rounds / 2]);
		if (i >= PAPER) {
			printf(" %12.0f", b->ns[base][0] / b->ns[i][0]);
		}
		putchar('\n');
	}
	printf("\nThe reference takes %.2f times the plain loop; stopping distances differ by %.2g "
	       "m at most.\n"
	       "Risk of the moving lead's scene: %.3g %%.\n"
	       "One evaluation of %d samples, all futures and perception effects: %.3g ms (median "
	       "%.3g "
	       "ms).\n",
	       b->ns[REFERENCE][0] / b->ns[PLAIN][0], plain_dev_m(b), b->p_moving * 100, EVALUATION,
	       b->ns[PERCEPTION][0] * EVALUATION * 1e-6,
	       b->ns[PERCEPTION][b->rounds / 2] * EVALUATION * 1e-6);
}

static int bench(const char *name, const struct args *a, struct bench *b)
{
	int error = scenes(b, (uint32_t)a->samples);

	error = error ? error : plain_inputs(b, &a->compute.params);
	cli_catch_interrupt();
	error = error ? error : measure(b, (uint32_t)a->samples);
	if (!error && a->compute.json && !cli_interrupted()) {
		error = bench_time_sizes(b->ops, b->b,
					 b->rounds < SIZES_REPS ? b->rounds : SIZES_REPS, b->size);
		error = error == -EINTR ? 0 : error;
	}
	if (error) {
		return cli_error(CLI_FAILED, name, "%s", strerror(-error));
	}
	sort_all(b);
	if (a->compute.json) {
		write_json(a, b);
	} else {
		print_words(a, b);
	}
	return cli_interrupted() ? cli_error(CLI_FAILED, name, "interrupted") : CLI_GOOD;
}

/* Every draw is made beforehand, those of the figure too. */
static uint32_t resident(const struct args *a)
{
	const uint32_t least = a->compute.json ? bench_size[BENCH_SIZES_CPU - 1] : EVALUATION;

	return a->samples > least ? (uint32_t)a->samples : least;
}

int cmd_bench(int argc, char **argv)
{
	struct args a = {compute_defaults(), SAMPLES, ROUNDS};
	struct bench b = {0};
	const char *name = argv[0];

	a.compute.params.threads = 1;
	int code = cli_parse(&argp, argc, argv, &a);

	if (!code && !strcmp(a.compute.backend, "cuda")) {
		return bench_cuda(name, &a.compute);
	}
	a.compute.params.n_resident = resident(&a);
	code = code ? code : compute_open(name, &a.compute, &b.ops, &b.b);
	if (code) {
		return code;
	}
	b.rounds = (uint32_t)a.rounds;
	double *ns = calloc(TIMED * (size_t)a.rounds, sizeof(double));

	for (int i = 0; i < TIMED; i++) {
		b.ns[i] = ns + (size_t)(i * a.rounds);
	}
	code = ns ? bench(name, &a, &b) : cli_error(CLI_FAILED, name, "out of memory");
	free(ns);
	b.ops->close(b.b);
	return code;
}
