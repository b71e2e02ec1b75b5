/* SPDX-License-Identifier: MIT
 * What the files that load a mapping share: mapping_load.c (the order of things), mapping_names.c, mapping_signal.c,
 * mapping_message.c. For them alone. All report to ini->err and return 0 or -EINVAL unless they say otherwise.
 */
#ifndef AEBMC_MAPPING_LOAD_H
#define AEBMC_MAPPING_LOAD_H

#include "config.h"
#include "ini.h"
#include "mapping.h"

#define MAP_SPEC_MAX     (2 * DBC_NAME_MAX + 2) /* "MESSAGE.SIGNAL" */
#define MAP_NO_IFACE     UINT8_MAX              /* not said yet */
#define MAP_COUNT(table) (sizeof(table) / sizeof((table)[0]))

struct map_names {
	int n;
	char name[MAP_TRACKS_MAX][MAP_SPEC_MAX];
};

struct map_load {
	const struct ini *ini;
	struct config *cfg;
	struct mapping *map;
	const struct ini_entry *at[MAP_MESSAGES_MAX]; /* where a message is set, or first named */
	uint8_t is_set[MAP_MESSAGES_MAX];
};

/* A key that a section may have; tables of them begin with the name, as text_nearest wants it. */
struct map_key {
	const char *name, *doc;
};

extern const struct map_key map_signal_keys[];
extern const struct map_key map_message_keys[];
extern const size_t map_signal_keys_len, map_message_keys_len;

/** mapping_argument - what follows @word in a section's name, or NULL if it starts with another word. */
const char *mapping_argument(const char *section, const char *word);

/** mapping_check_keys - every key of @section in the table? */
int mapping_check_keys(const struct map_load *l, const char *section, const struct map_key *keys,
		       size_t n);

/** mapping_expand - words to names: TRACK_{0..15} to TRACK_0 ... TRACK_15; {00..15} keeps its width. */
int mapping_expand(const struct map_load *l, const struct ini_entry *e, const char *text,
		   struct map_names *names);

/** mapping_used - index of a message that signals are taken from, or -1. */
int mapping_used(const struct mapping *map, const char *name);

/** mapping_use - index of the message called @name, added with its defaults if it is new; or -EINVAL. */
int mapping_use(struct map_load *l, const struct ini_entry *e, const char *name);

/** mapping_no_message, mapping_no_signal - say so, with the nearest that there is. Return -EINVAL. */
int mapping_no_message(const struct map_load *l, const struct ini_entry *e, const char *name);
int mapping_no_signal(const struct map_load *l, const struct ini_entry *e,
		      const struct dbc_message *msg, const char *name);

/** mapping_load_table - a table key's numbers; the mapping keeps them. */
int mapping_load_table(struct map_load *l, const struct ini_entry *e, const struct map_table **ret);

/** mapping_place_list - @s of struct map_list is set: note what its message is to a scan. */
int mapping_place_list(struct map_load *l, const struct ini_entry *from,
		       const struct map_signal *s);

/** mapping_check_list - do header, objects and their quality go together? All signals are set. */
int mapping_check_list(const struct map_load *l);

/** mapping_load_signals - all [signal ROLE] sections: roles, targets and the messages they need. */
int mapping_load_signals(struct map_load *l);

/** mapping_load_messages - all [message NAME] sections; afterwards every message is known to be receivable. */
int mapping_load_messages(struct map_load *l);

/** mapping_print_roles - every role and its doc, as scdoc text. */
void mapping_print_roles(FILE *out);

#endif
