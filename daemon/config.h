/* SPDX-License-Identifier: MIT
 * One row per option (config.def): default, range, unit, doc -> this struct, parser, --help, --print-config, man page.
 * A configuration file is INI: [section], key = value, # comments. Sections [message NAME] and [signal ROLE] map the
 * car (mapping.h).
 */
#ifndef AEBMC_CONFIG_H
#define AEBMC_CONFIG_H

#include <stdint.h>
#include <stdio.h>
#include "bus.h"

#define CONFIG_STR_MAX 256

struct mapping;

/* Field types, by the kind column of config.def. */
typedef double config_num;
typedef int64_t config_int;
typedef int32_t config_bool;
typedef int32_t config_choice;
typedef char config_str[CONFIG_STR_MAX];

struct config {
#define CONFIG(section, key, kind, def, min, max, unit, doc) config_##kind section##_##key;
#include "config.def"
#undef CONFIG
};

/** config_defaults - every option at its default. */
void config_defaults(struct config *c);

/**
 * config_load - read a file
 * @path: INI file; @map: receives the mapping (NULL: mapping sections are checked for syntax only)
 * @set:  "section.key=value" overrides applied after the file, @n_set of them
 * @err:  one line: file, line, name, what is wrong, nearest valid name
 * Options depend on each other: what does not fit together is refused too. LC_NUMERIC must be "C".
 * Returns 0 or -errno (-EINVAL for content). Nothing is half-applied: @c and @map are touched only on 0. Allocates;
 * blocks on the file system.
 */
int config_load(const char *path, const char *const *set, int n_set, struct config *c,
		struct mapping **map, char *err, int err_len);

/** config_set - one "section.key=value". 0, or -EINVAL with @c untouched. */
int config_set(struct config *c, const char *assignment, char *err, int err_len);

/** config_interfaces - bus.interfaces taken apart. Returns how many, or -EINVAL (too many, too long, twice, none). Pure. */
int config_interfaces(const struct config *c, char name[BUS_IFACES_MAX][BUS_NAME_MAX]);

/** config_out_interface - index of the interface that our frames go to, or -EINVAL if bus.out_interface is not listed. Pure. */
int config_out_interface(const struct config *c);

/** config_hash - 64-bit hash of the options (CONFIG_UNHASHED ones excepted) and the mapping (NULL: none); the same on
 * any machine. */
uint64_t config_hash(const struct config *c, const struct mapping *map);

/** config_print - the whole configuration as a file that loads again, every option with its doc, range and unit; @map's
 * sections at its end (NULL: options alone). */
void config_print(const struct config *c, const struct mapping *map, FILE *out);

/** config_print_options - OPTIONS of the man page (roff-free scdoc text), one entry per row. */
void config_print_options(FILE *out);

/** config_mapping_free - NULL is fine. */
void config_mapping_free(struct mapping *map);

#endif
