/* SPDX-License-Identifier: MIT
 * A configuration file as a list of entries with their lines: [section], key = value, # comments.
 * Knows no option: config.c and mapping.c give the entries their meaning and report errors through ini_fail.
 */
#ifndef AEBMC_INI_H
#define AEBMC_INI_H

#define INI_LINE_MAX    1000 /* characters in a line */
#define INI_ENTRIES_MAX 1000 /* sections and keys in a file */
#define INI_NAME_MAX    96   /* section or key, with the final 0 */

/* key is "" for the header of a section. A section's words are separated by one blank. */
struct ini_entry {
	int line; /* 1..; 0: an override from the command line */
	char section[INI_NAME_MAX];
	char key[INI_NAME_MAX];
	char value[INI_LINE_MAX + 1];
};

struct ini {
	const char *path; /* borrowed; NULL: overrides alone */
	char *err;        /* borrowed; receives one line */
	int err_len;
	int n, room;
	struct ini_entry *entry; /* [n], in the file's order */
};

/**
 * ini_read - read a file
 * @path: INI file, UTF-8, LF or CR LF; borrowed until ini_free, like @err
 * @err:  one line: file, line, name, what is wrong, how to mend it
 * Refuses lines over INI_LINE_MAX characters, control characters, bytes that are not UTF-8, duplicate sections and
 * keys, lines that are neither. Allocates. Returns 0, -EINVAL for content or -errno of the file.
 */
int ini_read(const char *path, char *err, int err_len, struct ini **ret);

/**
 * ini_split - take "section.key=value" apart
 * The section ends at the last dot before the first '='. Reports to ini->err. Returns 0 or -EINVAL. Pure on *@e.
 */
int ini_split(const struct ini *ini, const char *assignment, struct ini_entry *e);

/** ini_override - add "section.key=value", replacing that key where the file has it. Allocates. 0, -EINVAL, -ENOMEM. */
int ini_override(struct ini *ini, const char *assignment);

/** ini_get - the entry of @section with @key ("" for its header), or NULL. */
const struct ini_entry *ini_get(const struct ini *ini, const char *section, const char *key);

/**
 * ini_fail - say what is wrong with @e (NULL: with the file): "FILE:LINE: section.key: " and the text
 * Overwrites ini->err; control characters become '?', so that it is one line. Returns -EINVAL.
 */
int ini_fail(const struct ini *ini, const struct ini_entry *e, const char *fmt, ...)
	__attribute__((format(printf, 3, 4)));

void ini_free(struct ini *ini); /* NULL is fine */

#endif
