/* SPDX-License-Identifier: MIT
 * Radars that report a list of objects: which message begins a scan, which names its objects by number, and tables for
 * signals that are an index.
 */
#include <errno.h>
#include <stdio.h>

#include "mapping_load.h"
#include "text.h"

int mapping_load_table(struct map_load *l, const struct ini_entry *e, const struct map_table **ret)
{
	char copy[INI_LINE_MAX + 1], *rest = copy, *word;
	struct map_table *t = &l->map->table[l->map->n_tables];

	if (l->map->n_tables == MAP_TABLES_MAX) {
		return ini_fail(l->ini, e, "more than %d tables; map fewer signals by table",
				MAP_TABLES_MAX);
	}
	snprintf(copy, sizeof(copy), "%s", e->value);
	while ((word = text_word(&rest))) {
		if (t->n == MAP_TABLE_MAX) {
			return ini_fail(l->ini, e, "more than %d numbers", MAP_TABLE_MAX);
		}
		if (text_number(word, &t->value[t->n])) {
			return ini_fail(l->ini, e, "'%.40s' is no number", word);
		}
		t->n++;
	}
	if (!t->n) {
		return ini_fail(l->ini, e, "no numbers; write what raw value 0, 1, ... stands for");
	}
	l->map->n_tables++;
	*ret = t;
	return 0;
}

/* begin_scan - object_count and scan_start name one header between them */
static int begin_scan(struct map_load *l, const struct ini_entry *from, int16_t msg)
{
	struct mapping *map = l->map;

	if (map->list.header >= 0 && map->list.header != msg) {
		return ini_fail(l->ini, from, "%s begins each scan already; name one message",
				map->message[map->list.header].msg->name);
	}
	map->list.header = msg;
	map->message[msg].part = MAP_HEADER;
	return 0;
}

int mapping_place_list(struct map_load *l, const struct ini_entry *from, const struct map_signal *s)
{
	struct map_list *list = &l->map->list;

	if (s == &list->count || s == &list->start) {
		return begin_scan(l, from, s->message);
	}
	if (s == &list->quality_id) {
		list->quality = s->message;
		l->map->message[s->message].part = MAP_QUALITY;
	}
	return 0;
}

/* is_clash - two of header, objects and quality in one message */
static int is_clash(const struct mapping *map)
{
	const struct map_list *list = &map->list;

	return list->header == map->track[0].message || list->quality == map->track[0].message ||
	       (list->header >= 0 && list->header == list->quality);
}

int mapping_check_list(const struct map_load *l)
{
	const struct mapping *map = l->map;
	const struct map_list *list = &map->list;
	const struct ini_entry *id = ini_get(l->ini, "signal object_id", "from");
	const struct ini_entry *quality = ini_get(l->ini, "signal quality_id", "from");
	const int is_list = list->id.sig != NULL;

	if (is_list && list->header < 0) {
		return ini_fail(l->ini, id,
				"without a header an empty road looks like a dead radar; map "
				"object_count or scan_start");
	}
	if (is_list && (map->n_tracks != 1 || list->id.message != map->track[0].message)) {
		return ini_fail(l->ini, id,
				"the number is in %s, unlike the distance; one message carries all "
				"objects",
				map->message[list->id.message].msg->name);
	}
	if (list->quality_id.sig && !is_list) {
		return ini_fail(l->ini, quality, "quality of which object? map object_id too");
	}
	if (is_clash(map)) {
		return ini_fail(l->ini, quality,
				"header, objects and quality are one message; they must differ");
	}
	return 0;
}
