/* SPDX-License-Identifier: MIT
 * Warnings and requests of two replays: spans, partners, what is gained and lost.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../tools/compare_match.c"

#define N(a) (sizeof(a) / sizeof((a)[0]))

static struct compare_run run(struct compare_change *c, size_t n)
{
	return (struct compare_run){.head = {.n_changes = (uint32_t)n, .log_s = 100}, .change = c};
}

static void spans_have_their_highest_stage(void **state)
{
	struct compare_change a[] = {{1, LEVEL_WARN}, {2, LEVEL_PARTIAL}, {3, LEVEL_FULL},
				     {4, LEVEL_WARN}, {5, LEVEL_NONE},    {90, LEVEL_FULL}};
	const struct compare_run r[SIDES] = {run(a, N(a)), run(a, 0)};
	struct compare_diff d;

	(void)state;
	assert_int_equal(compare_match(r, KIND_WARNING, &d), 0);
	assert_int_equal(d.n[SIDE_A], 2);
	assert_int_equal(d.n[SIDE_B], 0);
	assert_true(d.span[SIDE_A][0].from_s == 1 && d.span[SIDE_A][0].to_s == 5);
	assert_int_equal(d.span[SIDE_A][0].level, LEVEL_FULL);
	assert_true(d.span[SIDE_A][1].to_s == 100); /* until the log's end */
	assert_int_equal(d.lost, 2);
	assert_int_equal(d.gained, 0);
	compare_match_free(&d);
	assert_int_equal(compare_match(r, KIND_REQUEST, &d), 0);
	assert_int_equal(d.n[SIDE_A], 2);
	assert_true(d.span[SIDE_A][0].from_s == 2 && d.span[SIDE_A][0].to_s == 4);
	compare_match_free(&d);
	compare_match_free(&d); /* twice is fine */
}

static void one_danger_is_one_partner(void **state)
{
	struct compare_change a[] = {{10, LEVEL_WARN}, {12, LEVEL_NONE}, {30, LEVEL_WARN},
				     {31, LEVEL_NONE}, {50, LEVEL_WARN}, {51, LEVEL_NONE}};
	struct compare_change b[] = {{11.5, LEVEL_WARN}, {13, LEVEL_NONE},  {13.5, LEVEL_WARN},
				     {14, LEVEL_NONE},   {32, LEVEL_WARN},  {33, LEVEL_NONE},
				     {49.5, LEVEL_WARN}, {49.7, LEVEL_NONE}};
	const struct compare_run r[SIDES] = {run(a, N(a)), run(b, N(b))};
	struct compare_diff d;

	(void)state;
	assert_int_equal(compare_match(r, KIND_WARNING, &d), 0);
	assert_int_equal(d.partner[0], 0);  /* they overlap */
	assert_int_equal(d.partner[1], -1); /* 2 s apart, one ended before the other began */
	assert_int_equal(d.partner[2], 3);  /* they begin within a second */
	assert_int_equal(d.lost, 1);
	assert_int_equal(d.gained, 2);
	assert_true(!compare_is_gained(&d, 0) && compare_is_gained(&d, 1));
	assert_true(compare_is_gained(&d, 2) && !compare_is_gained(&d, 3));
	compare_match_free(&d);
}

/* A's second warning begins within a second of B's first, but is on together with B's second. */
static void the_longest_overlap_wins(void **state)
{
	struct compare_change a[] = {
		{170, LEVEL_WARN}, {171, LEVEL_NONE}, {179.06, LEVEL_WARN}, {181.11, LEVEL_NONE}};
	struct compare_change b[] = {{178.16, LEVEL_WARN}, {178.56, LEVEL_NONE},
				     {179.01, LEVEL_WARN}, {181.11, LEVEL_NONE},
				     {190, LEVEL_WARN},    {191, LEVEL_NONE}};
	struct compare_run r[SIDES] = {run(a, N(a)), run(b, N(b))};
	struct compare_diff d;

	(void)state;
	assert_int_equal(compare_match(r, KIND_WARNING, &d), 0);
	assert_int_equal(d.partner[0], -1);
	assert_int_equal(d.partner[1], 1);
	assert_int_equal(d.lost, 1);
	assert_int_equal(d.gained, 2);
	assert_true(compare_is_gained(&d, 0) && !compare_is_gained(&d, 1));
	compare_match_free(&d);
	r[SIDE_A] = run(b, N(b));
	r[SIDE_B] = run(a, N(a));
	assert_int_equal(compare_match(r, KIND_WARNING, &d), 0); /* the same the other way round */
	assert_int_equal(d.partner[0], -1);
	assert_int_equal(d.partner[1], 1);
	compare_match_free(&d);
}

