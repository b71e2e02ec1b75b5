/* SPDX-License-Identifier: MIT
 * calibration: a file is the machine's own until device, clocks or CUDA change; other files are refused.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "calibration.h"

static const struct mc_cuda_info orin = {"Orin", 8, 7, 14, 1300000, 3199000, 12060, 12060};

static char path[] = "/tmp/test_calibration.XXXXXX";

static int make_file(void **state)
{
	const int fd = mkstemp(path);

	(void)state;
	return fd < 0 || close(fd);
}

static int drop_file(void **state)
{
	(void)state;
	return unlink(path);
}

static void write_text(const char *text)
{
	FILE *f = fopen(path, "w");

	assert_non_null(f);
	fputs(text, f);
	assert_int_equal(fclose(f), 0);
}

static void write_orin(void)
{
	const struct calibration c = {orin, {{1, 2, 3}, {4, 5, 6}}};
	FILE *f = fopen(path, "w");

	assert_non_null(f);
	calibration_write(&c, f);
	assert_int_equal(fclose(f), 0);
}

static void test_the_same_machine(void **state)
{
	char why[200] = "";

	(void)state;
	write_orin();
	assert_int_equal(calibration_differs(path, &orin, why, sizeof(why)), 0);
	assert_string_equal(why, "");
}

static void test_every_field_counts(void **state)
{
	(void)state;
	write_orin();
	for (int i = 0; i < 8; i++) {
		struct mc_cuda_info now = orin;
		int *const field[] = {
			&now.major,  &now.minor,  &now.sms, &now.clock_khz, &now.memory_clock_khz,
			&now.driver, &now.runtime};
		char why[200] = "";

		if (i < 7) {
			++*field[i];
		} else {
			now.name[0] = 'o';
		}
		assert_int_equal(calibration_differs(path, &now, why, sizeof(why)), 1);
		assert_non_null(
			strstr(why, i < 7 ? "here it is" : "device = Orin, here it is orin"));
	}
}

static void test_other_files(void **state)
{
	char why[200];

	(void)state;
	assert_int_equal(calibration_differs("/nonexistent/file", &orin, why, sizeof(why)),
			 -ENOENT);
	assert_int_equal(calibration_differs("/tmp", &orin, why, sizeof(why)), -EIO);
	write_text("");
	assert_int_equal(calibration_differs(path, &orin, why, sizeof(why)), -EINVAL);
	write_text("device\n");
	assert_int_equal(calibration_differs(path, &orin, why, sizeof(why)), -EINVAL);
	write_text("device = Orin\n");
	assert_int_equal(calibration_differs(path, &orin, why, sizeof(why)), -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_the_same_machine),
		cmocka_unit_test(test_every_field_counts),
		cmocka_unit_test(test_other_files),
	};

	return cmocka_run_group_tests(tests, make_file, drop_file);
}
