/* SPDX-License-Identifier: MIT
 * Words, numbers and strings out of DBC text, with one sticky error: after the first failure every call is a no-op that
 * returns nothing, so a parser runs straight through and looks at @rc once. Private to can-dbc.
 */
#ifndef AEBMC_LEX_H
#define AEBMC_LEX_H

#include <stddef.h>
#include <stdint.h>

struct lex {
	const char *name; /* of the file, for messages */
	const char *p;    /* next character; the text ends with NUL */
	unsigned line;    /* of @p, from 1 */
	int rc;           /* 0, or -errno of the first failure */
	char *pool; /* where words and strings are kept: as many bytes as the text has, and one */
	char *err;  /* receives "FILE:LINE: ..." of the first failure */
	size_t err_size;
};

/** lex_fail - record the first failure, at the present line (no line number while @line is 0). */
__attribute__((format(printf, 3, 4))) void lex_fail(struct lex *lx, int rc, const char *fmt, ...);

/** lex_peek - next character behind white space, 0 at the end or after a failure. */
char lex_peek(struct lex *lx);

/** lex_expect - take character @c; @where says what is being read. */
void lex_expect(struct lex *lx, char c, const char *where);

/** lex_is_word - 1 if a letter or underscore comes next. */
int lex_is_word(struct lex *lx);

/** lex_word - take a C identifier of at most DBC_NAME_MAX characters. Returns a kept copy, "" on failure. */
const char *lex_word(struct lex *lx, const char *what);

/** lex_string - take a quoted string (\" stands for a quote). Returns a kept copy, "" on failure. */
const char *lex_string(struct lex *lx, const char *what);

/** lex_uint - take a decimal number of 0..@max. 0 on failure. */
uint64_t lex_uint(struct lex *lx, uint64_t max, const char *what);

/** lex_double - take a finite decimal number. 0 on failure. */
double lex_double(struct lex *lx, const char *what);

/** lex_skip - skip to behind the next semicolon outside of strings; @what is being skipped. */
void lex_skip(struct lex *lx, const char *what);

/** lex_skip_line - skip to the end of the line. */
void lex_skip_line(struct lex *lx);

#endif
