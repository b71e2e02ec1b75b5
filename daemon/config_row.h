/* SPDX-License-Identifier: MIT
 * One option: what config.def says of it, and its value as text and back. For config.c alone.
 */
#ifndef AEBMC_CONFIG_ROW_H
#define AEBMC_CONFIG_ROW_H

#include <stddef.h>
#include <stdint.h>
#include "config.h"
#include "ini.h"

#define CONFIG_TEXT_MAX (CONFIG_STR_MAX + 64) /* any value or limit as text */

enum config_kind {
	CONFIG_KIND_num,
	CONFIG_KIND_int,
	CONFIG_KIND_bool,
	CONFIG_KIND_choice,
	CONFIG_KIND_str
};

struct config_row {
	const char *name; /* "section.key" */
	const char *section, *key;
	enum config_kind kind;
	int hashed;
	size_t offset; /* in struct config */
	union {
		struct {
			double def, min, max;
		} num;
		struct {
			int64_t def, min, max;
		} integer;
		const char *str;
	};
	const char *unit, *doc;
};

/* Every option, in the order of config.def. */
extern const struct config_row config_rows[];
extern const size_t config_rows_len;

/** config_row_default - set the option in @c to its default. */
void config_row_default(const struct config_row *r, struct config *c);

/** config_row_parse - @e's value into @c; what it may not be is reported to ini->err. 0, or -EINVAL with @c untouched. */
int config_row_parse(const struct config_row *r, const struct ini *ini, const struct ini_entry *e,
		     struct config *c);

/** config_row_print - its value in @c as text that reads back as the same; @text has CONFIG_TEXT_MAX bytes. */
void config_row_print(const struct config_row *r, const struct config *c, char *text);

/** config_row_limits - what it may be: "300 to 60000 kg", "yes|no"; @text has CONFIG_TEXT_MAX bytes. */
void config_row_limits(const struct config_row *r, char *text);

#endif
