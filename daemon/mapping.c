/* SPDX-License-Identifier: MIT
 * A loaded mapping: look-up, hash, printing. How it is loaded: mapping_load.c.
 */
#include <stdlib.h>
#include <string.h>

#include "hash.h"
#include "ini.h"
#include "mapping.h"

/* key - what messages are ordered by */
static uint64_t key(uint8_t iface, uint32_t id)
{
	return (uint64_t)iface << 32 | id;
}

int mapping_find(const struct mapping *m, uint8_t iface, uint32_t id)
{
	uint64_t want = key(iface, id);
	int lo = 0, hi = m->n_messages;

	while (lo < hi) {
		int mid = (lo + hi) / 2;
		const struct map_message *msg = &m->message[m->by_id[mid]];
		uint64_t have = key(msg->iface, msg->msg->id);

		if (have == want) {
			return m->by_id[mid];
		}
		if (have < want) {
			lo = mid + 1;
		} else {
			hi = mid;
		}
	}
	return -1;
}

static uint64_t hash_message(const struct map_message *m, uint64_t h)
{
	h = hash_text(h, m->msg->name);
	h = hash_text(h, m->counter ? m->counter->name : "");
	h = hash_u64(h, (uint64_t)m->iface << 8 | (uint64_t)m->check);
	return hash_u64(h, (uint64_t)m->period_ns);
}

static uint64_t hash_signal(const struct map_signal *s, uint64_t h)
{
	h = hash_text(h, s->sig ? s->sig->name : "");
	h = hash_f64(hash_f64(h, s->gain), s->offset);
	for (uint32_t i = 0; s->table && i < s->table->n; i++) {
		h = hash_f64(h, s->table->value[i]);
	}
	return hash_u64(hash_u64(h, (uint64_t)s->has_na), s->na_raw);
}

static uint64_t hash_list(const struct map_list *l, uint64_t h)
{
	if (l->header < 0) {
		return h;
	}
	h = hash_u64(hash_u64(h, (uint64_t)l->header), (uint64_t)l->quality);
	h = hash_signal(&l->count, h);
	h = hash_signal(&l->start, h);
	h = hash_signal(&l->id, h);
	return hash_signal(&l->quality_id, h);
}

uint64_t mapping_hash(const struct mapping *m, uint64_t h)
{
	h = hash_u64(h, dbc_hash(m->dbc));
	for (int i = 0; i < m->n_messages; i++) {
		h = hash_message(&m->message[i], h);
	}
	for (int r = 0; r < MAP_ROLES; r++) {
		h = hash_u64(h, (uint64_t)m->role[r].n);
		for (int i = 0; i < m->role[r].n; i++) {
			h = hash_u64(h, (uint64_t)m->role[r].message[i]);
			h = hash_signal(&m->role[r].signal[i], h);
		}
	}
	for (int i = 0; i < m->n_tracks; i++) {
		const struct map_track *t = &m->track[i];

		h = hash_u64(h, (uint64_t)t->message);
		h = hash_signal(&t->distance, h);
		h = hash_signal(&t->rel_speed, h);
		h = hash_signal(&t->lateral, h);
		h = hash_signal(&t->valid, h);
		h = hash_signal(&t->fresh, h);
		h = hash_signal(&t->existence, h);
		h = t->distance_sigma.sig ? hash_signal(&t->distance_sigma, h) : h;
		h = t->rate_sigma.sig ? hash_signal(&t->rate_sigma, h) : h;
	}
	return hash_list(&m->list, h);
}

/* print_section - the keys of one section, wherever the file or an override has them */
static void print_section(const struct ini *ini, const char *section, FILE *out)
{
	fprintf(out, "\n[%s]\n", section);
	for (int i = 0; i < ini->n; i++) {
		const struct ini_entry *e = &ini->entry[i];

		if (e->key[0] && !strcmp(e->section, section)) {
			fprintf(out, "%s = %s\n", e->key, e->value);
		}
	}
}

void mapping_print(const struct mapping *m, FILE *out)
{
	for (int i = 0; i < m->source->n; i++) {
		const struct ini_entry *e = &m->source->entry[i];

		if (!e->key[0] && mapping_section(e->section)) {
			print_section(m->source, e->section, out);
		}
	}
}

void mapping_free(struct mapping *m)
{
	if (m) {
		ini_free(m->source);
		dbc_free(m->dbc);
		free(m);
	}
}
