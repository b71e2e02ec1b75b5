/* SPDX-License-Identifier: MIT
 * fault: the table is sane, each way of clearing, precedence of states.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>
#include "fault.h"

#define S 1000000000LL

static void test_table(void **arg)
{
	(void)arg;
	assert_true(FAULTS < 32);
	for (int i = 0; i < FAULTS; i++) {
		assert_non_null(fault_table[i].name);
		assert_true(strlen(fault_table[i].doc) > 10);
		assert_true(fault_table[i].state >= STATE_DEGRADED);
		for (int k = 0; k < i; k++) {
			assert_string_not_equal(fault_table[i].name, fault_table[k].name);
		}
	}
	for (int i = 0; i < STATES; i++) {
		assert_non_null(state_name[i]);
	}
	assert_string_equal(fault_table[FAULT_MC_LATE].name, "MC_LATE");
	assert_string_equal(state_name[STATE_INHIBIT], "INHIBIT");
}

static void test_live_clears_at_once(void **arg)
{
	struct fault_set f = {0};

	(void)arg;
	fault_update(&f, FAULT_BIT(MC_LATE), 5);
	assert_int_equal(f.active, FAULT_BIT(MC_LATE));
	fault_update(&f, 0, 5);
	assert_int_equal(f.active, 0);
}

static void test_hold_clears_after_700_ms(void **arg)
{
	struct fault_set f = {0};

	(void)arg;
	fault_update(&f, FAULT_BIT(EGO_STALE), 3 * S);
	fault_update(&f, FAULT_BIT(EGO_STALE), 4 * S);
	fault_update(&f, 0, 4 * S + S * 7 / 10 - 1); /* from when it was last seen */
	assert_int_equal(f.active, FAULT_BIT(EGO_STALE));
	fault_update(&f, 0, 4 * S + S * 7 / 10);
	assert_int_equal(f.active, 0);
}

static void test_latch_never_clears(void **arg)
{
	struct fault_set f = {0};

	(void)arg;
	fault_update(&f, FAULT_BIT(MEMORY), 0);
	fault_update(&f, 0, 1000000 * S);
	assert_int_equal(f.active, FAULT_BIT(MEMORY));
}

static void test_reasons_are_independent(void **arg)
{
	struct fault_set f = {0};

	(void)arg;
	fault_update(&f, FAULT_BIT(STARTING) | FAULT_BIT(BUS_OFF) | FAULT_BIT(GPU_LOST), 0);
	fault_update(&f, FAULT_BIT(RADAR_STALE), S);
	assert_int_equal(f.active, FAULT_BIT(RADAR_STALE) | FAULT_BIT(GPU_LOST));
	for (int i = 0; i < FAULTS; i++) {
		f = (struct fault_set){0};
		fault_update(&f, 1u << i, 0);
		assert_int_equal(f.active, 1u << i);
	}
}

static void test_precedence(void **arg)
{
	static const struct {
		uint32_t active;
		enum state state;
	} row[] = {
		{0, STATE_ARMED},
		{FAULT_BIT(MC_ERROR), STATE_DEGRADED},
		{FAULT_BIT(MC_ERROR) | FAULT_BIT(STARTING), STATE_INIT},
		{FAULT_BIT(STARTING) | FAULT_BIT(EGO_STALE), STATE_INHIBIT},
		{FAULT_BIT(EGO_STALE) | FAULT_BIT(MC_ERROR), STATE_INHIBIT},
		{FAULT_BIT(EGO_STALE) | FAULT_BIT(CONFIG), STATE_FAULT},
		{~0u >> (32 - FAULTS), STATE_FAULT},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		assert_int_equal(fault_state(row[i].active), row[i].state);
	}
	for (int i = 0; i < FAULTS; i++) {
		assert_int_equal(fault_state(1u << i), fault_table[i].state);
	}
	assert_int_equal(fault_state(1u << FAULTS), STATE_ARMED); /* no reason at all */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_table),
		cmocka_unit_test(test_live_clears_at_once),
		cmocka_unit_test(test_hold_clears_after_700_ms),
		cmocka_unit_test(test_latch_never_clears),
		cmocka_unit_test(test_reasons_are_independent),
		cmocka_unit_test(test_precedence),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
