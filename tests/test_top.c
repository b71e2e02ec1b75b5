/* SPDX-License-Identifier: MIT
 * Every path that aebmc top shows exists in what the daemon says.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include "../tools/cli.c"
#include "../tools/json_path.c"
#include "../tools/top.c"
#include "status.h"

/* No daemon is asked here. */
const struct argp ask_argp;

int ask_open(const char *who, const struct ask_args *a, struct ask *ret)
{
	(void)who;
	(void)a;
	(void)ret;
	return CLI_FAILED;
}

int ask(const char *who, struct ask *a, const char *command)
{
	(void)who;
	(void)a;
	(void)command;
	return CLI_FAILED;
}

void ask_close(struct ask *a)
{
	(void)a;
}

static char text[CONTROL_REPLY_MAX];
static struct hist hist[STAGES];

static int write_status(void **state)
{
	const struct status s = {.now.fault = 3, .now.have_result = 1};
	const struct status_link link[] = {
		{"can0", 1, {.known = 1, .state = "bus-off", .counted = 1}},
		{"can1", 1, {.known = 1, .state = "bus-off"}},
	};
	FILE *out = fmemopen(text, sizeof(text), "w");

	(void)state;
	hist_add(&hist[STAGE_MC], 12000000);
	status_json(&s, hist, link, 2, out);
	return fclose(out);
}

static void expect_rows(const struct top_row *r, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		if (!json_path(text, r[i].path)) {
			fail_msg("the status has no %s", r[i].path);
		}
	}
}

static void test_paths(void **state)
{
	(void)state;
	expect_rows(rows, ROWS);
	expect_rows(line_rows, LINE_ROWS);
	expect_rows(link_rows, LINK_ROWS);
	assert_null(json_path(text, "links.1.tx_errors")); /* not counted is not 0 */
	assert_non_null(json_path(text, "links.1.bitrate"));
}

static void test_lists(void **state)
{
	char value[TEXT_MAX];

	(void)state;
	assert_string_equal(value_of(text, "reasons.0", value), fault_table[0].name);
	assert_string_equal(value_of(text, "reasons.1", value), fault_table[1].name);
	assert_string_equal(value_of(text, "reasons.2", value), "-");
}

static void test_values(void **state)
{
	char value[TEXT_MAX];

	(void)state;
	assert_string_equal(value_of("{\"a\":0.123456789}", "a", value), "0.1235");
	assert_string_equal(value_of("{\"a\":123456789}", "a", value), "123456789");
	assert_string_equal(value_of("{\"a\":null}", "a", value), "-");
	assert_string_equal(value_of("{\"a\":\"e.on\"}", "a", value), "e.on");
	assert_string_equal(value_of("{}", "a", value), "-");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_paths),
		cmocka_unit_test(test_lists),
		cmocka_unit_test(test_values),
	};

	return cmocka_run_group_tests(tests, write_status, NULL);
}
