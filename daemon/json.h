/* SPDX-License-Identifier: MIT
 * JSON written as it goes: one value at a time to a FILE, nothing kept but the nesting.
 * Inside an object every call names its key; inside an array key is NULL. Numbers that JSON cannot say become null.
 */
#ifndef AEBMC_JSON_H
#define AEBMC_JSON_H

#include <stdint.h>
#include <stdio.h>

struct json {
	FILE *out;
	int depth;       /* open objects and arrays, at most 63 */
	uint64_t filled; /* bit per depth: a value was written there */
};

/** json_start - an emitter on @out; write errors stay in ferror(@out). */
struct json json_start(FILE *out);

/** json_open, json_close - @kind '{' or '[', @end '}' or ']'; closing the outermost ends the line. */
void json_open(struct json *j, const char *key, char kind);
void json_close(struct json *j, char end);

/** json_num - shortest digits that read back to the same double; NaN and infinity are null. */
void json_num(struct json *j, const char *key, double v);
void json_uint(struct json *j, const char *key, uint64_t v);
void json_bool(struct json *j, const char *key, int v);

/** json_str - @v UTF-8; bytes that are not ASCII pass through, control characters are escaped; NULL is null. */
void json_str(struct json *j, const char *key, const char *v);

/** json_head - open the object and write schema ("aebmc.NAME.1") and version. */
void json_head(struct json *j, const char *name);

#endif
