/* SPDX-License-Identifier: MIT
 * Bad and hostile DBC files are refused with one line that names file, line and cause.
 */
#include <errno.h>
#include <fcntl.h>
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
#include "dbc.h"

#define A4  "\"A\",\"A\",\"A\",\"A\","
#define A16 A4 A4 A4 A4
#define BO  "BO_ 1 MSG: 8 X\n"
#define SG  " SG_ SIG : 0|8@1+ (1,0) [0|0] \"\" X\n"

static const struct {
	const char *text;
	int rc;
	const char *err;
} bad[] = {
	/* the frame of the file */
	{"", -EINVAL, "t.dbc: no message (BO_) in it: is this a DBC file?"},
	{"VERSION \"\"\nNS_ :\n CM_\nBS_:\nBU_: A\n", -EINVAL,
	 "t.dbc: no message (BO_) in it: is this a DBC file?"},
	{BO "hello\n", -EINVAL, "t.dbc:2: 'hello' is no DBC statement"},
	{BO "{}\n", -EINVAL, "t.dbc:2: DBC statement: a name expected, found '{'"},
	{"\x01", -EINVAL, "t.dbc:1: DBC statement: a name expected, found \\x01"},
	{"\xEF\xBB\n" BO, -EINVAL, "t.dbc:1: DBC statement: a name expected, found \\xef"},
	{"VERSION 1.0\n", -EINVAL, "t.dbc:1: VERSION: '\"' expected, found '1'"},
	{"NS_ CM_\n", -EINVAL, "t.dbc:1: NS_: ':' expected, found 'C'"},
	/* messages */
	{"BO_ x", -EINVAL, "t.dbc:1: message id: a number expected, found 'x'"},
	{"BO_ 4294967296 MSG: 8 X", -EINVAL, "t.dbc:1: message id: 4294967296 is above 4294967295"},
	{"BO_ 99999999999999999999999 MSG: 8 X", -EINVAL,
	 "t.dbc:1: message id: 99999999999999999999999 is above 4294967295"},
	{"BO_ 2048 MSG: 8 X", -EINVAL,
	 "t.dbc:1: message MSG: id 2048 has more than 11 bits (add 2^31 if extended)"},
	{"BO_ 2684354560 MSG: 8 X", -EINVAL,
	 "t.dbc:1: message MSG: id 2684354560 has more than 29 bits"},
	{"BO_ 1", -EINVAL, "t.dbc:1: BO_: a name expected, found the end of the file"},
	{"BO_ 1 MSG 8 X", -EINVAL, "t.dbc:1: BO_: ':' expected, found '8'"},
	{"BO_ 1 MSG: 65 X", -EINVAL, "t.dbc:1: bytes in a message: 65 is above 64"},
	{"BO_ 1 MSG: 9 X", -EINVAL,
	 "t.dbc:1: message MSG: no frame has 9 bytes: 0-8, 12, 16, 20, 24, 32, 48, 64"},
	{BO "BO_ 1 TWO: 8 X", -EINVAL, "t.dbc:2: message TWO: id 1 is already that of MSG"},
	{BO "BO_ 2 MSG: 8 X", -EINVAL, "t.dbc:2: message MSG: there is already one of this name"},
	/* signals */
	{SG, -EINVAL, "t.dbc:1: SG_ before any message (BO_)"},
	{BO "SG_ : 0|8@1+", -EINVAL, "t.dbc:2: SG_: a name expected, found ':'"},
	{BO "SG_ SIG 0|8@1+", -EINVAL, "t.dbc:2: SG_: ':' expected, found '0'"},
	{BO "SG_ SIG : 512|8@1+", -EINVAL, "t.dbc:2: start bit: 512 is above 511"},
	{BO "SG_ SIG : -1|8@1+", -EINVAL, "t.dbc:2: start bit: a number expected, found '-'"},
	{BO "SG_ SIG : 0,8@1+", -EINVAL, "t.dbc:2: start bit: '|' expected, found ','"},
	{BO "SG_ SIG : 0|65@1+", -EINVAL, "t.dbc:2: length in bits: 65 is above 64"},
	{BO "SG_ SIG : 0|8@2+", -EINVAL, "t.dbc:2: byte order: 2 is above 1"},
	{BO "SG_ SIG : 0|8@1 (1,0)", -EINVAL, "t.dbc:2: byte order: '+' expected, found '('"},
	{BO "SG_ SIG : 0|8@1+ (nan,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: scale: a finite decimal number expected"},
	{BO "SG_ SIG : 0|8@1+ (inf,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: scale: a finite decimal number expected"},
	{BO "SG_ SIG : 0|8@1+ (1e999,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: scale: a finite decimal number expected"},
	{BO "SG_ SIG : 0|8@1+ (1,0x10) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: offset: ')' expected, found 'x'"},
	{BO "SG_ SIG : 0|8@1+ (1,1-1) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: offset: a finite decimal number expected"},
	{BO "SG_ SIG : 0|8@1+ (1,0) [|0] \"\" X", -EINVAL,
	 "t.dbc:2: minimum: a finite decimal number expected"},
	{BO "SG_ SIG : 0|8@1+ (1,0) [0|"
	    "1111111111111111111111111111111111111111111111111111111111111111] \"\" X",
	 -EINVAL, "t.dbc:2: maximum: a finite decimal number expected"},
	{BO "SG_ SIG : 0|8@1+ (1,0) [0|0] X", -EINVAL, "t.dbc:2: unit: '\"' expected, found 'X'"},
	{BO "SG_ SIG : 0|8@1+ (1,0) [0|0] \"m\nBO_ 2 TWO: 8 X\n", -EINVAL,
	 "t.dbc:2: unit: string without its closing quote"},
	{BO "SG_ SIG : 0|0@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: no bits: the length must be 1 to 64"},
	{BO "SG_ SIG : 0|8@1+ (0,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: scale 0: it must not be"},
	{BO "SG_ SIG : 0|8@1+ (1e308,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: scale and offset overflow"},
	{BO "SG_ SIG : 0|8@1+ (-7e305,-1e308) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: scale and offset overflow"},
	{BO "SG_ SIG : 0|8@1+ (7e305,-1e308) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: scale and offset overflow"},
	{BO "SG_ SIG : 0|8@1+ (1,0) [2|1] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: range [2|1] is empty: swap its ends"},
	{BO SG "SG_ SIG : 8|8@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:3: signal SIG: message MSG already has one of this name"},
	{BO "SG_ SIG : 57|8@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: bits 57|8@1 exceed the 8 bytes of message MSG"},
	{BO "SG_ SIG : 62|8@0+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: bits 62|8@0 exceed the 8 bytes of message MSG"},
	{BO "SG_ SIG : 511|64@0+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: bits 511|64@0 exceed the 8 bytes of message MSG"},
	{"BO_ 1 MSG: 64 X\nSG_ SIG : 511|64@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal SIG: bits 511|64@1 exceed the 64 bytes of message MSG"},
	{BO SG "SG_ TWO : 7|2@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:3: signal TWO: overlaps signal SIG of message MSG"},
	{BO SG "SG_ TWO : 0|1@0+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:3: signal TWO: overlaps signal SIG of message MSG"},
	/* multiplexing */
	{BO "SG_ A m1M : 0|8@1+ (1,0) [0|0] \"\" X", -ENOTSUP,
	 "t.dbc:2: signal A: extended multiplexing (m1M) is not supported"},
	{BO "SG_ A mm : 0|8@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal A: 'mm' is neither M nor mNUMBER"},
	{BO "SG_ A m : 0|8@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal A: 'm' is neither M nor mNUMBER"},
	{BO "SG_ A m5x : 0|8@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal A: 'm5x' is neither M nor mNUMBER"},
	{BO "SG_ A m4294967296 : 0|8@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:2: signal A: 'm4294967296' is neither M nor mNUMBER"},
	{BO "SG_ A M : 0|8@1+ (1,0) [0|0] \"\" X\nSG_ B M : 8|8@1+ (1,0) [0|0] \"\" X", -EINVAL,
	 "t.dbc:3: signal B: message MSG already has a multiplexor"},
	{BO "SG_ A m1 : 0|8@1+ (1,0) [0|0] \"\" X\n", -EINVAL,
	 "t.dbc:1: message MSG: signal A is multiplexed, but no signal is marked M"},
	{BO "SG_ P M : 0|2@1+ (1,0) [0|0] \"\" X\nSG_ A m4 : 8|8@1+ (1,0) [0|0] \"\" X\n", -EINVAL,
	 "t.dbc:1: message MSG: multiplexor P never takes the m4 of signal A"},
	{BO "SG_ P M : 0|2@1+ (1,0) [0|0] \"\" X\nSG_ A m1 : 1|8@1+ (1,0) [0|0] \"\" X\n", -EINVAL,
	 "t.dbc:3: signal A: overlaps signal P of message MSG"},
	{BO "SG_ P M : 0|2@1+ (1,0) [0|0] \"\" X\nSG_ A m1 : 8|8@1+ (1,0) [0|0] \"\" X\n"
	    "SG_ B m1 : 8|8@1+ (1,0) [0|0] \"\" X\n",
	 -EINVAL, "t.dbc:4: signal B: overlaps signal A of message MSG"},
	/* values and types */
	{BO SG "VAL_ 2 SIG 0 \"x\" ;", -EINVAL,
	 "t.dbc:3: VAL_ refers to message 2, which no BO_ defines"},
	{BO SG "VAL_ 1 SIX 0 \"x\" ;", -EINVAL,
	 "t.dbc:3: VAL_: message MSG has no signal SIX: did you mean 'SIG'?"},
	{BO "VAL_ 1 SIX 0 \"x\" ;", -EINVAL,
	 "t.dbc:2: VAL_: message MSG has no signal SIX: did you mean ''?"},
	{BO SG "VAL_ 1 SIG table ;", -ENOTSUP,
	 "t.dbc:3: VAL_ by a table's name is not supported: write the values out"},
	{BO SG "VAL_ 1 SIG 0 ;", -EINVAL, "t.dbc:3: VAL_: '\"' expected, found ';'"},
	{BO SG "VAL_ 1 SIG 0 \"x\"", -EINVAL,
	 "t.dbc:3: VAL_: a number expected, found the end of the file"},
	{BO SG "SIG_VALTYPE_ 1 SIG : 1;", -ENOTSUP,
	 "t.dbc:3: signal SIG: floating-point signals are not supported"},
	{BO SG "SIG_VALTYPE_ 1 SIG : 2;", -ENOTSUP,
	 "t.dbc:3: signal SIG: floating-point signals are not supported"},
	{BO SG "SIG_VALTYPE_ 1 SIG : 4;", -EINVAL, "t.dbc:3: SIG_VALTYPE_: 4 is above 3"},
	{BO SG "SG_MUL_VAL_ 1 SIG SIG 1-1;", -ENOTSUP,
	 "t.dbc:3: SG_MUL_VAL_ is not supported: remove what it describes"},
	{BO SG "SIG_TYPE_REF_ 1 SIG : T;", -ENOTSUP,
	 "t.dbc:3: SIG_TYPE_REF_ is not supported: remove what it describes"},
	/* comments and attributes */
	{BO "CM_ \"never\nends", -EINVAL, "t.dbc:2: CM_: string without its closing quote"},
	{BO "CM_ BO_ 1 \"ends\"\n\n", -EINVAL, "t.dbc:2: CM_: ends without a semicolon"},
	{BO "BA_ \"GenMsgCycleTime\" BO_ 2 10;", -EINVAL,
	 "t.dbc:2: BA_ refers to message 2, which no BO_ defines"},
	{BO "BA_ \"GenMsgCycleTime\" BO_ 1 x;", -EINVAL,
	 "t.dbc:2: attribute: a finite decimal number expected"},
	{BO "BA_ \"GenMsgCycleTime\" BO_ 1 10", -EINVAL,
	 "t.dbc:2: attribute: ';' expected, found the end of the file"},
	{BO "BA_ \"GenMsgCycleTime\" BO_ 1 -1;", -EINVAL,
	 "t.dbc:2: message MSG: GenMsgCycleTime must be a number of ms >= 0"},
	{BO "BA_ \"GenMsgCycleTime\" BO_ 1 -1;\nBS_:\n", -EINVAL,
	 "t.dbc:2: message MSG: GenMsgCycleTime must be a number of ms >= 0"},
	{BO "BA_ \"GenMsgCycleTime\" BO_ 1 1e10;", -EINVAL,
	 "t.dbc:2: message MSG: GenMsgCycleTime must be a number of ms >= 0"},
	{BO "\nBA_DEF_DEF_ \"GenMsgCycleTime\" \"x\";", -EINVAL,
	 "t.dbc:3: message MSG: GenMsgCycleTime must be a number of ms >= 0"},
	{"BO_ 1 MSG: 64 X\nBA_ \"VFrameFormat\" BO_ 1 \"StandardCAN\";", -EINVAL,
	 "t.dbc:2: message MSG: 64 bytes, but its VFrameFormat is not CAN FD"},
	{"BO_ 1 MSG: 12 X\nBA_DEF_ BO_ \"VFrameFormat\" ENUM \"A_FD\",\"B\";\nBA_ \"VFrameFormat\" "
	 "BO_ 1 64;",
	 -EINVAL, "t.dbc:3: message MSG: 12 bytes, but its VFrameFormat is not CAN FD"},
	{"BO_ 1 MSG: 12 X\nBA_DEF_ BO_ \"VFrameFormat\" ENUM \"A_FD\";\nBA_ \"VFrameFormat\" "
	 "BO_ 1 -1;",
	 -EINVAL, "t.dbc:3: message MSG: 12 bytes, but its VFrameFormat is not CAN FD"},
	{"BO_ 1 MSG: 12 X\nBA_DEF_ BO_ \"VFrameFormat\" INT 0 9;\nBA_ \"VFrameFormat\" BO_ 1 0;",
	 -EINVAL, "t.dbc:3: message MSG: 12 bytes, but its VFrameFormat is not CAN FD"},
	/* of a 65th kind of frame nothing is known, whatever its name */
	{"BO_ 1 MSG: 12 X\nBA_DEF_ BO_ \"VFrameFormat\" ENUM " A16 A16 A16 A16
	 "\"A_FD\";\nBA_ \"VFrameFormat\" BO_ 1 0;",
	 -EINVAL, "t.dbc:3: message MSG: 12 bytes, but its VFrameFormat is not CAN FD"},
	{BO "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"A\", ;", -EINVAL,
	 "t.dbc:2: BA_DEF_: '\"' expected, found ';'"},
	{BO "BA_ \"E2EDataIDList\" BO_ 1 7;", -EINVAL,
	 "t.dbc:2: message MSG: E2EDataIDList must be 16 bytes in hexadecimal"},
	{BO "BA_ \"E2EDataIDList\" BO_ 1 \"1 2 3 4 5 6 7 8 9 A B C D E F\";", -EINVAL,
	 "t.dbc:2: message MSG: E2EDataIDList must be 16 bytes in hexadecimal"},
	{BO "BA_ \"E2EDataIDList\" BO_ 1 \"1 2 3 4 5 6 7 8 9 A B C D E F 10 11\";", -EINVAL,
	 "t.dbc:2: message MSG: E2EDataIDList must be 16 bytes in hexadecimal"},
	{BO "BA_ \"E2EDataIDList\" BO_ 1 \"1 2 3 4 5 6 7 8 9 A B C D E F 100\";", -EINVAL,
	 "t.dbc:2: message MSG: E2EDataIDList must be 16 bytes in hexadecimal"},
};

