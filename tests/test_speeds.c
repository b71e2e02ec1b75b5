/* SPDX-License-Identifier: MIT
 * The queue of ego speeds and what counts as a jump.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "clock.h"
#include "speeds.h"

#define MS CLOCK_NS_PER_MS

static int judge(struct speeds *q, int ms, double mps)
{
	return speeds_judge(q, &(struct speed){ms * MS, mps}, 10, 0.5);
}

static void push(struct speeds *q, int ms, double mps)
{
	struct speed old;

	assert_int_equal(speeds_push(q, &(struct speed){ms * MS, mps}, &old), 0);
}

static void what_was_measured_first_comes_first(void **state)
{
	struct speeds q;
	struct speed s;

	(void)state;
	speeds_reset(&q);
	assert_int_equal(speeds_pop(&q, INT64_MAX, &s), 0);
	push(&q, 20, 1);
	push(&q, 40, 2);
	assert_int_equal(q.n, 2);
	assert_true(speeds_at(&q, 1)->mps == 2);
	assert_int_equal(speeds_pop(&q, 19 * MS, &s), 0);
	assert_int_equal(speeds_pop(&q, 20 * MS, &s), 1);
	assert_true(s.t_ns == 20 * MS && s.mps == 1);
	assert_int_equal(speeds_pop(&q, 39 * MS, &s), 0);
	assert_int_equal(speeds_pop(&q, INT64_MAX, &s), 1);
	assert_int_equal(q.n, 0);
}

static void a_full_queue_hands_out_its_oldest(void **state)
{
	struct speeds q;
	struct speed s;

	(void)state;
	speeds_reset(&q);
	for (int i = 0; i < SPEEDS_MAX; i++) {
		push(&q, i, i);
	}
	for (int i = 0; i < 3 * SPEEDS_MAX; i++) {
		const struct speed next = {(SPEEDS_MAX + i) * MS, SPEEDS_MAX + i};

		assert_int_equal(speeds_push(&q, &next, &s), 1);
		assert_true(s.mps == i);
		assert_int_equal(q.n, SPEEDS_MAX);
		assert_true(speeds_at(&q, 0)->mps == i + 1);
		assert_true(speeds_at(&q, SPEEDS_MAX - 1)->mps == SPEEDS_MAX + i);
	}
}

static void the_first_speed_is_believed(void **state)
{
	struct speeds q;

	(void)state;
	speeds_reset(&q);
	assert_int_equal(judge(&q, 0, 70), 0);
}

static void a_jump_is_more_than_a_car_can(void **state)
{
	struct speeds q;

	(void)state;
	speeds_reset(&q);
	push(&q, 100, 20);
	assert_int_equal(judge(&q, 100, 20.5), 0);
	assert_int_equal(judge(&q, 100, 19.5), 0);
	/* 10 m/s2 for 20 ms and 0.5 m/s of noise */
	assert_int_equal(judge(&q, 120, 20.69), 0);
	assert_int_equal(judge(&q, 120, 19.31), 0);
	assert_int_equal(judge(&q, 120, 20.71), 1);
	assert_int_equal(judge(&q, 120, 19.29), 2);
	/* a value in between ends the row; time without a plausible one widens the bound */
	assert_int_equal(judge(&q, 140, 20.5), 0);
	assert_int_equal(judge(&q, 140, 21), 1);
	assert_int_equal(judge(&q, 160, 21), 0);
}

static void a_reset_forgets(void **state)
{
	struct speeds q;
	struct speed s;

	(void)state;
	speeds_reset(&q);
	push(&q, 100, 20);
	assert_int_equal(judge(&q, 100, 40), 1);
	speeds_reset(&q);
	assert_int_equal(speeds_pop(&q, INT64_MAX, &s), 0);
	assert_int_equal(judge(&q, 100, 40), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_was_measured_first_comes_first),
		cmocka_unit_test(a_full_queue_hands_out_its_oldest),
		cmocka_unit_test(the_first_speed_is_believed),
		cmocka_unit_test(a_jump_is_more_than_a_car_can),
		cmocka_unit_test(a_reset_forgets),
	};

	return cmocka_run_group_tests_name("speeds", tests, NULL, NULL);
}
