/* SPDX-License-Identifier: MIT
 * End-to-end protection: documented checksums, every error up to three bits, the sequence check step by step.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>
#include "e2e.h"

/* DataIDList 1..16, the documented example. */
static const struct dbc_message p2_message = {
	.name = "P2",
	.id = 0x123,
	.size = 8,
	.has_data_id = 1,
	.data_id = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16},
};
static const struct e2e_config p2 = {E2E_P2, &p2_message, NULL};

/* One frame with a given counter. */
static void p2_frame(uint8_t data[8], unsigned counter)
{
	struct e2e_state st = {.counter = counter};
	memset(data, 0, 8);
	e2e_protect(&p2, &st, data);
}

static enum e2e_status p2_receive(struct e2e_state *st, unsigned counter)
{
	uint8_t data[8];
	p2_frame(data, counter);
	return e2e_check(&p2, st, data, sizeof(data));
}

/* A receiver that has accepted its three frames, the last with this counter. */
static struct e2e_state p2_started(unsigned counter)
{
	struct e2e_state st = {0};
	assert_int_equal(p2_receive(&st, (counter + 14) & 15), E2E_INITIAL);
	assert_int_equal(p2_receive(&st, (counter + 15) & 15), E2E_SYNC);
	assert_int_equal(p2_receive(&st, counter), E2E_OK);
	return st;
}

/* ---- checksums ----------------------------------------------------------------------------------- */

/* AUTOSAR CRC library (SWS_CRCLibrary), CRC-8 H2F: check value and published examples. */
static void crc8h2f_known_answers(void **state)
{
	(void)state;
	static const struct {
		const char *bytes;
		unsigned len;
		uint8_t crc;
	} kat[] = {
		{"123456789", 9, 0xDF},        {"\x00\x00\x00\x00", 4, 0x12},
		{"\xF2\x01\x83", 3, 0xC2},     {"\x0F\xAA\x00\x55", 4, 0xC6},
		{"\x00\xFF\x55\x11", 4, 0x77}, {"\x33\x22\x55\xAA\xBB\xCC\xDD\xEE\xFF", 9, 0x11},
		{"\x92\x6B\x55", 3, 0x33},     {"\xFF\xFF\xFF\xFF", 4, 0x6C},
	};
	for (size_t i = 0; i < sizeof(kat) / sizeof(kat[0]); i++) {
		const uint8_t *bytes = (const uint8_t *)kat[i].bytes;
		assert_int_equal(e2e_crc8h2f(0, bytes, kat[i].len), kat[i].crc);
		uint8_t head = e2e_crc8h2f(0, bytes, 2);
		assert_int_equal(e2e_crc8h2f(head, bytes + 2, kat[i].len - 2), kat[i].crc);
	}
}

static void p2_known_answers(void **state)
{
	(void)state;
	static const struct {
		unsigned counter;
		uint8_t crc;
	} kat[] = {{0, 0x0E}, {1, 0x1B}, {2, 0x98}, {15, 0xCD}};
	for (size_t i = 0; i < sizeof(kat) / sizeof(kat[0]); i++) {
		uint8_t data[8];
		p2_frame(data, kat[i].counter);
		assert_int_equal(data[0], kat[i].crc);
		assert_int_equal(data[1], kat[i].counter);
	}
}

/* Outside of the counter no error of one, two or three bits in the 64 passes (test_contract.c: within it neither, with
 * the DataIDLists of our own messages). */
static void p2_finds_three_bit_errors(void **state)
{
	(void)state;
	uint8_t good[8];
	p2_frame(good, 5);
	unsigned passed = 0, tried = 0;
	for (unsigned a = 0; a < 64; a++) {
		for (unsigned b = a; b < 64; b++) {
			for (unsigned c = b; c < 64; c++) {
				uint8_t bad[8];
				memcpy(bad, good, 8);
				bad[a / 8] ^= (uint8_t)(1u << a % 8);
				bad[b / 8] ^= (uint8_t)(b > a ? 1u << b % 8 : 0);
				bad[c / 8] ^= (uint8_t)(c > b ? 1u << c % 8 : 0);
				if ((bad[1] & 15) == 5) {
					struct e2e_state st = {0};
					tried++;
					passed += e2e_check(&p2, &st, bad, 8) != E2E_WRONG_CRC;
				}
			}
		}
	}
	assert_int_equal(tried, 60 * 61 * 62 / 6);
	assert_int_equal(passed, 0);
}

/* The upper nibble of byte 1 is payload: kept by protecting, covered by the CRC. */
static void p2_keeps_payload(void **state)
{
	(void)state;
	uint8_t data[8] = {0xFF, 0xAF, 1, 2, 3, 4, 5, 6};
	struct e2e_state tx = {.counter = 3}, rx = {0};
	e2e_protect(&p2, &tx, data);
	const uint8_t want[7] = {0xA3, 1, 2, 3, 4, 5, 6};
	assert_memory_equal(data + 1, want, 7);
	assert_int_equal(e2e_check(&p2, &rx, data, 8), E2E_INITIAL);
	data[1] ^= 0x10;
	assert_int_equal(e2e_check(&p2, &rx, data, 8), E2E_WRONG_CRC);
}

