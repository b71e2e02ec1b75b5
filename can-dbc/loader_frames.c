/* SPDX-License-Identifier: MIT
 * Messages (BO_) and their signals (SG_), each checked as it is read, while its line is known.
 */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "codec.h"
#include "loader.h"

#define ID_MAX_STD 0x7FFu
#define ID_MAX_EXT 0x1FFFFFFFu

/* An array of @n elements with room for one more, or NULL; storage doubles, so that its size need not be kept. */
void *loader_grow(struct loader *ld, const void *array, uint32_t n, size_t size)
{
	void *same = (void *)array;
	if (n & (n - 1)) {
		return same;
	}
	void *more = realloc(same, (n ? 2 * (size_t)n : 1) * size);
	if (!more) {
		lex_fail(&ld->lx, -ENOMEM, "out of memory");
	}
	return more;
}

static struct dbc_message *last_message(struct loader *ld)
{
	return &ld->messages[ld->dbc->n_messages - 1];
}

/* ---- messages ---------------------------------------------------------------------------------- */

static int id_fits(uint32_t id)
{
	return id & DBC_ID_EXTENDED ? (id & ~DBC_ID_EXTENDED) <= ID_MAX_EXT : id <= ID_MAX_STD;
}

static int size_exists(unsigned size)
{
	static const uint8_t fd[] = {12, 16, 20, 24, 32, 48, 64};
	return size <= LOADER_CLASSIC_MAX || memchr(fd, (int)size, sizeof(fd));
}

static void check_message(struct loader *ld, const struct dbc_message *m)
{
	struct lex *lx = &ld->lx;
	const struct dbc_message *same = dbc_find_id(ld->dbc, m->id);
	if (same) {
		lex_fail(lx, -EINVAL, "message %s: id %u is already that of %s", m->name, m->id,
			 same->name);
	} else if (dbc_find(ld->dbc, m->name)) {
		lex_fail(lx, -EINVAL, "message %s: there is already one of this name", m->name);
	} else if (m->id != LOADER_ID_ORPHANS && !id_fits(m->id)) {
		lex_fail(lx, -EINVAL, "message %s: id %u has more than %s", m->name, m->id,
			 m->id & DBC_ID_EXTENDED ? "29 bits" : "11 bits (add 2^31 if extended)");
	} else if (!size_exists(m->size)) {
		lex_fail(lx, -EINVAL,
			 "message %s: no frame has %u bytes: 0-8, 12, 16, 20, 24, 32, 48, 64",
			 m->name, m->size);
	} else if (ld->dbc->n_messages == DBC_MESSAGES_MAX) {
		lex_fail(lx, -EINVAL, "more than %d messages", DBC_MESSAGES_MAX);
	}
}

static void add_message(struct loader *ld, const struct dbc_message *m)
{
	uint32_t n = ld->dbc->n_messages;
	struct dbc_message *messages = loader_grow(ld, ld->messages, n, sizeof(*messages));
	if (!messages) {
		return;
	}
	ld->dbc->messages = ld->messages = messages;
	struct loader_note *notes = loader_grow(ld, ld->notes, n, sizeof(*notes));
	if (!notes) {
		return;
	}
	ld->notes = notes;
	ld->messages[n] = *m;
	ld->notes[n] = (struct loader_note){.line = ld->lx.line};
	ld->dbc->n_messages++;
}

void loader_message(struct loader *ld, const char *word)
{
	struct lex *lx = &ld->lx;
	struct dbc_message m = {.id = (uint32_t)lex_uint(lx, UINT32_MAX, "message id")};
	m.name = lex_word(lx, word);
	lex_expect(lx, ':', word);
	m.size = (uint8_t)lex_uint(lx, DBC_DATA_MAX, "bytes in a message");
	check_message(ld, &m);
	lex_skip_line(lx); /* its sender */
	if (!lx->rc) {
		add_message(ld, &m);
	}
}

/* ---- signals ----------------------------------------------------------------------------------- */

/* Nothing, M or mN between the name and the colon. */
static void read_mux(struct lex *lx, struct dbc_signal *s)
{
	if (!lex_is_word(lx)) {
		return;
	}
	const char *word = lex_word(lx, "multiplexing");
	if (!strcmp(word, "M")) {
		s->mux = DBC_MULTIPLEXOR;
		return;
	}
	int numbered = word[0] == 'm' && isdigit((unsigned char)word[1]);
	char *end;
	unsigned long long value = strtoull(word + numbered, &end, 10);
	if (numbered && !strcmp(end, "M")) {
		lex_fail(lx, -ENOTSUP, "signal %s: extended multiplexing (%s) is not supported",
			 s->name, word);
	} else if (!numbered || *end || value > UINT32_MAX) {
		lex_fail(lx, -EINVAL, "signal %s: '%.40s' is neither M nor mNUMBER", s->name, word);
	}
	s->mux = DBC_MULTIPLEXED;
	s->mux_value = (uint32_t)value;
}

static void read_layout(struct lex *lx, struct dbc_signal *s)
{
	s->start = (uint16_t)lex_uint(lx, 8 * DBC_DATA_MAX - 1, "start bit");
	lex_expect(lx, '|', "start bit");
	s->len = (uint8_t)lex_uint(lx, 64, "length in bits");
	lex_expect(lx, '@', "length in bits");
	s->big_endian = !lex_uint(lx, 1, "byte order");
	s->is_signed = lex_peek(lx) == '-';
	lex_expect(lx, s->is_signed ? '-' : '+', "byte order");
}

