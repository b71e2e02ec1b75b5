/* SPDX-License-Identifier: MIT
 * What is seen of every mapped message and signal. Nothing is judged here.
 */
#include <math.h>
#include <string.h>
#include "clock.h"
#include "codec.h"
#include "decode.h"
#include "inputs.h"

#define HALF_NS   (CLOCK_NS_PER_S / 2)
#define PULL_MPS2 13.0 /* tyres of a road car on a dry road brake with less */
#define SKID_MPS2 15.0 /* and hold less sideways */
#define BEND_MPS2 1.0
#define TURN_MPS  5.0

/* ---- one signal -------------------------------------------------------------------------------- */

/* 1 with the SI value, 0 if there is none. */
static int value_of(const struct map_signal *s, const struct dbc_message *msg, const uint8_t *data,
		    double *si)
{
	return s->sig && decode_value(s, msg, data, si) == DECODE_OK;
}

/* The step from one frame to the next as a share of all that the signal can say. */
static double step_of(const struct dbc_signal *s, const uint8_t *before, const uint8_t *now)
{
	const double full = ldexp(1.0, s->len);

	return fabs((double)codec_int(s, codec_raw(s, now)) -
		    (double)codec_int(s, codec_raw(s, before))) /
	       full;
}

static void take_step(struct inputs_signal *s, const uint8_t *before, const uint8_t *now)
{
	const uint64_t differ = codec_raw(s->map->sig, now) ^ codec_raw(s->map->sig, before);

	s->steps++;
	s->moves += differ != 0;
	s->moved |= differ;
	s->travel += step_of(s->map->sig, before, now);
	for (int i = 0; i < s->n_swaps; i++) {
		s->swap[i].travel += step_of(&s->swap[i].sig, before, now);
	}
}

static void take_value(struct inputs_signal *s, double si, int64_t t_ns)
{
	if (si != s->now || si == 0 || s->still_ns == 0) {
		s->still_ns = t_ns;
	}
	if (t_ns - s->still_ns > s->still_max_ns) {
		s->still_max_ns = t_ns - s->still_ns;
		s->still_mps = si;
	}
	s->now = si;
	s->now_ns = t_ns;
	s->min = isnan(s->min) ? si : fmin(s->min, si);
	s->max = isnan(s->max) ? si : fmax(s->max, si);
}

static void take_signal(struct inputs *in, struct inputs_signal *s, const struct bus_frame *f,
			const uint8_t *before)
{
	const struct dbc_message *msg = in->map->message[s->message].msg;
	double si;

	if (!codec_present(msg, s->map->sig, f->data)) {
		return;
	}
	const uint64_t raw = codec_raw(s->map->sig, f->data);
	const int na = s->map->has_na && raw == s->map->na_raw;

	s->seen++;
	s->na += na;
	s->full += raw == codec_mask(s->map->sig) >> s->map->sig->is_signed;
	s->range += !na && !codec_in_range(s->map->sig, raw);
	if (before && codec_present(msg, s->map->sig, before)) {
		take_step(s, before, f->data);
	}
	if (value_of(s->map, msg, f->data, &si)) {
		take_value(s, si, f->t_ns);
	}
}

/* ---- one message ------------------------------------------------------------------------------- */

static void take_passes(struct inputs_message *st, const struct map_message *m,
			const struct bus_frame *f)
{
	for (int kind = 0; kind < E2E_KINDS; kind++) {
		const struct e2e_config cfg = {(enum e2e_kind)kind, m->msg, NULL};
		struct e2e_state fresh = {0};
		const char *why;

		if (!e2e_config_check(&cfg, &why)) {
			st->passes[kind] +=
				e2e_check(&cfg, &fresh, f->data, f->len) < E2E_WRONG_CRC;
		}
	}
}

static void take_times(struct inputs_message *st, const struct map_message *m,
		       const struct bus_frame *f)
{
	const int64_t since = st->frames ? f->t_ns - st->last_ns : 0;

	st->twins += st->frames && since < m->period_ns / 4 && f->len == m->msg->size &&
		     !memcmp(st->before, f->data, f->len);
	st->silence_ns = since > st->silence_ns ? since : st->silence_ns;
	st->first_ns = st->frames ? st->first_ns : f->t_ns;
	st->last_ns = f->t_ns;
	st->frames++;
}

