/* SPDX-License-Identifier: MIT
 * The configuration that says what was found, with the reasons as comments.
 */
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include "clock.h"
#include "codec.h"
#include "mapper.h"

#define FRAMES_MIN   50
#define COUNTER_UPS  0.98
#define COUNTER_LEN  16
#define PERIOD_OFF   0.2
#define FULL_SHARE   0.02
#define COMMENT_COLS 32
#define GAP_MS       12 /* radar.scan_gap where nothing is written */

/* "key = value" and a comment behind it, if there is one. */
static void line(FILE *out, const char *key, const char *value, const char *comment)
{
	const int n = fprintf(out, "%s = %s", key, value);

	if (*comment) {
		fprintf(out, "%*s# %s", n < COMMENT_COLS ? COMMENT_COLS - n : 1, "", comment);
	}
	fputc('\n', out);
}

/* ---- messages ---------------------------------------------------------------------------------- */

static int is_role(const struct mapper_choice *choice, const struct dbc_signal *s)
{
	for (int r = 0; r < MAPPER_ROLES; r++) {
		const struct mapper_choice *c = &choice[r];

		for (int i = 0; c->taken >= 0 && i < c->at[c->taken].n; i++) {
			if (c->at[c->taken].sig[i] == s) {
				return 1;
			}
		}
	}
	return 0;
}

static const struct dbc_signal *find_counter(const struct mapper *m,
					     const struct mapper_choice *choice,
					     const struct dbc_message *msg)
{
	for (uint32_t i = 0; i < msg->n_signals; i++) {
		const struct dbc_signal *s = &msg->signals[i];
		const struct mapper_stats *st = mapper_stats(m, msg, s);

		if (s->mux == DBC_PLAIN && s->len > 1 && s->len <= COUNTER_LEN &&
		    st->steps >= FRAMES_MIN && (double)st->ups >= COUNTER_UPS * (double)st->steps &&
		    !is_role(choice, s)) {
			return s;
		}
	}
	return NULL;
}

/* A signal that is called a counter and does not count, or NULL; not where the database gives a DataIDList. */
static const struct dbc_signal *find_odd_counter(const struct mapper *m,
						 const struct mapper_choice *choice,
						 const struct dbc_message *msg)
{
	if (msg->has_data_id || find_counter(m, choice, msg)) {
		return NULL;
	}
	for (uint32_t i = 0; i < msg->n_signals; i++) {
		const struct dbc_signal *s = &msg->signals[i];

		if (s->mux == DBC_PLAIN && s->len > 1 && s->len <= COUNTER_LEN &&
		    mapper_stats(m, msg, s)->steps >= FRAMES_MIN && mapper_is_counter(s->name) &&
		    !is_role(choice, s)) {
			return s;
		}
	}
	return NULL;
}

static void say_odd_counter(const struct mapper *m, const struct dbc_message *msg,
			    const struct dbc_signal *s, FILE *out)
{
	const struct mapper_stats *st = mapper_stats(m, msg, s);
	const double steps = (double)st->steps, repeats = 1 - (double)st->moves / steps;

	if (!st->moves) {
		fprintf(out, "%s never changes, not taken\n", s->name);
	} else if (repeats > 1 - COUNTER_UPS) {
		fprintf(out, "%s repeats in %.0f %% of the frames, not taken\n", s->name,
			100 * repeats);
	} else {
		fprintf(out, "%s goes up by one in %.0f %% of the frames only, not taken\n",
			s->name, 100 * (double)st->ups / steps);
	}
}

static void write_check(const struct mapper *m, const struct dbc_message *msg, FILE *out)
{
	const struct mapper_message *st = mapper_at(m, msg);
	char why[80];

	snprintf(why, sizeof(why), "right in all %" PRIu64 " frames of the log", st->frames);
	if (st->frames < FRAMES_MIN) {
		return;
	}
	if (msg->has_data_id && !st->passes[E2E_P2]) {
		line(out, "check", "none",
		     "the database gives a DataIDList, but no frame passes e2e-p2");
	} else if (!msg->has_data_id && st->passes[E2E_TOYOTA] == st->frames) {
		line(out, "check", e2e_kind_name[E2E_TOYOTA], why);
	}
}

