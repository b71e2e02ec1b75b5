/* SPDX-License-Identifier: MIT
 * aebmc plot: pictures of JSON. Every reader names what is missing.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "calibration.h"
#include "figure.h"
#include "json_path.h"
#include "picture.h"
#include "plot.h"
#include "text.h"

#define COLUMNS_MAX 8

/* ---- reading ----------------------------------------------------------------------------------- */

/* NaN for null and for what is not there. */
static double number(const char *text, const char *path)
{
	char word[64];
	double v;

	return json_path_text(text, path, word, sizeof(word)) || text_number(word, &v) ? NAN : v;
}

struct words {
	char text[160];
};

static struct words word(const struct plot *p, const char *path)
{
	struct words w;

	if (json_path_text(p->text, path, w.text, sizeof(w.text))) {
		w.text[0] = '\0';
	}
	return w;
}

/* An array of objects as columns, [n][rows] in one allocation. */
struct columns {
	size_t rows;
	double *v[COLUMNS_MAX];
};

static size_t count(const char *array)
{
	size_t n = 0;

	for (const char *m = json_path_first(array); m; m = json_path_next(m)) {
		n++;
	}
	return n;
}

/* Every value of the columns must be there; null is NaN. 0 or an exit code after one line. */
static int read_columns(const struct plot *p, const char *path, const char *const *key, int n,
			struct columns *ret)
{
	const char *array = json_path(p->text, path);
	const size_t rows = array && *array == '[' ? count(array) : 0;
	size_t row = 0;

	*ret = (struct columns){.rows = rows};
	if (!rows) {
		return plot_bad(p, "there are no rows in '%s'", path);
	}
	ret->v[0] = calloc(rows, sizeof(double) * (size_t)n);
	if (!ret->v[0]) {
		return plot_bad(p, "out of memory");
	}
	for (int i = 0; i < n; i++) {
		ret->v[i] = ret->v[0] + (size_t)i * rows;
	}
	for (const char *m = json_path_first(array); m; m = json_path_next(m), row++) {
		for (int i = 0; i < n; i++) {
			char value[64];

			if (json_path_text(m, key[i], value, sizeof(value)) ||
			    (*value && text_number(value, &ret->v[i][row]))) {
				return plot_bad(p, "row %zu of '%s' has no number '%s'", row + 1,
						path, key[i]);
			}
			ret->v[i][row] = *value ? ret->v[i][row] : NAN;
		}
	}
	return 0;
}

static int need(const struct plot *p, const char *path, double *ret)
{
	*ret = number(p->text, path);
	return isfinite(*ret) ? 0 : plot_bad(p, "there is no number '%s'", path);
}

/* ---- curve ------------------------------------------------------------------------------------- */

/* 100000 as 100,000. */
static struct words grouped(struct words in)
{
	struct words w = {""};
	const size_t n = strlen(in.text);

	for (size_t i = 0, k = 0; i < n && k + 2 < sizeof(w.text); i++) {
		w.text[k++] = in.text[i];
		if ((n - i) % 3 == 1 && i + 1 < n) {
			w.text[k++] = ',';
		}
	}
	return w;
}

static struct words scene_words(const struct plot *p)
{
	struct words w;

	snprintf(w.text, sizeof(w.text), "%.20s samples, %.20s draws, seed %.20s",
		 grouped(word(p, "samples")).text, word(p, "draws").text, word(p, "seed").text);
	return w;
}

static struct words machine_words(const struct plot *p)
{
	struct words w;

	snprintf(w.text, sizeof(w.text), "%.60s, %.40s, aebmc %.20s", word(p, "cpu").text,
		 word(p, "variant").text, word(p, "version").text);
	return w;
}

static const char *title(const struct plot *p, const char *own)
{
	return p->title ? p->title : own;
}

