/* SPDX-License-Identifier: MIT
 * Candidates for each role, best first, with the reasons: what they are called, in what unit, from where to where, and how
 * they behaved in the log.
 */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include "codec.h"
#include "mapper.h"

#define UNIT_POINTS    3.0
#define ABSENT_POINTS  -8.0
#define STILL_POINTS   -3.0
#define PLAIN_POINTS   1.0 /* for behaving as it should */
#define ODD_POINTS     -4.0
#define FOLLOWS_POINTS 6.0
#define STEPS_MIN      50
#define STRETCHES_MIN  5
#define RATIO_OFF      0.15
#define SPREAD_MAX     0.35
#define CAR_MAX_MPS    75.0
#define CAR_LEAP_MPS   15.0
#define YAW_MAX_RADPS  2.0

__attribute__((format(printf, 3, 4))) static void add(struct mapper_candidate *c, double points,
						      const char *fmt, ...)
{
	const size_t used = strlen(c->why);
	va_list ap;

	c->score += points;
	va_start(ap, fmt);
	if (used < sizeof(c->why) - 3) {
		vsnprintf(c->why + used + (used ? 2 : 0), sizeof(c->why) - used - 2, fmt, ap);
		memcpy(c->why + used, "; ", used ? 2 : 0);
	}
	va_end(ap);
}

/* ---- the name, the unit, what it can say ------------------------------------------------------- */

static double gain_of(enum unit_kind kind, const struct mapper_candidate *c)
{
	const char *unit = c->unit ? c->unit : c->sig[0]->unit;
	double gain = 1;

	return unit_gain(kind, unit, &gain) ? 1 : gain;
}

/* 0 if it cannot be, by its unit. */
static int judge_unit(struct mapper_candidate *c, enum unit_kind kind)
{
	const struct dbc_signal *s = c->sig[0];
	const char *known = mapper_unit(kind, s->unit);
	double gain;

	if (kind == UNIT_FLAG) {
		return 1;
	}
	if (known) {
		c->unit = unit_gain(kind, s->unit, &gain) ? known : NULL;
		add(c, UNIT_POINTS, "unit %s", known);
		return 1;
	}
	if (kind == UNIT_SHARE && !s->unit[0]) {
		const double top = codec_phys(s, codec_mask(s));

		c->unit = top > 20 ? "%" : NULL;
		add(c, 0, "no unit, up to %g: read as %s", top, top > 20 ? "%" : "a share");
		return 1;
	}
	add(c, -UNIT_POINTS / 2, "without a unit: say it");
	return !s->unit[0];
}

static double least_of(const struct dbc_signal *s)
{
	const uint64_t raw = s->is_signed ? codec_mask(s) / 2 + 1 : 0;

	return fmin(codec_phys(s, raw), codec_phys(s, codec_mask(s) >> s->is_signed));
}

/* 0 if it cannot be, by its bits. */
static int judge_bits(struct mapper_candidate *c, enum mapper_role role)
{
	const struct dbc_signal *s = c->sig[0];

	switch (role) {
	case MAPPER_rel_speed:
	case MAPPER_lateral:
	case MAPPER_yaw_rate:
		return s->len > 4 && least_of(s) < 0;
	case MAPPER_ego_speed:
	case MAPPER_distance:
		return s->len > 4;
	case MAPPER_object_id:
	case MAPPER_object_count:
		return s->len >= 3 && s->len <= 8 && s->scale == 1 && s->offset == 0;
	case MAPPER_existence:
		return s->len > 1;
	case MAPPER_driver_accel:
		return 1;
	default:
		return s->len <= 3;
	}
}

/* ---- the log ----------------------------------------------------------------------------------- */

/* All members' figures for a signal of the family. */
static struct mapper_stats pool(const struct mapper *m, const struct mapper_candidate *c)
{
	const struct mapper_family *f = &m->family[c->family];
	const uint32_t at = (uint32_t)(c->sig[0] - f->member[0]->signals);
	struct mapper_stats p = {0};