static void each_is_refused_in_one_line(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		char err[256] = "";
		struct dbc *dbc = NULL;
		int rc = dbc_parse("t.dbc", bad[i].text, strlen(bad[i].text), &dbc, err,
				   sizeof(err));
		assert_string_equal(err, bad[i].err);
		assert_int_equal(rc, bad[i].rc);
		assert_null(dbc);
	}
}

static void refused(const char *text, size_t len, const char *want)
{
	char err[256] = "";
	struct dbc *dbc = NULL;
	assert_int_equal(dbc_parse("t.dbc", text, len, &dbc, err, sizeof(err)), -EINVAL);
	assert_string_equal(err, want);
	assert_null(dbc);
}

static void nul_characters(void **state)
{
	(void)state;
	refused(BO "\0" SG, sizeof(BO "\0" SG) - 1, "t.dbc:2: NUL character: is this a DBC file?");
	refused("\0", 1, "t.dbc:1: NUL character: is this a DBC file?");
	refused(BO SG "CM_ \"a\n\0\";", sizeof(BO SG "CM_ \"a\n\0\";") - 1,
		"t.dbc:4: NUL character: is this a DBC file?");
}

static void long_lines(void **state)
{
	(void)state;
	size_t len = 1 << 20;
	char *text = malloc(len);
	assert_non_null(text);
	memset(text, 'x', len);
	memcpy(text, BO, sizeof(BO) - 1);
	refused(text, len,
		"t.dbc:2: line of 1048561 characters, at most 65536 are read: is this a DBC file?");
	refused(text, sizeof(BO) - 1 + DBC_LINE_MAX,
		"t.dbc:2: DBC statement: name of 65536 characters, at most 128 are allowed");
	free(text);
}

