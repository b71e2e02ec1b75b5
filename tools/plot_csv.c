/* SPDX-License-Identifier: MIT
 * aebmc plot: pictures of CSV.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "cli.h"
#include "figure.h"
#include "picture.h"
#include "plot.h"
#include "sheet.h"

/* The named columns as numbers, [n][rows] in one allocation. 0 or an exit code after one line. */
static int read_columns(const struct plot *p, const struct sheet *s, const char *const *name, int n,
			double **ret)
{
	double *v = calloc(s->rows * (size_t)n, sizeof(*v));
	char err[256];

	*ret = v;
	if (!v) {
		return plot_bad(p, "out of memory");
	}
	for (int i = 0; i < n; i++) {
		if (sheet_numbers(s, name[i], v + (size_t)i * s->rows, err, sizeof(err))) {
			return plot_bad(p, "%s", err);
		}
	}
	return 0;
}

static int open_sheet(const struct plot *p, struct sheet *s)
{
	char err[256] = "out of memory";

	return sheet_open(p->text, s, err, sizeof(err)) ? plot_bad(p, "%s", err) : 0;
}

/* ---- curve ------------------------------------------------------------------------------------- */

int plot_risk_csv(const struct plot *p)
{
	static const char *const name[] = {"headway_m", "risk", "risk_lo", "risk_hi"};
	struct figure_risk r = {.text = {.title = p->title ? p->title : "Risk against headway"},
				.at_m = {NAN, NAN, NAN},
				.ttc_s = {NAN, NAN, NAN}};
	struct sheet s = {0};
	double *v = NULL;
	int code = open_sheet(p, &s);

	code = code ? code : read_columns(p, &s, name, 4, &v);
	if (!code) {
		r.n = s.rows;
		r.headway_m = v, r.p = v + s.rows, r.lo = v + 2 * s.rows, r.hi = v + 3 * s.rows;
		code = picture_write(p->name, p->out, figure_risk, &r);
	}
	free(v);
	sheet_close(&s);
	return code;
}

/* ---- replay ------------------------------------------------------------------------------------ */

enum { TIME, EGO, LEAD_MPS, HEADWAY, SAFE, RISK, LO, HI, DRIVER, ACCEL, LEAD, COLUMNS };
static const char *const timeline_column[COLUMNS] = {
	[TIME] = "time_s",
	[EGO] = "ego_speed_mps",
	[LEAD_MPS] = "lead_speed_mps",
	[HEADWAY] = "headway_m",
	[SAFE] = "safe_headway_1pct_m",
	[RISK] = "p_defer",
	[LO] = "p_defer_lo",
	[HI] = "p_defer_hi",
	[DRIVER] = "p_driver",
	[ACCEL] = "accel_request_mps2",
	[LEAD] = "lead_id",
};

/* The words of a column; NULL after one line. */
static const char **read_words(const struct plot *p, const struct sheet *s, const char *name)
{
	const int column = sheet_column(s, name);
	const char **word = calloc(s->rows, sizeof(*word));

	if (column < 0 || !word) {
		plot_bad(p, "%s%s", word ? "no column " : "out of memory", word ? name : "");
		free(word);
		return NULL;
	}
	for (size_t i = 0; i < s->rows; i++) {
		word[i] = sheet_word(s, i, column);
	}
	return word;
}

/* The rows between --from and --to, which is all that is scaled and drawn. */
static int cut(const struct plot *p, const double *time_s, size_t *first, size_t *n)
{
	size_t end = *n;

	for (*first = 0; *first < end && time_s[*first] < p->from_s;) {
		++*first;
	}
	while (end > *first && time_s[end - 1] > p->to_s) {
		end--;
	}
	*n = end - *first;
	return *n >= 2 ? 0 : plot_bad(p, "there are fewer than two rows between --from and --to");
}

static const char *base_name(const char *path)
{
	const char *slash = strrchr(path, '/');

	return slash ? slash + 1 : path;
}

static int draw_timeline(const struct plot *p, const double *v, size_t rows,
			 const char *const *level, const char *const *state)
{
	const double *c[COLUMNS];
	size_t first, n = rows;
	char words[80];

	if (cut(p, v, &first, &n)) {
		return CLI_FAILED;
	}
	for (int i = 0; i < COLUMNS; i++) {
		c[i] = v + (size_t)i * rows + first;
	}
	snprintf(words, sizeof(words), "%zu evaluations; dashed: the stage rises", n);
	const struct figure_timeline t = {
		.text = {.title = p->title ? p->title : base_name(p->path), .subtitle = words},
		.n = n,
		.from_s = fmax(p->from_s, c[TIME][0]),
		.to_s = fmin(p->to_s, c[TIME][n - 1]),
		.time_s = c[TIME],
		.ego_mps = c[EGO],
		.lead_mps = c[LEAD_MPS],
		.headway_m = c[HEADWAY],
		.safe_m = c[SAFE],
		.p = c[RISK],
		.lo = c[LO],
		.hi = c[HI],
		.driver = c[DRIVER],
		.accel_mps2 = c[ACCEL],
		.lead = c[LEAD],
		.level = level + first,
		.state = state + first,
	};

	return picture_write(p->name, p->out, figure_timeline, &t);
}

int plot_timeline(const struct plot *p)
{
	const char **level = NULL, **state = NULL;
	struct sheet s = {0};
	double *v = NULL;
	int code = open_sheet(p, &s);

	code = code ? code : read_columns(p, &s, timeline_column, COLUMNS, &v);
	level = code ? NULL : read_words(p, &s, "level_name");
	state = level ? read_words(p, &s, "state") : NULL;
	code = code || state ? code : CLI_FAILED;
	code = code ? code : draw_timeline(p, v, s.rows, level, state);
	free(level);
	free(state);
	free(v);
	sheet_close(&s);
	return code;
}
