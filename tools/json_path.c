/* SPDX-License-Identifier: MIT
 * Values of a JSON text by their path. See json_path.h.
 */
#include "json_path.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define BLANKS " \t\r\n"

static const char *skip_blanks(const char *p)
{
	return p + strspn(p, BLANKS);
}

/* Behind the closing quote; NULL if there is none. */
static const char *skip_string(const char *p)
{
	for (p++; *p && *p != '"'; p++) {
		if (*p == '\\' && p[1]) {
			p++;
		}
	}
	return *p ? p + 1 : NULL;
}

static const char *skip_value(const char *p, int depth);

/* "key": in an object, nothing in an array. */
static const char *skip_key(const char *p)
{
	p = *p == '"' ? skip_string(p) : NULL;
	p = p ? skip_blanks(p) : NULL;
	return p && *p == ':' ? skip_blanks(p + 1) : NULL;
}

/* To the next member of an object or array, at its key; NULL behind the last one or where the text is no JSON. */
static const char *next_member(const char *value, int depth)
{
	const char *p = skip_value(value, depth);

	p = p ? skip_blanks(p) : NULL;
	return p && *p == ',' ? skip_blanks(p + 1) : NULL;
}

static const char *skip_members(const char *p, int depth)
{
	const char end = *p == '{' ? '}' : ']';

	for (p = skip_blanks(p + 1); *p != end;) {
		p = end == '}' ? skip_key(p) : p;
		p = p && depth < JSON_PATH_DEPTH_MAX ? skip_value(p, depth + 1) : NULL;
		p = p ? skip_blanks(p) : NULL;
		if (!p || (*p != ',' && *p != end)) {
			return NULL;
		}
		p = *p == ',' ? skip_blanks(p + 1) : p;
	}
	return p + 1;
}

/* Behind a value; NULL if it is none. */
static const char *skip_value(const char *p, int depth)
{
	size_t n;

	if (*p == '{' || *p == '[') {
		return skip_members(p, depth);
	}
	if (*p == '"') {
		return skip_string(p);
	}
	n = strcspn(p, ",]}" BLANKS);
	return n ? p + n : NULL;
}

static const char *member_by_key(const char *p, const char *key, size_t len)
{
	for (p = skip_blanks(p + 1); p && *p == '"';) {
		const int found = !strncmp(p + 1, key, len) && p[1 + len] == '"';

		p = skip_key(p);
		if (found || !p) {
			return p;
		}
		p = next_member(p, 0);
	}
	return NULL;
}

static const char *member_by_index(const char *p, long index)
{
	p = skip_blanks(p + 1);
	for (p = *p == ']' ? NULL : p; p && index > 0; index--) {
		p = next_member(p, 0);
	}
	return p;
}

const char *json_path(const char *text, const char *path)
{
	const char *p = skip_blanks(text);

	while (p && *path) {
		const size_t whole = strlen(path);
		const char *last = *p == '{' ? member_by_key(p, path, whole) : NULL;
		const size_t len = last ? whole : strcspn(path, ".");

		if (*p == '{') {
			p = last ? last : member_by_key(p, path, len);
		} else {
			p = *p == '[' ? member_by_index(p, strtol(path, NULL, 10)) : NULL;
		}
		path += len + (path[len] == '.');
	}
	return p && skip_value(p, 0) ? p : NULL;
}

/* Control characters are all that our emitter escapes by number. */
static char unescape(const char **p)
{
	if (**p != '\\') {
		return *(*p)++;
	}
	if ((*p)[1] == 'u') {
		*p += 2 + strspn(*p + 2, "0123456789abcdefABCDEF");
		return '?';
	}
	*p += 2;
	return (*p)[-1];
}

int json_path_text(const char *text, const char *path, char *value, size_t size)
{
	const char *p = json_path(text, path), *end;
	const int is_string = p && *p == '"';
	size_t n = 0;

	if (!p || *p == '{' || *p == '[') {
		return p ? -EINVAL : -ENOENT;
	}
	end = skip_value(p, 0) - is_string;
	if (!is_string && !strncmp(p, "null", 4)) {
		end = p;
	}
	for (p += is_string; p < end && n + 1 < size;) {
		value[n++] = unescape(&p);
	}
	value[n] = '\0';
	return 0;
}

int json_path_whole(const char *text)
{
	const char *p = skip_value(skip_blanks(text), 0);

	return p && !*skip_blanks(p);
}

const char *json_path_first(const char *array)
{
	return *array == '[' ? member_by_index(array, 0) : NULL;
}

const char *json_path_next(const char *member)
{
	return next_member(member, 0);
}
