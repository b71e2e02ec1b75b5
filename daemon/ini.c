/* SPDX-License-Identifier: MIT
 * Reads character by character, so that an endless or binary file is refused at its first bad line.
 */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ini.h"
#include "text.h"

static const char blanks[] = " \t";
static const char mark[] = "\xEF\xBB\xBF"; /* of byte order: some editors put it first */

int ini_fail(const struct ini *ini, const struct ini_entry *e, const char *fmt, ...)
{
	char where[2 * INI_NAME_MAX + 32] = "";
	char what[1024];
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(what, sizeof(what), fmt, ap);
	va_end(ap);
	if (e && e->line > 0) {
		snprintf(where, sizeof(where), ":%d", e->line);
	}
	if (e && e->section[0]) {
		size_t n = strlen(where);

		snprintf(where + n, sizeof(where) - n, e->key[0] ? ": %s.%s" : ": [%s]", e->section,
			 e->key);
	}
	snprintf(ini->err, (size_t)ini->err_len, "%s%s: %s",
		 e && e->line == 0 ? "--set" : ini->path, where, what);
	for (char *c = ini->err; *c; c++) {
		/* What a database calls a unit may hold anything, ends of lines too. */
		*c = (unsigned char)*c < ' ' || *c == 0x7F ? '?' : *c;
	}
	return -EINVAL;
}

const struct ini_entry *ini_get(const struct ini *ini, const char *section, const char *key)
{
	for (int i = 0; i < ini->n; i++) {
		if (!strcmp(ini->entry[i].section, section) && !strcmp(ini->entry[i].key, key)) {
			return &ini->entry[i];
		}
	}
	return NULL;
}

/* trim - @s without blanks at either end; cuts the text. */
static char *trim(char *s)
{
	size_t n;

	s += strspn(s, blanks);
	for (n = strlen(s); n > 0 && strchr(blanks, s[n - 1]); n--) {
	}
	s[n] = '\0';
	return s;
}

/* utf8_len - bytes of the character at @s, of which @n are left; 0 for a control character or no UTF-8. */
static int utf8_len(const unsigned char *s, int n)
{
	int len = s[0] < 0x80   ? 1
		  : s[0] < 0xC2 ? 0
		  : s[0] < 0xE0 ? 2
		  : s[0] < 0xF0 ? 3
		  : s[0] < 0xF5 ? 4
				: 0;

	if (len == 1) {
		return s[0] == '\t' || (s[0] >= ' ' && s[0] != 0x7F);
	}
	if (len > n) {
		return 0;
	}
	for (int i = 1; i < len; i++) {
		if ((s[i] & 0xC0) != 0x80) {
			return 0;
		}
	}
	return len;
}

/* check_text - only printable UTF-8 and tabs? */
static int check_text(const struct ini *ini, const struct ini_entry *e, const char *line, int n)
{
	int len;

	for (int i = 0; i < n; i += len) {
		len = utf8_len((const unsigned char *)line + i, n - i);
		if (!len) {
			return ini_fail(
				ini, e,
				"byte 0x%02X in column %d is no text; save the file as UTF-8",
				(unsigned char)line[i], i + 1);
		}
	}
	return 0;
}

/* read_line - the next line without its end. 1, 0 at the end of the file, -errno. */
static int read_line(const struct ini *ini, const struct ini_entry *e, FILE *f, char *line)
{
	int c, n = 0, rc;

	while ((c = getc(f)) != EOF && c != '\n') {
		if (n == INI_LINE_MAX) {
			return ini_fail(ini, e, "line longer than %d characters; shorten it",
					INI_LINE_MAX);
		}
		line[n++] = (char)c;
	}
	if (ferror(f)) {
		rc = -errno;
		ini_fail(ini, NULL, "cannot read: %s", strerror(-rc));
		return rc;
	}
	n -= n > 0 && line[n - 1] == '\r';
	line[n] = '\0';
	rc = check_text(ini, e, line, n);
	return rc ? rc : c != EOF || n > 0;
}

/* copy_name - a section or key, its words separated by one blank. */
static int copy_name(const struct ini *ini, const struct ini_entry *e, char *text,
		     char to[INI_NAME_MAX])
{
	char *word;
	size_t n = 0;

	while ((word = text_word(&text))) {
		n += (size_t)snprintf(to + n, INI_NAME_MAX - n, "%s%s", n ? " " : "", word);
		if (n >= INI_NAME_MAX) {
			to[0] = '\0';
			return ini_fail(ini, e, "name longer than %d characters; shorten it",
					INI_NAME_MAX - 1);
		}
	}
	return n ? 0 : ini_fail(ini, e, "empty name; write [section] or key = value");
}

/* parse_header - "[section]" into @e */
static int parse_header(const struct ini *ini, char *line, struct ini_entry *e)
{
	size_t n = strlen(line);

	e->section[0] = '\0';
	if (line[n - 1] != ']') {
		return ini_fail(ini, e, "'%.40s' has no closing bracket; write [section]", line);
	}
	line[n - 1] = '\0';
	return copy_name(ini, e, line + 1, e->section);
}