int plot_risk(const struct plot *p)
{
	static const char *const key[] = {"headway_m", "risk", "lo", "hi"};
	const struct words scene = scene_words(p), machine = machine_words(p);
	struct figure_risk r = {
		.text = {title(p, "Risk against headway"), scene.text, machine.text}};
	struct columns c;
	int code = read_columns(p, "curve", key, 4, &c);

	r.n = c.rows;
	r.headway_m = c.v[0], r.p = c.v[1], r.lo = c.v[2], r.hi = c.v[3];
	for (int i = 0; i < MC_RISKS; i++) {
		char path[32];

		snprintf(path, sizeof(path), "headway_m.%g", mc_risk_level[i]);
		r.at_m[i] = number(p->text, path);
		snprintf(path, sizeof(path), "ttc_s.%g", mc_risk_level[i]);
		r.ttc_s[i] = number(p->text, path);
	}
	code = code ? code : picture_write(p->name, p->out, figure_risk, &r);
	free(c.v[0]);
	return code;
}

/* From counts to shares of all samples, in place. */
static int read_shares(const struct plot *p, struct figure_distribution *d, double **share)
{
	const char *array = json_path(p->text, "stops.count");
	const size_t n = array && *array == '[' ? count(array) : 0;
	double samples = 0;
	size_t i = 0;

	*share = calloc(n + 1, sizeof(**share));
	if (!n || !*share) {
		return plot_bad(p, "there are no counts in 'stops.count'");
	}
	int code = need(p, "samples", &samples);

	for (const char *m = json_path_first(array); m && !code; m = json_path_next(m), i++) {
		const double v = number(m, "");

		(*share)[i] = v / samples;
		code = v >= 0 ? 0 : plot_bad(p, "row %zu of 'stops.count' is no number", i + 1);
	}
	d->n = n;
	d->share = *share;
	return code;
}

int plot_distribution(const struct plot *p)
{
	const struct words scene = scene_words(p), machine = machine_words(p);
	struct figure_distribution d = {
		.text = {title(p, "Stopping distances"), scene.text, machine.text}};
	double *share = NULL;
	int code = need(p, "stops.first_m", &d.first_m);

	code = code ? code : need(p, "mean_m", &d.mean_m);
	code = code ? code : need(p, "sd_m", &d.sd_m);
	code = code ? code : read_shares(p, &d, &share);
	code = code ? code : picture_write(p->name, p->out, figure_distribution, &d);
	free(share);
	return code;
}

/* ---- bench ------------------------------------------------------------------------------------- */

static int too_long(const struct plot *p, const struct columns *c)
{
	return c->rows <= FIGURE_SIZES_MAX
		       ? 0
		       : plot_bad(p, "more than %d rows in 'figure'", FIGURE_SIZES_MAX);
}

static int plot_cpu(const struct plot *p, const char *own,
		    void (*draw)(FILE *out, const void *bench))
{
	static const char *const key[] = {"n", "cpu_simd.p50_ns"};
	const struct words machine = machine_words(p);
	struct figure_bench b = {
		.text = {title(p, own), "the paper's scene; medians", machine.text}};
	struct columns c;
	int code = read_columns(p, "figure", key, 2, &c);

	code = code ? code : too_long(p, &c);
	code = code ? code : need(p, "reference_ns", &b.scalar_ns);
	b.cpu = (struct figure_series){c.rows, c.v[0], c.v[1]};
	code = code ? code : picture_write(p->name, p->out, draw, &b);
	free(c.v[0]);
	return code;
}

