/* SPDX-License-Identifier: MIT
 * End-to-end protection: a checksum per kind, one sequence check for all.
 */
#include <errno.h>
#include <string.h>
#include "codec.h"
#include "e2e.h"

#define CRC8H2F_POLY 0x2F

const char *const e2e_kind_name[E2E_KINDS] = {
	[E2E_NONE] = "none",
	[E2E_P2] = "e2e-p2",
	[E2E_TOYOTA] = "toyota",
};

const char *const e2e_status_name[E2E_STATUSES] = {
	[E2E_OK] = "ok",
	[E2E_SOME_LOST] = "some-lost",
	[E2E_INITIAL] = "initial",
	[E2E_SYNC] = "sync",
	[E2E_REPEATED] = "repeated",
	[E2E_WRONG_SEQUENCE] = "wrong-sequence",
	[E2E_WRONG_CRC] = "wrong-crc",
	[E2E_WRONG_LENGTH] = "wrong-length",
};

/* Low nibble of byte 1. */
static const struct dbc_signal p2_counter = {.name = "COUNTER", .start = 8, .len = 4};

uint8_t e2e_crc8h2f(uint8_t crc, const uint8_t *data, unsigned len)
{
	crc ^= 0xFF;
	for (unsigned i = 0; i < len; i++) {
		crc ^= data[i];
		for (int bit = 0; bit < 8; bit++) {
			crc = (uint8_t)(crc & 0x80 ? crc << 1 ^ CRC8H2F_POLY : crc << 1);
		}
	}
	return crc ^ 0xFF;
}

static uint8_t sum_p2(const struct dbc_message *msg, const uint8_t *data)
{
	uint8_t crc = e2e_crc8h2f(0, data + 1, msg->size - 1u);
	return e2e_crc8h2f(crc, &msg->data_id[data[1] & 0x0F], 1);
}

static uint8_t sum_toyota(const struct dbc_message *msg, const uint8_t *data)
{
	uint32_t id = msg->id & ~DBC_ID_EXTENDED;
	unsigned sum = id + (id >> 8) + (id >> 16) + (id >> 24) + msg->size;
	for (unsigned i = 0; i + 1 < msg->size; i++) {
		sum += data[i];
	}
	return (uint8_t)sum;
}

/* How each kind computes its checksum, and whether it is the first or the last byte. */
static const struct {
	uint8_t (*sum)(const struct dbc_message *msg, const uint8_t *data);
	int at_end;
} kinds[E2E_KINDS] = {
	[E2E_P2] = {.sum = sum_p2},
	[E2E_TOYOTA] = {.sum = sum_toyota, .at_end = 1},
};

static unsigned sum_at(const struct e2e_config *cfg)
{
	return kinds[cfg->kind].at_end ? cfg->msg->size - 1u : 0;
}

static const struct dbc_signal *counter_of(const struct e2e_config *cfg)
{
	return cfg->kind == E2E_P2 ? &p2_counter : cfg->counter;
}

int e2e_kind_find(const char *name)
{
	for (int i = 0; i < E2E_KINDS; i++) {
		if (!strcmp(name, e2e_kind_name[i])) {
			return i;
		}
	}
	return -ENOENT;
}

int e2e_config_check(const struct e2e_config *cfg, const char **why)
{
	const char *missing = NULL;
	if (cfg->kind == E2E_P2 && !cfg->msg->has_data_id) {
		missing = "e2e-p2 needs the message's attribute E2EDataIDList";
	} else if (cfg->kind == E2E_P2 && cfg->msg->size < 2) {
		missing = "e2e-p2 needs a message of at least 2 bytes";
	} else if (cfg->kind == E2E_TOYOTA && cfg->msg->size < 1) {
		missing = "toyota needs a message of at least 1 byte";
	} else if (cfg->counter && cfg->counter->mux == DBC_MULTIPLEXED) {
		missing = "the counter must be in every frame, not multiplexed";
	}
	if (missing) {
		*why = missing;
		return -EINVAL;
	}
	return 0;
}

void e2e_reset(struct e2e_state *st)
{
	*st = (struct e2e_state){0};
}

static void widen(struct e2e_state *st, uint64_t mask)
{
	st->max_delta += st->max_delta < mask;
}

static enum e2e_status check_sequence(struct e2e_state *st, uint64_t counter, uint64_t mask)
{
	uint64_t delta = (counter - st->counter) & mask;
	enum e2e_status status;
	if (st->good == 0) {
		st->good = 1;
		status = E2E_INITIAL;
	} else if (delta == 0) {
		widen(st, mask);
		return E2E_REPEATED;
	} else if (delta > st->max_delta) {
		st->good = 1;
		status = E2E_WRONG_SEQUENCE;
	} else {
		st->good += st->good < E2E_START;
		status = st->good < E2E_START ? E2E_SYNC : delta == 1 ? E2E_OK : E2E_SOME_LOST;
	}
	st->counter = counter;
	st->max_delta = E2E_MAX_DELTA;
	return status;
}

enum e2e_status e2e_check(const struct e2e_config *cfg, struct e2e_state *st, const uint8_t *data,
			  unsigned len)
{
	const struct dbc_signal *counter = counter_of(cfg);
	uint64_t mask = counter ? codec_mask(counter) : 0;
	if (len != cfg->msg->size) {
		widen(st, mask);
		return E2E_WRONG_LENGTH;
	}
	if (kinds[cfg->kind].sum && data[sum_at(cfg)] != kinds[cfg->kind].sum(cfg->msg, data)) {
		widen(st, mask);
		return E2E_WRONG_CRC;
	}
	return counter ? check_sequence(st, codec_raw(counter, data), mask) : E2E_OK;
}

int e2e_usable(enum e2e_status status)
{
	return status == E2E_OK || status == E2E_SOME_LOST;
}

void e2e_protect(const struct e2e_config *cfg, struct e2e_state *st, uint8_t *data)
{
	const struct dbc_signal *counter = counter_of(cfg);
	if (counter) {
		codec_set_raw(counter, data, st->counter++ & codec_mask(counter));
	}
	if (kinds[cfg->kind].sum) {
		data[sum_at(cfg)] = kinds[cfg->kind].sum(cfg->msg, data);
	}
}