/* Eight bits are right by chance in one of 256 frames. */
int inputs_by_chance(const struct inputs_message *st, enum e2e_kind check)
{
	return st->passes[check] * 32 <= st->frames;
}

/* 1 if the content is to be looked at: not if the checksum fails, where it is the right one. */
static int take_message(struct inputs_message *st, const struct map_message *m,
			const struct bus_frame *f)
{
	const struct e2e_config cfg = {m->check, m->msg, m->counter};
	const enum e2e_status status = e2e_check(&cfg, &st->e2e, f->data, f->len);

	take_times(st, m, f);
	st->status[status]++;
	if (status == E2E_WRONG_LENGTH) {
		st->lengths++;
		st->length = f->len;
		return 0;
	}
	take_passes(st, m, f);
	return status != E2E_WRONG_CRC || inputs_by_chance(st, m->check);
}

/* ---- the car ----------------------------------------------------------------------------------- */

static double role_value(const struct inputs *in, enum map_role role, int message,
			 const uint8_t *data)
{
	const struct map_role_signals *r = &in->map->role[role];
	double sum = 0, si = 0;
	int n = 0;

	for (int i = 0; i < r->n; i++) {
		if (r->message[i] == message &&
		    value_of(&r->signal[i], in->map->message[message].msg, data, &si)) {
			sum += si;
			n++;
		}
	}
	return n ? sum / n : NAN;
}

static void take_ego(struct inputs *in, double mps, int64_t t_ns)
{
	if (isnan(in->ref_mps) || t_ns - in->ref_ns > 2 * HALF_NS) {
		in->ref_mps = mps;
		in->ref_ns = t_ns;
	} else if (t_ns - in->ref_ns >= HALF_NS) {
		const double accel =
			fabs(mps - in->ref_mps) / ((double)(t_ns - in->ref_ns) / CLOCK_NS_PER_S);

		in->pulls++;
		in->hard_pulls += accel > PULL_MPS2;
		in->accel_mps2 = fmax(in->accel_mps2, accel);
		in->ref_mps = mps;
		in->ref_ns = t_ns;
	}
	in->ego_mps = mps;
}

static void take_turn(struct inputs *in, double radps)
{
	const double mps2 = fabs(radps) * in->ego_mps;

	in->yaw_radps = radps;
	if (in->ego_mps > TURN_MPS) {
		in->turns++;
		in->bends += mps2 > BEND_MPS2;
		in->skids += mps2 > SKID_MPS2;
		in->side_mps2 = fmax(in->side_mps2, mps2);
	}
}

static void take_car(struct inputs *in, int message, const struct bus_frame *f)
{
	const double mps = role_value(in, MAP_EGO_SPEED, message, f->data);
	const double yaw = role_value(in, MAP_YAW_RATE, message, f->data);

	if (!isnan(mps)) {
		take_ego(in, mps, f->t_ns);
	}
	if (!isnan(yaw)) {
		take_turn(in, yaw);
	}
}

static void take_others(struct inputs *in, const struct bus_frame *f)
{
	for (int i = 0; i < in->n_others; i++) {
		struct inputs_other *o = &in->other[i];

		if (o->msg->id != f->id || f->len != o->msg->size || isnan(in->ego_mps)) {
			continue;
		}
		const double y = o->gain * codec_phys(o->sig, codec_raw(o->sig, f->data));

		o->n++;
		o->x += in->ego_mps;
		o->y += y;
		o->xx += in->ego_mps * in->ego_mps;
		o->yy += y * y;
		o->xy += in->ego_mps * y;
	}
}

/* ---- targets ----------------------------------------------------------------------------------- */

/* Where a target is remembered: by its slot, or by its number in a list. */
static int run_of(const struct mapping *map, int track, const uint8_t *data)
{
	const struct map_message *m = &map->message[map->track[track].message];

	if (!map->list.id.sig || !codec_present(m->msg, map->list.id.sig, data)) {
		return track;
	}
	return (int)(codec_raw(map->list.id.sig, data) % INPUTS_RUNS_MAX);
}

