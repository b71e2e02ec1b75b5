/* SPDX-License-Identifier: MIT
 * The JSON emitter: nesting, commas, escapes, numbers that read back.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <math.h>
#include <cmocka.h>
#include "json.h"
#include "version.h"

static char *text;
static size_t size;

static struct json begin(void)
{
	return json_start(open_memstream(&text, &size));
}

static void expect(struct json *j, const char *want)
{
	fclose(j->out);
	assert_string_equal(text, want);
	free(text);
}

static void test_nesting(void **state)
{
	struct json j = begin();

	(void)state;
	json_open(&j, NULL, '{');
	json_uint(&j, "a", UINT64_MAX);
	json_open(&j, "b", '[');
	json_bool(&j, NULL, 1);
	json_bool(&j, NULL, 0);
	json_open(&j, NULL, '{');
	json_close(&j, '}');
	json_open(&j, NULL, '[');
	json_uint(&j, NULL, 1);
	json_close(&j, ']');
	json_close(&j, ']');
	json_str(&j, "c", NULL);
	json_close(&j, '}');
	expect(&j, "{\"a\":18446744073709551615,\"b\":[true,false,{},[1]],\"c\":null}\n");
}

static void test_strings(void **state)
{
	struct json j = begin();

	(void)state;
	json_str(&j, NULL, "a\"b\\c\n\x01 \xc3\xa9");
	expect(&j, "\"a\\\"b\\\\c\\u000a\\u0001 \xc3\xa9\"");
}

static void test_numbers(void **state)
{
	static const double values[] = {0.1,   1.0 / 3, 5e-324,  1.7976931348623157e308,
					-0.05, 1e22,    79.2269, 3e-5};
	static const double nothing[] = {NAN, INFINITY, -INFINITY};

	(void)state;
	for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
		struct json j = begin();

		json_num(&j, NULL, values[i]);
		fclose(j.out);
		assert_true(strtod(text, NULL) == values[i]);
		free(text);
	}
	for (size_t i = 0; i < sizeof(nothing) / sizeof(nothing[0]); i++) {
		struct json j = begin();

		json_num(&j, NULL, nothing[i]);
		expect(&j, "null");
	}
	struct json j = begin();

	json_num(&j, NULL, 0.1);
	expect(&j, "0.1");
}

static void test_head(void **state)
{
	struct json j = begin();

	(void)state;
	json_head(&j, "curve");
	json_close(&j, '}');
	expect(&j, "{\"schema\":\"aebmc.curve.1\",\"version\":\"" AEBMC_VERSION "\"}\n");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_nesting),
		cmocka_unit_test(test_strings),
		cmocka_unit_test(test_numbers),
		cmocka_unit_test(test_head),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
