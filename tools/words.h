/* SPDX-License-Identifier: MIT
 * What a replay has to tell, in plain words: one event per change of what is asked of the brakes, or of the state.
 */
#ifndef AEBMC_WORDS_H
#define AEBMC_WORDS_H

#include <stdio.h>
#include "pipeline.h"

/** words_ttc_s - time to collision as the speeds stand [s]; NaN without a lead or where the gap does not close. Pure. */
double words_ttc_s(const struct scene *s);

/** words_level - lines about the level @now, which was @before until @time_s of the log. */
void words_level(FILE *out, double time_s, const struct publish_in *now, enum stage_level before);

/** words_state - a line about a change of state, with its reasons. */
void words_state(FILE *out, double time_s, const struct publish_in *now, enum state before);

#endif
