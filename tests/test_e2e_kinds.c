/* SPDX-License-Identifier: MIT
 * End-to-end protection beside Profile 2: the Toyota checksum, counters alone, nothing at all; what cannot be checked is
 * refused; a recorded drive checks from the first frame to the last.
 */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "codec.h"
#include "e2e.h"

#define DRIVE "../shared/canlog/comma2k19-rav4-seg40-speed-radar.log.xz"

static const struct dbc_signal byte_counter = {
	.name = "C", .scale = 1, .start = 7, .len = 8, .big_endian = 1};
static const struct dbc_message track = {.name = "TRACK_A_0", .id = 0x210, .size = 8};
static const struct e2e_config toyota = {E2E_TOYOTA, &track, &byte_counter};

/* Two frames of one radar slot in a row. */
static void toyota_known_answers(void **state)
{
	(void)state;
	uint8_t a[] = {0x93, 0x38, 0x26, 0x08, 0xAC, 0x09, 0x01, 0xC9};
	uint8_t b[] = {0x94, 0x38, 0x2C, 0x08, 0xAC, 0x08, 0xC9, 0x97};
	struct e2e_state st = {0};
	assert_int_equal(e2e_check(&toyota, &st, a, 8), E2E_INITIAL);
	assert_int_equal(e2e_check(&toyota, &st, b, 8), E2E_SYNC);
	assert_int_equal(e2e_check(&toyota, &st, b, 8), E2E_REPEATED);
	b[3] ^= 1;
	assert_int_equal(e2e_check(&toyota, &st, b, 8), E2E_WRONG_CRC);
	assert_int_equal(e2e_check(&toyota, &st, b, 7), E2E_WRONG_LENGTH);
}

static void toyota_protects(void **state)
{
	(void)state;
	struct e2e_state tx = {.counter = 0x93};
	uint8_t data[] = {0, 0x38, 0x26, 0x08, 0xAC, 0x09, 0x01, 0};
	e2e_protect(&toyota, &tx, data);
	assert_int_equal(data[0], 0x93);
	assert_int_equal(data[7], 0xC9);
	e2e_protect(&toyota, &tx, data);
	assert_int_equal(data[0], 0x94);
	assert_int_equal(data[7], 0xCA);
	const struct dbc_message extended = {.id = DBC_ID_EXTENDED | 0x01020304, .size = 2};
	const struct e2e_config cfg = {E2E_TOYOTA, &extended, NULL};
	uint8_t two[2] = {5, 0};
	e2e_protect(&cfg, &tx, two);
	assert_int_equal(two[1], 1 + 2 + 3 + 4 + 2 + 5);
}

static void without_counter_each_frame_stands_alone(void **state)
{
	(void)state;
	uint8_t data[] = {0x00, 0x00, 0x00, 0x00, 0x1D, 0x0B, 0x7A, 0x5E};
	const struct dbc_message speed = {.name = "SPEED", .id = 0x0B4, .size = 8};
	const struct e2e_config sum = {E2E_TOYOTA, &speed, NULL}, none = {E2E_NONE, &speed, NULL};
	struct e2e_state st = {0};
	assert_int_equal(e2e_check(&sum, &st, data, 8), E2E_OK);
	assert_int_equal(e2e_check(&sum, &st, data, 8), E2E_OK);
	data[7]++;
	assert_int_equal(e2e_check(&sum, &st, data, 8), E2E_WRONG_CRC);
	assert_int_equal(e2e_check(&none, &st, data, 8), E2E_OK);
	assert_int_equal(e2e_check(&none, &st, data, 5), E2E_WRONG_LENGTH);
	assert_int_equal(st.max_delta, 0); /* no counter, no step to allow */
	uint8_t same[8];
	memcpy(same, data, 8);
	e2e_protect(&none, &st, data);
	assert_memory_equal(same, data, 8);
}

/* A counter alone, 64 bits wide: the arithmetic of the step must not overflow. */
static void counter_without_checksum(void **state)
{
	(void)state;
	const struct dbc_signal wide = {.name = "C", .scale = 1, .start = 0, .len = 64};
	const struct dbc_message m = {.name = "M", .id = 1, .size = 8};
	const struct e2e_config cfg = {E2E_NONE, &m, &wide};
	struct e2e_state tx = {.counter = UINT64_MAX - 1}, rx = {0};
	static const enum e2e_status want[] = {E2E_INITIAL, E2E_SYNC, E2E_OK, E2E_OK};
	for (int i = 0; i < 4; i++) {
		uint8_t data[8];
		e2e_protect(&cfg, &tx, data);
		assert_int_equal(e2e_check(&cfg, &rx, data, 8), want[i]);
	}
	assert_int_equal(rx.good, E2E_START);
	e2e_reset(&tx);
	assert_int_equal(tx.counter, 0);
	assert_int_equal(tx.good, 0);
}

