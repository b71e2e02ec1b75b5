/* SPDX-License-Identifier: MIT
 * TAP for programs that must run where nothing but gcc, make and nvcc is installed. Children of fork() count on.
 */
#ifndef AEBMC_TESTS_GPU_TAP_H
#define AEBMC_TESTS_GPU_TAP_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

struct tap {
	int count, failed;
};

/* The counters, shared with children. */
static inline struct tap *tap_state(void)
{
	static struct tap *t;

	if (!t) {
		t = mmap(NULL, sizeof(*t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1,
			 0);
	}
	if (t == MAP_FAILED) {
		exit(1);
	}
	return t;
}

/* tap_ok - one result line; returns @good. */
__attribute__((format(printf, 2, 3))) static inline int tap_ok(int good, const char *fmt, ...)
{
	struct tap *t = tap_state();
	va_list ap;

	t->failed += !good;
	printf("%sok %d - ", good ? "" : "not ", ++t->count);
	va_start(ap, fmt);
	vprintf(fmt, ap);
	va_end(ap);
	putchar('\n');
	fflush(stdout);
	return good;
}

/* tap_end - the plan, after the fact; returns the exit code. */
static inline int tap_end(void)
{
	printf("1..%d\n", tap_state()->count);
	return tap_state()->failed ? 1 : 0;
}

#endif
