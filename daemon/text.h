/* SPDX-License-Identifier: MIT
 * What reading a value takes: words, numbers that are numbers to the last character, the nearest valid name.
 */
#ifndef AEBMC_TEXT_H
#define AEBMC_TEXT_H

#include <stddef.h>
#include <stdint.h>

/**
 * text_nearest - the name most like @want
 * @names: the first name; the others follow every @stride bytes, @n in all (an array of strings, or a column of a table)
 * By edit distance, ignoring case; of equals the first. "" if @n is 0. Pure.
 */
const char *text_nearest(const char *want, const char *const *names, size_t n, size_t stride);

/**
 * text_number, text_integer - a value that is one number and nothing else
 * A number is finite; an integer is decimal, or hexadecimal after 0x. Returns 0, -EINVAL, or -ERANGE if it does not fit.
 */
int text_number(const char *text, double *ret);
int text_integer(const char *text, int64_t *ret);

/** text_truth - yes, true, 1 or no, false, 0. Returns 0 with *@ret 1 or 0, or -EINVAL. */
int text_truth(const char *text, int *ret);

/** text_word - cut the next blank-separated word off *@text; NULL at the end. Writes into the text. */
char *text_word(char **text);

#endif
