/* SPDX-License-Identifier: MIT
 * strtod and strtoll take leading blanks, NaN, infinity and octal: what a configuration must not silently contain.
 */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nearest.h"
#include "text.h"

char *text_word(char **text)
{
	char *word = *text + strspn(*text, " \t");
	size_t len = strcspn(word, " \t");

	*text = word + len;
	if (**text) {
		*(*text)++ = '\0';
	}
	return len ? word : NULL;
}

const char *text_nearest(const char *want, const char *const *names, size_t n, size_t stride)
{
	const char *best = "";
	unsigned least = UINT_MAX;

	for (size_t i = 0; i < n; i++) {
		const char *name = *(const char *const *)((const char *)names + i * stride);
		unsigned d = nearest_distance(want, name);

		if (d < least) {
			least = d;
			best = name;
		}
	}
	return best;
}

int text_number(const char *text, double *ret)
{
	char *end;
	double value;

	value = strtod(text, &end);
	if (end == text || *end) {
		return -EINVAL;
	}
	if (!isfinite(value)) {
		return -ERANGE;
	}
	*ret = value;
	return 0;
}

int text_integer(const char *text, int64_t *ret)
{
	const char *digits = text + (*text == '-');
	int hex = digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X');
	char *end;
	long long value;

	errno = 0;
	value = strtoll(text, &end, hex ? 16 : 10);
	if (end == text || *end) {
		return -EINVAL;
	}
	if (errno) {
		return -ERANGE;
	}
	*ret = value;
	return 0;
}

int text_truth(const char *text, int *ret)
{
	static const char *const names[] = {"no", "yes", "false", "true", "0", "1"};

	for (int i = 0; i < 6; i++) {
		if (!strcmp(text, names[i])) {
			*ret = i % 2;
			return 0;
		}
	}
	return -EINVAL;
}
