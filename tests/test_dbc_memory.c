/* SPDX-License-Identifier: MIT
 * Every allocation of the loader fails in turn, and every read: the error is reported, nothing leaks (AddressSanitizer).
 * The loader is compiled into this program with its calls replaced.
 */
#include <errno.h>
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

static unsigned calls_left; /* allocations that still succeed */
static int one_fails;       /* only the first that does not; otherwise all after it too */
static int read_mode;       /* 0: as it is; 1: one byte at a time; 2: ends early; 3: fails */

static int stat_fails;
static off_t size_then; /* of a file that grew since; 0: as it is */

static int odd_fstat(int fd, struct stat *st)
{
	if (stat_fails) {
		errno = EIO;
		return -1;
	}
	int rc = fstat(fd, st);
	st->st_size = size_then ? size_then : st->st_size;
	return rc;
}

static int refuse_call(void)
{
	const int refused = calls_left == 0;

	calls_left = refused && one_fails ? UINT_MAX : calls_left - !refused;
	return refused;
}

static void *scarce_malloc(size_t size)
{
	return refuse_call() ? NULL : malloc(size);
}

static void *scarce_calloc(size_t n, size_t size)
{
	return refuse_call() ? NULL : calloc(n, size);
}

static void *scarce_realloc(void *p, size_t size)
{
	return refuse_call() ? NULL : realloc(p, size);
}

static ssize_t odd_read(int fd, void *to, size_t size)
{
	switch (read_mode) {
	case 1:
		return read(fd, to, size < 1 ? size : 1);
	case 2:
		return 0;
	case 3:
		errno = EIO;
		return -1;
	default:
		return read(fd, to, size);
	}
}

#define malloc  scarce_malloc
#define calloc  scarce_calloc
#define realloc scarce_realloc
#define read    odd_read
#define fstat   odd_fstat
#include "../can-dbc/dbc_load.c"
#include "../can-dbc/loader_frames.c"
#include "../can-dbc/loader_values.c"
#include "../can-dbc/loader_attrs.c"
#undef malloc
#undef calloc
#undef realloc
#undef read
#undef fstat

#define FILE_DBC "can-dbc/aebmc.dbc"

static int load(char err[256])
{
	struct dbc *dbc = NULL;
	int rc = dbc_load(FILE_DBC, &dbc, err, 256);
	assert_int_equal(rc == 0, dbc != NULL);
	dbc_free(dbc);
	return rc;
}

static unsigned fail_each(void)
{
	unsigned n = 0;

	for (int rc = -ENOMEM; rc; n++) {
		char err[256] = "";
		calls_left = n;
		rc = load(err);
		assert_true(rc == 0 || rc == -ENOMEM);
		assert_int_equal(rc != 0, strstr(err, FILE_DBC ":") == err);
		if (n > 0 && n < 5) { /* the file is there, no line is read yet */
			assert_string_equal(err, FILE_DBC ": out of memory");
		}
	}
	return n;
}

static void every_allocation_may_fail(void **state)
{
	(void)state;
	read_mode = 0;
	const unsigned n = fail_each();

	/* text, names, two arrays of messages, each message's signals, each signal's values */
	assert_true(n > 50);
	one_fails = 1;
	assert_int_equal(fail_each(), n);
	one_fails = 0;
}

static void reads_may_be_odd(void **state)
{
	(void)state;
	static const struct {
		int rc;
		const char *err;
	} want[] = {
		{0, ""},
		{0, ""},
		{-EINVAL, FILE_DBC ": no message (BO_) in it: is this a DBC file?"},
		{-EIO, FILE_DBC ": Input/output error"},
	};
	for (read_mode = 0; read_mode < 4; read_mode++) {
		char err[256] = "";
		calls_left = UINT_MAX;
		assert_int_equal(load(err), want[read_mode].rc);
		assert_string_equal(err, want[read_mode].err);
	}
}

static void file_may_not_say_its_size(void **state)
{
	char err[256] = "";

	(void)state;
	read_mode = 0;
	calls_left = UINT_MAX;
	stat_fails = 1;
	assert_int_equal(load(err), -EIO);
	assert_string_equal(err, FILE_DBC ": Input/output error");
	stat_fails = 0;
}

static void only_what_was_there_is_read(void **state)
{
	char path[] = "/tmp/test_dbc_XXXXXX", err[256] = "";
	static const char first[] = "BO_ 1 ONE: 8 X\n", later[] = "BO_ 2 TWO: 8 X\n";
	struct dbc *dbc = NULL;
	int fd = mkstemp(path);

	(void)state;
	assert_int_equal(write(fd, first, sizeof(first) - 1), sizeof(first) - 1);
	assert_int_equal(write(fd, later, sizeof(later) - 1), sizeof(later) - 1);
	close(fd);
	read_mode = 1;
	calls_left = UINT_MAX;
	size_then = sizeof(first) - 1;
	int rc = dbc_load(path, &dbc, err, sizeof(err));
	size_then = 0;
	unlink(path);
	assert_int_equal(rc, 0);
	assert_int_equal(dbc->n_messages, 1);
	dbc_free(dbc);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_allocation_may_fail),
		cmocka_unit_test(reads_may_be_odd),
		cmocka_unit_test(file_may_not_say_its_size),
		cmocka_unit_test(only_what_was_there_is_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