/* 1 with the sample if the frame holds a target that was there before. */
static int read_target(struct inputs *in, const struct map_track *t, const struct bus_frame *f,
		       struct stretch_sample *s)
{
	const struct dbc_message *msg = in->map->message[t->message].msg;
	double valid = 1, fresh = 0;

	*s = (struct stretch_sample){f->t_ns, NAN, NAN, NAN, in->ego_mps, in->yaw_radps};
	if (t->valid.sig && (!value_of(&t->valid, msg, f->data, &valid) || valid == 0)) {
		return 0;
	}
	if (!value_of(&t->distance, msg, f->data, &s->distance_m)) {
		return 0;
	}
	in->targets++;
	const int full = codec_raw(t->distance.sig, f->data) == codec_mask(t->distance.sig);

	in->full += full;
	in->far_m = fmax(in->far_m, s->distance_m);
	in->beyond += !full && s->distance_m > in->cfg->radar_range_max;
	in->behind += s->distance_m < in->cfg->vehicle_front_offset;
	value_of(&t->rel_speed, msg, f->data, &s->rate_mps);
	value_of(&t->lateral, msg, f->data, &s->lateral_m);
	value_of(&t->fresh, msg, f->data, &fresh);
	return fresh == 0;
}

static void count_valid(struct inputs *in, const struct map_track *t, const uint8_t *before,
			const uint8_t *now)
{
	const struct dbc_message *msg = in->map->message[t->message].msg;
	double valid = 0, distance_m;

	if (t->valid.sig && value_of(&t->valid, msg, now, &valid)) {
		const int there = value_of(&t->distance, msg, now, &distance_m);
		const int moves = before && codec_raw(t->distance.sig, now) !=
						    codec_raw(t->distance.sig, before);

		in->valid += valid != 0;
		in->invalid += valid == 0;
		in->invalid_there += valid == 0 && there;
		in->valid_moves += valid != 0 && moves;
		in->invalid_moves += valid == 0 && moves;
	}
}

static void take_target(struct inputs *in, int track, int run, const uint8_t *before,
			const struct bus_frame *f)
{
	const struct map_track *t = &in->map->track[track];
	struct stretch_sample s;
	struct stretch done;
	const int there = read_target(in, t, f, &s);

	count_valid(in, t, before, f->data);
	if (there ? stretch_add(&in->run[run], &s, &done) : stretch_end(&in->run[run], &done)) {
		stretch_keep(&in->stretches, &done);
	}
}

/* ---- frames ------------------------------------------------------------------------------------ */

static void take_content(struct inputs *in, int message, const struct bus_frame *f)
{
	const struct map_message *m = &in->map->message[message];
	struct inputs_message *st = &in->message[message];
	const int run = m->part == MAP_TARGET ? run_of(in->map, m->track, f->data) : -1;
	const uint8_t *before = run >= 0         ? in->run_seen[run] ? in->run_before[run] : NULL
				: st->frames > 1 ? st->before
						 : NULL;

	for (int i = 0; i < in->n_signals; i++) {
		if (in->signal[i].message == message) {
			take_signal(in, &in->signal[i], f, before);
		}
	}
	if (m->ego) {
		take_car(in, message, f);
	}
	if (run >= 0) {
		take_target(in, m->track, run, before, f);
		memcpy(in->run_before[run], f->data, BUS_DATA_MAX);
		in->run_seen[run] = 1;
	}
}

void inputs_frame(struct inputs *in, const struct bus_frame *f)
{
	const int message = f->flags & (BUS_RTR | BUS_ERR) || f->iface >= in->map->n_ifaces
				    ? -1
				    : mapping_find(in->map, f->iface, f->id);

	in->first_ns = in->frames ? in->first_ns : f->t_ns;
	in->last_ns = f->t_ns;
	in->frames++;
	if (!(f->flags & (BUS_RTR | BUS_ERR))) {
		census_add(&in->census, f->iface, f->id);
	}
	if (message < 0) {
		take_others(in, f);
		return;
	}
	if (take_message(&in->message[message], &in->map->message[message], f)) {
		take_content(in, message, f);
	}
	memcpy(in->message[message].before, f->data, BUS_DATA_MAX);
}
