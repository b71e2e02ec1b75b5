/* SPDX-License-Identifier: MIT
 * Reasons and states, from fault.def. A set of reasons is a bit mask; the state is the worst any reason leads to.
 */
#ifndef AEBMC_FAULT_H
#define AEBMC_FAULT_H

#include <stdint.h>

/* Ordered by precedence: a later one wins over an earlier one. */
enum state {
	STATE_ARMED,
	STATE_BRAKE,
	STATE_DEGRADED,
	STATE_INIT,
	STATE_INHIBIT,
	STATE_FAULT,
	STATES
};

enum fault {
#define FAULT(name, state, clears, doc) FAULT_##name,
#include "fault.def"
#undef FAULT
	FAULTS
};
#define FAULT_BIT(name) (1u << FAULT_##name)

enum fault_clear { FAULT_CLEAR_LIVE, FAULT_CLEAR_HOLD, FAULT_CLEAR_LATCH };

struct fault_row {
	const char *name;
	enum state state;
	enum fault_clear clears;
	const char *doc;
};
extern const struct fault_row fault_table[FAULTS];
extern const char *const state_name[STATES]; /* "ARMED", ... */

/* Which reasons are active, and since when each was last raised. */
struct fault_set {
	uint32_t active;
	int64_t last_ns[FAULTS];
};

/** fault_update - raise the bits of @raised at @now_ns, clear what may clear (fault.def). Pure on *@f. */
void fault_update(struct fault_set *f, uint32_t raised, int64_t now_ns);

/** fault_state - the worst state any active reason leads to; STATE_ARMED without one (BRAKE is the decision's). */
enum state fault_state(uint32_t active);

#endif
