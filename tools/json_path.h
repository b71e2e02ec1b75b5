/* SPDX-License-Identifier: MIT
 * Values of a JSON text by their path, as "risk.defer.p" or "links.0.name": the few that are shown or drawn.
 * No tree is built; the text is walked anew for each value.
 */
#ifndef AEBMC_JSON_PATH_H
#define AEBMC_JSON_PATH_H

#include <stddef.h>

#define JSON_PATH_DEPTH_MAX 32

/**
 * json_path - where the value begins; NULL if there is none or the text before it is no JSON
 * The last key of a path may have dots in it. Pure.
 */
const char *json_path(const char *text, const char *path);

/**
 * json_path_text - a value in words: a string without quotes and escapes, a number or a word as it stands, null as ""
 * @size: > 0; what does not fit is cut. Returns 0; -ENOENT if there is none; -EINVAL for an object or array. Pure.
 */
int json_path_text(const char *text, const char *path, char *value, size_t size);

/** json_path_whole - 1 if the text is one JSON value and blanks: nothing is missing at its end. Pure. */
int json_path_whole(const char *text);

/** json_path_first, json_path_next - a member of an array, as a text of its own for json_path; NULL: there is none. Pure. */
const char *json_path_first(const char *array);
const char *json_path_next(const char *member);

#endif