static void write_period(const struct mapper *m, const struct dbc_message *msg, FILE *out)
{
	const struct mapper_message *st = mapper_at(m, msg);
	const double ms = st->frames > 1 ? (double)(st->last_ns - st->first_ns) /
						   (double)(st->frames - 1) / CLOCK_NS_PER_MS
					 : 0;
	char text[32], why[80];

	if (st->frames < FRAMES_MIN ||
	    (msg->cycle_ms && fabs(ms / msg->cycle_ms - 1) < PERIOD_OFF)) {
		return;
	}
	snprintf(text, sizeof(text), "%.3g", fmin(fmax(ms, 1), 10000));
	snprintf(why, sizeof(why), "ms, as in the log; the database says %u", msg->cycle_ms);
	line(out, "period", text, msg->cycle_ms ? why : "ms, as in the log");
}

static void write_message(const struct mapper *m, const struct mapper_choice *choice, int family,
			  const char *iface, FILE *out)
{
	const struct mapper_family *f = &m->family[family];
	const struct dbc_message *msg = f->member[0];
	const struct census_id *there = census_elsewhere(&m->census, msg->id);
	const struct dbc_signal *counter = find_counter(m, choice, msg);
	const struct dbc_signal *odd = find_odd_counter(m, choice, msg);

	fprintf(out, "\n[message %s]\n", f->name);
	line(out, "interface", there ? m->iface[there->iface] : iface, "");
	write_check(m, msg, out);
	if (counter && !msg->has_data_id) {
		line(out, "counter", counter->name, "one up with each frame of the log");
	}
	if (odd) {
		fprintf(out, "# counter: ");
		say_odd_counter(m, msg, odd, out);
	}
	write_period(m, msg, out);
}

static int is_used(const struct mapper_choice *choice, int family)
{
	for (int r = 0; r < MAPPER_ROLES; r++) {
		if (choice[r].taken >= 0 && choice[r].at[choice[r].taken].family == family) {
			return 1;
		}
	}
	return 0;
}

static void write_messages(const struct mapper *m, const struct mapper_choice *choice,
			   const char *iface, FILE *out)
{
	fprintf(out, "\n# ---- how the messages arrive ----\n");
	for (int f = 0; f < m->n_families; f++) {
		if (is_used(choice, f)) {
			write_message(m, choice, f, iface, out);
		}
	}
}

void mapper_odd_counters(const struct mapper *m, const struct mapper_choice choice[MAPPER_ROLES],
			 FILE *out)
{
	for (int f = 0; f < m->n_families; f++) {
		const struct dbc_message *msg = m->family[f].member[0];
		const struct dbc_signal *odd =
			is_used(choice, f) ? find_odd_counter(m, choice, msg) : NULL;

		if (odd) {
			fprintf(out, "counter: %s.", m->family[f].name);
			say_odd_counter(m, msg, odd, out);
		}
	}
}

/* ---- signals ----------------------------------------------------------------------------------- */

/* All bits one, where that says that there is no value: by the database, or for a distance by the log. */
static void write_na(const struct mapper *m, enum mapper_role role,
		     const struct mapper_candidate *c, FILE *out)
{
	const struct dbc_signal *s = c->sig[0];
	const struct mapper_stats *st = mapper_stats(m, m->family[c->family].member[0], s);
	const char *text = dbc_value_text(s, codec_mask(s));
	const enum unit_kind kind = mapper_role_table[role].unit;
	char na[32], why[80] = "";

	if (kind == UNIT_FLAG || kind == UNIT_SHARE || (text && !strcmp(text, "not available"))) {
		return;
	}
	if (text) {
		snprintf(why, sizeof(why), "as the database names it");
	} else if (role == MAPPER_distance && (double)st->full > FULL_SHARE * (double)st->n) {
		snprintf(why, sizeof(why), "full scale, in %.0f %% of the frames: no target",
			 100 * (double)st->full / (double)st->n);
	}
	if (*why) {
		snprintf(na, sizeof(na), "0x%" PRIX64, codec_mask(s));
		line(out, "na", na, why);
	}
}

/* Reasons, wrapped before column 100. */
static void write_why(const char *why, FILE *out)
{
	while (*why) {
		int n = (int)strlen(why);

		if (n > 96) {
			for (n = 96; n > 0 && why[n] != ' '; n--) {
			}
			n = n ? n : 96;
		}
		fprintf(out, "# %.*s\n", n, why);
		why += n;
		why += *why == ' ';
	}
}

