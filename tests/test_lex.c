/* SPDX-License-Identifier: MIT
 * The reader of DBC text by itself: what each call takes, keeps, counts and says. Pools are as small as the header
 * allows, so that AddressSanitizer sees a byte too much.
 */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "lex.h"

struct reader {
	struct lex lx;
	char *pool, err[96];
};

static struct lex *begin(struct reader *r, const char *text)
{
	memset(r, 0, sizeof(*r));
	r->pool = malloc(strlen(text) + 1);
	assert_non_null(r->pool);
	r->lx = (struct lex){.name = "t",
			     .p = text,
			     .line = 1,
			     .pool = r->pool,
			     .err = r->err,
			     .err_size = sizeof(r->err)};
	return &r->lx;
}

static void failed(struct reader *r, const char *words)
{
	assert_int_equal(r->lx.rc, -EINVAL);
	assert_string_equal(r->err, words);
	free(r->pool);
}

static void good(struct reader *r, const char *rest, unsigned line)
{
	assert_int_equal(r->lx.rc, 0);
	assert_string_equal(r->lx.p, rest);
	assert_int_equal(r->lx.line, line);
	free(r->pool);
}

static void words_and_strings_are_kept_side_by_side(void **state)
{
	struct reader r;
	struct lex *lx = begin(&r, "a\"b\"c");

	(void)state;
	assert_string_equal(lex_word(lx, "w"), "a");
	assert_ptr_equal(lx->pool, r.pool + 2);
	assert_string_equal(lex_string(lx, "s"), "b");
	assert_ptr_equal(lx->pool, r.pool + 4);
	assert_string_equal(lex_word(lx, "w"), "c");
	assert_ptr_equal(lx->pool, r.pool + 6);
	good(&r, "", 1);
}

static void longest_name_is_taken(void **state)
{
	char text[160];
	struct reader r;

	(void)state;
	memset(text, 'n', sizeof(text));
	text[128] = 0;
	assert_int_equal(strlen(lex_word(begin(&r, text), "w")), 128);
	good(&r, "", 1);
	text[128] = 'n';
	text[129] = 0;
	assert_string_equal(lex_word(begin(&r, text), "w"), "");
	failed(&r, "t:1: w: name of 129 characters, at most 128 are allowed");
}

static void lines_within_strings_count(void **state)
{
	struct reader r;
	struct lex *lx = begin(&r, "\n\"a\n\\\"b\n\" x");

	(void)state;
	assert_string_equal(lex_string(lx, "s"), "a\n\"b\n");
	assert_int_equal(lx->line, 4);
	assert_string_equal(lex_word(lx, "w"), "x");
	good(&r, "", 4);
	lex_skip(begin(&r, "a \"\n;\n\" \n ;z"), "k");
	good(&r, "z", 4);
	lex_string(begin(&r, "\n\"a\nb"), "s");
	failed(&r, "t:2: s: string without its closing quote");
	lex_skip(begin(&r, "\na\nb"), "k");
	failed(&r, "t:1: k: ends without a semicolon");
}

static void whole_numbers(void **state)
{
	static const struct {
		const char *text;
		uint64_t max, value;
		const char *err;
	} row[] = {
		{"0 x", 0, 0, NULL},
		{"18446744073709551615 x", UINT64_MAX, UINT64_MAX, NULL},
		{"18446744073709551609 x", UINT64_MAX, 18446744073709551609u, NULL},
		{"18446744073709551616", UINT64_MAX, 0,
		 "t:1: n: 18446744073709551616 is above 18446744073709551615"},
		{"18446744073709551617", 5, 0, "t:1: n: 18446744073709551617 is above 5"},
		{"184467440737095516170000", 5, 0, "t:1: n: 184467440737095516170000 is above 5"},
		{"1844674407370955161700001", 5, 0, "t:1: n: 184467440737095516170000 is above 5"},
		{"6", 5, 0, "t:1: n: 6 is above 5"},
		{"x", 5, 0, "t:1: n: a number expected, found 'x'"},
	};
	struct reader r;

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		assert_true(lex_uint(begin(&r, row[i].text), row[i].max, "n") == row[i].value);
		if (row[i].err) {
			failed(&r, row[i].err);
		} else {
			good(&r, " x", 1);
		}
	}
}

