/* SPDX-License-Identifier: MIT
 * Between plot.c, which knows the kinds of pictures, and plot_json.c and plot_csv.c, which read what one shows.
 */
#ifndef AEBMC_PLOT_H
#define AEBMC_PLOT_H

#include <stddef.h>
#include <stdio.h>

struct plot {
	const char *name; /* "aebmc plot", for messages */
	const char *path, *out;
	const char *title;   /* NULL: the picture's own */
	double from_s, to_s; /* of a timeline */
	char *text;          /* of the file */
};

/* Each reads one kind of picture and draws it into p->out. Returns an exit code, after one line if it is not 0. CSV is cut
 * up in place. */
int plot_risk(const struct plot *p);
int plot_distribution(const struct plot *p);
int plot_time_cpu(const struct plot *p);
int plot_time_cuda(const struct plot *p);
int plot_speedup_cpu(const struct plot *p);
int plot_speedup_cuda(const struct plot *p);
int plot_budget(const struct plot *p);
int plot_converge(const struct plot *p);
int plot_risk_csv(const struct plot *p);
int plot_timeline(const struct plot *p);

/** plot_bad - "aebmc plot: FILE: ..." Returns CLI_FAILED. */
int plot_bad(const struct plot *p, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

#endif
