/* SPDX-License-Identifier: MIT
 * The log bus where memory is short and the kernel says no: its calls are replaced by ones that fail on request.
 */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

enum call { NONE, CALLOC, FSTAT, FTRUNCATE, READ, WRITE, CLOSE };

/* The @after'th call of @which fails with @error, once; -n: a read or write that takes only n bytes. */
static struct {
	enum call which;
	int after, error;
} deny;

static int refused(enum call c)
{
	if (deny.which != c || deny.after-- > 0) {
		return 0;
	}
	deny.which = NONE;
	errno = deny.error;
	return 1;
}

static void *odd_calloc(size_t n, size_t size)
{
	return refused(CALLOC) ? NULL : calloc(n, size);
}

static int odd_fstat(int fd, struct stat *st)
{
	return refused(FSTAT) ? -1 : fstat(fd, st);
}

static int odd_ftruncate(int fd, off_t size)
{
	return refused(FTRUNCATE) ? -1 : ftruncate(fd, size);
}

static ssize_t odd_read(int fd, void *data, size_t size)
{
	return read(fd, data, refused(READ) ? (size_t)-deny.error : size);
}

static ssize_t odd_write(int fd, const void *data, size_t size)
{
	if (refused(WRITE)) {
		return deny.error > 0 ? -1 : write(fd, data, (size_t)-deny.error);
	}
	return write(fd, data, size);
}

static int odd_close(int fd)
{
	int error = refused(CLOSE);

	return close(fd) || error ? -1 : 0;
}

#define calloc    odd_calloc
#define fstat     odd_fstat
#define ftruncate odd_ftruncate
#define read      odd_read
#define write     odd_write
#define close(fd) odd_close(fd)
#include "../daemon/bus_log.c"
#undef calloc
#undef fstat
#undef ftruncate
#undef read
#undef write
#undef close

static char in[] = "/tmp/test_log_in_XXXXXX", out[] = "/tmp/test_log_out_XXXXXX";

static int make_files(void **state)
{
	(void)state;
	close(mkstemp(in));
	close(mkstemp(out));
	return 0;
}

static int remove_files(void **state)
{
	(void)state;
	return unlink(in) | unlink(out);
}

static int open_log(struct bus **b, char err[256])
{
	static const char *const ifaces[] = {"can0"};

	*b = NULL;
	return bus_log_open(in, out, ifaces, 1, b, err, 256);
}

static void opening_fails_with_what_refused(void **state)
{
	static const struct {
		enum call which;
		int after, error;
		const char *words;
	} row[] = {
		{CALLOC, 0, ENOMEM, ": out of memory"},
		{FSTAT, 0, EIO, ": cannot read: Input/output error"},
		{FTRUNCATE, 0, EPERM, ": cannot empty: Operation not permitted"},
	};
	char err[256];
	struct bus *b;

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		deny.which = row[i].which;
		deny.after = row[i].after;
		deny.error = row[i].error;
		assert_int_equal(open_log(&b, err), -row[i].error);
		assert_non_null(strstr(err, row[i].words));
		assert_null(b);
	}
}

/* Two files of which one cannot say what it is are not known to be one; a device cannot be emptied and need not be. */
static void doubts_do_not_stop_the_opening(void **state)
{
	static const struct {
		enum call which;
		int after, error;
	} row[] = {{FSTAT, 1, EIO}, {FSTAT, 2, EIO}, {FTRUNCATE, 0, EINVAL}};
	char err[256];
	struct bus *b;

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		deny.which = row[i].which;
		deny.after = row[i].after;
		deny.error = row[i].error;
		assert_int_equal(open_log(&b, err), 0);
		assert_int_equal(deny.which, NONE);
		b->ops->close(b);
	}
}

static void device_is_read_like_a_log(void **state)
{
	static const char *const ifaces[] = {"can0"};
	struct bus_frame f;
	int64_t now_ns;
	char err[256];
	struct bus *b;

	(void)state;
	assert_int_equal(bus_log_open("/dev/null", out, ifaces, 1, &b, err, 256), 0);
	assert_int_equal(b->ops->recv(b, &f, 1, INT64_MAX, &now_ns), -ENODATA);
	b->ops->close(b);
}

/* A pipe may give a single byte at a time, and that is not yet the end. */
static void reads_may_be_short(void **state)
{
	static const char text[] = "(1.000000) can0 123#0102\n";
	struct bus_frame f;
	int64_t now_ns;
	char err[256];
	struct bus *b;
	FILE *log = fopen(in, "w");

	(void)state;
	assert_non_null(log);
	fputs(text, log);
	fclose(log);
	assert_int_equal(open_log(&b, err), 0);
	deny.which = READ;
	deny.after = 0;
	deny.error = -1;
	assert_int_equal(b->ops->recv(b, &f, 1, INT64_MAX, &now_ns), 1);
	assert_int_equal(deny.which, NONE);
	assert_int_equal(f.id, 0x123);
	b->ops->close(b);
}

static void writes_go_on_after_an_interruption_and_in_pieces(void **state)
{
	static const int error[] = {EINTR, 0, -1};
	const struct bus_frame f = {.id = 0x123, .len = 2, .data = {1, 2}, .t_ns = 1000000000};
	char err[256], text[128] = "";
	struct bus *b;

	(void)state;
	for (size_t i = 0; i < sizeof(error) / sizeof(error[0]); i++) {
		assert_int_equal(open_log(&b, err), 0);
		deny.which = WRITE;
		deny.error = error[i];
		assert_int_equal(b->ops->send(b, &f), 0);
		assert_int_equal(deny.which, NONE);
		assert_int_equal(bus_log_finish(b), 0);
		b->ops->close(b);

		FILE *written = fopen(out, "r");

		assert_non_null(written);
		assert_non_null(fgets(text, sizeof(text), written));
		assert_string_equal(text, "(0000000001.000000) can0 123#0102\n");
		assert_int_equal(fgetc(written), EOF);
		fclose(written);
	}
}

static void first_error_of_writing_is_kept(void **state)
{
	const struct bus_frame f = {.id = 0x123};
	char err[256];
	struct bus *b;

	(void)state;
	assert_int_equal(open_log(&b, err), 0);
	deny.which = WRITE;
	deny.error = ENOSPC;
	assert_int_equal(b->ops->send(b, &f), -ENOSPC);
	deny.which = WRITE;
	deny.error = EIO;
	assert_int_equal(b->ops->send(b, &f), -EIO);
	deny.which = CLOSE;
	deny.error = EDQUOT;
	assert_int_equal(bus_log_finish(b), -ENOSPC);
	b->ops->close(b);

	assert_int_equal(open_log(&b, err), 0);
	deny.which = CLOSE;
	deny.error = EDQUOT;
	assert_int_equal(bus_log_finish(b), -EDQUOT);
	b->ops->close(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(opening_fails_with_what_refused),
		cmocka_unit_test(doubts_do_not_stop_the_opening),
		cmocka_unit_test(device_is_read_like_a_log),
		cmocka_unit_test(reads_may_be_short),
		cmocka_unit_test(writes_go_on_after_an_interruption_and_in_pieces),
		cmocka_unit_test(first_error_of_writing_is_kept),
	};

	return cmocka_run_group_tests(tests, make_files, remove_files);
}
