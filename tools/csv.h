/* SPDX-License-Identifier: MIT
 * One row per evaluation, for PlotJuggler or pandas: units in the column names, a field that is not known stays empty.
 */
#ifndef AEBMC_CSV_H
#define AEBMC_CSV_H

#include <stdio.h>
#include "pipeline.h"

/** csv_head - the line of column names. */
void csv_head(FILE *out);

/** csv_row - one evaluation; time_s counts from @start_ns. Write errors stay in ferror(@out). */
void csv_row(FILE *out, const struct cycle *c, enum state state, int64_t start_ns);

#endif
