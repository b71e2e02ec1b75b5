/* SPDX-License-Identifier: MIT
 * Logs that are no candump logs. See foreign.h.
 */
#include "foreign.h"
#include <stdio.h>
#include <string.h>
#include "cli.h"

#define BEGIN_BYTES 16

static const struct {
	const char *begin, *format;
} formats[] = {
	{"LOGG", "Vector BLF"},
	{"date ", "Vector ASC"},
	{";$FILEVERSION", "PCAN TRC"},
	{"MDF ", "ASAM MDF"},
};

static const char *format_of(const char *path)
{
	char begin[BEGIN_BYTES] = "";
	FILE *f = fopen(path, "r");

	if (f) {
		begin[fread(begin, 1, sizeof(begin) - 1, f)] = '\0';
		fclose(f);
	}
	for (size_t i = 0; i < sizeof(formats) / sizeof(formats[0]); i++) {
		if (!strncmp(begin, formats[i].begin, strlen(formats[i].begin))) {
			return formats[i].format;
		}
	}
	return NULL;
}

int foreign_log(const char *name, const char *path)
{
	const char *format = format_of(path);

	return format ? cli_error(CLI_FAILED, name,
				  "%s: looks like %s; python-can makes a candump log of it: "
				  "can_logconvert %s %s.log",
				  path, format, path, path)
		      : cli_error(CLI_FAILED, name,
				  "%s: no frame in it; a log of candump -L is needed", path);
}
