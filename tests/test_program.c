/* SPDX-License-Identifier: MIT
 * program: which of the folders around the running program, here this test, has a file.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "program.h"

static void test_first(void **state)
{
	static const char *const place[] = {"none/", "", "../tests/"};
	char path[PATH_MAX], own[PATH_MAX];

	(void)state;
	assert_non_null(realpath("/proc/self/exe", own));
	assert_int_equal(program_file(place, 3, strrchr(own, '/') + 1, path), 0);
	assert_string_equal(path, own);
	assert_int_equal(program_file(place + 2, 1, strrchr(own, '/') + 1, path), 0);
	assert_non_null(strstr(path, "/../tests/"));
}

static void test_none(void **state)
{
	static const char *const place[] = {"", "../none/"};
	char path[PATH_MAX];

	(void)state;
	assert_int_equal(program_file(place, 2, "nosuch", path), -ENOENT);
	assert_non_null(strstr(path, "/../none/nosuch"));
}

/* A path that was cut is not taken for the file that it happens to name. */
static void test_long(void **state)
{
	static char own[PATH_MAX], file[2 * PATH_MAX];
	char path[PATH_MAX];
	const char *const place[] = {file};

	(void)state;
	assert_non_null(realpath("/proc/self/exe", own));
	strrchr(own, '/')[1] = '\0';
	memset(file, '/', PATH_MAX - strlen(own) - 2); /* as many slashes as one */
	assert_int_equal(program_file(place, 1, "", path), 0);
	memset(file, '/', PATH_MAX);
	assert_int_equal(program_file(place, 1, "nosuch", path), -ENOENT);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_first),
		cmocka_unit_test(test_none),
		cmocka_unit_test(test_long),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
