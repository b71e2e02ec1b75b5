/* SPDX-License-Identifier: MIT
 * Configuration files as lines: what is no such file, and where.
 */
#include "conf_dir.h"

#include <errno.h>

#include "ini.h"

#define PATH_MAX_ (2 * CONF_DIR_PATH)

static char dir[CONF_DIR_PATH];

/* refused - one line, "DIR/test.conf" and then @want */
static void refused(const char *text, size_t len, const char *want)
{
	struct ini *ini = NULL;
	char err[1024] = "", path[PATH_MAX_], start[PATH_MAX_ + 256];

	conf_dir_write(dir, "test.conf", text, len, path);
	assert_int_equal(ini_read(path, err, sizeof(err), &ini), -EINVAL);
	assert_null(ini);
	snprintf(start, sizeof(start), "%s%s", path, want);
	if (strncmp(err, start, strlen(start)) != 0) {
		fail_msg("wanted %s, got %s", start, err);
	}
	assert_null(strchr(err, '\n'));
}

/* accepted - with @n sections and keys */
static void accepted(const char *text, size_t len, int n)
{
	struct ini *ini;
	char err[1024] = "", path[PATH_MAX_];

	conf_dir_write(dir, "test.conf", text, len, path);
	if (ini_read(path, err, sizeof(err), &ini)) {
		fail_msg("%s", err);
	}
	assert_int_equal(ini->n, n);
	ini_free(ini);
}

static const struct {
	const char *text, *want;
} bad[] = {
	/* no configuration file */
	{"mass = 1\n", ":1: 'mass = 1' stands before any section"},
	{"[vehicle]\nmass 1\n", ":2: [vehicle]: 'mass 1' has no '='"},
	{"# x\n\n[vehicle\n", ":3: '[vehicle' has no closing bracket"},
	{"[vehicle] mass = 1\n", ":1: '[vehicle] mass = 1' has no closing bracket"},
	{"[]\n", ":1: empty name"},
	{"[ \t ]\n", ":1: empty name"},
	{"[vehicle]\n = 3\n", ":2: [vehicle]: empty name"},
	{"; comment\n", ":1: '; comment' has no '='"},
	{"[vehicle]\nmass = 1500\nmass = 1500\n", ":3: vehicle.mass: given twice, first in line 2"},
	{"[road]\n[vehicle]\n[road]\n", ":3: [road]: given twice, first in line 1"},
	{"[road]\nmu =\x01 1\n", ":2: [road]: byte 0x01 in column 5 is no text"},
	{"[road]\nmu = 1\x7F\n", ":2: [road]: byte 0x7F in column 7 is no text"},
	{"[road]\n# \x1B[31m\n", ":2: [road]: byte 0x1B in column 3 is no text"},
	{"[road]\nmu = 1\r2\n", ":2: [road]: byte 0x0D in column 7 is no text"},
	{"# 20 \xB0\n", ":1: byte 0xB0 in column 6 is no text; save the file as UTF-8"},
	{"# \xC3\n", ":1: byte 0xC3 in column 3 is no text"},
	{"# \xC3(\n", ":1: byte 0xC3 in column 3 is no text"},
	{"# \xC0\x80\n", ":1: byte 0xC0 in column 3 is no text"},
	{"# \xE2\x82", ":1: byte 0xE2 in column 3 is no text"},
	{"# \xF5\x80\x80\x80\n", ":1: byte 0xF5 in column 3 is no text"},
	{"\xFF\xFE[", ":1: byte 0xFF in column 1 is no text"},
};

static void errors_are_named(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		refused(bad[i].text, strlen(bad[i].text), bad[i].want);
	}
}

static void entries_are_found(void **state)
{
	static const char text[] = "[ a   b ]\nk = v w # x\n\tl=\n[c]\nk =1=2\n";
	char err[1024], path[PATH_MAX_];
	const struct ini_entry *e;
	struct ini *ini;

	(void)state;
	conf_dir_write(dir, "test.conf", text, sizeof(text) - 1, path);
	assert_int_equal(ini_read(path, err, sizeof(err), &ini), 0);
	assert_int_equal(ini->n, 5);
	e = ini_get(ini, "a b", "k");
	assert_string_equal(e->value, "v w");
	assert_int_equal(e->line, 2);
	assert_string_equal(ini_get(ini, "a b", "l")->value, "");
	assert_string_equal(ini_get(ini, "c", "k")->value, "1=2");
	assert_int_equal(ini_get(ini, "c", "")->line, 4);
	assert_null(ini_get(ini, "c", "l"));
	assert_int_equal(ini_override(ini, "a b.k=z"), 0);
	assert_string_equal(ini_get(ini, "a b", "k")->value, "z");
	assert_int_equal(ini->n, 5);
	assert_int_equal(ini_override(ini, "new {0..1}.k = z"), 0);
	assert_int_equal(ini->n, 7);
	assert_string_equal(ini_get(ini, "new {0..1}", "k")->value, "z");
	ini_free(ini);
	ini_free(NULL);
}

