/* SPDX-License-Identifier: MIT
 * Loading a DBC: what dbc_load.c (file and statements), loader_frames.c (BO_, SG_), loader_values.c (VAL_) and
 * loader_attrs.c (BA_) share. Errors stick in the lexer: the first one ends the load. Private to can-dbc.
 */
#ifndef AEBMC_LOADER_H
#define AEBMC_LOADER_H

#include "dbc.h"
#include "lex.h"

#define LOADER_ID_ORPHANS \
	0xC0000000u           /* VECTOR__INDEPENDENT_SIG_MSG: signals that belong to no frame */
#define LOADER_CLASSIC_MAX 8  /* bytes in a classic frame */
#define LOADER_MAP_BYTES   72 /* reach of a signal of 64 bits from the last start bit of a frame */

/* Attributes of a message that mean something here. */
enum loader_attr { ATTR_CYCLE, ATTR_FORMAT, ATTR_DATA_IDS, ATTRS };

/* A value as written: text, or a number (of an enumeration its index). */
struct loader_value {
	unsigned line; /* 0: not given */
	double number;
	const char *text; /* NULL: it is a number */
};

/* What is known of a message, beside struct dbc_message, while its file is being read. */
struct loader_note {
	unsigned line;
	struct loader_value attr[ATTRS];
};

struct loader {
	struct lex lx;
	struct dbc *dbc;
	struct dbc_message *messages; /* dbc->messages */
	struct loader_note *notes;    /* [dbc->n_messages] */
	struct loader_value attr_default[ATTRS];
	uint64_t fd_formats; /* bit n: enumerator n of VFrameFormat is CAN FD */
	uint8_t map[DBC_SIGNALS_MAX]
		   [LOADER_MAP_BYTES]; /* bits taken by each signal of the last message */
};

/** loader_grow - array of @n elements of @size with room for one more; NULL with the error recorded. Storage doubles, so
 * that its size need not be kept. */
void *loader_grow(struct loader *ld, const void *array, uint32_t n, size_t size);

/* Readers of one statement each, behind its first word @word. */
void loader_message(struct loader *ld, const char *word);
void loader_signal(struct loader *ld, const char *word);
void loader_values(struct loader *ld, const char *word);
void loader_value_type(struct loader *ld, const char *word);
void loader_attr_definition(struct loader *ld, const char *word);
void loader_attr_default(struct loader *ld, const char *word);
void loader_attr(struct loader *ld, const char *word);

/** loader_message_ref - take a message id; the message's index, or -1 with the error recorded. */
int loader_message_ref(struct loader *ld, const char *word);

/** loader_attr_apply - attributes of message @at, its own or the defaults, into struct dbc_message. */
void loader_attr_apply(struct loader *ld, uint32_t at);

#endif
