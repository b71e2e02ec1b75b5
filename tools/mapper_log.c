/* SPDX-License-Identifier: MIT
 * Families of messages, and what a log shows of every signal: how often, from where to where, in what steps; and of every
 * distance how it goes with what may be its rate.
 */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"
#include "codec.h"
#include "mapper.h"

#define GAPS_MIN 200
#define GAPS_ODD 0.02
#define PART_MAX 6 /* distances, and rates, of a message that are tried */

/* ---- families ---------------------------------------------------------------------------------- */

static int is_same_signal(const struct dbc_signal *a, const struct dbc_signal *b)
{
	return !strcmp(a->name, b->name) && a->start == b->start && a->len == b->len &&
	       a->big_endian == b->big_endian && a->is_signed == b->is_signed;
}

static int is_alike(const struct dbc_message *a, const struct dbc_message *b)
{
	if (a->size != b->size || a->n_signals != b->n_signals || !a->n_signals) {
		return 0;
	}
	for (uint32_t i = 0; i < a->n_signals; i++) {
		if (!is_same_signal(&a->signals[i], &b->signals[i])) {
			return 0;
		}
	}
	return 1;
}

/* The last number in a name: its place, or NULL; at most three digits. */
static const char *number_in(const char *name, int *len)
{
	const char *end = name + strlen(name);

	while (end > name && !isdigit((unsigned char)end[-1])) {
		end--;
	}
	*len = 0;
	while (end > name && isdigit((unsigned char)end[-1]) && *len < 3) {
		end--;
		(*len)++;
	}
	return *len ? end : NULL;
}

/* Its followers in number, as far as they go. */
static void grow(struct mapper_family *f, const struct dbc *dbc, const struct dbc_message *first)
{
	char name[DBC_NAME_MAX + 16];
	int len;
	const char *number = number_in(first->name, &len);
	const int from = number ? atoi(number) : 0, width = number && *number == '0' ? len : 1;
	const int before = number ? (int)(number - first->name) : 0;

	f->n = 1;
	f->member[0] = first;
	snprintf(f->name, sizeof(f->name), "%s", first->name);
	while (number && f->n < MAP_TRACKS_MAX) {
		snprintf(name, sizeof(name), "%.*s%0*d%s", before, first->name, width, from + f->n,
			 number + len);
		const struct dbc_message *next = dbc_find(dbc, name);

		if (!next || !is_alike(first, next)) {
			break;
		}
		f->member[f->n++] = next;
	}
	if (f->n > 1) {
		snprintf(f->name, sizeof(f->name), "%.*s{%0*d..%0*d}%s", before, first->name, width,
			 from, width, from + f->n - 1, number + len);
	}
}

static int is_in(const struct mapper *m, const struct dbc_message *msg)
{
	for (int i = 0; i < m->n_families; i++) {
		for (int k = 0; k < m->family[i].n; k++) {
			if (m->family[i].member[k] == msg) {
				return 1;
			}
		}
	}
	return 0;
}

static void find_families(struct mapper *m)
{
	for (uint32_t i = 0; i < m->dbc->n_messages; i++) {
		if (!is_in(m, &m->dbc->messages[i])) {
			grow(&m->family[m->n_families++], m->dbc, &m->dbc->messages[i]);
		}
	}
}

/* ---- pairs ------------------------------------------------------------------------------------- */

/* SI per physical unit; without a unit the SI one is tried. */
static double gain_of(enum unit_kind kind, const struct dbc_signal *s)
{
	const char *unit = mapper_unit(kind, s->unit);
	double gain = 1;

	if (unit) {
		unit_gain(kind, unit, &gain);
	}
	return !unit && s->unit[0] ? 0 : gain;
}

static int may_be(enum mapper_role role, const struct dbc_signal *s)
{
	const enum unit_kind kind = mapper_role_table[role].unit;

	return s->mux != DBC_MULTIPLEXOR && s->len > 4 && gain_of(kind, s) != 0 &&
	       mapper_words(role, MAPPER_SIGNAL, s->name) +
			       3 * (mapper_unit(kind, s->unit) != NULL) >
		       0;
}