/* A frame of another message with the same bytes does not pass: its DataIDList differs. */
static void p2_tells_messages_apart(void **state)
{
	(void)state;
	struct dbc_message other = p2_message;
	const struct e2e_config cfg = {E2E_P2, &other, NULL};
	uint8_t data[8];
	p2_frame(data, 4);
	other.data_id[4] ^= 1;
	struct e2e_state st = {0};
	assert_int_equal(e2e_check(&cfg, &st, data, 8), E2E_WRONG_CRC);
}

/* ---- sequence ------------------------------------------------------------------------------------ */

static void sender_counts_and_wraps(void **state)
{
	(void)state;
	struct e2e_state tx = {0}, rx = {0};
	for (unsigned i = 0; i < 40; i++) {
		uint8_t data[8] = {0};
		e2e_protect(&p2, &tx, data);
		assert_int_equal(data[1] & 15, i & 15);
		enum e2e_status want = i == 0 ? E2E_INITIAL : i == 1 ? E2E_SYNC : E2E_OK;
		assert_int_equal(e2e_check(&p2, &rx, data, 8), want);
	}
}

static void steps_from_each_counter(void **state)
{
	(void)state;
	for (unsigned from = 0; from < 16; from++) {
		for (unsigned delta = 0; delta < 16; delta++) {
			struct e2e_state st = p2_started(from);
			enum e2e_status want = delta == 0   ? E2E_REPEATED
					       : delta == 1 ? E2E_OK
					       : delta == 2 ? E2E_SOME_LOST
							    : E2E_WRONG_SEQUENCE;
			assert_int_equal(p2_receive(&st, (from + delta) & 15), want);
		}
	}
}

static void wrong_sequence_starts_anew(void **state)
{
	(void)state;
	struct e2e_state st = p2_started(0);
	assert_int_equal(p2_receive(&st, 9), E2E_WRONG_SEQUENCE);
	assert_int_equal(p2_receive(&st, 10), E2E_SYNC);
	assert_int_equal(p2_receive(&st, 11), E2E_OK);
	assert_int_equal(p2_receive(&st, 13), E2E_SOME_LOST);
}

static void starting_tolerates_one_loss(void **state)
{
	(void)state;
	struct e2e_state st = {0};
	assert_int_equal(p2_receive(&st, 7), E2E_INITIAL);
	assert_int_equal(p2_receive(&st, 7), E2E_REPEATED);
	assert_int_equal(p2_receive(&st, 9), E2E_SYNC);
	assert_int_equal(p2_receive(&st, 11), E2E_SOME_LOST);
}

/* The allowed step grows with each frame that is not accepted, and returns to 2 with one that is. */
static void tolerance_grows_with_bad_frames(void **state)
{
	(void)state;
	uint8_t bad[8] = {0};
	struct e2e_state st = p2_started(0);
	assert_int_equal(e2e_check(&p2, &st, bad, 8), E2E_WRONG_CRC);
	assert_int_equal(p2_receive(&st, 3), E2E_SOME_LOST);
	assert_int_equal(p2_receive(&st, 6), E2E_WRONG_SEQUENCE);

	st = p2_started(0);
	assert_int_equal(e2e_check(&p2, &st, bad, 7), E2E_WRONG_LENGTH);
	assert_int_equal(p2_receive(&st, 0), E2E_REPEATED);
	assert_int_equal(p2_receive(&st, 4), E2E_SOME_LOST);

	st = p2_started(0);
	for (int i = 0; i < 100; i++) {
		assert_int_equal(p2_receive(&st, 0), E2E_REPEATED);
	}
	assert_int_equal(st.max_delta, 15);
	assert_int_equal(p2_receive(&st, 15), E2E_SOME_LOST);
}

static void reset_starts_anew(void **state)
{
	(void)state;
	struct e2e_state st = p2_started(3);
	e2e_reset(&st);
	assert_int_equal(p2_receive(&st, 3), E2E_INITIAL);
}

static void only_two_statuses_are_usable(void **state)
{
	(void)state;
	for (int s = 0; s < E2E_STATUSES; s++) {
		assert_int_equal(e2e_usable(s), s == E2E_OK || s == E2E_SOME_LOST);
		assert_non_null(e2e_status_name[s]);
	}
}

static void wrong_length_is_not_read(void **state)
{
	(void)state;
	uint8_t data[8];
	p2_frame(data, 0);
	struct e2e_state st = {0};
	assert_int_equal(e2e_check(&p2, &st, data, 0), E2E_WRONG_LENGTH);
	assert_int_equal(e2e_check(&p2, &st, data, 7), E2E_WRONG_LENGTH);
	assert_int_equal(e2e_check(&p2, &st, data, 64), E2E_WRONG_LENGTH);
	assert_int_equal(e2e_check(&p2, &st, data, 8), E2E_INITIAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(crc8h2f_known_answers),
		cmocka_unit_test(p2_known_answers),
		cmocka_unit_test(p2_finds_three_bit_errors),
		cmocka_unit_test(p2_keeps_payload),
		cmocka_unit_test(p2_tells_messages_apart),
		cmocka_unit_test(sender_counts_and_wraps),
		cmocka_unit_test(steps_from_each_counter),
		cmocka_unit_test(wrong_sequence_starts_anew),
		cmocka_unit_test(starting_tolerates_one_loss),
		cmocka_unit_test(tolerance_grows_with_bad_frames),
		cmocka_unit_test(reset_starts_anew),
		cmocka_unit_test(only_two_statuses_are_usable),
		cmocka_unit_test(wrong_length_is_not_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
