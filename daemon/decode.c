/* SPDX-License-Identifier: MIT
 * Frames to measurements by role.
 */
#include <math.h>
#include <string.h>
#include "codec.h"
#include "decode.h"

void decode_open(struct decode *d, const struct mapping *map, double range_max_m,
		 double existence_min)
{
	*d = (struct decode){
		.map = map,
		.existence_min = existence_min,
		.range_max_m = range_max_m,
	};
	for (int i = 0; i < MAP_MESSAGES_MAX; i++) {
		d->message[i].t_ns = DECODE_NEVER;
	}
}

void decode_distrust(struct decode *d)
{
	for (int i = 0; i < MAP_MESSAGES_MAX; i++) {
		d->message[i] =
			(struct decode_message){.t_ns = DECODE_NEVER, .wait = E2E_START - 1};
	}
}

/* ---- checks --------------------------------------------------------------------------------- */

/* How a status counts; SCENE_REJECTS for those that are no fault of the frame. */
static enum scene_reject reject_of(enum e2e_status status)
{
	static const enum scene_reject reject[E2E_STATUSES] = {
		[E2E_OK] = SCENE_REJECTS,
		[E2E_SOME_LOST] = SCENE_REJECTS,
		[E2E_INITIAL] = SCENE_REJECTS,
		[E2E_SYNC] = SCENE_REJECTS,
		[E2E_REPEATED] = SCENE_REJECT_COUNTER,
		[E2E_WRONG_SEQUENCE] = SCENE_REJECT_COUNTER,
		[E2E_WRONG_CRC] = SCENE_REJECT_CRC,
		[E2E_WRONG_LENGTH] = SCENE_REJECT_LENGTH,
	};

	return reject[status];
}

/* 1 if the frame is intact, new, and its message is trusted. */
static int check(struct decode *d, int message, const struct bus_frame *f)
{
	const struct map_message *m = &d->map->message[message];
	const struct e2e_config cfg = {m->check, m->msg, m->counter};
	struct decode_message *st = &d->message[message];
	const enum e2e_status status = e2e_check(&cfg, &st->e2e, f->data, f->len);

	if (reject_of(status) != SCENE_REJECTS) {
		d->rejected[reject_of(status)]++;
		st->refused++;
		return 0;
	}
	if (st->wait > 0) {
		st->wait--;
		return 0;
	}
	if (!e2e_usable(status)) {
		return 0;
	}
	st->t_ns = f->t_ns;
	return 1;
}

/* ---- values --------------------------------------------------------------------------------- */

enum decode_got decode_value(const struct map_signal *s, const struct dbc_message *msg,
			     const uint8_t *data, double *si)
{
	if (!codec_present(msg, s->sig, data)) {
		return DECODE_ABSENT;
	}
	const uint64_t raw = codec_raw(s->sig, data);

	if (s->has_na && raw == s->na_raw) {
		return DECODE_NOT_AVAILABLE;
	}
	if (!codec_in_range(s->sig, raw)) {
		return DECODE_OUT_OF_RANGE;
	}
	if (s->table && raw >= s->table->n) {
		return DECODE_OUT_OF_RANGE;
	}
	*si = s->gain * (s->table ? s->table->value[raw] : codec_phys(s->sig, raw)) + s->offset;
	return DECODE_OK;
}

/* Reads a value and counts why there is none. A signal that is not mapped, or in another message, leaves *@si as it is. */
static enum decode_got take_value(struct decode *d, int message, const struct map_signal *s,
				  const uint8_t *data, double *si)
{
	if (!s->sig || s->message != message) {
		return DECODE_OK;
	}
	const enum decode_got got = decode_value(s, d->map->message[message].msg, data, si);

	d->rejected[SCENE_REJECT_NOT_AVAILABLE] += got == DECODE_NOT_AVAILABLE;
	d->rejected[SCENE_REJECT_RANGE] += got == DECODE_OUT_OF_RANGE;
	return got;
}

static uint32_t take_number(const struct map_signal *s, const uint8_t *data)
{
	return s->sig ? (uint32_t)codec_raw(s->sig, data) : 0;
}

/* The radar's own sigma, and what rounding to the signal's steps adds. 0 where it does not say. */
static double take_sigma(struct decode *d, int message, const struct map_signal *s,
			 const struct map_signal *of, const uint8_t *data)
{
	const double step = of->gain * of->sig->scale;
	double sigma = 0;

	if (take_value(d, message, s, data, &sigma) || sigma <= 0) {
		return 0;
	}
	return sqrt(sigma * sigma + step * step / 12);
}

