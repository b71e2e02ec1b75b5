/* SPDX-License-Identifier: MIT
 * Levenshtein distance with one row of memory.
 */
#include <ctype.h>
#include <string.h>

#include "nearest.h"

static int min3(int a, int b, int c)
{
	int m = a < b ? a : b;

	return m < c ? m : c;
}

int nearest_distance(const char *a, const char *b)
{
	int row[NEAREST_LEN + 1];
	int la = (int)strnlen(a, NEAREST_LEN), lb = (int)strnlen(b, NEAREST_LEN);

	for (int j = 0; j <= lb; j++) {
		row[j] = j;
	}
	for (int i = 1; i <= la; i++) {
		int diagonal = row[0];

		row[0] = i;
		for (int j = 1; j <= lb; j++) {
			int same = tolower((unsigned char)a[i - 1]) ==
				   tolower((unsigned char)b[j - 1]);
			int cost = min3(diagonal + !same, row[j] + 1, row[j - 1] + 1);

			diagonal = row[j];
			row[j] = cost;
		}
	}
	return row[lb];
}

void nearest_offer(struct nearest *n, const char *name)
{
	int d;

	if (!name) {
		return;
	}
	d = nearest_distance(n->want, name);
	if (!n->best || d < n->distance) {
		n->best = name;
		n->distance = d;
	}
}
