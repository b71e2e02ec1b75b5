/* SPDX-License-Identifier: MIT
 * What the housekeeping thread decides: when the watchdog is fed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

#include "clock.h"
#include "service.h"

#define INTERVAL_NS CLOCK_NS_PER_S

static int fed;

static int told(const char *state)
{
	fed += !strcmp(state, "WATCHDOG=1");
	return 1;
}

static int64_t watchdog_ns(void)
{
	return INTERVAL_NS;
}
#define service_notify      told
#define service_watchdog_ns watchdog_ns
#include "../daemon/housekeeping.c"
#undef service_notify
#undef service_watchdog_ns

/* ---- sign of life -------------------------------------------------------------------------------- */

#define SHADOW AEB_STATUS_TRANSMIT_SHADOW

static void test_sign_of_life(void **state)
{
	static const struct {
		uint64_t steps, confirmed; /* since it was fed */
		int64_t transmit;
		uint32_t fault;
		int alive;
	} row[] = {
		{1, 1, SHADOW, 0, 1},
		{1, 0, SHADOW, 0, 0}, /* nothing came back, and the bus is fine */
		{1, 0, AEB_STATUS_TRANSMIT_ARMED, 0, 0},
		{1, 0, AEB_STATUS_TRANSMIT_NONE, 0, 1}, /* nothing is sent */
		{0, 1, SHADOW, 0, 0},                   /* the loop stands */
		{0, 0, AEB_STATUS_TRANSMIT_NONE, 0, 0},
		{1, 0, SHADOW, FAULT_BIT(BUS_DOWN), 1},
		{1, 0, SHADOW, FAULT_BIT(BUS_OFF), 1},
		{1, 0, SHADOW, FAULT_BIT(BUS_PASSIVE), 1},
		{1, 0, SHADOW, FAULT_BIT(TX_REFUSED), 1},
		{1, 0, AEB_STATUS_TRANSMIT_ARMED, FAULT_BIT(TX_REFUSED), 1},
		{0, 0, SHADOW, BUS_DEAD, 0},
		{1, 0, SHADOW, ~BUS_DEAD, 0}, /* no other reason excuses it */
	};

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct live l = {.fed_steps = 7, .fed_confirmed = 9};

		l.seen.steps = 7 + row[i].steps;
		l.seen.bus.confirmed = 9 + row[i].confirmed;
		l.seen.transmit = row[i].transmit;
		l.seen.now.fault = row[i].fault;
		print_message("row %zu\n", i);
		assert_int_equal(is_alive(&l), row[i].alive);
	}
}

static void test_watchdog_is_fed_by_new_signs_alone(void **state)
{
	struct live l = {.seen.steps = 1, .seen.bus.confirmed = 1, .seen.transmit = SHADOW};
	int64_t now_ns = CLOCK_NS_PER_S;

	(void)state;
	fed = 0;
	feed_watchdog(&l, now_ns);
	assert_int_equal(fed, 1);
	l.seen.steps++;
	feed_watchdog(&l, now_ns += INTERVAL_NS); /* the echo stays away */
	assert_int_equal(fed, 1);
	l.seen.bus.confirmed++;
	feed_watchdog(&l, now_ns);
	assert_int_equal(fed, 2);
	l.seen.bus.confirmed++;
	feed_watchdog(&l, now_ns += INTERVAL_NS); /* the loop stands */
	assert_int_equal(fed, 2);
	l.seen.steps++;
	feed_watchdog(&l, now_ns);
	l.seen.steps++;
	l.seen.bus.confirmed++;
	feed_watchdog(&l, now_ns += INTERVAL_NS / 8); /* not more often than it takes */
	assert_int_equal(fed, 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_sign_of_life),
		cmocka_unit_test(test_watchdog_is_fed_by_new_signs_alone),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
