/* SPDX-License-Identifier: MIT
 * Values of a JSON text by their path, as "risk.defer.p" or "links.0.name": the few that `aebmc top` shows.
 * No tree is built; the text is walked anew for each value.
 */
#ifndef AEBMC_JSON_PATH_H
#define AEBMC_JSON_PATH_H

#include <stddef.h>

#define JSON_PATH_DEPTH_MAX 32

/** json_path - where the value begins; NULL if there is none or the text before it is no JSON. Pure. */
const char *json_path(const char *text, const char *path);

/**
 * json_path_text - a value in words: a string without quotes and escapes, a number or a word as it stands, null as ""
 * @size: > 0; what does not fit is cut. Returns 0; -ENOENT if there is none; -EINVAL for an object or array. Pure.
 */
int json_path_text(const char *text, const char *path, char *value, size_t size);

#endif