/* parse_key - "key = value" into @e */
static int parse_key(const struct ini *ini, char *line, struct ini_entry *e)
{
	char *equals = strchr(line, '=');
	int rc;

	if (!equals) {
		return ini_fail(ini, e,
				"'%.40s' has no '='; write key = value, [section] or # comment",
				line);
	}
	if (!e->section[0]) {
		return ini_fail(ini, e, "'%.40s' stands before any section; put [section] above it",
				line);
	}
	*equals = '\0';
	rc = copy_name(ini, e, line, e->key);
	snprintf(e->value, sizeof(e->value), "%s", trim(equals + 1));
	return rc;
}

/* add - append @e unless it is there already */
static int add(struct ini *ini, const struct ini_entry *e)
{
	const struct ini_entry *first = ini_get(ini, e->section, e->key);

	if (first) {
		return ini_fail(ini, e, "given twice, first in line %d; keep one", first->line);
	}
	if (ini->n == INI_ENTRIES_MAX) {
		return ini_fail(ini, e, "more than %d sections and keys; shorten the file",
				INI_ENTRIES_MAX);
	}
	if (ini->n == ini->room) {
		int room = ini->room ? 2 * ini->room : 32;
		struct ini_entry *more = realloc(ini->entry, (size_t)room * sizeof(*more));

		if (!more) {
			ini_fail(ini, e, "out of memory");
			return -ENOMEM;
		}
		ini->entry = more;
		ini->room = room;
	}
	ini->entry[ini->n++] = *e;
	return 0;
}

static int read_entries(struct ini *ini, FILE *f)
{
	char text[INI_LINE_MAX + 1];
	struct ini_entry e = {.line = 1};
	int rc;

	for (; (rc = read_line(ini, &e, f, text)) > 0; e.line++) {
		char *line;

		text[strcspn(text, "#")] = '\0';
		line = e.line == 1 && !strncmp(text, mark, strlen(mark)) ? text + strlen(mark)
									 : text;
		line = trim(line);
		e.key[0] = e.value[0] = '\0';
		if (!line[0]) {
			continue;
		}
		rc = line[0] == '[' ? parse_header(ini, line, &e) : parse_key(ini, line, &e);
		if (!rc) {
			rc = add(ini, &e);
		}
		if (rc) {
			return rc;
		}
	}
	return rc;
}

int ini_read(const char *path, char *err, int err_len, struct ini **ret)
{
	struct ini *ini = calloc(1, sizeof(*ini));
	FILE *f;
	int rc;

	if (!ini) {
		snprintf(err, (size_t)err_len, "%s: out of memory", path);
		return -ENOMEM;
	}
	*ini = (struct ini){.path = path, .err = err, .err_len = err_len};
	f = fopen(path, "re");
	if (!f) {
		rc = -errno;
		ini_fail(ini, NULL, "cannot open: %s", strerror(-rc));
		goto out;
	}
	rc = read_entries(ini, f);
	fclose(f);
out:
	if (rc) {
		ini_free(ini);
		return rc;
	}
	*ret = ini;
	return 0;
}

int ini_split(const struct ini *ini, const char *assignment, struct ini_entry *e)
{
	char text[INI_LINE_MAX + 1];
	size_t name = strcspn(assignment, "="), n = strlen(assignment), dot = name;
	int rc;

	*e = (struct ini_entry){0};
	if (n > INI_LINE_MAX) {
		return ini_fail(ini, e, "longer than %d characters; shorten it", INI_LINE_MAX);
	}
	rc = check_text(ini, e, assignment, (int)n);
	while (!rc && dot > 0 && assignment[dot - 1] != '.') {
		dot--;
	}
	if (!rc && (dot == 0 || name == n)) {
		rc = ini_fail(ini, e, "'%.80s' is no assignment; write section.key=value",
			      assignment);
	}
	if (rc) {
		return rc;
	}
	memcpy(text, assignment, n + 1);
	text[dot - 1] = '\0';
	rc = copy_name(ini, e, text, e->section);
	return rc ? rc : parse_key(ini, text + dot, e);
}

int ini_override(struct ini *ini, const char *assignment)
{
	struct ini_entry e;
	int rc = ini_split(ini, assignment, &e);

	for (int i = 0; !rc && i < ini->n; i++) {
		struct ini_entry *old = &ini->entry[i];

		if (!strcmp(old->section, e.section) && !strcmp(old->key, e.key)) {
			*old = e;
			return 0;
		}
	}
	if (!rc && !ini_get(ini, e.section, "")) {
		struct ini_entry header = e;

		header.key[0] = header.value[0] = '\0';
		rc = add(ini, &header);
	}
	return rc ? rc : add(ini, &e);
}

void ini_free(struct ini *ini)
{
	if (ini) {
		free(ini->entry);
		free(ini);
	}
}
