/* SPDX-License-Identifier: MIT
 * The same runs decided by each rule of rules.h and by the daemon: what does probability buy?
 */
#ifndef AEBMC_SCENARIO_COMPARE_H
#define AEBMC_SCENARIO_COMPARE_H

#include "scenario_report.h"

/**
 * scenario_compare - run @p with every rule, in words on @out or as JSON
 * @result: [rows][cars], overwritten for each rule. Returns 0, or an exit code after one line. Blocks.
 */
int scenario_compare(FILE *out, int as_json, const struct scenario_plan *p,
		     struct scenario_result *result);

#endif