	for (int i = 0; i < f->n; i++) {
		const struct mapper_stats *s =
			mapper_stats(m, f->member[i], &f->member[i]->signals[at]);

		p.min = p.n ? (s->n ? fmin(p.min, s->min) : p.min) : s->min;
		p.max = p.n ? (s->n ? fmax(p.max, s->max) : p.max) : s->max;
		p.n += s->n;
		p.steps += s->steps;
		p.moves += s->moves;
		p.full += s->full;
		p.leap = fmax(p.leap, s->leap);
	}
	return p;
}

static void judge_values(struct mapper_candidate *c, enum mapper_role role,
			 const struct mapper_stats *p)
{
	const double gain = gain_of(mapper_role_table[role].unit, c);
	const double min = fmin(gain * p->min, gain * p->max),
		     max = fmax(gain * p->min, gain * p->max);
	const char *range = "%.4g to %.4g in the log";
	int odd = 0;

	if (role == MAPPER_ego_speed) {
		odd = max > CAR_MAX_MPS || min < -15 || fabs(gain) * p->leap > CAR_LEAP_MPS;
	} else if (role == MAPPER_yaw_rate) {
		odd = max > YAW_MAX_RADPS || min < -YAW_MAX_RADPS;
	} else if (role == MAPPER_lateral || role == MAPPER_rel_speed) {
		odd = min >= 0;
	} else if (mapper_role_table[role].unit == UNIT_FLAG) {
		range = "%.4g to %.4g";
	}
	char text[64];

	snprintf(text, sizeof(text), odd ? "%.4g to %.4g in the log: odd" : range, min, max);
	c->odd |= odd;
	add(c, odd ? ODD_POINTS : PLAIN_POINTS, "%s", text);
}

static void judge_log(const struct mapper *m, struct mapper_candidate *c, enum mapper_role role)
{
	const struct mapper_stats p = pool(m, c);

	if (!m->frames) {
		return;
	}
	if (!p.n) {
		add(c, ABSENT_POINTS, "0x%X is not in the log",
		    m->family[c->family].member[0]->id & BUS_ID_MASK);
	} else if (p.steps >= STEPS_MIN && !p.moves && p.min == p.max) {
		const int may = mapper_role_table[role].unit == UNIT_FLAG ||
				mapper_role_table[role].unit == UNIT_SHARE;

		c->odd |= !may && mapper_role_table[role].required;
		add(c, may ? 0 : STILL_POINTS, "never changes, always %.4g", p.min);
	} else {
		judge_values(c, role, &p);
	}
}

/* ---- distances and their rates ----------------------------------------------------------------- */

static const struct {
	double ratio;
	int negate;
	const char *unit, *what;
} ratios[] = {
	{1, 0, NULL, "is the change of %s"},
	{-1, 1, NULL, "is the change of %s, but for the sign: negate"},
	{3.6, 0, "km/h", "is the change of %s in km/h"},
	{-3.6, 1, "km/h", "is the change of %s in km/h, but for the sign: negate"},
	{1 / 3.6, 0, "m/s", "is the change of %s in m/s"},
	{-1 / 3.6, 1, "m/s", "is the change of %s in m/s, but for the sign: negate"},
};

/* Which row of ratios, -1 for none, -2 for too little data. */
static int follows(const struct mapper_pair *p, struct stretch_median *m)
{
	*m = stretch_ratio(&p->list, 0);
	if (m->n < STRETCHES_MIN) {
		return -2;
	}
	for (size_t i = 0; i < sizeof(ratios) / sizeof(ratios[0]); i++) {
		if (fabs(m->value / ratios[i].ratio - 1) < RATIO_OFF &&
		    m->spread < SPREAD_MAX * fabs(m->value)) {
			return (int)i;
		}
	}
	return -1;
}