/* How sure the radar is of its target. 0 if it does not say although it should. */
static int take_quality(struct decode *d, int message, const uint8_t *data, int track,
			struct detection *det)
{
	const struct map_track *t = &d->map->track[track];

	det->distance_sigma_m = take_sigma(d, message, &t->distance_sigma, &t->distance, data);
	det->rate_sigma_mps = take_sigma(d, message, &t->rate_sigma, &t->rel_speed, data);
	return !take_value(d, message, &t->existence, data, &det->existence);
}

/* The rest of a target whose distance is known. 0 if something is missing. */
static int take_target(struct decode *d, int message, const struct map_track *t,
		       const uint8_t *data, struct detection *det)
{
	double fresh = 0;

	if (take_value(d, message, &t->rel_speed, data, &det->rate_mps) ||
	    take_value(d, message, &t->lateral, data, &det->lateral_m) ||
	    take_value(d, message, &t->fresh, data, &fresh) ||
	    !take_quality(d, message, data, (int)(t - d->map->track), det)) {
		return 0;
	}
	det->fresh = fresh != 0;
	return 1;
}

/* A distance that is not available says that the slot is empty, as does a target beyond the radar's range. Any other
 * value that is missing makes a frame that cannot be trusted: there is a target, but not where. Returns 0 for that. */
static int take_track(struct decode *d, const uint8_t *data, struct decode_frame *out)
{
	const struct map_track *t = &d->map->track[out->track];
	double valid = 1;

	out->det = (struct detection){
		.existence = 1,
		.id = take_number(&d->map->list.id, data),
	};
	if (take_value(d, out->message, &t->valid, data, &valid)) {
		return 0;
	}
	if (valid == 0) {
		return 1;
	}
	const enum decode_got got =
		take_value(d, out->message, &t->distance, data, &out->det.distance_m);

	if (got == DECODE_ABSENT) {
		out->track = -1; /* the frame is about something else */
		out->part = MAP_NO_PART;
	}
	if (got != DECODE_OK) {
		return got != DECODE_OUT_OF_RANGE;
	}
	if (!take_target(d, out->message, t, data, &out->det)) {
		return 0;
	}
	out->target =
		out->det.distance_m <= d->range_max_m && out->det.existence >= d->existence_min;
	return 1;
}

/* A message of the radar. 0 for a target that is there, but not where. */
static int take_part(struct decode *d, const uint8_t *data, struct decode_frame *out)
{
	const struct map_list *list = &d->map->list;

	switch (out->part) {
	case MAP_HEADER:
		out->count = list->count.sig ? (int)take_number(&list->count, data) : -1;
		return 1;
	case MAP_TARGET:
		return take_track(d, data, out);
	case MAP_QUALITY:
		out->det = (struct detection){
			.existence = 1,
			.id = take_number(&list->quality_id, data),
		};
		take_quality(d, out->message, data, 0, &out->det);
		return 1;
	default:
		return 1;
	}
}

/* The mean of a role's signals in this message; all of them must have a value. */
static void take_role(struct decode *d, enum map_role role, const uint8_t *data,
		      struct decode_frame *out)
{
	const struct map_role_signals *r = &d->map->role[role];
	double sum = 0, si = 0;
	int n = 0;

	for (int i = 0; i < r->n; i++) {
		if (r->message[i] != out->message) {
			continue;
		}
		if (take_value(d, out->message, &r->signal[i], data, &si)) {
			return;
		}
		sum += si;
		n++;
	}
	if (n > 0) {
		out->value[role] = sum / n;
		out->roles |= 1u << role;
	}
}

int decode_take(struct decode *d, const struct bus_frame *f, struct decode_frame *out)
{
	const int message =
		f->flags & (BUS_RTR | BUS_ERR) ? -1 : mapping_find(d->map, f->iface, f->id);

	if (message < 0 || !check(d, message, f)) {
		return 0;
	}
	const struct map_message *m = &d->map->message[message];

	*out = (struct decode_frame){.message = message, .part = m->part, .track = m->track};
	const int sound = take_part(d, f->data, out);

	for (int role = 0; role < MAP_ROLES && m->ego; role++) {
		take_role(d, (enum map_role)role, f->data, out);
	}
	d->message[message].refused = sound ? 0 : d->message[message].refused + 1;
	return 1;
}