static void decimal_numbers(void **state)
{
	char text[80];
	struct reader r;

	(void)state;
	assert_true(lex_double(begin(&r, "\n -1.5e2,"), "d") == -150);
	good(&r, ",", 2);
	assert_true(lex_double(begin(&r, "1-1"), "d") == 0);
	failed(&r, "t:1: d: a finite decimal number expected");
	assert_true(lex_double(begin(&r, "x"), "d") == 0);
	failed(&r, "t:1: d: a finite decimal number expected");
	assert_true(lex_double(begin(&r, "1e999"), "d") == 0);
	failed(&r, "t:1: d: a finite decimal number expected");
	memset(text, '0', sizeof(text));
	strcpy(text + 62, "1");
	assert_true(lex_double(begin(&r, text), "d") == 1);
	good(&r, "", 1);
	memset(text, '0', sizeof(text));
	strcpy(text + 63, "1");
	assert_true(lex_double(begin(&r, text), "d") == 0);
	failed(&r, "t:1: d: a finite decimal number expected");
}

/* After a failure every call takes nothing and returns nothing; the first reason stays. */
static void first_failure_stays(void **state)
{
	struct reader r;
	struct lex *lx = begin(&r, "7 w");
	const char *at = lx->p;

	(void)state;
	lex_fail(lx, -EINVAL, "no %d", 1);
	lex_fail(lx, -ENOENT, "no %d", 2);
	assert_int_equal(lex_peek(lx), 0);
	lex_expect(lx, '7', "e");
	assert_true(lex_uint(lx, 9, "n") == 0);
	assert_true(lex_double(lx, "d") == 0);
	assert_string_equal(lex_word(lx, "w"), "");
	assert_string_equal(lex_string(lx, "s"), "");
	lex_skip_line(lx);
	assert_ptr_equal(lx->p, at);
	failed(&r, "t:1: no 1");
}

static void characters_without_glyph_are_named(void **state)
{
	struct reader r;

	(void)state;
	lex_expect(begin(&r, "\x01"), ';', "e");
	failed(&r, "t:1: e: ';' expected, found \\x01");
	lex_expect(begin(&r, "\xff"), ';', "e");
	failed(&r, "t:1: e: ';' expected, found \\xff");
	lex_expect(begin(&r, ""), ';', "e");
	failed(&r, "t:1: e: ';' expected, found the end of the file");
}

/* The place takes "t:1: " = 5 characters: of a buffer of that many nothing is left for the reason. */
static void messages_end_where_their_buffer_does(void **state)
{
	struct reader r;

	(void)state;
	for (size_t size = 1; size < 8; size++) {
		struct lex *lx = begin(&r, "");

		memset(r.err, '#', sizeof(r.err));
		lx->err_size = size;
		lex_fail(lx, -EINVAL, "why");
		assert_int_equal(strlen(r.err), size - 1);
		assert_memory_equal(r.err, "t:1: why", size - 1);
		assert_int_equal(r.err[size], '#');
		free(r.pool);
	}
}

static void lines_are_skipped_to_their_end(void **state)
{
	struct reader r;

	(void)state;
	lex_skip_line(begin(&r, "a b;c\nd"));
	good(&r, "\nd", 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(words_and_strings_are_kept_side_by_side),
		cmocka_unit_test(longest_name_is_taken),
		cmocka_unit_test(lines_within_strings_count),
		cmocka_unit_test(whole_numbers),
		cmocka_unit_test(decimal_numbers),
		cmocka_unit_test(first_failure_stays),
		cmocka_unit_test(characters_without_glyph_are_named),
		cmocka_unit_test(messages_end_where_their_buffer_does),
		cmocka_unit_test(lines_are_skipped_to_their_end),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