static void judge_rate(const struct mapper *m, struct mapper_candidate *c,
		       const struct mapper_candidate *distance)
{
	for (int i = 0; i < m->n_pairs; i++) {
		const struct mapper_pair *p = &m->pair[i];
		struct stretch_median med;

		if (p->family != c->family || p->rate != c->sig[0] ||
		    p->distance != distance->sig[0] || !m->frames) {
			continue;
		}
		const int row = follows(p, &med);
		char what[DBC_NAME_MAX + 80];

		if (row == -2) {
			add(c, 0, "too few changes of the distance to compare (%u)", med.n);
		} else if (row == -1) {
			c->odd = 1;
			add(c, ODD_POINTS, "does not follow %s (ratio %.2f, %u stretches)",
			    p->distance->name, med.value, med.n);
		} else {
			c->negate = ratios[row].negate;
			c->unit = ratios[row].unit ? ratios[row].unit : c->unit;
			snprintf(what, sizeof(what), ratios[row].what, p->distance->name);
			add(c, FOLLOWS_POINTS, "%s (ratio %.2f, %u stretches)", what, med.value,
			    med.n);
		}
	}
}

/* A distance has a rate beside it. */
static void judge_distance(const struct mapper *m, struct mapper_candidate *c)
{
	const struct mapper_pair *best = NULL;
	double points = 0;
	int rates = 0;

	for (int i = 0; i < m->n_pairs; i++) {
		const struct mapper_pair *p = &m->pair[i];
		struct stretch_median med;

		if (p->family == c->family && p->distance == c->sig[0]) {
			const int row = m->frames ? follows(p, &med) : -2;
			const double here =
				row >= 0 ? FOLLOWS_POINTS
					 : fmax(0, mapper_words(MAPPER_rel_speed, MAPPER_SIGNAL,
								p->rate->name)) /
						   2;

			rates++;
			best = !best || here > points ? p : best;
			points = best == p ? here : points;
		}
	}
	if (!rates) {
		add(c, ODD_POINTS, "no relative speed beside it");
	} else if (points >= FOLLOWS_POINTS) {
		add(c, points, "%s goes with it", best->rate->name);
	} else {
		add(c, points, "beside %s", best->rate->name);
	}
}

/* ---- candidates -------------------------------------------------------------------------------- */

static void keep(struct mapper_choice *c, const struct mapper_candidate *new)
{
	int i = c->n;

	if (i == MAPPER_CANDIDATES_MAX && c->at[--i].score >= new->score) {
		return;
	}
	for (; i > 0 && c->at[i - 1].score < new->score; i--) {
		c->at[i] = c->at[i - 1];
	}
	c->at[i] = *new;
	c->n += c->n < MAPPER_CANDIDATES_MAX;
}

static void keep_strange(struct mapper_choice *c, int family, const struct dbc_signal *s,
			 double points)
{
	if (points > c->strange_points) {
		c->strange = s;
		c->strange_family = family;
		c->strange_points = points;
	}
}

static void judge(const struct mapper *m, enum mapper_role role,
		  const struct mapper_candidate *distance, struct mapper_candidate *c)
{
	judge_log(m, c, role);
	if (role == MAPPER_rel_speed && distance) {
		judge_rate(m, c, distance);
	} else if (role == MAPPER_distance) {
		judge_distance(m, c);
	}
}

static int name_points(const struct mapper *m, enum mapper_role role, int family,
		       const struct dbc_signal *s, double *points)
{
	*points = mapper_words(role, MAPPER_SIGNAL, s->name) +
		  mapper_words(role, MAPPER_MESSAGE, m->family[family].member[0]->name);
	return mapper_words(role, MAPPER_SIGNAL, s->name) > 0 ||
	       (*points >= 0 && mapper_role_table[role].unit != UNIT_FLAG &&
		mapper_unit(mapper_role_table[role].unit, s->unit));
}

