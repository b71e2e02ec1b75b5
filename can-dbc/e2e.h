/* SPDX-License-Identifier: MIT
 * End-to-end protection of messages: is the content intact, and is it new?
 * One row per kind of check; the sequence check on the counter is the same for all. No clock: a counter never replaces a
 * timeout, so the caller watches ages and calls e2e_reset() after one.
 *
 * e2e-p2: AUTOSAR E2E Profile 2 (PRS_E2EProtocol). Byte 0 is the CRC-8 (polynomial 0x2F, start 0xFF, inverted) over bytes
 *         1..n-1 and DataIDList[counter]; the low nibble of byte 1 is the counter.
 * toyota: last byte = (id >> 8) + (id & 0xFF) + length + the other bytes, modulo 256. A counter, where the message has
 *         one, is an ordinary signal.
 */
#ifndef AEBMC_E2E_H
#define AEBMC_E2E_H

#include "dbc.h"

#define E2E_MAX_DELTA \
	2 /* largest step of the counter from one good frame to the next; 1 is no loss */
#define E2E_START \
	3 /* good frames in sequence before the third is usable, at start and after a wrong sequence */

enum e2e_kind { E2E_NONE, E2E_P2, E2E_TOYOTA, E2E_KINDS };
extern const char *const e2e_kind_name[E2E_KINDS]; /* "none", "e2e-p2", "toyota" */

/* What is checked and how. Read-only. */
struct e2e_config {
	enum e2e_kind kind;
	const struct dbc_message *msg; /* id, length and DataIDList */
	const struct dbc_signal
		*counter; /* rolling counter outside the check, or NULL; ignored by e2e-p2 */
};

/* A receiver's (or, for e2e_protect(), a sender's) memory of one message. Zero-initialised, or by e2e_reset(). */
struct e2e_state {
	uint64_t counter; /* of the last accepted frame */
	uint32_t max_delta;
	uint32_t good; /* frames in sequence so far, up to E2E_START; 0: nothing seen yet */
};

/* Statuses as in AUTOSAR; only the first two let a frame be used. */
enum e2e_status {
	E2E_OK,
	E2E_SOME_LOST,      /* in order, but up to max_delta - 1 frames are missing */
	E2E_INITIAL,        /* first good frame since the reset */
	E2E_SYNC,           /* in sequence, but fewer than E2E_START good ones so far */
	E2E_REPEATED,       /* same counter as the last one */
	E2E_WRONG_SEQUENCE, /* too large a step; the sequence starts anew from here */
	E2E_WRONG_CRC,
	E2E_WRONG_LENGTH,
	E2E_STATUSES
};
extern const char *const e2e_status_name[E2E_STATUSES]; /* "ok", "some-lost", ... */

/** e2e_kind_find - kind by name, or -ENOENT. */
int e2e_kind_find(const char *name);

/** e2e_config_check - can this message be checked so? 0, or -EINVAL with *@why saying what is missing (static text). */
int e2e_config_check(const struct e2e_config *cfg, const char **why);

/** e2e_reset - forget what was seen: after a timeout, and at start. */
void e2e_reset(struct e2e_state *st);

/**
 * e2e_check - check one received frame and remember its counter
 * @data, @len: the frame as received
 * The step allowed grows by one with each checked frame that is not accepted, up to the counter's range less one.
 * Without a counter (kind none or toyota, counter NULL) a frame that passes its checksum is E2E_OK.
 * No allocation, never blocks.
 */
enum e2e_status e2e_check(const struct e2e_config *cfg, struct e2e_state *st, const uint8_t *data,
			  unsigned len);

/** e2e_usable - 1 for the statuses that let a frame's content be used. */
int e2e_usable(enum e2e_status status);

/**
 * e2e_protect - write counter and checksum into a frame about to be sent
 * @data: msg->size bytes, all other signals already packed
 * The counter starts at 0 and advances with each call.
 */
void e2e_protect(const struct e2e_config *cfg, struct e2e_state *st, uint8_t *data);

/** e2e_crc8h2f - AUTOSAR CRC-8 H2F of @len bytes, continuing from @crc (0 to start). "123456789" gives 0xDF. */
uint8_t e2e_crc8h2f(uint8_t crc, const uint8_t *data, unsigned len);

#endif
