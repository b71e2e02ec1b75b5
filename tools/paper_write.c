/* SPDX-License-Identifier: MIT
 * aebmc paper: the figures and the table, each with the machine it comes from.
 */
#include <math.h>
#include <stdio.h>
#include "calibration.h"
#include "cli.h"
#include "figure.h"
#include "paper.h"
#include "picture.h"
#include "record.h"

#define SPEED_MPS 30.0 /* its mean, Sec. IV */
#define PATH_SIZE 4096

static void path_of(const struct paper *p, const char *stem, const char *end, char path[PATH_SIZE])
{
	snprintf(path, PATH_SIZE, "%s/%s.%s", p->dir, stem, end);
}

static int write_figure(const struct paper *p, const char *stem, const char *title,
			void (*draw)(FILE *out, const void *arg), const void *arg)
{
	char path[PATH_SIZE];

	path_of(p, stem, "svg", path);
	int code = picture_write(p->name, path, draw, arg);

	if (!code && p->png) {
		path_of(p, stem, "png", path);
		code = picture_write(p->name, path, draw, arg);
	}
	if (!code) {
		printf("%s: %s\n", path, title);
	}
	return code;
}

/* ---- what this machine computes ---------------------------------------------------------------- */

static int write_distribution(const struct paper *p)
{
	const struct figure_distribution d = {
		.text = {"Stopping distances",
			 "1,000,000 samples; the paper: 79.22 m and 12.21 m "
			 "from 12,000",
			 p->machine},
		.n = (size_t)p->stops.n,
		.first_m = p->stops.first_m,
		.mean_m = p->res.stop_mean_m,
		.sd_m = p->res.stop_sd_m,
		.share = p->share};

	return write_figure(p, "distribution", d.text.title, figure_distribution, &d);
}

static int write_risk(const struct paper *p)
{
	struct figure_risk r = {
		.text = {"Risk of a collision against headway",
			 "1,000,000 samples, 30 m/s, standing obstacle, -6 m/s\302\262",
			 p->machine},
		.n = (size_t)p->rows,
		.headway_m = p->headway_m,
		.p = p->p,
		.lo = p->lo,
		.hi = p->hi,
		.paper = 1};

	for (int i = 0; i < MC_RISKS; i++) {
		r.at_m[i] = p->res.headway_m[i];
		r.ttc_s[i] = r.at_m[i] / SPEED_MPS;
	}
	return write_figure(p, "risk", r.text.title, figure_risk, &r);
}

static int write_converge(const struct paper *p)
{
	double v[7][TABLE1_ROWS];

	for (int i = 0; i < TABLE1_ROWS; i++) {
		const struct table1_row *r = &p->table1[i];
		const double row[] = {r->n,    r->paper_mean_m, r->paper_sd_m, r->mean_m,
				      r->sd_m, r->mean_se_m,    r->sd_se_m};

		for (int k = 0; k < 7; k++) {
			v[k][i] = row[k];
		}
	}
	const struct figure_converge c = {.text = {"Table I as a picture",
						   "stopping distance; independent draws",
						   p->machine},
					  .n = TABLE1_ROWS,
					  .samples = v[0],
					  .paper_mean_m = v[1],
					  .paper_sd_m = v[2],
					  .mean_m = v[3],
					  .sd_m = v[4],
					  .mean_se_m = v[5],
					  .sd_se_m = v[6]};

	return write_figure(p, "table1", c.text.title, figure_converge, &c);
}

/* ---- what needs a GPU -------------------------------------------------------------------------- */

static int write_scatter(const struct paper *p)
{
	char title[80], subtitle[120], gpu[80];
	const struct figure_scatter f = {.text = {title, subtitle, p->machine},
					 .n = p->n_stops,
					 .cpu_m = p->cpu_m,
					 .gpu_m = p->gpu_m,
					 .cpu = "stopping distance on this CPU [m]",
					 .gpu = gpu};

	snprintf(title, sizeof(title), "CPU against GPU: %u stopping distances", p->n_stops);
	snprintf(subtitle, sizeof(subtitle), "the same samples; largest difference %.6f m",
		 p->max_dev_m);
	snprintf(gpu, sizeof(gpu), "on the GPU: %s, %s [m]", record.stops_gpu, record.stops_date);
	return write_figure(p, "cpu-gpu", title, figure_scatter, &f);
}

static int write_bench(const struct paper *p)
{
	char note[200], here[160];
	struct figure_bench b = {.text = {"Time of a batch against the number of samples",
					  "the paper's scene; medians", note},
				 .paper = record.paper,
				 .fast = record.fast,
				 .cpu = record.host,
				 .scalar_ns = record.scalar_ns,
				 .here = here,
				 .here_cpu = {BENCH_SIZES_CPU, p->size, p->size_ns},
				 .here_scalar_ns = p->scalar_ns,
				 .prints = 1};

	snprintf(note, sizeof(note), "GPU: %s; one core: %s; %s", record.gpu, record.cpu,
		 record.date);
	snprintf(here, sizeof(here), "the fast rollout on this machine: %.90s, %u threads",
		 p->machine, p->threads);
	int code = write_figure(p, "time", b.text.title, figure_time, &b);

	b.text.title = "Speedup over one core against the number of samples";
	b.text.subtitle = "the paper's scene; medians; dashed: the peaks that the paper prints for "
			  "its devices and its CPU";
	return code ? code : write_figure(p, "speedup", b.text.title, figure_speedup, &b);
}

static int write_budget(const struct paper *p)
{
	static const struct figure_point point[] = {{1, 8000, "Orin Nano"}, {1, 25000, "AGX Orin"}};
	char note[120];
	struct figure_budget b = {
		.text = {"Samples that fit a budget", "at p99.9 of a thousand batches", note},
		.budget = {"400 ms", "530 ms (Sec. VI)", "800 ms"},
		.kernel = {{.name = "the paper's kernel, with copies", .colour = SVG_RED},
			   {.name = "the fast rollout", .colour = SVG_BLUE}},
		.point = point,
		.points = 2};

	for (int i = 0; i < FIGURE_BUDGETS; i++) {
		b.kernel[0].samples[i] = record.paper_fits[i];
		b.kernel[1].samples[i] = record.fast_fits[i];
	}
	snprintf(note, sizeof(note), "%s, %s", record.gpu, record.date);
	return write_figure(p, "budget", b.text.title, figure_budget, &b);
}

/* ---- Table I ----------------------------------------------------------------------------------- */

static int write_table(const struct paper *p, const char *end,
		       void (*table)(FILE *out, const struct table1_row *rows, size_t n))
{
	char path[PATH_SIZE];

	path_of(p, "table1", end, path);
	FILE *f = cli_create(p->name, path);

	if (!f) {
		return CLI_FAILED;
	}
	table(f, p->table1, TABLE1_ROWS);
	int code = cli_close(p->name, path, f);

	if (!code) {
		printf("%s: Table I\n", path);
	}
	return code;
}

int paper_write(const struct paper *p)
{
	static int (*const write[])(const struct paper *p) = {write_scatter, write_distribution,
							      write_risk,    write_bench,
							      write_budget,  write_converge};
	int code = 0;

	for (size_t i = 0; i < sizeof(write) / sizeof(write[0]) && !code; i++) {
		code = write[i](p);
	}
	code = code ? code : write_table(p, "txt", table1_words);
	code = code ? code : write_table(p, "csv", table1_csv);
	return code ? code : write_table(p, "md", table1_markdown);
}
