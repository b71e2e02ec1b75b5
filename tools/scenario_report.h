/* SPDX-License-Identifier: MIT
 * What came of a suite, in words, as JSON and as CSV.
 */
#ifndef AEBMC_SCENARIO_REPORT_H
#define AEBMC_SCENARIO_REPORT_H

#include "scenario_pool.h"

/* One row over all its cars. Figures that no run has are NaN. */
struct scenario_row {
	int runs, contacts, requests, warned, failed;
	int evaluated;     /* runs that had an evaluation: the others could not have requested */
	double impact_mps; /* largest */
	double closest_m;  /* smallest */
	double warn_s, request_s, request99_s; /* median and 99 % of the times, from the onset */
	double spare_s; /* left of latest_s when the request came; NaN for drawn cars, whose limits differ */
	double before_mps2, after_mps2; /* largest decelerations */
	double added_mps2; /* largest that a request added where none was wanted; NaN: there was none */
};

/* Runs whose goal is one, those that missed it, and 95 % of failed / judged. */
struct scenario_share {
	uint64_t judged, failed;
	double lo, hi;
};

/* All rows together. */
struct scenario_sum {
	uint64_t runs, evaluated;
	struct scenario_share all, in_evaluated; /* of all runs; of those that had an evaluation */
	uint64_t contacts, requests;
	uint64_t unwarned;           /* requests without a warning before them */
	double lead_s, lead_least_s; /* warning before request: median, smallest */
	int calm;                    /* runs in which none was wanted */
	double added_mps2;           /* largest deceleration that a request added in them */
};

/** scenario_row_of - @r: the results of one row. Pure. */
struct scenario_row scenario_row_of(const struct scenario_plan *p, int row,
				    const struct scenario_result *r);

/** scenario_sum_of - over [rows][cars]. Allocates and frees; without memory the median is NaN. */
struct scenario_sum scenario_sum_of(const struct scenario_plan *p, const struct scenario_result *r);

/** scenario_rows - "213 rows" or "16 of 213 rows". */
void scenario_rows(FILE *out, const struct scenario_plan *p);

/** scenario_fault_of - the fault that begins with @row, NULL where none does: its rows follow each other. Pure. */
const struct scenario_fault *scenario_fault_of(const struct scenario_plan *p, int row);

/** scenario_faults - what is wrong with the sensors, what the daemon is told of it and its configuration then, each
 * between @before and @after. */
void scenario_faults(FILE *out, const struct scenario_plan *p, const char *before,
		     const char *after);

/** scenario_verdict - what became of the row's goal, in words. */
const char *scenario_verdict(const struct scenario *s, const struct scenario_row *r);

/** scenario_html - a page that needs nothing else. 0 or -ENOMEM; write errors stay in ferror(@out). */
int scenario_html(FILE *out, const struct scenario_plan *p, const struct scenario_result *r);

/** scenario_list - the rows, and what the radar makes of them where a row says; in words or as JSON. */
void scenario_list(FILE *out, int as_json, const struct scenario_plan *p);

/** scenario_words, scenario_csv, scenario_json - the report. Write errors stay in ferror(). */
void scenario_words(FILE *out, const struct scenario_plan *p, const struct scenario_result *r);
void scenario_csv(FILE *out, const struct scenario_plan *p, const struct scenario_result *r);
void scenario_json(FILE *out, const struct scenario_plan *p, const struct scenario_result *r);

#endif