/* Wheels: signals of one message that differ in two letters at most, FL to RR. */
static int is_wheel_like(const struct dbc_signal *a, const struct dbc_signal *b)
{
	int differ = 0;

	if (strlen(a->name) != strlen(b->name) || strcmp(a->unit, b->unit) || a->len != b->len ||
	    a->scale != b->scale || a->offset != b->offset) {
		return 0;
	}
	for (size_t i = 0; a->name[i]; i++) {
		if (a->name[i] != b->name[i]) {
			differ++;
			if (!strchr("FRLHVflrhv1234", a->name[i]) ||
			    !strchr("FRLHVflrhv1234", b->name[i])) {
				return 0;
			}
		}
	}
	return differ > 0 && differ <= 2;
}

/* The others of a set of wheels are averaged with the first; -1 if @at is none of the firsts. */
static int add_wheels(struct mapper_candidate *c, const struct dbc_message *msg, uint32_t at)
{
	for (uint32_t i = 0; i < at; i++) {
		if (is_wheel_like(&msg->signals[i], &msg->signals[at])) {
			return -1;
		}
	}
	for (uint32_t i = at + 1; i < msg->n_signals && c->n < MAP_SPEEDS_MAX; i++) {
		if (is_wheel_like(&msg->signals[at], &msg->signals[i])) {
			c->sig[c->n++] = &msg->signals[i];
		}
	}
	return 0;
}

static void try_signal(const struct mapper *m, enum mapper_role role, int family, uint32_t at,
		       const struct mapper_candidate *distance, struct mapper_choice *choice)
{
	const struct dbc_message *msg = m->family[family].member[0];
	const struct dbc_signal *s = &msg->signals[at];
	struct mapper_candidate c = {.family = family, .n = 1, .sig = {s}};
	double points;

	if (s->mux != DBC_PLAIN || (role != MAPPER_distance && distance && s == distance->sig[0]) ||
	    !name_points(m, role, family, s, &points) || !judge_bits(&c, role)) {
		return;
	}
	add(&c, points, points > 0 ? "named so" : "by its unit");
	if (!judge_unit(&c, mapper_role_table[role].unit)) {
		keep_strange(choice, family, s, points);
		return;
	}
	if (role == MAPPER_ego_speed && add_wheels(&c, msg, at)) {
		return;
	}
	judge(m, role, distance, &c);
	if (c.score > 0) {
		keep(choice, &c);
	}
}

void mapper_rank(const struct mapper *m, enum mapper_role role, int family,
		 const struct mapper_candidate *distance, struct mapper_choice *c)
{
	const enum mapper_whose whose = mapper_role_table[role].whose;

	c->n = 0;
	c->taken = -1;
	c->strange = NULL;
	c->strange_points = 0;
	for (int i = 0; i < m->n_families; i++) {
		const int here = role == MAPPER_distance || whose == MAPPER_TARGET
					 ? family < 0 || i == family
					 : i != family && m->family[i].n == 1;

		for (uint32_t k = 0; here && k < m->family[i].member[0]->n_signals; k++) {
			try_signal(m, role, i, k, whose == MAPPER_TARGET ? distance : NULL, c);
		}
	}
}

int mapper_is_clear(const struct mapper_choice *c)
{
	return c->n > 0 && c->at[0].score >= MAPPER_SCORE_MIN && !c->at[0].odd &&
	       (c->n == 1 || c->at[0].score - c->at[1].score >= MAPPER_LEAD_MIN);
}

const char *mapper_spec(const struct mapper *m, const struct mapper_candidate *c,
			char text[MAPPER_SPEC_MAX])
{
	size_t used = 0;

	text[0] = '\0';
	for (int i = 0; i < c->n; i++) {
		used += (size_t)snprintf(text + used, MAPPER_SPEC_MAX - used, "%s%s.%s",
					 i ? " " : "", m->family[c->family].name, c->sig[i]->name);
	}
	return text;
}
