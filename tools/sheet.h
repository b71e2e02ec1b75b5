/* SPDX-License-Identifier: MIT
 * A CSV text as our commands write it: a line of column names, then as many fields in every line; no quotes.
 */
#ifndef AEBMC_SHEET_H
#define AEBMC_SHEET_H

#include <stddef.h>

struct sheet {
	size_t rows; /* without the names */
	int columns;
	char **cell; /* [1 + rows][columns], names first */
};

/**
 * sheet_open - cut @text into cells, in place; it must outlive the sheet
 * Returns 0; -ENOMEM; or -EINVAL with the line and the reason in @err: lines of another length, no row, no end of line.
 */
int sheet_open(char *text, struct sheet *ret, char *err, size_t size);

/** sheet_column - its place by name, or -1. */
int sheet_column(const struct sheet *s, const char *name);

/** sheet_word - what stands in a row, 0..rows-1. */
const char *sheet_word(const struct sheet *s, size_t row, int column);

/**
 * sheet_numbers - the named column as numbers, NaN where a field is empty
 * @ret: [rows]. Returns 0, or -EINVAL with the line and the reason in @err.
 */
int sheet_numbers(const struct sheet *s, const char *name, double *ret, char *err, size_t size);

/** sheet_close - the cells, not the text. */
void sheet_close(struct sheet *s);

#endif