static void read_scaling(struct lex *lx, struct dbc_signal *s)
{
	lex_expect(lx, '(', "scale");
	s->scale = lex_double(lx, "scale");
	lex_expect(lx, ',', "scale");
	s->offset = lex_double(lx, "offset");
	lex_expect(lx, ')', "offset");
	lex_expect(lx, '[', "minimum");
	s->min = lex_double(lx, "minimum");
	lex_expect(lx, '|', "minimum");
	s->max = lex_double(lx, "maximum");
	lex_expect(lx, ']', "maximum");
	s->unit = lex_string(lx, "unit");
}

static void check_signal(struct loader *ld, const struct dbc_signal *s)
{
	struct lex *lx = &ld->lx;
	const struct dbc_message *m = last_message(ld);
	if (s->len == 0) {
		lex_fail(lx, -EINVAL, "signal %s: no bits: the length must be 1 to 64", s->name);
	} else if (s->scale == 0) {
		lex_fail(lx, -EINVAL, "signal %s: scale 0: it must not be", s->name);
	} else if (!isfinite(ldexp(s->scale, s->len) + s->offset) ||
		   !isfinite(ldexp(-s->scale, s->len) + s->offset)) {
		lex_fail(lx, -EINVAL, "signal %s: scale and offset overflow", s->name);
	} else if (s->min > s->max) {
		lex_fail(lx, -EINVAL, "signal %s: range [%g|%g] is empty: swap its ends", s->name,
			 s->min, s->max);
	} else if (dbc_find_signal(m, s->name)) {
		lex_fail(lx, -EINVAL, "signal %s: message %s already has one of this name", s->name,
			 m->name);
	} else if (s->mux == DBC_MULTIPLEXOR && m->mux) {
		lex_fail(lx, -EINVAL, "signal %s: message %s already has a multiplexor", s->name,
			 m->name);
	} else if (m->n_signals == DBC_SIGNALS_MAX) {
		lex_fail(lx, -EINVAL, "message %s: more than %d signals", m->name, DBC_SIGNALS_MAX);
	}
}

static int share_bits(const uint8_t *a, const uint8_t *b)
{
	unsigned shared = 0;
	for (int i = 0; i < LOADER_MAP_BYTES; i++) {
		shared |= a[i] & b[i];
	}
	return shared != 0;
}

static int share_frame(const struct dbc_signal *a, const struct dbc_signal *b)
{
	return a->mux != DBC_MULTIPLEXED || b->mux != DBC_MULTIPLEXED ||
	       a->mux_value == b->mux_value;
}

/* Within the frame, and on no other signal's bits unless the multiplexor keeps the two apart. */
static void check_place(struct loader *ld, const struct dbc_signal *s)
{
	const struct dbc_message *m = last_message(ld);
	uint8_t *map = ld->map[m->n_signals];
	memset(map, 0, LOADER_MAP_BYTES);
	codec_set_raw(s, map, codec_mask(s));
	for (int i = m->size; i < LOADER_MAP_BYTES; i++) {
		if (map[i]) {
			lex_fail(&ld->lx, -EINVAL,
				 "signal %s: bits %u|%u@%d exceed the %u bytes of message %s",
				 s->name, s->start, s->len, !s->big_endian, m->size, m->name);
			return;
		}
	}
	for (uint32_t i = 0; i < m->n_signals; i++) {
		if (share_frame(s, &m->signals[i]) && share_bits(map, ld->map[i])) {
			lex_fail(&ld->lx, -EINVAL, "signal %s: overlaps signal %s of message %s",
				 s->name, m->signals[i].name, m->name);
			return;
		}
	}
}

static void add_signal(struct loader *ld, const struct dbc_signal *s)
{
	struct dbc_message *m = last_message(ld);
	struct dbc_signal *signals = loader_grow(ld, m->signals, m->n_signals, sizeof(*signals));
	if (!signals) {
		return;
	}
	signals[m->n_signals++] = *s;
	m->signals = signals;
	m->mux = NULL; /* the array may have moved */
	for (uint32_t i = 0; i < m->n_signals; i++) {
		m->mux = signals[i].mux == DBC_MULTIPLEXOR ? &signals[i] : m->mux;
	}
}

void loader_signal(struct loader *ld, const char *word)
{
	struct lex *lx = &ld->lx;
	if (!ld->dbc->n_messages) {
		lex_fail(lx, -EINVAL, "%s before any message (BO_)", word);
		return;
	}
	struct dbc_signal s = {.name = lex_word(lx, word)};
	read_mux(lx, &s);
	lex_expect(lx, ':', word);
	read_layout(lx, &s);
	read_scaling(lx, &s);
	if (!lx->rc) {
		check_signal(ld, &s);
	}
	if (!lx->rc && last_message(ld)->id != LOADER_ID_ORPHANS) {
		check_place(ld, &s);
	}
	lex_skip_line(lx); /* its receivers */
	if (!lx->rc) {
		add_signal(ld, &s);
	}
}
