/* SPDX-License-Identifier: MIT
 * The table made from config.def, and what each kind of option may hold.
 */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config_row.h"
#include "text.h"

#define LIMITS_num(def_, min_, max_)    .num = {def_, min_, max_}
#define LIMITS_int(def_, min_, max_)    .integer = {def_, min_, max_}
#define LIMITS_bool(def_, min_, max_)   .integer = {def_, min_, max_}
#define LIMITS_choice(def_, min_, max_) .integer = {def_, min_, max_}
#define LIMITS_str(def_, min_, max_)    .str = def_
#define ROW(section_, key_, kind_, def_, min_, max_, unit_, doc_, hashed_) \
	{.name = #section_ "." #key_,                                      \
	 .section = #section_,                                             \
	 .key = #key_,                                                     \
	 .kind = CONFIG_KIND_##kind_,                                      \
	 .hashed = hashed_,                                                \
	 .offset = offsetof(struct config, section_##_##key_),             \
	 LIMITS_##kind_(def_, min_, max_),                                 \
	 .unit = unit_,                                                    \
	 .doc = doc_},

const struct config_row config_rows[] = {
#define CONFIG(...)          ROW(__VA_ARGS__, 1)
#define CONFIG_UNHASHED(...) ROW(__VA_ARGS__, 0)
#include "config.def"
#undef CONFIG
};

const size_t config_rows_len = sizeof(config_rows) / sizeof(config_rows[0]);

static void *field_of(const struct config_row *r, struct config *c)
{
	return (char *)c + r->offset;
}

void config_row_default(const struct config_row *r, struct config *c)
{
	void *field = field_of(r, c);

	switch (r->kind) {
	case CONFIG_KIND_num:
		*(double *)field = r->num.def;
		break;
	case CONFIG_KIND_int:
		*(int64_t *)field = r->integer.def;
		break;
	case CONFIG_KIND_bool:
	case CONFIG_KIND_choice:
		*(int32_t *)field = (int32_t)r->integer.def;
		break;
	case CONFIG_KIND_str:
		memset(field, 0, CONFIG_STR_MAX);
		memcpy(field, r->str, strlen(r->str));
		break;
	}
}

/* ---- values as text ---- */

#define NUMBER_MAX 32 /* any number as text */

/* print_number - the shortest decimal that reads back as @value */
static void print_number(double value, char *text)
{
	for (int digits = 15; digits <= 17; digits++) {
		snprintf(text, NUMBER_MAX, "%.*g", digits, value);
		if (strtod(text, NULL) == value) {
			return;
		}
	}
}

static void print_integer(const struct config_row *r, int64_t value, char *text)
{
	snprintf(text, NUMBER_MAX, !strcmp(r->unit, "id") ? "0x%" PRIX64 : "%" PRId64, value);
}

/* print_choice - the name at @index of "a|b|c" */
static void print_choice(const char *names, int index, char *text)
{
	for (; index > 0; index--) {
		names += strcspn(names, "|") + 1;
	}
	snprintf(text, CONFIG_TEXT_MAX, "%.*s", (int)strcspn(names, "|"), names);
}

void config_row_print(const struct config_row *r, const struct config *c, char *text)
{
	const void *field = (const char *)c + r->offset;

	switch (r->kind) {
	case CONFIG_KIND_num:
		print_number(*(const double *)field, text);
		break;
	case CONFIG_KIND_int:
		print_integer(r, *(const int64_t *)field, text);
		break;
	case CONFIG_KIND_bool:
		snprintf(text, CONFIG_TEXT_MAX, "%s", *(const int32_t *)field ? "yes" : "no");
		break;
	case CONFIG_KIND_choice:
		print_choice(r->unit, *(const int32_t *)field, text);
		break;
	case CONFIG_KIND_str:
		snprintf(text, CONFIG_TEXT_MAX, "%s", (const char *)field);
		break;
	}
}

void config_row_limits(const struct config_row *r, char *text)
{
	const char *unit = strcmp(r->unit, "1") && strcmp(r->unit, "id") ? r->unit : "";
	char min[NUMBER_MAX], max[NUMBER_MAX];

	switch (r->kind) {
	case CONFIG_KIND_num:
		print_number(r->num.min, min);
		print_number(r->num.max, max);
		break;
	case CONFIG_KIND_int:
		print_integer(r, r->integer.min, min);
		print_integer(r, r->integer.max, max);
		break;
	case CONFIG_KIND_bool:
		unit = "yes|no";
		/* fall through */
	default:
		snprintf(text, CONFIG_TEXT_MAX, "%s", unit);
		return;
	}
	snprintf(text, CONFIG_TEXT_MAX, "%s to %s%s%s", min, max, *unit ? " " : "", unit);
}

/* ---- text to values ---- */

static int refuse(const struct ini *ini, const struct ini_entry *e, const struct config_row *r,
		  const char *what)
{
	char limits[CONFIG_TEXT_MAX];

	config_row_limits(r, limits);
	return ini_fail(ini, e, "'%.40s' %s; allowed: %s", e->value, what, limits);
}

static int parse_num(const struct ini *ini, const struct ini_entry *e, const struct config_row *r,
		     void *field)
{
	double value;
	int rc = text_number(e->value, &value);

	if (rc) {
		return refuse(ini, e, r, rc == -ERANGE ? "is not finite" : "is not a number");
	}
	if (value < r->num.min || value > r->num.max) {
		return refuse(ini, e, r, "is out of range");
	}
	*(double *)field = value + 0.0; /* -0 becomes 0: they must not print and hash differently */
	return 0;
}

static int parse_int(const struct ini *ini, const struct ini_entry *e, const struct config_row *r,
		     void *field)
{
	int64_t value = 0;
	int rc = text_integer(e->value, &value);

	if (rc == -EINVAL) {
		return refuse(ini, e, r, "is not a whole number");
	}
	if (rc || value < r->integer.min || value > r->integer.max) {
		return refuse(ini, e, r, "is out of range");
	}
	*(int64_t *)field = value;
	return 0;
}

static int parse_bool(const struct ini *ini, const struct ini_entry *e, const struct config_row *r,
		      void *field)
{
	int value;

	if (!text_truth(e->value, &value)) {
		*(int32_t *)field = value;
		return 0;
	}
	return refuse(ini, e, r, "is neither yes nor no");
}

static int parse_choice(const struct ini *ini, const struct ini_entry *e,
			const struct config_row *r, void *field)
{
	char name[CONFIG_TEXT_MAX];

	for (int i = 0; i <= (int)r->integer.max; i++) {
		print_choice(r->unit, i, name);
		if (!strcmp(e->value, name)) {
			*(int32_t *)field = i;
			return 0;
		}
	}
	return refuse(ini, e, r, "is not among the choices");
}

static int parse_str(const struct ini *ini, const struct ini_entry *e, const struct config_row *r,
		     void *field)
{
	(void)r;
	if (strlen(e->value) >= CONFIG_STR_MAX) {
		return ini_fail(ini, e, "longer than %d characters; shorten it",
				CONFIG_STR_MAX - 1);
	}
	memset(field, 0, CONFIG_STR_MAX);
	memcpy(field, e->value, strlen(e->value));
	return 0;
}

int config_row_parse(const struct config_row *r, const struct ini *ini, const struct ini_entry *e,
		     struct config *c)
{
	static int (*const parse[])(const struct ini *, const struct ini_entry *,
				    const struct config_row *, void *) = {
		[CONFIG_KIND_num] = parse_num,   [CONFIG_KIND_int] = parse_int,
		[CONFIG_KIND_bool] = parse_bool, [CONFIG_KIND_choice] = parse_choice,
		[CONFIG_KIND_str] = parse_str,
	};

	return parse[r->kind](ini, e, r, field_of(r, c));
}