/* One of two takes what both want; the other gets the next best. */
static void the_better_claim_wins(void **state)
{
	struct compare_change a[] = {
		{10, LEVEL_WARN}, {13, LEVEL_NONE}, {13.5, LEVEL_WARN}, {17, LEVEL_NONE}};
	struct compare_change b[] = {
		{10, LEVEL_WARN}, {10.5, LEVEL_NONE}, {11, LEVEL_WARN}, {17, LEVEL_NONE}};
	struct compare_change near[] = {{29.2, LEVEL_WARN}, {29.3, LEVEL_NONE}, {29.5, LEVEL_WARN},
					{29.6, LEVEL_NONE}, {30.7, LEVEL_WARN}, {30.8, LEVEL_NONE}};
	struct compare_change one[] = {{30, LEVEL_WARN}, {30.4, LEVEL_NONE}};
	const struct compare_run r[SIDES] = {run(a, N(a)), run(b, N(b))};
	const struct compare_run s[SIDES] = {run(one, N(one)), run(near, N(near))};
	struct compare_diff d;

	(void)state;
	assert_int_equal(compare_match(r, KIND_WARNING, &d), 0);
	assert_int_equal(d.partner[0],
			 0); /* 0.5 s of it; 2 s of the other, which has 3.5 s with a[1] */
	assert_int_equal(d.partner[1], 1);
	assert_int_equal(d.lost + d.gained, 0);
	compare_match_free(&d);
	assert_int_equal(compare_match(s, KIND_WARNING, &d), 0);
	assert_int_equal(d.partner[0], 1); /* none overlaps: the nearest */
	assert_int_equal(d.gained, 2);
	compare_match_free(&d);
}

static int differs(struct compare_change *a, size_t n_a, struct compare_change *b, size_t n_b)
{
	struct compare_log l = {.run = {run(a, n_a), run(b, n_b)}};

	for (int k = 0; k < KINDS; k++) {
		assert_int_equal(compare_match(l.run, k, &l.diff[k]), 0);
	}
	const int ret = compare_differs(&l);

	for (int k = 0; k < KINDS; k++) {
		compare_match_free(&l.diff[k]);
	}
	return ret;
}

static void what_counts_as_a_difference(void **state)
{
	struct compare_change warn[] = {{10, LEVEL_WARN}, {12, LEVEL_NONE}};
	struct compare_change later[] = {{10.5, LEVEL_WARN}, {12, LEVEL_NONE}};
	struct compare_change full[] = {{10, LEVEL_WARN}, {11, LEVEL_FULL}, {12, LEVEL_NONE}};
	struct compare_change partial[] = {{10, LEVEL_WARN}, {11, LEVEL_PARTIAL}, {12, LEVEL_NONE}};

	(void)state;
	assert_false(differs(warn, 0, warn, 0));
	assert_false(differs(warn, 2, warn, 2));
	assert_false(differs(warn, 2, later, 2)); /* moved alone is none */
	assert_true(differs(warn, 2, warn, 0));
	assert_true(differs(warn, 0, warn, 2));
	assert_true(differs(warn, 2, full, 3));
	assert_true(differs(full, 3, partial, 3));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(spans_have_their_highest_stage),
		cmocka_unit_test(one_danger_is_one_partner),
		cmocka_unit_test(the_longest_overlap_wins),
		cmocka_unit_test(the_better_claim_wins),
		cmocka_unit_test(what_counts_as_a_difference),
	};

	return cmocka_run_group_tests_name("compare", tests, NULL, NULL);
}
