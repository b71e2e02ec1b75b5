/* SPDX-License-Identifier: MIT
 * [message NAME]: how a message is received. Every message a signal is taken from needs an interface and a period.
 */
#include <errno.h>
#include <string.h>

#include "clock.h"
#include "contract.h"
#include "mapping_load.h"
#include "text.h"

#define PERIOD_MAX_MS 10000.0

const struct map_key map_message_keys[] = {
	{"interface", "one of bus.interfaces; default: the only one"},
	{"check", "none, e2e-p2 or toyota; default: e2e-p2 where the database gives a DataIDList"},
	{"counter", "signal that counts frames up by one, where the check does not include one"},
	{"period", "nominal cycle in ms; default: the database's"},
};

const size_t map_message_keys_len = MAP_COUNT(map_message_keys);

static int set_interface(const struct map_load *l, const struct ini_entry *e, struct map_message *m)
{
	const struct mapping *map = l->map;
	const char *names[BUS_IFACES_MAX];

	for (int i = 0; i < map->n_ifaces; i++) {
		names[i] = map->iface[i];
		if (!strcmp(e->value, map->iface[i])) {
			m->iface = (uint8_t)i;
			return 0;
		}
	}
	return ini_fail(l->ini, e, "'%.40s' is not among bus.interfaces (nearest: %s)", e->value,
			text_nearest(e->value, names, (size_t)map->n_ifaces, sizeof(names[0])));
}

static int set_check(const struct map_load *l, const struct ini_entry *e, struct map_message *m)
{
	int kind = e2e_kind_find(e->value);

	if (kind < 0) {
		return ini_fail(
			l->ini, e, "no check '%.40s' (nearest: %s)", e->value,
			text_nearest(e->value, e2e_kind_name, E2E_KINDS, sizeof(e2e_kind_name[0])));
	}
	m->check = (enum e2e_kind)kind;
	return 0;
}

static int set_counter(const struct map_load *l, const struct ini_entry *e, struct map_message *m)
{
	m->counter = dbc_find_signal(m->msg, e->value);
	return m->counter ? 0 : mapping_no_signal(l, e, m->msg, e->value);
}

static int set_period(const struct map_load *l, const struct ini_entry *e, struct map_message *m)
{
	double ms;

	if (text_number(e->value, &ms) || ms < 1.0 || ms > PERIOD_MAX_MS) {
		return ini_fail(l->ini, e, "'%.40s' is no period; allowed: 1 to %g ms", e->value,
				PERIOD_MAX_MS);
	}
	m->period_ns = clock_s_to_ns(ms * 1e-3);
	return 0;
}

/* set_message - apply the keys of @header's section to one message */
static int set_message(const struct map_load *l, const struct ini_entry *header,
		       struct map_message *m)
{
	/* in the order of map_message_keys */
	static int (*const set[])(const struct map_load *, const struct ini_entry *,
				  struct map_message *) = {set_interface, set_check, set_counter,
							   set_period};
	int rc = 0;

	for (size_t i = 0; !rc && i < MAP_COUNT(set); i++) {
		const struct ini_entry *e =
			ini_get(l->ini, header->section, map_message_keys[i].name);

		if (e) {
			rc = set[i](l, e, m);
		}
	}
	return rc;
}

/* load_name - one message of a [message NAME] section; one that no signal is taken from is only checked */
static int load_name(struct map_load *l, const struct ini_entry *header, const char *name)
{
	struct map_message unused = {.msg = dbc_find(l->map->dbc, name)};
	int i = mapping_used(l->map, name);

	if (!unused.msg) {
		return mapping_no_message(l, header, name);
	}
	if (i < 0) {
		return set_message(l, header, &unused);
	}
	if (l->is_set[i]) {
		return ini_fail(l->ini, header, "%s is set twice, first in line %d; keep one", name,
				l->at[i]->line);
	}
	l->is_set[i] = 1;
	l->at[i] = header;
	return set_message(l, header, &l->map->message[i]);
}

static int load_section(struct map_load *l, const struct ini_entry *header, const char *text)
{
	struct map_names names;
	int rc = mapping_check_keys(l, header->section, map_message_keys, map_message_keys_len);

	rc = rc ? rc : mapping_expand(l, header, text, &names);
	for (int i = 0; !rc && i < names.n; i++) {
		rc = load_name(l, header, names.name[i]);
	}
	return rc;
}

/* check_message - can it be received, and is it none of our own? */
static int check_message(const struct map_load *l, const struct map_message *m,
			 const struct ini_entry *at)
{
	const struct e2e_config check = {.kind = m->check, .msg = m->msg, .counter = m->counter};
	const char *name = m->msg->name, *why = "";
	int64_t first = l->cfg->bus_request_id, id = m->msg->id & BUS_ID_MASK;
	int is_long = (m->msg->id & BUS_ID_EFF) != 0;

	if (m->iface == MAP_NO_IFACE) {
		return ini_fail(l->ini, at,
				"%s: which of bus.interfaces? write [message %s] interface = %s",
				name, name, l->map->iface[0]);
	}
	if (m->period_ns <= 0) {
		return ini_fail(l->ini, at,
				"%s: the database gives no cycle; write [message %s] period = MS",
				name, name);
	}
	if (e2e_config_check(&check, &why)) {
		return ini_fail(l->ini, at, "%s: check %s: %s", name, e2e_kind_name[m->check], why);
	}
	if (m->iface == config_out_interface(l->cfg) && is_long == (first > 0x7FF) && id >= first &&
	    id < first + CONTRACT_MESSAGES) {
		return ini_fail(l->ini, at,
				"%s has an identifier of our own frames, 0x%X; move bus.request_id",
				name, (unsigned)id);
	}
	return 0;
}

int mapping_load_messages(struct map_load *l)
{
	int rc = 0;

	for (int i = 0; !rc && i < l->ini->n; i++) {
		const struct ini_entry *e = &l->ini->entry[i];
		const char *names = mapping_argument(e->section, "message");

		if (names && !e->key[0]) {
			rc = load_section(l, e, names);
		}
	}
	for (int i = 0; !rc && i < l->map->n_messages; i++) {
		rc = check_message(l, &l->map->message[i], l->at[i]);
	}
	return rc;
}
