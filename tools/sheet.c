/* SPDX-License-Identifier: MIT
 * A CSV text in cells. See sheet.h.
 */
#include "sheet.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "text.h"

static int count(const char *text, char c, const char *stop)
{
	int n = 0;

	for (; *text && !strchr(stop, *text); text++) {
		n += *text == c;
	}
	return n;
}

/* Cut the line at *@text into @n cells and step behind it. Returns how many fields it has. */
static int cut_line(char **text, char **cell, int n)
{
	char *p = *text, *end = p + strcspn(p, "\n");
	int fields = 0;

	*text = end + 1;
	*end = '\0';
	if (end > p && end[-1] == '\r') {
		end[-1] = '\0';
	}
	for (; p; fields++) {
		char *comma = strchr(p, ',');

		if (fields < n) {
			cell[fields] = p;
		}
		p = comma ? comma + 1 : NULL;
		if (comma) {
			*comma = '\0';
		}
	}
	return fields;
}

int sheet_open(char *text, struct sheet *ret, char *err, size_t size)
{
	const size_t length = strlen(text);
	const size_t lines = (size_t)count(text, '\n', "");
	struct sheet s = {.columns = count(text, ',', "\r\n") + 1};

	if (lines < 2 || text[length - 1] != '\n') {
		snprintf(err, size, lines < 2 ? "no rows" : "line %zu ends in the middle: cut off?",
			 lines + 1);
		return -EINVAL;
	}
	s.cell = calloc(lines, sizeof(*s.cell) * (size_t)s.columns);
	if (!s.cell) {
		return -ENOMEM;
	}
	for (size_t i = 0; i < lines; i++) {
		const int fields = cut_line(&text, s.cell + i * (size_t)s.columns, s.columns);

		if (fields != s.columns) {
			snprintf(err, size, "line %zu has %d fields, the first line %d", i + 1,
				 fields, s.columns);
			sheet_close(&s);
			return -EINVAL;
		}
	}
	s.rows = lines - 1;
	*ret = s;
	return 0;
}

int sheet_column(const struct sheet *s, const char *name)
{
	for (int i = 0; i < s->columns; i++) {
		if (!strcmp(s->cell[i], name)) {
			return i;
		}
	}
	return -1;
}

const char *sheet_word(const struct sheet *s, size_t row, int column)
{
	return s->cell[(row + 1) * (size_t)s->columns + (size_t)column];
}

int sheet_numbers(const struct sheet *s, const char *name, double *ret, char *err, size_t size)
{
	const int column = sheet_column(s, name);

	if (column < 0) {
		snprintf(err, size, "no column %s", name);
		return -EINVAL;
	}
	for (size_t i = 0; i < s->rows; i++) {
		const char *word = sheet_word(s, i, column);

		ret[i] = NAN;
		if (*word && text_number(word, &ret[i])) {
			snprintf(err, size, "line %zu: %s is '%s', which is no number", i + 2, name,
				 word);
			return -EINVAL;
		}
	}
	return 0;
}

void sheet_close(struct sheet *s)
{
	free(s->cell);
	s->cell = NULL;
}