static int plot_cuda(const struct plot *p, const char *own,
		     void (*draw)(FILE *out, const void *bench))
{
	static const char *const key[] = {"n", "paper_with_copies.p50_ns", "fast_run.p50_ns",
					  "cpu_simd.p50_ns"};
	struct words machine;
	struct figure_bench b = {
		.text = {title(p, own), "the paper's scene; medians", machine.text}};
	struct columns c;
	int code = read_columns(p, "figure", key, 4, &c);

	snprintf(machine.text, sizeof(machine.text), "%.60s, %.60s, aebmc %.20s",
		 word(p, "device.name").text, word(p, "cpu").text, word(p, "version").text);
	code = code ? code : too_long(p, &c);
	code = code ? code : need(p, "cpu_scalar_ns", &b.scalar_ns);
	b.paper = (struct figure_series){c.rows, c.v[0], c.v[1]};
	b.fast = (struct figure_series){c.rows, c.v[0], c.v[2]};
	b.cpu = (struct figure_series){c.rows, c.v[0], c.v[3]};
	code = code ? code : picture_write(p->name, p->out, draw, &b);
	free(c.v[0]);
	return code;
}

#define TIME    "Time of a batch against the number of samples"
#define SPEEDUP "Speedup against the number of samples"

int plot_time_cpu(const struct plot *p)
{
	return plot_cpu(p, TIME, figure_time);
}

int plot_speedup_cpu(const struct plot *p)
{
	return plot_cpu(p, SPEEDUP, figure_speedup);
}

int plot_time_cuda(const struct plot *p)
{
	return plot_cuda(p, TIME, figure_time);
}

int plot_speedup_cuda(const struct plot *p)
{
	return plot_cuda(p, SPEEDUP, figure_speedup);
}

/* ---- budget and converge ----------------------------------------------------------------------- */

int plot_budget(const struct plot *p)
{
	static const struct {
		const char *key, *words;
		enum svg_colour colour;
	} kernel[] = {{"paper", "the paper's kernel, with copies", SVG_RED},
		      {"fast", "the fast rollout", SVG_BLUE}};
	static const int budget_ms[FIGURE_BUDGETS] = {CALIBRATION_MS};
	struct words machine;
	char words[FIGURE_BUDGETS][16];
	struct figure_budget b = {
		.text = {title(p, "Samples that fit a budget"), "at p99.9", machine.text}};
	int code = 0;

	snprintf(machine.text, sizeof(machine.text), "%.80s, aebmc %.20s", word(p, "device").text,
		 word(p, "version").text);
	for (int i = 0; i < FIGURE_BUDGETS; i++) {
		snprintf(words[i], sizeof(words[i]), "%d ms", budget_ms[i]);
		b.budget[i] = words[i];
	}
	for (int k = 0; k < 2; k++) {
		b.kernel[k].name = kernel[k].words;
		b.kernel[k].colour = kernel[k].colour;
		for (int i = 0; i < FIGURE_BUDGETS && !code; i++) {
			char path[48];

			snprintf(path, sizeof(path), "%s.samples_%d_ms", kernel[k].key,
				 budget_ms[i]);
			code = need(p, path, &b.kernel[k].samples[i]);
		}
	}
	return code ? code : picture_write(p->name, p->out, figure_budget, &b);
}

int plot_converge(const struct plot *p)
{
	static const char *const key[] = {"samples", "paper_mean_m", "paper_sd_m", "mean_m",
					  "sd_m",    "mean_se_m",    "sd_se_m"};
	const struct words machine = machine_words(p);
	struct words draws;
	struct columns c;
	int code = read_columns(p, "rows", key, 7, &c);

	snprintf(draws.text, sizeof(draws.text),
		 "Table I: stopping distance; %.20s draws, seed %.20s", word(p, "draws").text,
		 word(p, "seed").text);
	const struct figure_converge f = {
		.text = {title(p, "Mean and spread against the number of samples"), draws.text,
			 machine.text},
		.n = c.rows,
		.samples = c.v[0],
		.paper_mean_m = c.v[1],
		.paper_sd_m = c.v[2],
		.mean_m = c.v[3],
		.sd_m = c.v[4],
		.mean_se_m = c.v[5],
		.sd_se_m = c.v[6]};

	code = code ? code : picture_write(p->name, p->out, figure_converge, &f);
	free(c.v[0]);
	return code;
}