static void long_names(void **state)
{
	(void)state;
	char text[256], err[256];
	struct dbc *dbc = NULL;
	char name[DBC_NAME_MAX + 2];
	memset(name, 'n', sizeof(name));
	int n = snprintf(text, sizeof(text), "BO_ 1 %.*s: 8 X\n", DBC_NAME_MAX, name);
	assert_int_equal(dbc_parse("t.dbc", text, (size_t)n, &dbc, err, sizeof(err)), 0);
	assert_int_equal(strlen(dbc->messages[0].name), DBC_NAME_MAX);
	dbc_free(dbc);
	n = snprintf(text, sizeof(text), "BO_ 1 %.*s: 8 X\n", DBC_NAME_MAX + 1, name);
	refused(text, (size_t)n, "t.dbc:1: BO_: name of 129 characters, at most 128 are allowed");
}

/* @count statements from a pattern with the number in two places, then one more. */
static void too_many(const char *head, const char *pattern, unsigned count, const char *want)
{
	size_t size = strlen(head) + (count + 1) * (strlen(pattern) + 16);
	char *text = malloc(size), *p = text;
	assert_non_null(text);
	p += sprintf(p, "%s", head);
	for (unsigned i = 0; i < count; i++) {
		p += snprintf(p, size - (size_t)(p - text), pattern, i, i);
	}
	char err[256];
	struct dbc *dbc = NULL;
	assert_int_equal(dbc_parse("t.dbc", text, (size_t)(p - text), &dbc, err, sizeof(err)), 0);
	dbc_free(dbc);
	p += snprintf(p, size - (size_t)(p - text), pattern, count, count);
	refused(text, (size_t)(p - text), want);
	free(text);
}