static void write_signal(const struct mapper *m, enum mapper_role role,
			 const struct mapper_choice *choice, FILE *out)
{
	const struct mapper_role_row *row = &mapper_role_table[role];
	char spec[MAPPER_SPEC_MAX];

	if (choice->taken < 0) {
		fprintf(out, "\n# [signal %s]: not mapped. %s\n", row->name, row->doc);
		return;
	}
	const struct mapper_candidate *c = &choice->at[choice->taken];

	fprintf(out, "\n");
	write_why(c->why, out);
	fprintf(out, "[signal %s]\n", row->name);
	line(out, "from", mapper_spec(m, c, spec), row->doc);
	if (c->unit) {
		line(out, "unit", c->unit, "");
	}
	if (c->negate) {
		line(out, "negate", "yes", "it runs against the change of the distance");
	}
	write_na(m, role, c, out);
}

/* ---- the file ---------------------------------------------------------------------------------- */

static void write_interfaces(const struct mapper *m, const struct mapper_choice *choice,
			     const char *iface, FILE *out)
{
	int used[BUS_IFACES_MAX] = {0}, any = 0;

	for (int r = 0; r < MAPPER_ROLES; r++) {
		const struct mapper_choice *c = &choice[r];
		const struct census_id *there =
			c->taken < 0
				? NULL
				: census_elsewhere(&m->census,
						   m->family[c->at[c->taken].family].member[0]->id);

		if (there) {
			used[there->iface] = any = 1;
		}
	}
	fprintf(out, "[bus]\ninterfaces =");
	for (int i = 0; i < m->n_ifaces; i++) {
		if (used[i]) {
			fprintf(out, " %s", m->iface[i]);
		}
	}
	fprintf(out, "%s%s\n", any ? "" : " ", any ? "" : iface);
	fprintf(out, "transmit = none                 # listen only; shadow: frames that never "
		     "request\n");
}

/* Silence that ends a scan of which frames were lost: between that within and that between scans. */
static void write_gap(const struct mapper *m, int family, FILE *out)
{
	int within, between;

	if (mapper_gaps(m, family, &within, &between)) {
		return;
	}
	if (between < within + 2) {
		fprintf(out,
			"# scan_gap: silences of %d ms within scans and %d ms between them cannot "
			"be told apart\n",
			within, between);
	} else if (within > GAP_MS - 2 || between < GAP_MS + 2) {
		fprintf(out,
			"scan_gap = %-20d # ms: silences are up to %d ms within scans, from %d ms "
			"on between "
			"them\n",
			(within + between) / 2, within, between);
	}
}

static void write_radar(const struct mapper *m, const struct mapper_choice *choice, FILE *out)
{
	const struct mapper_choice *c = &choice[MAPPER_distance];
	const struct mapper_message *st = mapper_at(m, m->family[c->at[c->taken].family].member[0]);

	fprintf(out, "\n[radar]\n");
	if (st->frames >= FRAMES_MIN && choice[MAPPER_object_id].taken < 0) {
		fprintf(out, "period = %-22.3g # ms between scans, as in the log\n",
			fmax(5, fmin(1000, (double)(st->last_ns - st->first_ns) /
						   (double)(st->frames - 1) / CLOCK_NS_PER_MS)));
	}
	write_gap(m, c->at[c->taken].family, out);
	fprintf(out, "# latency, range_sigma, rate_sigma: from the radar's manual; the risk is as "
		     "true as they are\n");
}

void mapper_write(const struct mapper *m, const struct mapper_choice choice[MAPPER_ROLES],
		  const char *dbc_path, const char *iface, FILE *out)
{
	fprintf(out, "# Written by aebmc map. Check it: aebmc inputs LOG --config THIS says what "
		     "is read wrong;\n"
		     "# aebmcd --check-config THIS says what does not fit; aebmcd --print-config "
		     "lists every option.\n\n");
	write_interfaces(m, choice, iface, out);
	fprintf(out, "\n[dbc]\nfile = %s\n", dbc_path);
	fprintf(out,
		"\n# ---- the car: weigh and measure yours, then take away the # ----\n[vehicle]\n"
		"# mass = 1500                   # kg, with driver\n"
		"# mass_sigma = 100              # passengers, luggage, fuel\n"
		"# wheelbase = 2.7               # m\n"
		"# front_offset = 0              # m, from the radar to the front bumper\n");
	write_radar(m, choice, out);
	write_messages(m, choice, iface, out);
	fprintf(out, "\n# ---- which signal means what, and why it was taken ----\n");
	for (int r = 0; r < MAPPER_ROLES; r++) {
		write_signal(m, (enum mapper_role)r, &choice[r], out);
	}
}
