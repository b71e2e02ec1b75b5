/* SPDX-License-Identifier: MIT
 * A CAN database (DBC): messages and their signals, loaded from a file or compiled in (contract.h).
 * Loading allocates and checks everything; afterwards all of it is read-only, and packing (codec.h) goes by pointer.
 * Knows frames' layout only: no bus, no clock, no log.
 *
 * Read: BO_, SG_ (multiplexing M and mN, both byte orders, 1..64 bits, scale, offset, range, unit), VAL_, SIG_VALTYPE_ 0,
 * and of the attributes GenMsgCycleTime, VFrameFormat (CAN FD) and E2EDataIDList. Refused by name: extended
 * multiplexing (mNM, SG_MUL_VAL_), floating-point signals, signal types. The rest (comments, nodes, groups) is skipped.
 */
#ifndef AEBMC_DBC_H
#define AEBMC_DBC_H

#include <stddef.h>
#include <stdint.h>

#define DBC_ID_EXTENDED \
	0x80000000u           /* in an id: 29 bits; the same bit as in SocketCAN and in the file */
#define DBC_NAME_MAX     128  /* longest name, without its NUL */
#define DBC_DATA_MAX     64   /* bytes in a CAN FD frame */
#define DBC_DATA_IDS     16   /* length of an E2E Profile 2 DataIDList */
#define DBC_SIGNALS_MAX  1024 /* in one message */
#define DBC_MESSAGES_MAX 4096
#define DBC_FILE_MAX     (16u << 20) /* bytes */
#define DBC_LINE_MAX     65536u      /* bytes */

enum dbc_mux {
	DBC_PLAIN,       /* in every frame */
	DBC_MULTIPLEXOR, /* its raw value says which multiplexed signals are in the frame */
	DBC_MULTIPLEXED, /* in frames whose multiplexor equals mux_value */
};

/* A named raw value (VAL_). Raw values are the field's bits as an unsigned number, for signed signals too. */
struct dbc_value {
	uint64_t raw;
	const char *text;
};

struct dbc_signal {
	const char *name;
	const char *unit; /* "" if none */
	double scale;     /* physical = raw * scale + offset; finite, not 0, may be negative */
	double offset;
	double min, max; /* physical; both 0: the file gives no range */
	const struct dbc_value *values;
	uint32_t n_values;
	uint32_t mux_value; /* of a DBC_MULTIPLEXED signal */
	uint16_t
		start; /* as in the file: bit 8 * byte + bit of the LSB, of the MSB if big_endian */
	uint8_t len;   /* 1..64 bits */
	uint8_t big_endian;
	uint8_t is_signed;
	uint8_t mux; /* enum dbc_mux */
};

struct dbc_message {
	const char *name;
	uint32_t id;       /* with DBC_ID_EXTENDED */
	uint32_t cycle_ms; /* GenMsgCycleTime; 0 if not given */
	uint8_t size;      /* bytes: 0..8, with is_fd also 12, 16, 20, 24, 32, 48, 64 */
	uint8_t is_fd;
	uint8_t has_data_id;           /* data_id was given */
	uint8_t data_id[DBC_DATA_IDS]; /* E2EDataIDList */
	const struct dbc_signal *signals;
	const struct dbc_signal *mux; /* the DBC_MULTIPLEXOR among them, or NULL */
	uint32_t n_signals;
};

struct dbc {
	const struct dbc_message *messages; /* in the file's order */
	uint32_t n_messages;
	char *names; /* storage of a loaded file's strings; NULL if compiled in */
};

/**
 * dbc_load - load and check a DBC file
 * @path: a regular file of at most DBC_FILE_MAX bytes
 * @ret:  to be freed by dbc_free(); untouched on failure
 * @err, @err_size: on failure one line "FILE:LINE: what, how to mend it" (without LINE where there is none)
 * Numbers are read by strtod(): the LC_NUMERIC locale must be "C".
 * Returns 0; -errno of opening or reading; -EISDIR; -EFBIG; -ENOMEM; -ENOTSUP for a DBC feature that is not
 * supported; -EINVAL for everything else. Allocates; blocks on the file system.
 */
int dbc_load(const char *path, struct dbc **ret, char *err, size_t err_size);

/** dbc_parse - dbc_load() of @len bytes at @text; @name stands for the file in messages. */
int dbc_parse(const char *name, const char *text, size_t len, struct dbc **ret, char *err,
	      size_t err_size);

/** dbc_free - free what was loaded (never a compiled-in database); NULL is fine. */
void dbc_free(struct dbc *dbc);

/** dbc_find - message by name, or NULL. Linear; for start-up. */
const struct dbc_message *dbc_find(const struct dbc *dbc, const char *name);

/** dbc_find_id - message by id (with DBC_ID_EXTENDED), or NULL. Linear. */
const struct dbc_message *dbc_find_id(const struct dbc *dbc, uint32_t id);

/** dbc_find_signal - signal by name, or NULL. Linear; for start-up. */
const struct dbc_signal *dbc_find_signal(const struct dbc_message *msg, const char *name);

/**
 * dbc_nearest - the existing name most like @name, for "did you mean"
 * @msg: look among its signals; NULL: among the messages
 * By edit distance, ignoring case; "" if there is nothing to choose from. O(names).
 */
const char *dbc_nearest(const struct dbc *dbc, const struct dbc_message *msg, const char *name);

/** dbc_value_text - what VAL_ calls this raw value, or NULL. Linear in the signal's values. */
const char *dbc_value_text(const struct dbc_signal *sig, uint64_t raw);

/** dbc_value_raw - raw value that VAL_ calls @text. Returns 0, or -ENOENT with *@raw untouched. */
int dbc_value_raw(const struct dbc_signal *sig, const char *text, uint64_t *raw);

/** dbc_hash - 64-bit FNV-1a of all content (names, layout, scaling, values, attributes), the same on any machine. */
uint64_t dbc_hash(const struct dbc *dbc);

#endif