static const struct dbc_signal *find_id(const struct mapper_family *f)
{
	for (uint32_t i = 0; f->n == 1 && i < f->member[0]->n_signals; i++) {
		const struct dbc_signal *s = &f->member[0]->signals[i];

		if (s->len <= 8 && s->len >= 4 &&
		    mapper_words(MAPPER_object_id, MAPPER_SIGNAL, s->name) > 0) {
			return s;
		}
	}
	return NULL;
}

/* At most PART_MAX signals of a message that may play the role. */
static int find_parts(const struct dbc_message *msg, enum mapper_role role,
		      const struct dbc_signal *part[PART_MAX])
{
	int n = 0;

	for (uint32_t i = 0; n < PART_MAX && i < msg->n_signals; i++) {
		if (may_be(role, &msg->signals[i])) {
			part[n++] = &msg->signals[i];
		}
	}
	return n;
}

static void add_pair(struct mapper *m, int family, const struct dbc_signal *distance,
		     const struct dbc_signal *rate)
{
	if (rate != distance && m->n_pairs < MAPPER_PAIRS_MAX) {
		struct mapper_pair *p = &m->pair[m->n_pairs++];

		p->family = family;
		p->distance = distance;
		p->rate = rate;
		p->id = find_id(&m->family[family]);
		p->distance_gain = gain_of(UNIT_LENGTH, distance);
		p->rate_gain = gain_of(UNIT_SPEED, rate);
	}
}

static void add_pairs(struct mapper *m, int family)
{
	const struct dbc_message *msg = m->family[family].member[0];
	const struct dbc_signal *distance[PART_MAX], *rate[PART_MAX];
	const int n = find_parts(msg, MAPPER_distance, distance);
	const int n_rates = n ? find_parts(msg, MAPPER_rel_speed, rate) : 0;

	for (int i = 0; i < n; i++) {
		for (int k = 0; k < n_rates; k++) {
			add_pair(m, family, distance[i], rate[k]);
		}
	}
}

/* ---- opening ----------------------------------------------------------------------------------- */

int mapper_open(const struct dbc *dbc, struct mapper **ret)
{
	struct mapper *m = calloc(1, sizeof(*m));
	uint32_t signals = 0;

	if (!m) {
		return -ENOMEM;
	}
	m->dbc = dbc;
	m->family = calloc(dbc->n_messages, sizeof(*m->family));
	m->message = calloc(dbc->n_messages, sizeof(*m->message));
	m->pair = calloc(MAPPER_PAIRS_MAX, sizeof(*m->pair));
	for (uint32_t i = 0; m->message && i < dbc->n_messages; i++) {
		m->message[i].signals = signals;
		signals += dbc->messages[i].n_signals;
	}
	m->stats = calloc(signals + 1, sizeof(*m->stats));
	if (!m->family || !m->message || !m->pair || !m->stats) {
		mapper_close(m);
		return -ENOMEM;
	}
	find_families(m);
	for (int i = 0; i < m->n_families; i++) {
		add_pairs(m, i);
	}
	*ret = m;
	return 0;
}

void mapper_close(struct mapper *m)
{
	if (!m) {
		return;
	}
	for (int i = 0; i < m->n_pairs; i++) {
		free(m->pair[i].list.at);
	}
	free(m->family);
	free(m->message);
	free(m->stats);
	free(m->pair);
	free(m);
}

/* ---- frames ------------------------------------------------------------------------------------ */

static void take_signal(struct mapper_stats *st, const struct dbc_signal *s, const uint8_t *now,
			const uint8_t *before)
{
	const uint64_t raw = codec_raw(s, now), mask = codec_mask(s);
	const double v = codec_phys(s, raw);

	if (before) {
		const uint64_t old = codec_raw(s, before);

		st->steps++;
		st->moves += raw != old;
		st->ups += ((raw - old) & mask) == 1;
		st->leap = fmax(st->leap, fabs(v - codec_phys(s, old)));
	}
	st->full += raw == mask;
	st->min = st->n ? fmin(st->min, v) : v;
	st->max = st->n ? fmax(st->max, v) : v;
	st->n++;
}

static void take_passes(struct mapper_message *st, const struct dbc_message *msg,
			const struct bus_frame *f)
{
	for (int kind = 0; kind < E2E_KINDS; kind++) {
		const struct e2e_config cfg = {(enum e2e_kind)kind, msg, NULL};
		struct e2e_state fresh = {0};
		const char *why;

		if (!e2e_config_check(&cfg, &why)) {
			st->passes[kind] +=
				e2e_check(&cfg, &fresh, f->data, f->len) < E2E_WRONG_CRC;
		}
	}
}