static void counts_are_bounded(void **state)
{
	(void)state;
	too_many("", "BO_ 214749%04u M%u: 8 X\n", DBC_MESSAGES_MAX,
		 "t.dbc:4097: more than 4096 messages");
	too_many(BO "SG_ P M : 0|16@1+ (1,0) [0|0] \"\" X\n",
		 "SG_ S%u m%u : 16|8@1+ (1,0) [0|0] \"\" X\n", DBC_SIGNALS_MAX - 1,
		 "t.dbc:1026: message MSG: more than 1024 signals");
}

static void short_error_buffers(void **state)
{
	(void)state;
	for (size_t size = 0; size < 24; size++) {
		char err[32];
		memset(err, '#', sizeof(err));
		struct dbc *dbc = NULL;
		assert_int_equal(dbc_parse("t.dbc", "x", 1, &dbc, err, size), -EINVAL);
		assert_int_equal(err[size], '#');
		assert_int_equal(memchr(err, 0, size) != NULL, size > 0);
	}
}

/* ---- files --------------------------------------------------------------------------------------- */

static void load_refused(const char *path, int rc, const char *want)
{
	char err[256] = "";
	struct dbc *dbc = NULL;
	assert_int_equal(dbc_load(path, &dbc, err, sizeof(err)), rc);
	assert_string_equal(err, want);
	assert_null(dbc);
}

