/* SPDX-License-Identifier: MIT
 * Time in the daemon: int64_t nanoseconds. Live it is CLOCK_MONOTONIC; on a log it is the log's own time.
 */
#ifndef AEBMC_CLOCK_H
#define AEBMC_CLOCK_H

#include <stdint.h>
#include <time.h>

#define CLOCK_NS_PER_S  1000000000LL
#define CLOCK_NS_PER_MS 1000000LL
#define CLOCK_NEVER     INT64_MAX

/** clock_now_ns - CLOCK_MONOTONIC now [ns]. Does not block. */
static inline int64_t clock_now_ns(void)
{
	struct timespec ts;

	clock_gettime(CLOCK_MONOTONIC, &ts);
	return ts.tv_sec * CLOCK_NS_PER_S + ts.tv_nsec;
}

/** clock_s_to_ns - seconds to nanoseconds, rounded; @s within +-9e9. */
static inline int64_t clock_s_to_ns(double s)
{
	return (int64_t)(s * 1e9 + (s < 0 ? -0.5 : 0.5));
}

static inline int64_t clock_earlier(int64_t a_ns, int64_t b_ns)
{
	return a_ns < b_ns ? a_ns : b_ns;
}

#endif
