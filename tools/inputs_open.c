/* SPDX-License-Identifier: MIT
 * What is to be watched: the mapping's signals, how each would read with the other byte order, and other speeds.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "codec.h"
#include "inputs.h"
#include "unit.h"

#define OTHER_MAX_MPS 20.0 /* a signal that cannot be this large is no speed of a car */

const struct inputs_role_row inputs_role_table[INPUTS_ROLES] = {
	[INPUTS_EGO_SPEED] = {"ego_speed", "m/s"},
	[INPUTS_YAW_RATE] = {"yaw_rate", "rad/s"},
	[INPUTS_DRIVER_BRAKE] = {"driver_brake", ""},
	[INPUTS_DRIVER_ACCEL] = {"driver_accel", ""},
	[INPUTS_DISTANCE] = {"distance", "m"},
	[INPUTS_REL_SPEED] = {"rel_speed", "m/s"},
	[INPUTS_LATERAL] = {"lateral", "m"},
	[INPUTS_VALID] = {"valid", ""},
	[INPUTS_FRESH] = {"fresh", ""},
	[INPUTS_EXISTENCE] = {"existence", ""},
	[INPUTS_DISTANCE_SIGMA] = {"distance_sigma", "m"},
	[INPUTS_RATE_SIGMA] = {"rate_sigma", "m/s"},
	[INPUTS_OBJECT_COUNT] = {"object_count", ""},
	[INPUTS_SCAN_START] = {"scan_start", ""},
	[INPUTS_OBJECT_ID] = {"object_id", ""},
	[INPUTS_QUALITY_ID] = {"quality_id", ""},
};

/* Do @sig's bits lie in @size bytes? */
static int fits(const struct dbc_signal *sig, unsigned size)
{
	const unsigned first =
		sig->big_endian ? sig->start / 8u * 8 + 7 - sig->start % 8u : sig->start;

	return first + sig->len <= 8 * size;
}

/* The other byte order, once with the same start bit, once from the edge of the same byte. */
static void find_swaps(struct inputs_signal *s, unsigned size)
{
	const struct dbc_signal *sig = s->map->sig;
	const unsigned byte = sig->start / 8u * 8, edge = sig->big_endian ? byte : byte + 7;
	const unsigned start[INPUTS_SWAPS] = {edge, sig->start};

	for (int i = 0; i < INPUTS_SWAPS && sig->len > 8; i++) {
		struct dbc_signal other = *sig;

		other.big_endian = !sig->big_endian;
		other.start = (uint16_t)start[i];
		if (fits(&other, size) && (i == 0 || start[0] != start[1])) {
			s->swap[s->n_swaps++].sig = other;
		}
	}
}

static void add_signal(struct inputs *in, const struct map_signal *m, int message, int track,
		       enum inputs_role role)
{
	struct inputs_signal *s = &in->signal[in->n_signals];

	if (!m->sig) {
		return;
	}
	*s = (struct inputs_signal){.map = m,
				    .message = message,
				    .track = track,
				    .role = role,
				    .now = NAN,
				    .min = NAN,
				    .max = NAN};
	find_swaps(s, in->map->message[message].msg->size);
	in->n_signals++;
}

static void add_track(struct inputs *in, int i)
{
	const struct map_track *t = &in->map->track[i];
	const struct map_signal *const targets[] = {
		&t->distance, &t->rel_speed, &t->lateral,        &t->valid,
		&t->fresh,    &t->existence, &t->distance_sigma, &t->rate_sigma};

	for (size_t k = 0; k < sizeof(targets) / sizeof(targets[0]); k++) {
		add_signal(in, targets[k], targets[k]->message, i,
			   (enum inputs_role)(INPUTS_DISTANCE + k));
	}
}

static void add_signals(struct inputs *in)
{
	const struct map_list *list = &in->map->list;
	const struct map_signal *const lists[] = {&list->count, &list->start, &list->id,
						  &list->quality_id};

	for (int role = 0; role < MAP_ROLES; role++) {
		const struct map_role_signals *r = &in->map->role[role];

		for (int i = 0; i < r->n; i++) {
			add_signal(in, &r->signal[i], r->message[i], -1, (enum inputs_role)role);
		}
	}
	for (int i = 0; i < in->map->n_tracks; i++) {
		add_track(in, i);
	}
	for (size_t k = 0; k < sizeof(lists) / sizeof(lists[0]); k++) {
		add_signal(in, lists[k], lists[k]->message, -1,
			   (enum inputs_role)(INPUTS_OBJECT_COUNT + k));
	}
}

static int is_mapped(const struct mapping *map, const struct dbc_message *msg)
{
	for (int i = 0; i < map->n_messages; i++) {
		if (map->message[i].msg == msg) {
			return 1;
		}
	}
	return 0;
}

static void add_others(struct inputs *in)
{
	const struct dbc *dbc = in->map->dbc;

	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		const struct dbc_message *m = &dbc->messages[i];

		for (uint32_t k = 0; k < m->n_signals && !is_mapped(in->map, m); k++) {
			const struct dbc_signal *s = &m->signals[k];
			double gain;

			if (in->n_others < INPUTS_OTHERS_MAX && s->mux != DBC_MULTIPLEXED &&
			    !unit_gain(UNIT_SPEED, s->unit, &gain) &&
			    gain * codec_phys(s, codec_mask(s) >> s->is_signed) > OTHER_MAX_MPS) {
				in->other[in->n_others++] =
					(struct inputs_other){.msg = m, .sig = s, .gain = gain};
			}
		}
	}
}

int inputs_open(const struct config *cfg, const struct mapping *map, struct inputs **ret)
{
	struct inputs *in = calloc(1, sizeof(*in));

	if (!in) {
		return -ENOMEM;
	}
	in->cfg = cfg;
	in->map = map;
	in->ego_mps = in->yaw_radps = in->ref_mps = NAN;
	memcpy(in->iface, map->iface, sizeof(in->iface));
	in->n_ifaces = map->n_ifaces;
	add_signals(in);
	add_others(in);
	*ret = in;
	return 0;
}

void inputs_close(struct inputs *in)
{
	if (in) {
		free(in->stretches.at);
		free(in);
	}
}
