/* SPDX-License-Identifier: MIT
 * The ego's speed as measured: is a new value plausible, and the last half second in order, for filters that run behind
 * by the radar's latency. Knows no frame and no filter.
 */
#ifndef AEBMC_SPEEDS_H
#define AEBMC_SPEEDS_H

#include <stdint.h>

#define SPEEDS_MAX 64 /* 0.5 s, the longest latency, at 100 Hz and more */

struct speed {
	int64_t t_ns;
	double mps;
};

struct speeds {
	struct speed queue[SPEEDS_MAX]; /* ring, oldest at head */
	int head, n;
	struct speed last; /* the last plausible one, also when it has left the queue */
	int jumps;         /* implausible ones in a row since then */
	int64_t heard_ns;  /* when one came last, plausible or not */
};

/** speeds_reset - empty, and nothing to compare with. */
void speeds_reset(struct speeds *q);

/**
 * speeds_judge - could a vehicle have come from the last plausible speed to this one?
 * @accel_max: it cannot change its speed faster [m/s2]; @noise: apart from this [m/s]
 * Returns 0, or how many speeds in a row could not; they are for the caller to leave out or to believe after all.
 */
int speeds_judge(struct speeds *q, const struct speed *s, double accel_max, double noise);

/** speeds_push - append one. Returns 1 and the oldest in *@out if it had to make room, else 0. */
int speeds_push(struct speeds *q, const struct speed *s, struct speed *out);

/** speeds_pop - take the oldest if it is not later than @t_ns. Returns 1, else 0. */
int speeds_pop(struct speeds *q, int64_t t_ns, struct speed *out);

/** speeds_at - the @i'th oldest, 0 <= i < n. */
const struct speed *speeds_at(const struct speeds *q, int i);

#endif
