/* SPDX-License-Identifier: MIT
 * JSON written as it goes: one value at a time to a FILE, nothing kept but the nesting.
 */
#include "json.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include "version.h"

struct json json_start(FILE *out)
{
	return (struct json){out, 0, 0};
}

static void quote(FILE *out, const char *s)
{
	fputc('"', out);
	for (; *s; s++) {
		unsigned char c = (unsigned char)*s;

		if (c < 0x20) {
			fprintf(out, "\\u%04x", c);
			continue;
		}
		if (c == '"' || c == '\\') {
			fputc('\\', out);
		}
		fputc(c, out);
	}
	fputc('"', out);
}

static void lead_in(struct json *j, const char *key)
{
	uint64_t bit = 1ull << j->depth;

	if (j->filled & bit) {
		fputc(',', j->out);
	}
	j->filled |= bit;
	if (key) {
		quote(j->out, key);
		fputc(':', j->out);
	}
}

void json_open(struct json *j, const char *key, char kind)
{
	lead_in(j, key);
	fputc(kind, j->out);
	j->depth++;
	j->filled &= ~(1ull << j->depth);
}

void json_close(struct json *j, char end)
{
	fputc(end, j->out);
	j->depth--;
	if (!j->depth) {
		fputc('\n', j->out);
	}
}

void json_num(struct json *j, const char *key, double v)
{
	char text[40];

	lead_in(j, key);
	snprintf(text, sizeof(text), "%.15g", v);
	if (strtod(text, NULL) != v) {
		snprintf(text, sizeof(text), "%.17g", v);
	}
	fputs(isfinite(v) ? text : "null", j->out);
}

void json_uint(struct json *j, const char *key, uint64_t v)
{
	lead_in(j, key);
	fprintf(j->out, "%" PRIu64, v);
}

void json_bool(struct json *j, const char *key, int v)
{
	lead_in(j, key);
	fputs(v ? "true" : "false", j->out);
}

void json_str(struct json *j, const char *key, const char *v)
{
	lead_in(j, key);
	if (v) {
		quote(j->out, v);
	} else {
		fputs("null", j->out);
	}
}

void json_head(struct json *j, const char *name)
{
	char schema[48];

	snprintf(schema, sizeof(schema), "aebmc.%s.1", name);
	json_open(j, NULL, '{');
	json_str(j, "schema", schema);
	json_str(j, "version", AEBMC_VERSION);
}
