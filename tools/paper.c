/* SPDX-License-Identifier: MIT
 * aebmc paper: the paper's figures and its Table I (Sec. VI) anew, in a folder. What a CPU can say is computed here and
 * now; what needs a GPU comes from the record that was kept of one.
 */
#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include "cli.h"
#include "cmd.h"
#include "compute.h"
#include "paper.h"
#include "record.h"

#define SAMPLES  1000000u
#define RESIDENT (1u << 20)
#define SCALAR   500u /* samples that the sequential CPU is timed on; the rest is scaled */
#define REPS     5    /* of each number of samples */

/* ---- arguments --------------------------------------------------------------------------------- */

enum { KEY_PNG = 0x100 };

static const struct argp_option options[] = {
	{"out", 'o', "DIR", 0, "where to write; made if it is not there", 1},
	{"png", KEY_PNG, NULL, 0, "every figure as PNG too, by rsvg-convert", 1},
	{0},
};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct paper *a = st->input;

	switch (key) {
	case 'o':
		a->dir = arg;
		return 0;
	case KEY_PNG:
		a->png = 1;
		return 0;
	case ARGP_KEY_ARG:
		return cli_bad(st, "'%s': paper takes options alone", arg);
	case ARGP_KEY_END:
		return a->dir ? 0 : cli_bad(st, "--out DIR is needed");
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {
	options,
	parse,
	NULL,
	"The paper's figures and its Table I, computed on this machine; what "
	"needs a GPU is drawn from the record of one.",
	NULL,
	NULL,
	NULL};

/* ---- computing --------------------------------------------------------------------------------- */

/* The curve, the distribution and the time against N. */
static int compute_scene(struct paper *p, struct mc_backend *b)
{
	struct bench_timing time[BENCH_SIZES_CPU];
	struct mc_request req;

	mc_preset_paper(&req, 100, SAMPLES);
	int error = mc_cpu_ops.run(b, &req, cli_catch_interrupt(), &p->res);

	if (error || (p->res.flags & MC_RES_CUT)) {
		return error ? error : -EINTR;
	}
	p->rows = risk_curve(mc_cpu_ops.hist(b)->need, p->res.n, RISK_CURVE_ROWS, p->row);
	for (int i = 0; i < p->rows; i++) {
		p->headway_m[i] = p->row[i].headway_m;
		p->p[i] = p->row[i].p;
		p->lo[i] = p->row[i].lo;
		p->hi[i] = p->row[i].hi;
	}
	stop_counts(mc_cpu_ops.hist(b)->stop, &p->stops);
	for (int i = 0; i < p->stops.n; i++) {
		p->share[i] = (double)p->stops.count[i] / (double)p->res.n;
	}
	error = bench_time_sizes(&mc_cpu_ops, b, REPS, time);
	for (int i = 0; i < BENCH_SIZES_CPU; i++) {
		p->size[i] = bench_size[i];
		p->size_ns[i] = time[i].p50;
	}
	return error;
}

/* The samples of the record, again, and how long one core takes for each. */
static int compute_stops(struct paper *p, struct mc_backend *b)
{
	struct model_out out[PAPER_STOPS];
	struct mc_request req;
	int error = bench_time_scalar(b, SCALAR, out, &p->scalar_ns);

	p->n_stops = record.stops < PAPER_STOPS ? (uint32_t)record.stops : PAPER_STOPS;
	mc_preset_paper(&req, 100, p->n_stops);
	error = error ? error : mc_cpu_ops.samples(b, &req, MC_REFERENCE, 0, p->n_stops, out);
	for (uint32_t i = 0; i < p->n_stops; i++) {
		p->cpu_m[i] = (double)out[i].stop_m;
		p->gpu_m[i] = (double)record.stop_m[i];
		p->max_dev_m = fmax(p->max_dev_m, fabs(p->cpu_m[i] - p->gpu_m[i]));
	}
	return error;
}

static int compute_table1(struct paper *p, struct mc_backend *b)
{
	size_t done;
	const int error = table1_compute(&mc_cpu_ops, b, cli_catch_interrupt(), p->table1, &done);

	return error ? error : done < TABLE1_ROWS ? -EINTR : 0;
}

static int on_backend(struct paper *p, const struct compute_args *a,
		      int (*compute)(struct paper *p, struct mc_backend *b))
{
	const time_t now = time(NULL);
	char cpu[100], date[16];
	struct mc_backend *b;
	int error = mc_cpu_ops.open(&a->params, &b);

	if (error) {
		return error;
	}
	cli_cpu_name(cpu, sizeof(cpu));
	strftime(date, sizeof(date), "%F", localtime(&now));
	snprintf(p->machine, sizeof(p->machine), "%.60s, %.30s, %s", cpu, mc_cpu_ops.describe(b),
		 date);
	error = compute(p, b);
	mc_cpu_ops.close(b);
	return error;
}

static int compute_all(struct paper *p)
{
	struct compute_args many = compute_defaults(), one = many;
	int error;

	p->threads = many.params.threads;
	many.params.n_resident = RESIDENT;
	one.params.kind = MC_PHILOX; /* independent draws, as in the paper and in the record */
	one.params.threads = 1;
	one.params.n_resident = 65536;
	error = on_backend(p, &one, compute_stops);
	error = error ? error : on_backend(p, &one, compute_table1);
	return error ? error : on_backend(p, &many, compute_scene);
}

int cmd_paper(int argc, char **argv)
{
	static struct paper p;
	int code = cli_parse(&argp, argc, argv, &p);

	p.name = argv[0];
	if (code) {
		return code;
	}
	if (mkdir(p.dir, 0777) && errno != EEXIST) {
		return cli_error(CLI_FAILED, p.name, "%s: %s", p.dir, strerror(errno));
	}
	cli_catch_interrupt();
	const int error = compute_all(&p);

	return error ? cli_error(CLI_FAILED, p.name, "%s",
				 error == -EINTR ? "interrupted" : strerror(-error))
		     : paper_write(&p);
}
