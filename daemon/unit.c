/* SPDX-License-Identifier: MIT
 * The table of units.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unit.h"

#define PI 3.14159265358979323846

static const struct {
	enum unit_kind kind;
	const char *name;
	double gain;
} units[] = {
	{UNIT_SPEED, "m/s", 1.0},
	{UNIT_SPEED, "km/h", 1.0 / 3.6},
	{UNIT_SPEED, "kph", 1.0 / 3.6},
	{UNIT_SPEED, "kmh", 1.0 / 3.6},
	{UNIT_SPEED, "mph", 0.44704}, /* international mile, exact */
	{UNIT_LENGTH, "m", 1.0},
	{UNIT_LENGTH, "meters", 1.0},
	{UNIT_LENGTH, "cm", 0.01},
	{UNIT_LENGTH, "mm", 0.001},
	{UNIT_TURN, "rad/s", 1.0},
	{UNIT_TURN, "deg/s", PI / 180.0},
	{UNIT_TURN, "deg/sec", PI / 180.0},
	{UNIT_TURN, "\xC2\xB0/s", PI / 180.0}, /* degree sign in UTF-8 */
	{UNIT_TURN, "\xB0/s", PI / 180.0},     /* and in Latin-1, as most DBC editors write it */
	{UNIT_SHARE, "1", 1.0},
	{UNIT_SHARE, "", 1.0},
	{UNIT_SHARE, "%", 0.01},
};

#define UNITS (sizeof(units) / sizeof(units[0]))

int unit_gain(enum unit_kind kind, const char *name, double *gain)
{
	if (kind == UNIT_FLAG) {
		*gain = 1.0;
		return 0;
	}
	for (size_t i = 0; i < UNITS; i++) {
		if (units[i].kind == kind && !strcmp(units[i].name, name)) {
			*gain = units[i].gain;
			return 0;
		}
	}
	return -EINVAL;
}

/* A name that can be printed and typed: not empty, ASCII. */
static int is_plain(const char *name)
{
	return name[0] > ' ' && name[0] < 0x7F;
}

const char *unit_list(enum unit_kind kind, char *text, size_t size)
{
	size_t n = 0;

	text[0] = '\0';
	for (size_t i = 0; i < UNITS && n < size; i++) {
		if (units[i].kind == kind && is_plain(units[i].name)) {
			n += (size_t)snprintf(text + n, size - n, "%s%s", n ? ", " : "",
					      units[i].name);
		}
	}
	return text;
}
