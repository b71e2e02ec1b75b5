/* SPDX-License-Identifier: MIT
 * Looking things up in a CAN database, loaded (dbc_load.c) or compiled in (contract.c).
 */
#include <errno.h>
#include <limits.h>
#include <string.h>
#include "dbc.h"
#include "nearest.h"

const struct dbc_message *dbc_find(const struct dbc *dbc, const char *name)
{
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		if (!strcmp(dbc->messages[i].name, name)) {
			return &dbc->messages[i];
		}
	}
	return NULL;
}

const struct dbc_message *dbc_find_id(const struct dbc *dbc, uint32_t id)
{
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		if (dbc->messages[i].id == id) {
			return &dbc->messages[i];
		}
	}
	return NULL;
}

const struct dbc_signal *dbc_find_signal(const struct dbc_message *msg, const char *name)
{
	for (uint32_t i = 0; i < msg->n_signals; i++) {
		if (!strcmp(msg->signals[i].name, name)) {
			return &msg->signals[i];
		}
	}
	return NULL;
}

const char *dbc_nearest(const struct dbc *dbc, const struct dbc_message *msg, const char *name)
{
	const char *best = "";
	unsigned least = UINT_MAX;
	uint32_t n = msg ? msg->n_signals : dbc->n_messages;
	for (uint32_t i = 0; i < n; i++) {
		const char *candidate = msg ? msg->signals[i].name : dbc->messages[i].name;
		unsigned distance = nearest_distance(name, candidate);
		if (distance < least) {
			least = distance;
			best = candidate;
		}
	}
	return best;
}

const char *dbc_value_text(const struct dbc_signal *sig, uint64_t raw)
{
	for (uint32_t i = 0; i < sig->n_values; i++) {
		if (sig->values[i].raw == raw) {
			return sig->values[i].text;
		}
	}
	return NULL;
}

int dbc_value_raw(const struct dbc_signal *sig, const char *text, uint64_t *raw)
{
	for (uint32_t i = 0; i < sig->n_values; i++) {
		if (!strcmp(sig->values[i].text, text)) {
			*raw = sig->values[i].raw;
			return 0;
		}
	}
	return -ENOENT;
}

/* ---- hash ------------------------------------------------------------------------------------- */

#define FNV_START 0xcbf29ce484222325u
#define FNV_PRIME 0x100000001b3u

static uint64_t hash_uint(uint64_t h, uint64_t v)
{
	for (int i = 0; i < 64; i += 8) {
		h = (h ^ (v >> i & 0xff)) * FNV_PRIME;
	}
	return h;
}

static uint64_t hash_text(uint64_t h, const char *s)
{
	do {
		h = (h ^ (uint8_t)*s) * FNV_PRIME;
	} while (*s++);
	return h;
}

static uint64_t hash_double(uint64_t h, double d)
{
	uint64_t bits;
	memcpy(&bits, &d, sizeof(bits));
	return hash_uint(h, bits);
}

static uint64_t hash_signal(uint64_t h, const struct dbc_signal *s)
{
	const uint64_t layout[] = {s->start, s->len,       s->big_endian, s->is_signed,
				   s->mux,   s->mux_value, s->n_values};
	const double scaling[] = {s->scale, s->offset, s->min, s->max};
	h = hash_text(hash_text(h, s->name), s->unit);
	for (size_t i = 0; i < sizeof(layout) / sizeof(layout[0]); i++) {
		h = hash_uint(h, layout[i]);
	}
	for (size_t i = 0; i < sizeof(scaling) / sizeof(scaling[0]); i++) {
		h = hash_double(h, scaling[i]);
	}
	for (uint32_t i = 0; i < s->n_values; i++) {
		h = hash_text(hash_uint(h, s->values[i].raw), s->values[i].text);
	}
	return h;
}

uint64_t dbc_hash(const struct dbc *dbc)
{
	uint64_t h = FNV_START;
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		const struct dbc_message *m = &dbc->messages[i];
		h = hash_text(h, m->name);
		h = hash_uint(hash_uint(h, m->id), m->cycle_ms);
		h = hash_uint(hash_uint(h, m->size), m->is_fd);
		for (int k = 0; m->has_data_id && k < DBC_DATA_IDS; k++) {
			h = hash_uint(h, m->data_id[k]);
		}
		h = hash_uint(h, m->n_signals);
		for (uint32_t k = 0; k < m->n_signals; k++) {
			h = hash_signal(h, &m->signals[k]);
		}
	}
	return h;
}
