/* SPDX-License-Identifier: MIT
 * The pictures of plot and paper: what is in each, and how it is drawn. Draws only what it is given; the caller reads
 * files or measures. A figure_* function takes its struct as void, as picture_write hands it on.
 */
#ifndef AEBMC_FIGURE_H
#define AEBMC_FIGURE_H

#include "mc.h"
#include "svg.h"

/* What every picture says about itself; NULL: nothing. */
struct figure_text {
	const char *title, *subtitle, *note;
};

/* Risk against headway, 0..1, with its 95 % interval. */
struct figure_risk {
	struct figure_text text;
	size_t n;
	const double *headway_m, *p, *lo, *hi;
	double at_m[MC_RISKS], ttc_s[MC_RISKS]; /* where it is mc_risk_level[]; NaN: not known */
	int paper;                              /* with the headways that Sec. VI prints */
};
void figure_risk(FILE *out, const void *risk);

/* Stopping distances: @share[i] of all lie in the metre that begins at @first_m + i. */
struct figure_distribution {
	struct figure_text text;
	size_t n;
	double first_m, mean_m, sd_m;
	const double *share;
};
void figure_distribution(FILE *out, const void *distribution);

/* Time of a batch against the number of samples; what is NULL was not measured. */
#define FIGURE_SIZES_MAX 32
struct figure_series {
	size_t n; /* 0..FIGURE_SIZES_MAX */
	const double *samples, *ns;
};
struct figure_bench {
	struct figure_text text;
	struct figure_series paper, fast, cpu; /* paper: its kernel, with copies; cpu: one thread */
	double scalar_ns; /* the f64 reference on one core, for each sample; timed on few and scaled */
	const char *here; /* a second processor in words; NULL: none */
	struct figure_series here_cpu;
	double here_scalar_ns;
	int prints; /* with the figures that Sec. VI prints */
};
void figure_time(FILE *out, const void *bench);
void figure_speedup(FILE *out, const void *bench); /* over scalar_ns, each on its machine */

/* A figure that the paper prints. */
struct figure_point {
	double x, y;
	const char *text;
};

/* The largest number of samples within a budget, for a few kernels. */
#define FIGURE_BUDGETS 3
struct figure_budget {
	struct figure_text text;
	const char *budget[FIGURE_BUDGETS]; /* "530 ms" */
	struct {
		const char *name;
		enum svg_colour colour;
		double samples[FIGURE_BUDGETS];
	} kernel[2];
	const struct figure_point *point; /* of the paper; x counts budgets from 0 */
	int points;
};
void figure_budget(FILE *out, const void *budget);

/* Table I: mean and standard deviation against the number of samples, ours with standard errors. */
struct figure_converge {
	struct figure_text text;
	size_t n;
	const double *samples, *paper_mean_m, *paper_sd_m, *mean_m, *sd_m, *mean_se_m, *sd_se_m;
};
void figure_converge(FILE *out, const void *converge);

/* Stopping distances of the same samples on two processors. */
struct figure_scatter {
	struct figure_text text;
	size_t n;
	const double *cpu_m, *gpu_m;
	const char *cpu, *gpu;
};
void figure_scatter(FILE *out, const void *scatter);

/* A replay against time. What is not known is NaN. p, lo, hi: the risk if full braking waits one period; driver: if the
 * driver brakes, NULL: not drawn. */
struct figure_timeline {
	struct figure_text text;
	size_t n;
	double from_s, to_s;
	const double *time_s, *ego_mps, *lead_mps, *headway_m, *safe_m, *p, *lo, *hi, *driver,
		*accel_mps2, *lead;
	const char *const *level, *const *state; /* [n], as level_name and state_name */
};
void figure_timeline(FILE *out, const void *timeline);

#endif