static void paths_that_are_no_files(void **state)
{
	(void)state;
	char dir[] = "/tmp/test_dbc_XXXXXX", path[64], want[128];
	assert_non_null(mkdtemp(dir));
	load_refused("/nonexistent/x.dbc", -ENOENT,
		     "/nonexistent/x.dbc: No such file or directory");
	load_refused("/dev/null", -EINVAL, "/dev/null: not a regular file");
	snprintf(want, sizeof(want), "%s: Is a directory", dir);
	load_refused(dir, -EISDIR, want);

	snprintf(path, sizeof(path), "%s/fifo", dir);
	assert_int_equal(mkfifo(path, 0600), 0);
	snprintf(want, sizeof(want), "%s: not a regular file", path);
	load_refused(path, -EINVAL, want);
	unlink(path);

	snprintf(path, sizeof(path), "%s/large", dir);
	FILE *f = fopen(path, "w");
	assert_non_null(f);
	assert_int_equal(ftruncate(fileno(f), DBC_FILE_MAX + 1), 0);
	snprintf(want, sizeof(want), "%s: larger than 16 MiB: is this a DBC file?", path);
	load_refused(path, -EFBIG, want);
	snprintf(want, sizeof(want), "%s:1: NUL character: is this a DBC file?", path);
	assert_int_equal(ftruncate(fileno(f), DBC_FILE_MAX), 0);
	load_refused(path, -EINVAL, want); /* the largest that is read */
	assert_int_equal(ftruncate(fileno(f), 5), 0);
	load_refused(path, -EINVAL, want);
	assert_int_equal(ftruncate(fileno(f), 0), 0);
	snprintf(want, sizeof(want), "%s: no message (BO_) in it: is this a DBC file?", path);
	load_refused(path, -EINVAL, want);
	fclose(f);
	unlink(path);
	rmdir(dir);
}

