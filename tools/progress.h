/* SPDX-License-Identifier: MIT
 * A progress line for a person: on standard error, only where that is a terminal, only for work over 2 s.
 */
#ifndef AEBMC_PROGRESS_H
#define AEBMC_PROGRESS_H

#include <stdint.h>

struct progress {
	const char *what;
	int on;    /* standard error is a terminal */
	int shown; /* a line stands there */
	int64_t start_ns, last_ns;
};

/** progress_start - begin; @what is the first word of the line. */
struct progress progress_start(const char *what);

/** progress_update - @share done, 0..1 (below 0: unknown), and a few words (may be ""). Draws 5 times a second at most. */
void progress_update(struct progress *p, double share, const char *words);

/** progress_clear - wipe the line, before other output or at the end. */
void progress_clear(struct progress *p);

#endif