static void bytes_that_strings_cannot_hold(void **state)
{
	static const char nul[] = "[road]\nmu = 1\0 2\n", early[] = "\0[road]";

	(void)state;
	refused(nul, sizeof(nul) - 1, ":2: [road]: byte 0x00 in column 7 is no text");
	refused(early, sizeof(early) - 1, ":1: byte 0x00 in column 1 is no text");
}

static void byte_order_mark_is_skipped(void **state)
{
	static const char text[] = "\xEF\xBB\xBF[road]\nmu = 1\n",
			  later[] = "\n\xEF\xBB\xBF[road]\n";

	(void)state;
	accepted(text, sizeof(text) - 1, 2);
	accepted(text, 3, 0);
	refused(later, sizeof(later) - 1, ":2: ");
}

static void long_things(void **state)
{
	static char text[1 << 20];
	int n;

	(void)state;
	memset(text, 'x', sizeof(text));
	refused(text, sizeof(text), ":1: line longer than 1000 characters");
	text[0] = '#';
	text[1000] = '\n';
	accepted(text, 1001, 0);
	text[1000] = 'x';
	text[1001] = '\n';
	refused(text, 1002, ":1: line longer than 1000 characters");

	n = snprintf(text, sizeof(text), "[%0*d]\n", INI_NAME_MAX, 0);
	refused(text, (size_t)n, ":1: name longer than 95 characters");
	n = snprintf(text, sizeof(text), "[mc]\n%0*d = 1\n", INI_NAME_MAX, 0);
	refused(text, (size_t)n, ":2: [mc]: name longer than 95 characters");

	n = 0;
	for (int i = 0; i <= INI_ENTRIES_MAX; i++) {
		n += snprintf(text + n, sizeof(text) - (size_t)n, "[message M%d]\n", i);
	}
	refused(text, (size_t)n, ":1001: [message M1000]: more than 1000 sections and keys");
}

static void files_that_are_none(void **state)
{
	char err[1024], path[PATH_MAX_];
	struct ini *ini;

	(void)state;
	snprintf(path, sizeof(path), "%s/nosuch.conf", dir);
	assert_int_equal(ini_read(path, err, sizeof(err), &ini), -ENOENT);
	assert_non_null(strstr(err, "nosuch.conf: cannot open: No such file"));
	assert_int_equal(ini_read(dir, err, sizeof(err), &ini), -EISDIR);
	assert_non_null(strstr(err, ": cannot read: Is a directory"));
	assert_int_equal(ini_read("/dev/zero", err, sizeof(err), &ini), -EINVAL);
	assert_non_null(strstr(err, "/dev/zero:1: line longer"));
}

/* A line that is cut must still be one, and end. */
static void short_error_buffer(void **state)
{
	char err[16], path[PATH_MAX_];
	struct ini *ini;

	(void)state;
	conf_dir_write(dir, "test.conf", "x", 1, path);
	memset(err, 'x', sizeof(err));
	assert_int_equal(ini_read(path, err, 8, &ini), -EINVAL);
	assert_int_equal(strlen(err), 7);
	assert_int_equal(err[8], 'x');
}

static int setup(void **state)
{
	(void)state;
	conf_dir_open(dir);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	conf_dir_close(dir);
	return 0;
}

static void errors_are_one_line(void **state)
{
	char err[64];
	const struct ini ini = {.path = "car.conf", .err = err, .err_len = sizeof(err)};

	(void)state;
	assert_int_equal(ini_fail(&ini, NULL, "unit '%s'", "m\n/\r\x1Bs\xB0"), -EINVAL);
	assert_string_equal(err, "car.conf: unit 'm?/??s\xB0'");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(errors_are_one_line),
		cmocka_unit_test(errors_are_named),
		cmocka_unit_test(entries_are_found),
		cmocka_unit_test(bytes_that_strings_cannot_hold),
		cmocka_unit_test(byte_order_mark_is_skipped),
		cmocka_unit_test(long_things),
		cmocka_unit_test(files_that_are_none),
		cmocka_unit_test(short_error_buffer),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
