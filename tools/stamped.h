/* SPDX-License-Identifier: MIT
 * A bus around a bus that remembers when the first and the last frame came: what a replay must know and the pipeline
 * need not.
 */
#ifndef AEBMC_STAMPED_H
#define AEBMC_STAMPED_H

#include "bus.h"

struct stamped {
	struct bus bus; /* to hand to the pipeline */
	struct bus *inner;
	int64_t first_ns, last_ns; /* both 0 before the first frame */
};

/** stamped_init - @inner stays the caller's and must outlive @s. */
void stamped_init(struct stamped *s, struct bus *inner);

#endif
