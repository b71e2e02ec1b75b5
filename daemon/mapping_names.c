/* SPDX-License-Identifier: MIT
 * Names of messages and signals: ranges, look-up in the database.
 */
#include <stdio.h>
#include <string.h>

#include "clock.h"
#include "mapping_load.h"
#include "text.h"

/* expand_word - TRACK_{0..15} to TRACK_0 ... TRACK_15; {00..15} keeps its width */
static int expand_word(const struct map_load *l, const struct ini_entry *e, const char *word,
		       struct map_names *names)
{
	const char *open = strchr(word, '{');
	unsigned from = 0, to = 0;
	int used = 0, width = 1, before = open ? (int)(open - word) : (int)strlen(word);

	if (open) {
		if (sscanf(open, "{%4u..%4u}%n", &from, &to, &used) < 2 || !used || from > to ||
		    strchr(open + used, '{')) {
			return ini_fail(l->ini, e,
					"'%.80s' is no range; write NAME_{0..15}, one a name",
					word);
		}
		width = open[1] == '0' ? (int)strspn(open + 1, "0123456789") : 1;
	}
	for (unsigned i = from; i <= to; i++, names->n++) {
		char *name = names->name[names->n];

		if (names->n == MAP_TRACKS_MAX) {
			return ini_fail(l->ini, e, "more than %d names; shorten the list",
					MAP_TRACKS_MAX);
		}
		snprintf(name, MAP_SPEC_MAX, open ? "%.*s%0*u%s" : "%.*s", before, word, width, i,
			 open ? open + used : "");
	}
	return 0;
}

int mapping_expand(const struct map_load *l, const struct ini_entry *e, const char *text,
		   struct map_names *names)
{
	char copy[INI_LINE_MAX + 1], *rest = copy, *word;
	int rc = 0;

	names->n = 0;
	snprintf(copy, sizeof(copy), "%s", text);
	while (!rc && (word = text_word(&rest))) {
		rc = expand_word(l, e, word, names);
	}
	if (!rc && !names->n) {
		rc = ini_fail(l->ini, e, "no name given; write it after the word");
	}
	return rc;
}

int mapping_no_message(const struct map_load *l, const struct ini_entry *e, const char *name)
{
	return ini_fail(l->ini, e, "no message '%.128s' in %s (nearest: %s)", name,
			l->cfg->dbc_file, dbc_nearest(l->map->dbc, NULL, name));
}

int mapping_no_signal(const struct map_load *l, const struct ini_entry *e,
		      const struct dbc_message *msg, const char *name)
{
	return ini_fail(l->ini, e, "message %s has no signal '%.128s' (nearest: %s)", msg->name,
			name, dbc_nearest(l->map->dbc, msg, name));
}

int mapping_used(const struct mapping *map, const char *name)
{
	for (int i = 0; i < map->n_messages; i++) {
		if (!strcmp(map->message[i].msg->name, name)) {
			return i;
		}
	}
	return -1;
}

int mapping_use(struct map_load *l, const struct ini_entry *e, const char *name)
{
	struct mapping *map = l->map;
	const struct dbc_message *msg = dbc_find(map->dbc, name);
	int i = mapping_used(map, name);

	if (i >= 0) {
		return i;
	}
	if (!msg) {
		return mapping_no_message(l, e, name);
	}
	if (map->n_messages == MAP_MESSAGES_MAX) {
		return ini_fail(l->ini, e, "signals from more than %d messages; map fewer",
				MAP_MESSAGES_MAX);
	}
	map->message[map->n_messages] = (struct map_message){
		.msg = msg,
		.iface = map->n_ifaces == 1 ? 0 : MAP_NO_IFACE,
		.check = msg->has_data_id ? E2E_P2 : E2E_NONE,
		.period_ns = (int64_t)msg->cycle_ms * CLOCK_NS_PER_MS,
		.track = -1,
	};
	l->at[map->n_messages] = e;
	return map->n_messages++;
}
