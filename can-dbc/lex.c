/* SPDX-License-Identifier: MIT
 * Words, numbers and strings out of DBC text.
 */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "dbc.h"
#include "lex.h"

#define NUMBER_MAX 64 /* characters */

void lex_fail(struct lex *lx, int rc, const char *fmt, ...)
{
	if (lx->rc) {
		return;
	}
	lx->rc = rc;
	int n = lx->line ? snprintf(lx->err, lx->err_size, "%s:%u: ", lx->name, lx->line)
			 : snprintf(lx->err, lx->err_size, "%s: ", lx->name);
	if ((size_t)n < lx->err_size) {
		va_list ap;
		va_start(ap, fmt);
		vsnprintf(lx->err + n, lx->err_size - (size_t)n, fmt, ap);
		va_end(ap);
	}
}

char lex_peek(struct lex *lx)
{
	if (lx->rc) {
		return 0;
	}
	while (isspace((unsigned char)*lx->p)) {
		lx->line += *lx->p++ == '\n';
	}
	return *lx->p;
}

/* "'x'", or a name for what has no glyph. */
static const char *show(char c, char buf[8])
{
	if (!c) {
		return "the end of the file";
	}
	snprintf(buf, 8, isprint((unsigned char)c) ? "'%c'" : "\\x%02x", (unsigned char)c);
	return buf;
}

static void unexpected(struct lex *lx, const char *want, const char *where)
{
	char buf[8];
	char c = lex_peek(lx);
	lex_fail(lx, -EINVAL, "%s: %s expected, found %s", where, want, show(c, buf));
}

void lex_expect(struct lex *lx, char c, const char *where)
{
	if (lex_peek(lx) != c) {
		unexpected(lx, (char[]){'\'', c, '\'', 0}, where);
	} else {
		lx->p++;
	}
}

static int word_char(char c)
{
	return isalnum((unsigned char)c) || c == '_';
}

int lex_is_word(struct lex *lx)
{
	char c = lex_peek(lx);
	return word_char(c) && !isdigit((unsigned char)c);
}

const char *lex_word(struct lex *lx, const char *what)
{
	if (!lex_is_word(lx)) {
		unexpected(lx, "a name", what);
		return "";
	}
	size_t n = 0;
	while (word_char(lx->p[n])) {
		n++;
	}
	if (n > DBC_NAME_MAX) {
		lex_fail(lx, -EINVAL, "%s: name of %zu characters, at most %d are allowed", what, n,
			 DBC_NAME_MAX);
		return "";
	}
	char *word = memcpy(lx->pool, lx->p, n);
	word[n] = 0;
	lx->pool += n + 1;
	lx->p += n;
	return word;
}

/* Behind the string's closing quote; copies it to @to unless that is NULL. */
static char *string_body(struct lex *lx, char *to, const char *what)
{
	unsigned start = lx->line;
	for (; *lx->p != '"'; lx->p++) {
		if (!*lx->p) {
			lx->line = start;
			lex_fail(lx, -EINVAL, "%s: string without its closing quote", what);
			return to;
		}
		lx->line += *lx->p == '\n';
		if (lx->p[0] == '\\' && lx->p[1] == '"') {
			lx->p++;
		}
		if (to) {
			*to++ = *lx->p;
		}
	}
	lx->p++;
	return to;
}

const char *lex_string(struct lex *lx, const char *what)
{
	lex_expect(lx, '"', what);
	if (lx->rc) {
		return "";
	}
	char *text = lx->pool;
	char *end = string_body(lx, text, what);
	*end = 0;
	lx->pool = end + 1;
	return text;
}

uint64_t lex_uint(struct lex *lx, uint64_t max, const char *what)
{
	if (!isdigit((unsigned char)lex_peek(lx))) {
		unexpected(lx, "a number", what);
		return 0;
	}
	const char *from = lx->p;
	uint64_t v = 0;
	int over = 0;
	for (; isdigit((unsigned char)*lx->p); lx->p++) {
		unsigned digit = (unsigned)(*lx->p - '0');
		over |= v > (UINT64_MAX - digit) / 10;
		v = v * 10 + digit;
	}
	if (over || v > max) {
		int digits = (int)strspn(from, "0123456789");
		lex_fail(lx, -EINVAL, "%s: %.*s is above %llu", what, digits < 24 ? digits : 24,
			 from, (unsigned long long)max);
		return 0;
	}
	return v;
}

double lex_double(struct lex *lx, const char *what)
{
	lex_peek(lx);
	size_t n = lx->rc ? 0 : strspn(lx->p, "+-.0123456789eE");
	char text[NUMBER_MAX] = "";
	char *end = text;
	double v = 0;
	if (n < sizeof(text)) {
		memcpy(text, lx->p, n);
		v = strtod(text, &end);
	}
	if (end == text || *end || !isfinite(v)) {
		lex_fail(lx, -EINVAL, "%s: a finite decimal number expected", what);
		return 0;
	}
	lx->p += n;
	return v;
}

void lex_skip(struct lex *lx, const char *what)
{
	unsigned start = lx->line;
	for (char c = lex_peek(lx); c != ';'; c = lex_peek(lx)) {
		if (!c) {
			lx->line = start;
			lex_fail(lx, -EINVAL, "%s: ends without a semicolon", what);
			return;
		}
		lx->p++;
		if (c == '"') {
			string_body(lx, NULL, what);
		}
	}
	lx->p++;
}

void lex_skip_line(struct lex *lx)
{
	if (!lx->rc) {
		lx->p += strcspn(lx->p, "\n");
	}
}
