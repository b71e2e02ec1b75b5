/* SPDX-License-Identifier: MIT
 * The CSV reader of aebmc plot: cells where they belong, and every way in which a file can be wrong told with its line.
 */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../tools/sheet.c"

static void test_cells(void **state)
{
	char text[] = "time_s,p,word\n0.5,,none\r\n1,1e-3,\n-2,0x10,full\n";
	char err[128] = "";
	struct sheet s;
	double v[3];

	(void)state;
	assert_int_equal(sheet_open(text, &s, err, sizeof(err)), 0);
	assert_int_equal(s.rows, 3);
	assert_int_equal(s.columns, 3);
	assert_int_equal(sheet_column(&s, "p"), 1);
	assert_int_equal(sheet_column(&s, "tim"), -1);
	assert_string_equal(sheet_word(&s, 0, 2), "none");
	assert_string_equal(sheet_word(&s, 1, 2), "");
	assert_string_equal(sheet_word(&s, 2, 2), "full");
	assert_int_equal(sheet_numbers(&s, "time_s", v, err, sizeof(err)), 0);
	assert_true(v[0] == 0.5 && v[1] == 1 && v[2] == -2);
	assert_int_equal(sheet_numbers(&s, "word", v, err, sizeof(err)), -EINVAL);
	assert_string_equal(err, "line 2: word is 'none', which is no number");
	assert_int_equal(sheet_numbers(&s, "p_now", v, err, sizeof(err)), -EINVAL);
	assert_string_equal(err, "no column p_now");
	sheet_close(&s);
}

static void test_empty_is_nan(void **state)
{
	char text[] = "a,b\n1,\n,2\n";
	char err[128];
	struct sheet s;
	double v[2];

	(void)state;
	assert_int_equal(sheet_open(text, &s, err, sizeof(err)), 0);
	assert_int_equal(sheet_numbers(&s, "b", v, err, sizeof(err)), 0);
	assert_true(isnan(v[0]) && v[1] == 2);
	sheet_close(&s);
}

static void expect_bad(const char *content, const char *want)
{
	char *text = strdup(content), err[128] = "";
	struct sheet s;

	assert_int_equal(sheet_open(text, &s, err, sizeof(err)), -EINVAL);
	assert_string_equal(err, want);
	free(text);
}

static void test_bad(void **state)
{
	(void)state;
	expect_bad("", "no rows");
	expect_bad("a,b\n", "no rows");
	expect_bad("a,b", "no rows");
	expect_bad("a,b\n1,2\n3", "line 3 ends in the middle: cut off?");
	expect_bad("a,b\n1,2\n3,4", "line 3 ends in the middle: cut off?");
	expect_bad("a,b\n1,2\n3\n", "line 3 has 1 fields, the first line 2");
	expect_bad("a,b\n1,2,3\n", "line 2 has 3 fields, the first line 2");
	expect_bad("a,b\n\n1,2\n", "line 2 has 1 fields, the first line 2");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_cells),
		cmocka_unit_test(test_empty_is_nan),
		cmocka_unit_test(test_bad),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
