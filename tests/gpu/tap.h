/* SPDX-License-Identifier: MIT
 * TAP for programs that must run where nothing but gcc, make and nvcc is installed. One program, one file.
 */
#ifndef AEBMC_TESTS_GPU_TAP_H
#define AEBMC_TESTS_GPU_TAP_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static int tap_count, tap_failed;

/* tap_ok - one result line; returns @good. */
__attribute__((format(printf, 2, 3))) static int tap_ok(int good, const char *fmt, ...)
{
	va_list ap;

	tap_failed += !good;
	printf("%sok %d - ", good ? "" : "not ", ++tap_count);
	va_start(ap, fmt);
	vprintf(fmt, ap);
	va_end(ap);
	putchar('\n');
	fflush(stdout);
	return good;
}

/* tap_end - the plan, after the fact, and the exit code. */
static int tap_end(void)
{
	printf("1..%d\n", tap_count);
	return tap_failed ? 1 : 0;
}

#endif
