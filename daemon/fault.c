/* SPDX-License-Identifier: MIT
 * The table of reasons, how each clears, and the state that a set of them means.
 */
#include "fault.h"
#include "clock.h"

/* Three radar scans until the inputs count again, 200 ms until a link that came back is looked at: with this much on top
 * good traffic leads back to ARMED within one second. */
#define HOLD_NS (700 * CLOCK_NS_PER_MS)

const struct fault_row fault_table[FAULTS] = {
#define FAULT(name, state, clears, doc) {#name, STATE_##state, FAULT_CLEAR_##clears, doc},
#include "fault.def"
#undef FAULT
};

const char *const state_name[STATES] = {
	[STATE_ARMED] = "ARMED", [STATE_BRAKE] = "BRAKE",     [STATE_DEGRADED] = "DEGRADED",
	[STATE_INIT] = "INIT",   [STATE_INHIBIT] = "INHIBIT", [STATE_FAULT] = "FAULT",
};

static int may_clear(const struct fault_set *f, int i, int64_t now_ns)
{
	switch (fault_table[i].clears) {
	case FAULT_CLEAR_LIVE:
		return 1;
	case FAULT_CLEAR_HOLD:
		return now_ns - f->last_ns[i] >= HOLD_NS;
	default:
		return 0;
	}
}

void fault_update(struct fault_set *f, uint32_t raised, int64_t now_ns)
{
	for (int i = 0; i < FAULTS; i++) {
		uint32_t bit = 1u << i;

		if (raised & bit) {
			f->active |= bit;
			f->last_ns[i] = now_ns;
		} else if (may_clear(f, i, now_ns)) {
			f->active &= ~bit;
		}
	}
}

enum state fault_state(uint32_t active)
{
	enum state worst = STATE_ARMED;

	for (int i = 0; i < FAULTS; i++) {
		if (active & 1u << i && fault_table[i].state > worst) {
			worst = fault_table[i].state;
		}
	}
	return worst;
}