static void take_gap(struct mapper_pair *p, int64_t t_ns)
{
	const int64_t ms = (t_ns - p->last_ns) / CLOCK_NS_PER_MS;

	if (p->last_ns) {
		p->gap[ms < 0 ? 0 : ms < MAPPER_GAPS ? ms : MAPPER_GAPS]++;
	}
	p->last_ns = t_ns;
}

static void take_pair(struct mapper_pair *p, int member, const struct bus_frame *f)
{
	const uint64_t raw = codec_raw(p->distance, f->data);
	const int run = p->id ? (int)(codec_raw(p->id, f->data) % MAPPER_RUNS) : member;
	const struct stretch_sample s = {
		.t_ns = f->t_ns,
		.distance_m = p->distance_gain * codec_phys(p->distance, raw),
		.rate_mps = p->rate_gain * codec_phys(p->rate, codec_raw(p->rate, f->data)),
	};
	struct stretch done;

	take_gap(p, f->t_ns);
	if (raw == codec_mask(p->distance) ? stretch_end(&p->run[run], &done)
					   : stretch_add(&p->run[run], &s, &done)) {
		stretch_keep(&p->list, &done);
	}
}

static void take_pairs(struct mapper *m, const struct dbc_message *msg, const struct bus_frame *f)
{
	for (int i = 0; i < m->n_pairs; i++) {
		const struct mapper_family *family = &m->family[m->pair[i].family];

		for (int k = 0; k < family->n; k++) {
			if (family->member[k] == msg &&
			    codec_present(msg, m->pair[i].distance, f->data) &&
			    codec_present(msg, m->pair[i].rate, f->data)) {
				take_pair(&m->pair[i], k, f);
			}
		}
	}
}

void mapper_frame(struct mapper *m, const struct bus_frame *f)
{
	const struct dbc_message *msg = dbc_find_id(m->dbc, f->id);

	m->frames++;
	if (f->flags & (BUS_RTR | BUS_ERR)) {
		return;
	}
	census_add(&m->census, f->iface, f->id);
	if (!msg || f->len != msg->size) {
		return;
	}
	struct mapper_message *st = &m->message[msg - m->dbc->messages];

	for (uint32_t i = 0; i < msg->n_signals; i++) {
		const struct dbc_signal *s = &msg->signals[i];
		const int had = st->frames && codec_present(msg, s, st->before);

		if (codec_present(msg, s, f->data)) {
			take_signal(&m->stats[st->signals + i], s, f->data,
				    had ? st->before : NULL);
		}
	}
	take_passes(st, msg, f);
	take_pairs(m, msg, f);
	st->first_ns = st->frames ? st->first_ns : f->t_ns;
	st->last_ns = f->t_ns;
	st->frames++;
	memcpy(st->before, f->data, sizeof(st->before));
}

const struct mapper_message *mapper_at(const struct mapper *m, const struct dbc_message *msg)
{
	return &m->message[msg - m->dbc->messages];
}

const struct mapper_stats *mapper_stats(const struct mapper *m, const struct dbc_message *msg,
					const struct dbc_signal *sig)
{
	return &m->stats[mapper_at(m, msg)->signals + (uint32_t)(sig - msg->signals)];
}

/* The gap that @rank others are longer than. */
static int ranked(const struct mapper_pair *p, double rank)
{
	double n = 0;
	int ms = MAPPER_GAPS;

	while (ms > 0 && (n += p->gap[ms]) <= rank) {
		ms--;
	}
	return ms;
}

int mapper_gaps(const struct mapper *m, int family, int *within, int *between)
{
	const struct mapper_pair *p = NULL;
	double n = 0;

	for (int i = 0; i < m->n_pairs && !p; i++) {
		p = m->pair[i].family == family ? &m->pair[i] : NULL;
	}
	for (int ms = 0; p && ms <= MAPPER_GAPS; ms++) {
		n += p->gap[ms];
	}
	if (m->family[family].n == 1 || n < GAPS_MIN) {
		return -ENODATA;
	}
	*between = ranked(p, n / m->family[family].n * (1 - GAPS_ODD));
	*within = ranked(p, n / m->family[family].n * (1 + GAPS_ODD)) + 1;
	return 0;
}
