/* SPDX-License-Identifier: MIT
 * Attributes: read as they come (BA_DEF_, BA_DEF_DEF_, BA_), applied at the end of the file.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include "loader.h"

static const char *const attr_name[ATTRS] = {
	[ATTR_CYCLE] = "GenMsgCycleTime",
	[ATTR_FORMAT] = "VFrameFormat",
	[ATTR_DATA_IDS] = "E2EDataIDList",
};

static enum loader_attr find_attr(const char *name)
{
	enum loader_attr a = 0;
	while (a < ATTRS && strcmp(name, attr_name[a])) {
		a++;
	}
	return a;
}

static int take_word(struct lex *lx, const char *word)
{
	return lex_is_word(lx) && !strcmp(lex_word(lx, word), word);
}

static struct loader_value read_attr_value(struct lex *lx)
{
	struct loader_value v = {0};
	if (lex_peek(lx) == '"') {
		v.line = lx->line;
		v.text = lex_string(lx, "attribute");
	} else {
		v.line = lx->line;
		v.number = lex_double(lx, "attribute");
	}
	lex_expect(lx, ';', "attribute");
	return v;
}

static int is_fd_name(const char *text)
{
	return strstr(text, "FD") != NULL;
}

/* Of all definitions only the enumerators of VFrameFormat matter. */
void loader_attr_definition(struct loader *ld, const char *word)
{
	struct lex *lx = &ld->lx;
	if (take_word(lx, "BO_") && find_attr(lex_string(lx, word)) == ATTR_FORMAT &&
	    take_word(lx, "ENUM")) {
		unsigned n = 0;
		do {
			lx->p += n > 0;
			uint64_t fd = (uint64_t)is_fd_name(lex_string(lx, word));
			ld->fd_formats |= n < 64 ? fd << n : 0;
			n++;
		} while (lex_peek(lx) == ',');
	}
	lex_skip(lx, word);
}

void loader_attr_default(struct loader *ld, const char *word)
{
	enum loader_attr a = find_attr(lex_string(&ld->lx, word));
	if (a == ATTRS) {
		lex_skip(&ld->lx, word);
	} else {
		ld->attr_default[a] = read_attr_value(&ld->lx);
	}
}

void loader_attr(struct loader *ld, const char *word)
{
	struct lex *lx = &ld->lx;
	enum loader_attr a = find_attr(lex_string(lx, word));
	if (a == ATTRS || !take_word(lx, "BO_")) {
		lex_skip(lx, word);
		return;
	}
	int at = loader_message_ref(ld, word);
	struct loader_value v = read_attr_value(lx);
	if (!lx->rc) {
		ld->notes[at].attr[a] = v;
	}
}

/* ---- at the end of the file -------------------------------------------------------------------- */

static void apply_cycle(struct loader *ld, struct dbc_message *m, const struct loader_value *v)
{
	if (v->text || !(v->number >= 0 && v->number <= UINT32_MAX)) {
		lex_fail(&ld->lx, -EINVAL,
			 "message %s: GenMsgCycleTime must be a number of ms >= 0", m->name);
		return;
	}
	m->cycle_ms = (uint32_t)v->number;
}

static void apply_format(struct loader *ld, struct dbc_message *m, const struct loader_value *v)
{
	if (v->text) {
		m->is_fd = (uint8_t)is_fd_name(v->text);
	} else {
		m->is_fd =
			v->number >= 0 && v->number < 64 && (ld->fd_formats >> (int)v->number & 1);
	}
	if (m->size > LOADER_CLASSIC_MAX && !m->is_fd) {
		lex_fail(&ld->lx, -EINVAL,
			 "message %s: %u bytes, but its VFrameFormat is not CAN FD", m->name,
			 m->size);
	}
}

static void apply_data_ids(struct loader *ld, struct dbc_message *m, const struct loader_value *v)
{
	const char *p = v->text ? v->text : "?";
	if (!*p) {
		return; /* the usual default: none */
	}
	for (int i = 0; i < DBC_DATA_IDS; i++) {
		char *end;
		unsigned long byte = strtoul(p, &end, 16);
		if (end == p || byte > UINT8_MAX) {
			break;
		}
		m->data_id[i] = (uint8_t)byte;
		m->has_data_id = i == DBC_DATA_IDS - 1;
		p = end;
	}
	if (!m->has_data_id || p[strspn(p, " \t")]) {
		lex_fail(&ld->lx, -EINVAL,
			 "message %s: E2EDataIDList must be %d bytes in hexadecimal", m->name,
			 DBC_DATA_IDS);
	}
}

static void (*const attr_apply[ATTRS])(struct loader *ld, struct dbc_message *m,
				       const struct loader_value *v) = {
	[ATTR_CYCLE] = apply_cycle,
	[ATTR_FORMAT] = apply_format,
	[ATTR_DATA_IDS] = apply_data_ids,
};

void loader_attr_apply(struct loader *ld, uint32_t at)
{
	struct dbc_message *m = &ld->messages[at];
	m->is_fd = m->size > LOADER_CLASSIC_MAX;
	for (enum loader_attr a = 0; a < ATTRS; a++) {
		const struct loader_value *own = &ld->notes[at].attr[a];
		const struct loader_value *v = own->line ? own : &ld->attr_default[a];
		if (v->line) {
			ld->lx.line = v->line;
			attr_apply[a](ld, m, v);
		}
	}
}
