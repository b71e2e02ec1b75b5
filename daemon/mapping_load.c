/* SPDX-License-Identifier: MIT
 * A mapping from a read configuration file: the database, then the signals, which say what messages are needed, then how
 * those are received.
 */
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "mapping_load.h"
#include "text.h"

const char *mapping_argument(const char *section, const char *word)
{
	size_t n = strlen(word);

	if (strncmp(section, word, n) || (section[n] && section[n] != ' ')) {
		return NULL;
	}
	return section + n + (section[n] == ' ');
}

int mapping_section(const char *section)
{
	return mapping_argument(section, "message") || mapping_argument(section, "signal");
}

int mapping_check_keys(const struct map_load *l, const char *section, const struct map_key *keys,
		       size_t n)
{
	for (int i = 0; i < l->ini->n; i++) {
		const struct ini_entry *e = &l->ini->entry[i];
		size_t k = 0;

		if (!e->key[0] || strcmp(e->section, section)) {
			continue;
		}
		while (k < n && strcmp(keys[k].name, e->key)) {
			k++;
		}
		if (k == n) {
			return ini_fail(l->ini, e, "no such key (nearest: %s)",
					text_nearest(e->key, &keys[0].name, n, sizeof(keys[0])));
		}
	}
	return 0;
}

/* find_dbc - the database's absolute path: relative to the file that names it, or to the working directory */
static int find_dbc(struct map_load *l, const struct ini_entry *e)
{
	char given[2 * PATH_MAX], found[PATH_MAX];
	const char *slash = strrchr(l->ini->path, '/');
	int dir = e->line > 0 && e->value[0] != '/' && slash ? (int)(slash + 1 - l->ini->path) : 0;

	snprintf(given, sizeof(given), "%.*s%s", dir, l->ini->path, e->value);
	if (!realpath(given, found)) {
		return ini_fail(l->ini, e, "cannot open '%s': %s", given, strerror(errno));
	}
	if (strlen(found) >= CONFIG_STR_MAX) {
		return ini_fail(l->ini, e, "'%s' is longer than %d characters; move it", found,
				CONFIG_STR_MAX - 1);
	}
	memset(l->cfg->dbc_file, 0, CONFIG_STR_MAX);
	memcpy(l->cfg->dbc_file, found, strlen(found));
	return 0;
}

static int load_dbc(struct map_load *l)
{
	const struct ini_entry *e = ini_get(l->ini, "dbc", "file");
	char why[512];
	int rc;

	if (!e || !e->value[0]) {
		return ini_fail(l->ini, e, "no CAN database; write [dbc] file = NAME.dbc");
	}
	rc = find_dbc(l, e);
	if (rc) {
		return rc;
	}
	rc = dbc_load(l->cfg->dbc_file, &l->map->dbc, why, sizeof(why));
	return rc ? ini_fail(l->ini, e, "%s", why) : 0;
}

/* order - by interface and id, for mapping_find */
static void order(struct mapping *map)
{
	for (int i = 0; i < map->n_messages; i++) {
		const struct map_message *m = &map->message[i];
		int k = i;

		for (; k > 0; k--) {
			const struct map_message *before = &map->message[map->by_id[k - 1]];

			if (before->iface < m->iface ||
			    (before->iface == m->iface && before->msg->id < m->msg->id)) {
				break;
			}
			map->by_id[k] = map->by_id[k - 1];
		}
		map->by_id[k] = (uint8_t)i;
	}
}

int mapping_load(struct ini *ini, struct config *cfg, struct mapping **ret)
{
	struct map_load l = {.ini = ini, .cfg = cfg, .map = calloc(1, sizeof(*l.map))};
	int rc;

	if (!l.map) {
		ini_fail(ini, NULL, "out of memory");
		return -ENOMEM;
	}
	l.map->list.header = l.map->list.quality = -1;
	l.map->n_ifaces = config_interfaces(cfg, l.map->iface);
	l.map->scan_gap_ns = clock_s_to_ns(cfg->radar_scan_gap * 1e-3);
	rc = load_dbc(&l);
	rc = rc ? rc : mapping_load_signals(&l);
	rc = rc ? rc : mapping_load_messages(&l);
	if (rc) {
		mapping_free(l.map);
		return rc;
	}
	order(l.map);
	l.map->source = ini;
	*ret = l.map;
	return 0;
}

static void print_keys(const struct map_key *keys, size_t n, FILE *out)
{
	for (size_t i = 0; i < n; i++) {
		fprintf(out, "*%s*\n\t%s\n\n", keys[i].name, keys[i].doc);
	}
}

void mapping_print_options(FILE *out)
{
	mapping_print_roles(out);
	fprintf(out, "Keys of *[signal ROLE]*:\n\n");
	print_keys(map_signal_keys, map_signal_keys_len, out);
	fprintf(out, "Keys of *[message NAME]*:\n\n");
	print_keys(map_message_keys, map_message_keys_len, out);
}
