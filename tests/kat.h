/* SPDX-License-Identifier: MIT
 * Known-answer files: one case a line, '#' starts a comment, numbers as hex floats where bits matter.
 */
#ifndef AEBMC_TESTS_KAT_H
#define AEBMC_TESTS_KAT_H

#include <stdio.h>

/** kat_open - tests/kat/@name; the test fails if it is not there. */
static inline FILE *kat_open(const char *name)
{
	char path[256];
	FILE *f;

	snprintf(path, sizeof(path), "tests/kat/%s", name);
	f = fopen(path, "r");
	assert_non_null(f);
	return f;
}

/** kat_line - the next case into @line; 0 at the end, when the file is closed. */
static inline int kat_line(FILE *f, char *line, int size)
{
	while (fgets(line, size, f)) {
		if (line[0] != '#' && line[0] != '\n') {
			return 1;
		}
	}
	fclose(f);
	return 0;
}

#endif