/* Without a standard input the file gets its number, and gives it back. */
static void file_may_be_descriptor_0(void **state)
{
	(void)state;
	char err[256] = "";
	struct dbc *dbc = NULL;
	int saved = dup(STDIN_FILENO);
	close(STDIN_FILENO);
	load_refused("/dev/null", -EINVAL, "/dev/null: not a regular file");
	int kept_bad =
		fcntl(STDIN_FILENO, F_GETFD); /* errno is now EBADF, which is not the file's */
	int rc = dbc_load("can-dbc/aebmc.dbc", &dbc, err, sizeof(err));
	int kept_good = fcntl(STDIN_FILENO, F_GETFD);
	dup2(saved, STDIN_FILENO);
	close(saved);
	assert_int_equal(kept_bad, -1);
	assert_string_equal(err, "");
	assert_int_equal(rc, 0);
	assert_int_equal(kept_good, -1);
	dbc_free(dbc);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_is_refused_in_one_line),
		cmocka_unit_test(nul_characters),
		cmocka_unit_test(long_lines),
		cmocka_unit_test(long_names),
		cmocka_unit_test(counts_are_bounded),
		cmocka_unit_test(short_error_buffers),
		cmocka_unit_test(paths_that_are_no_files),
		cmocka_unit_test(file_may_be_descriptor_0),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