static void kinds_by_name(void **state)
{
	(void)state;
	for (int k = 0; k < E2E_KINDS; k++) {
		assert_int_equal(e2e_kind_find(e2e_kind_name[k]), k);
	}
	assert_int_equal(e2e_kind_find("crc"), -ENOENT);
}

static void unfit_messages_are_refused(void **state)
{
	(void)state;
	const char *why = NULL;
	assert_int_equal(e2e_config_check(&toyota, &why), 0);
	assert_null(why);

	struct dbc_message m = {.name = "M", .size = 8};
	struct e2e_config cfg = {E2E_P2, &m, NULL};
	assert_int_equal(e2e_config_check(&cfg, &why), -EINVAL);
	assert_non_null(strstr(why, "E2EDataIDList"));
	m.has_data_id = 1;
	m.size = 1;
	assert_int_equal(e2e_config_check(&cfg, &why), -EINVAL);
	assert_non_null(strstr(why, "2 bytes"));
	m.size = 2;
	assert_int_equal(e2e_config_check(&cfg, &why), 0);
	cfg.kind = E2E_TOYOTA;
	m.size = 1;
	assert_int_equal(e2e_config_check(&cfg, &why), 0);
	m.size = 0;
	assert_int_equal(e2e_config_check(&cfg, &why), -EINVAL);
	assert_non_null(strstr(why, "1 byte"));
	struct dbc_signal counter = byte_counter;
	counter.mux = DBC_MULTIPLEXED;
	cfg = (struct e2e_config){E2E_TOYOTA, &track, &counter};
	assert_int_equal(e2e_config_check(&cfg, &why), -EINVAL);
	assert_non_null(strstr(why, "multiplexed"));
}

/* ---- a recorded drive ------------------------------------------------------------------------------ */

/* Every frame of the radar's 16 slots and of the speed is intact and in sequence. */
static void recorded_drive_checks(void **state)
{
	(void)state;
	FILE *probe = fopen(DRIVE, "r");
	if (!probe) {
		print_message("# needs shared\n");
		skip();
	}
	fclose(probe);
	char err[256];
	struct dbc *dbc;
	assert_int_equal(dbc_load("can-dbc/vehicles/toyota-tss-p.dbc", &dbc, err, sizeof(err)), 0);
	FILE *log = popen("xz -dc " DRIVE, "r");
	assert_non_null(log);
	struct e2e_state st[32] = {0};
	unsigned count[E2E_STATUSES] = {0}, in_range = 0;
	char line[256];
	while (fgets(line, sizeof(line), log)) {
		unsigned id;
		uint8_t d[8];
		if (sscanf(line, "%*s %*s %x#%2hhx%2hhx%2hhx%2hhx%2hhx%2hhx%2hhx%2hhx", &id, &d[0],
			   &d[1], &d[2], &d[3], &d[4], &d[5], &d[6], &d[7]) != 9 ||
		    id == 0x0AA) {
			continue;
		}
		const struct dbc_message *m = dbc_find_id(dbc, id);
		assert_non_null(m);
		const struct dbc_signal *counter = dbc_find_signal(m, "COUNTER");
		const struct e2e_config cfg = {E2E_TOYOTA, m, counter};
		count[e2e_check(&cfg, &st[id & 31], d, 8)]++;
		in_range +=
			counter && codec_in_range(dbc_find_signal(m, "LONG_DIST"),
						  codec_raw(dbc_find_signal(m, "LONG_DIST"), d));
	}
	assert_int_equal(pclose(log), 0);
	assert_int_equal(count[E2E_INITIAL], 16);
	assert_int_equal(count[E2E_SYNC], 16);
	assert_int_equal(count[E2E_OK], 2487 + 16 * 1198);
	assert_int_equal(in_range, 16 * 1200 - 7841);
	dbc_free(dbc);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(toyota_known_answers),
		cmocka_unit_test(toyota_protects),
		cmocka_unit_test(without_counter_each_frame_stands_alone),
		cmocka_unit_test(counter_without_checksum),
		cmocka_unit_test(kinds_by_name),
		cmocka_unit_test(unfit_messages_are_refused),
		cmocka_unit_test(recorded_drive_checks),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
