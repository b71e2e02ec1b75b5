/* SPDX-License-Identifier: MIT
 * Small helpers of the configuration: words, numbers, names, units, hashes.
 */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <math.h>

#include "hash.h"
#include "text.h"
#include "unit.h"

static void text_helpers(void **state)
{
	static const char *const names[] = {"alpha", "beta", "betas"};
	char line[] = "  one\t two ", *rest = line;
	double number = 7;
	int64_t integer = 7;
	int truth = 7;

	(void)state;
	assert_string_equal(text_word(&rest), "one");
	assert_string_equal(text_word(&rest), "two");
	assert_null(text_word(&rest));
	assert_string_equal(text_nearest("BETAZ", names, 3, sizeof(names[0])), "beta");
	assert_string_equal(text_nearest("x", names, 0, sizeof(names[0])), "");
	assert_int_equal(text_number(" ", &number), -EINVAL);
	assert_int_equal(text_number("inf", &number), -ERANGE);
	assert_int_equal(text_integer("-0x8000000000000000", &integer), 0);
	assert_true(integer == INT64_MIN);
	assert_int_equal(text_integer("-0x8000000000000001", &integer), -ERANGE);
	assert_int_equal(text_truth("yes", &truth), 0);
	assert_int_equal(truth, 1);
	assert_int_equal(text_truth("Yes", &truth), -EINVAL);
	assert_true(number == 7);
}

/* FNV-1a as published: "foobar" without its end gives 85944171f73967e8. */
static void hash_known_answers(void **state)
{
	(void)state;
	assert_true(hash_text(HASH_START, "") == 0xaf63bd4c8601b7dfu);
	assert_true(hash_text(HASH_START, "foobar") == 0x85944171f73967e8u * 0x100000001b3u);
	assert_true(hash_u64(HASH_START, 0x7261626f6f66u) ==
		    0x85944171f73967e8u * 0x100000001b3u * 0x100000001b3u);
	assert_true(hash_f64(HASH_START, -0.0) == hash_f64(HASH_START, 0.0));
	assert_true(hash_f64(HASH_START, 1.0) == hash_u64(HASH_START, 0x3ff0000000000000u));
}

static void units_are_converted(void **state)
{
	static const struct {
		enum unit_kind kind;
		const char *name;
		double gain;
	} known[] = {
		{UNIT_SPEED, "m/s", 1.0},
		{UNIT_SPEED, "km/h", 1.0 / 3.6},
		{UNIT_SPEED, "mph", 0.44704},
		{UNIT_LENGTH, "m", 1.0},
		{UNIT_LENGTH, "cm", 0.01},
		{UNIT_TURN, "rad/s", 1.0},
		{UNIT_TURN, "\xB0/s", M_PI / 180},
		{UNIT_SHARE, "%", 0.01},
		{UNIT_SHARE, "", 1.0},
		{UNIT_FLAG, "anything", 1.0},
	};
	char text[128], tiny[4];
	double gain = 7;

	(void)state;
	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
		assert_int_equal(unit_gain(known[i].kind, known[i].name, &gain), 0);
		assert_true(gain == known[i].gain);
	}
	gain = 7;
	assert_int_equal(unit_gain(UNIT_SPEED, "m", &gain), -EINVAL);
	assert_int_equal(unit_gain(UNIT_LENGTH, "", &gain), -EINVAL);
	assert_true(gain == 7);
	assert_string_equal(unit_list(UNIT_LENGTH, text, sizeof(text)), "m, meters, cm, mm");
	assert_string_equal(unit_list(UNIT_SHARE, text, sizeof(text)), "1, %");
	assert_string_equal(unit_list(UNIT_LENGTH, tiny, sizeof(tiny)), "m, ");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(text_helpers),
		cmocka_unit_test(hash_known_answers),
		cmocka_unit_test(units_are_converted),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
