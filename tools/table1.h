/* SPDX-License-Identifier: MIT
 * Table I of the paper (Sec. VI): the stopping distance over the number of samples, beside our own with standard errors,
 * so that one sees which differences are chance.
 */
#ifndef AEBMC_TABLE1_H
#define AEBMC_TABLE1_H

#include <stdio.h>
#include "mc_ops.h"

#define TABLE1_ROWS 10

struct table1_row {
	uint32_t n;
	double paper_mean_m, paper_sd_m;
	double mean_m, sd_m, mean_se_m, sd_se_m; /* standard errors for independent samples */
	double mean_z,
		sd_z; /* the difference in units of its own standard error: both sides have one */
};

/**
 * table1_compute - run the rows' batches
 * @done: how many rows are filled; fewer than TABLE1_ROWS where @cut (see mc_ops.run) ended a batch
 * 0 or the backend's -errno. Blocks for as long as 752,000 samples take.
 */
int table1_compute(const struct mc_ops *ops, struct mc_backend *b, const uint64_t *cut,
		   struct table1_row rows[TABLE1_ROWS], size_t *done);

/** table1_words - as text, with a head. */
void table1_words(FILE *out, const struct table1_row *rows, size_t n);

/** table1_csv, table1_markdown - the same for machines and for a document. */
void table1_csv(FILE *out, const struct table1_row *rows, size_t n);
void table1_markdown(FILE *out, const struct table1_row *rows, size_t n);

#endif
