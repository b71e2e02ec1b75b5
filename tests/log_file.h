/* SPDX-License-Identifier: MIT
 * Logs for the log bus's tests: in.log of a directory of their own, opened and read to the end.
 */
#ifndef AEBMC_TEST_LOG_FILE_H
#define AEBMC_TEST_LOG_FILE_H

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include "bus.h"
#include "clock.h"

static const char *const log_ifaces[] = {"can0", "can1"};

static inline void log_write(const char *path, const void *data, size_t size)
{
	FILE *f = fopen(path, "w");

	assert_non_null(f);
	assert_int_equal(fwrite(data, 1, size, f), size);
	assert_int_equal(fclose(f), 0);
}

static inline int log_make_dir(void **state)
{
	static char dir[64];

	snprintf(dir, sizeof(dir), "/tmp/aebmc_bus_log_XXXXXX");
	*state = mkdtemp(dir);
	return *state && chdir(dir) == 0 ? 0 : -1;
}

static inline int log_remove_dir(void **state)
{
	(void)remove("in.log");
	(void)remove("out.log");
	return chdir("/") == 0 && rmdir(*state) == 0 ? 0 : -1;
}

static inline struct bus *log_open(const char *text, size_t size, const char *out)
{
	struct bus *b = NULL;
	char err[256] = "";

	log_write("in.log", text, size);
	assert_int_equal(bus_log_open("in.log", out, log_ifaces, 2, &b, err, sizeof(err)), 0);
	return b;
}

/* Reads to the end; returns the number of frames. */
static inline int log_drain(struct bus *b)
{
	struct bus_frame f[8];
	int64_t now;
	int n, total = 0;

	while ((n = b->ops->recv(b, f, 8, CLOCK_NEVER, &now)) > 0) {
		total += n;
	}
	assert_int_equal(n, -ENODATA);
	return total;
}

#endif
