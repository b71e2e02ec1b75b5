/* SPDX-License-Identifier: MIT
 * Quantities in SI to frames.
 */
#include <math.h>
#include <string.h>
#include "codec.h"
#include "encode.h"

#define FAR_M 1e9 /* beyond the end of any signal */

void encode_open(struct encode *e, const struct mapping *map)
{
	*e = (struct encode){.map = map};
}

static double clamp(double x, double lo, double hi)
{
	x = x < hi ? x : hi;
	return x > lo ? x : lo;
}

static void set_clamped(const struct dbc_signal *s, uint8_t *data, double phys)
{
	const uint64_t top = codec_mask(s);
	double lo = s->min, hi = s->max;

	if (lo == 0 && hi == 0) {
		lo = codec_phys(s, s->is_signed ? top / 2 + 1 : 0);
		hi = codec_phys(s, s->is_signed ? top / 2 : top);
	}
	codec_set_phys(s, data, lo < hi ? clamp(phys, lo, hi) : clamp(phys, hi, lo));
}

/* The raw value whose entry is nearest. */
static uint64_t find_entry(const struct map_table *t, double phys)
{
	uint64_t best = 0;

	for (uint32_t i = 1; i < t->n; i++) {
		best = fabs(t->value[i] - phys) < fabs(t->value[best] - phys) ? i : best;
	}
	return best;
}

static void set_value(const struct map_signal *m, uint8_t *data, double si)
{
	if (!m->sig) {
		return;
	}
	const double phys = (si - m->offset) / m->gain;

	if (m->table) {
		codec_set_raw(m->sig, data, find_entry(m->table, phys));
	} else {
		set_clamped(m->sig, data, phys);
	}
}

/* Only if the signal is in this message. */
static void set_part(const struct map_signal *m, int message, uint8_t *data, double si)
{
	if (m->message == message) {
		set_value(m, data, si);
	}
}

static void set_number(const struct map_signal *m, uint8_t *data, uint32_t number)
{
	if (m->sig) {
		codec_set_raw(m->sig, data, number);
	}
}

static void set_absent(const struct map_signal *m, uint8_t *data)
{
	if (m->sig && m->has_na) {
		codec_set_raw(m->sig, data, m->na_raw);
	}
}

static void set_quality(const struct map_track *t, int message, uint8_t *data,
			const struct detection *det)
{
	set_part(&t->existence, message, data, det->existence);
	set_part(&t->distance_sigma, message, data, det->distance_sigma_m);
	set_part(&t->rate_sigma, message, data, det->rate_sigma_mps);
}

static void set_target(const struct map_track *t, uint8_t *data, const struct detection *det)
{
	set_value(&t->valid, data, 1);
	set_value(&t->distance, data, det->distance_m);
	set_value(&t->rel_speed, data, det->rate_mps);
	set_value(&t->lateral, data, det->lateral_m);
	set_quality(t, t->message, data, det);
	set_value(&t->fresh, data, det->fresh);
}

static void set_empty(const struct map_track *t, uint8_t *data)
{
	set_value(&t->valid, data, 0);
	set_value(&t->fresh, data, 0);
	set_value(&t->distance, data, FAR_M);
	set_absent(&t->distance, data);
	set_absent(&t->rel_speed, data);
	set_absent(&t->lateral, data);
	set_absent(&t->existence, data);
}

/* What nobody fills in is not available, where the database can say so. */
static void set_unknown(const struct dbc_message *msg, uint8_t *data)
{
	for (uint32_t i = 0; i < msg->n_signals; i++) {
		uint64_t raw;

		if (dbc_value_raw(&msg->signals[i], "not available", &raw) == 0) {
			codec_set_raw(&msg->signals[i], data, raw);
		}
	}
}

static void set_role(const struct map_role_signals *r, int message, uint8_t *data, double si)
{
	for (int i = 0; i < r->n; i++) {
		if (r->message[i] == message) {
			set_value(&r->signal[i], data, si);
		}
	}
}

static void set_radar(const struct mapping *map, int message, const struct detection *det,
		      uint8_t *data)
{
	const struct map_message *m = &map->message[message];

	if (m->part == MAP_QUALITY && det) {
		set_number(&map->list.quality_id, data, det->id);
		set_quality(&map->track[0], message, data, det);
	} else if (m->track >= 0 && det) {
		set_number(&map->list.id, data, det->id);
		set_target(&map->track[m->track], data, det);
	} else if (m->track >= 0) {
		set_empty(&map->track[m->track], data);
	}
}

static void begin(const struct map_message *m, int64_t t_ns, struct bus_frame *f)
{
	*f = (struct bus_frame){
		.t_ns = t_ns,
		.id = m->msg->id,
		.iface = m->iface,
		.len = m->msg->size,
		.flags = m->msg->is_fd ? BUS_FD : 0,
	};
	set_unknown(m->msg, f->data);
}

static void protect(struct encode *e, int message, struct bus_frame *f)
{
	const struct map_message *m = &e->map->message[message];
	const struct e2e_config check = {m->check, m->msg, m->counter};

	e2e_protect(&check, &e->e2e[message], f->data);
}

void encode_message(struct encode *e, int message, uint32_t roles, const double value[MAP_ROLES],
		    const struct detection *det, int64_t t_ns, struct bus_frame *f)
{
	begin(&e->map->message[message], t_ns, f);
	for (int role = 0; role < MAP_ROLES; role++) {
		if (roles >> role & 1) {
			set_role(&e->map->role[role], message, f->data, value[role]);
		}
	}
	set_radar(e->map, message, det, f->data);
	protect(e, message, f);
}

void encode_header(struct encode *e, int count, int64_t t_ns, struct bus_frame *f)
{
	const struct map_list *list = &e->map->list;

	begin(&e->map->message[list->header], t_ns, f);
	set_number(&list->count, f->data, (uint32_t)count);
	protect(e, list->header, f);
}

/* Profile 2 keeps its counter in the low nibble of byte 1. */
static uint64_t counter_in(const struct map_message *m, const uint8_t *data)
{
	if (m->check == E2E_P2) {
		return data[1] & 15;
	}
	return m->counter ? codec_raw(m->counter, data) : 0;
}

void encode_track(const struct mapping *map, int message, const struct detection *det,
		  struct bus_frame *f)
{
	const struct map_message *m = &map->message[message];
	const struct e2e_config check = {m->check, m->msg, m->counter};
	struct e2e_state st = {.counter = counter_in(m, f->data)};

	if (det) {
		set_target(&map->track[m->track], f->data, det);
	} else {
		set_empty(&map->track[m->track], f->data);
	}
	e2e_protect(&check, &st, f->data);
}
