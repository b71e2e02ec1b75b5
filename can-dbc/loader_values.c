/* SPDX-License-Identifier: MIT
 * What refers to signals read before: names of raw values (VAL_) and types (SIG_VALTYPE_).
 */
#include <errno.h>
#include "codec.h"
#include "loader.h"

/* Takes a message id; its index, or -1 with the error recorded. */
int loader_message_ref(struct loader *ld, const char *word)
{
	uint32_t id = (uint32_t)lex_uint(&ld->lx, UINT32_MAX, "message id");
	const struct dbc_message *m = ld->lx.rc ? NULL : dbc_find_id(ld->dbc, id);
	if (!m) {
		lex_fail(&ld->lx, -EINVAL, "%s refers to message %u, which no BO_ defines", word,
			 id);
		return -1;
	}
	return (int)(m - ld->messages);
}

/* Takes a message id and a signal's name; the signal, or NULL with the error recorded. */
static struct dbc_signal *read_signal_ref(struct loader *ld, const char *word)
{
	int at = loader_message_ref(ld, word);
	const char *name = lex_word(&ld->lx, word);
	if (ld->lx.rc) {
		return NULL;
	}
	const struct dbc_message *m = &ld->messages[at];
	const struct dbc_signal *s = dbc_find_signal(m, name);
	if (!s) {
		lex_fail(&ld->lx, -EINVAL, "%s: message %s has no signal %s: did you mean '%s'?",
			 word, m->name, name, dbc_nearest(ld->dbc, m, name));
	}
	return (struct dbc_signal *)s;
}

static void add_value(struct loader *ld, struct dbc_signal *s, int negative, uint64_t number,
		      const char *text)
{
	uint64_t raw = negative ? -number : number;
	uint64_t lowest = s->is_signed ? (codec_mask(s) >> 1) + 1 : 0;
	if (negative ? number > lowest : number > codec_mask(s)) {
		return; /* a name for what can never be seen */
	}
	struct dbc_value *values = loader_grow(ld, s->values, s->n_values, sizeof(*values));
	if (values) {
		values[s->n_values++] = (struct dbc_value){raw & codec_mask(s), text};
		s->values = values;
	}
}

void loader_values(struct loader *ld, const char *word)
{
	struct lex *lx = &ld->lx;
	if (lex_is_word(lx)) { /* of an environment variable */
		lex_skip(lx, word);
		return;
	}
	struct dbc_signal *s = read_signal_ref(ld, word);
	if (lex_is_word(lx)) {
		lex_fail(lx, -ENOTSUP,
			 "VAL_ by a table's name is not supported: write the values out");
	}
	while (!lx->rc && lex_peek(lx) != ';') {
		int negative = *lx->p == '-';
		lx->p += negative;
		uint64_t number = lex_uint(lx, UINT64_MAX, word);
		const char *text = lex_string(lx, word);
		if (!lx->rc) {
			add_value(ld, s, negative, number, text);
		}
	}
	lex_expect(lx, ';', word);
}

void loader_value_type(struct loader *ld, const char *word)
{
	struct lex *lx = &ld->lx;
	const struct dbc_signal *s = read_signal_ref(ld, word);
	if (lex_peek(lx) == ':') {
		lx->p++;
	}
	if (lex_uint(lx, 3, word)) {
		lex_fail(lx, -ENOTSUP, "signal %s: floating-point signals are not supported",
			 s->name);
	}
	lex_expect(lx, ';', word);
}
