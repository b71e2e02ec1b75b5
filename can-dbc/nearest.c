/* SPDX-License-Identifier: MIT
 * How alike two names are: Levenshtein distance, one row at a time.
 */
#include <ctype.h>
#include <string.h>
#include "nearest.h"

static unsigned min3(unsigned a, unsigned b, unsigned c)
{
	unsigned m = a < b ? a : b;
	return m < c ? m : c;
}

unsigned nearest_distance(const char *a, const char *b)
{
	size_t n = strnlen(b, NEAREST_LEN);
	unsigned row[NEAREST_LEN + 1]; /* distance of a's first i characters to b's first j */
	for (size_t j = 0; j <= n; j++) {
		row[j] = (unsigned)j;
	}
	for (size_t i = 0; i < NEAREST_LEN && a[i]; i++) {
		unsigned diagonal = row[0]++;
		for (size_t j = 0; j < n; j++) {
			int differ = tolower((unsigned char)a[i]) != tolower((unsigned char)b[j]);
			unsigned replaced = diagonal + (unsigned)differ;
			diagonal = row[j + 1];
			row[j + 1] = min3(replaced, row[j] + 1, diagonal + 1);
		}
	}
	return row[n];
}
