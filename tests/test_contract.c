/* SPDX-License-Identifier: MIT
 * The compiled-in bus contract is the file aebmc.dbc, to the last bit, and holds what its readers rely on.
 * `test_contract --generate` writes contract.def from aebmc.dbc.
 */
#include <ctype.h>
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
#include "contract.h"
#include "e2e.h"

#define FILE_DBC "can-dbc/aebmc.dbc"
#define FILE_DEF "can-dbc/contract.def"

/* ---- generator --------------------------------------------------------------------------------- */

static const char *const mux_name[] = {"DBC_PLAIN", "DBC_MULTIPLEXOR", "DBC_MULTIPLEXED"};

/* The shortest decimal number that reads back as @d. */
static const char *number(double d, char text[32])
{
	for (int digits = 1; digits <= 17; digits++) {
		snprintf(text, 32, "%.*g", digits, d);
		if (strtod(text, NULL) == d) {
			break;
		}
	}
	return text;
}

static void put_value(FILE *f, const char *msg, const char *sig, const struct dbc_value *v)
{
	fprintf(f, "VALUE(%s_%s, ", msg, sig);
	for (const char *p = v->text; *p; p++) {
		fputc(isalnum((unsigned char)*p) ? toupper((unsigned char)*p) : '_', f);
	}
	fprintf(f, ", %llu, \"%s\")\n", (unsigned long long)v->raw, v->text);
}

static void put_signal(FILE *f, const char *msg, const struct dbc_signal *s, unsigned first_value)
{
	char t[4][32];
	fprintf(f, "SIGNAL(%s, %s, \"%s\", %s, %s, %s, %s, %u, %u, %s, %u, %u, %u, %u, %u)\n", msg,
		s->name, s->unit, number(s->scale, t[0]), number(s->offset, t[1]),
		number(s->min, t[2]), number(s->max, t[3]), first_value, s->n_values,
		mux_name[s->mux], s->mux_value, s->start, s->len, s->big_endian, s->is_signed);
}

static void put_message(FILE *f, const struct dbc_message *m)
{
	fprintf(f, "MESSAGE(%s, 0x%03X, %u, %u, %u, %s_%s, %u, ", m->name, m->id, m->cycle_ms,
		m->size, m->is_fd, m->name, m->signals[0].name, m->n_signals);
	if (m->mux) {
		fprintf(f, "&contract_signal[%s_%s]", m->name, m->mux->name);
	} else {
		fprintf(f, "NULL");
	}
	for (int i = 0; i < DBC_DATA_IDS; i++) {
		fprintf(f, ", 0x%02X", m->data_id[i]);
	}
	fprintf(f, ")\n");
}

static void put_contract(FILE *f, const struct dbc *dbc)
{
	unsigned n_values = 0;
	fprintf(f, "/* SPDX-License-Identifier: MIT\n * The bus contract as rows, written from "
		   "aebmc.dbc by "
		   "`test_contract --generate`: edit that file, not this one.\n */\n"
		   "#ifndef MESSAGE\n#define MESSAGE(...)\n#endif\n#ifndef SIGNAL\n#define "
		   "SIGNAL(...)\n#endif\n"
		   "#ifndef VALUE\n#define VALUE(...)\n#endif\n"
		   "\n/* name, id, cycle [ms], bytes, CAN FD, first signal, signals, multiplexor, "
		   "DataIDList */\n");
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		put_message(f, &dbc->messages[i]);
	}
	fprintf(f, "\n/* message, name, unit, scale, offset, min, max, first value, values, "
		   "multiplexing, its value, "
		   "start, bits, big endian, signed */\n");
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		const struct dbc_message *m = &dbc->messages[i];
		for (uint32_t k = 0; k < m->n_signals; k++) {
			put_signal(f, m->name, &m->signals[k], n_values);
			n_values += m->signals[k].n_values;
		}
	}
	fprintf(f, "\n/* signal, name, raw, text */\n");
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		const struct dbc_message *m = &dbc->messages[i];
		for (uint32_t k = 0; k < m->n_signals; k++) {
			for (uint32_t v = 0; v < m->signals[k].n_values; v++) {
				put_value(f, m->name, m->signals[k].name, &m->signals[k].values[v]);
			}
		}
	}
	fprintf(f, "\n#undef MESSAGE\n#undef SIGNAL\n#undef VALUE\n");
}

static struct dbc *load(void)
{
	char err[256] = "";
	struct dbc *dbc = NULL;
	if (dbc_load(FILE_DBC, &dbc, err, sizeof(err))) {
		fprintf(stderr, "%s\n", err);
	}
	return dbc;
}

static int generate(void)
{
	struct dbc *dbc = load();
	if (!dbc) {
		return 1;
	}
	put_contract(stdout, dbc);
	dbc_free(dbc);
	return 0;
}

/* ---- tests ------------------------------------------------------------------------------------- */

static void def_is_generated_from_dbc(void **state)
{
	(void)state;
	struct dbc *dbc = load();
	assert_non_null(dbc);
	char *want = NULL;
	size_t want_len = 0;
	FILE *f = open_memstream(&want, &want_len);
	assert_non_null(f);
	put_contract(f, dbc);
	fclose(f);
	dbc_free(dbc);

	char *have = malloc(want_len + 2);
	f = fopen(FILE_DEF, "r");
	assert_non_null(f);
	size_t have_len = fread(have, 1, want_len + 1, f);
	fclose(f);
	assert_int_equal(have_len, want_len);
	assert_memory_equal(have, want, want_len);
	free(have);
	free(want);
}

static void assert_signal_equal(const struct dbc_signal *a, const struct dbc_signal *b)
{
	assert_string_equal(a->name, b->name);
	assert_string_equal(a->unit, b->unit);
	assert_memory_equal(&a->scale, &b->scale, sizeof(double));
	assert_memory_equal(&a->offset, &b->offset, sizeof(double));
	assert_memory_equal(&a->min, &b->min, sizeof(double));
	assert_memory_equal(&a->max, &b->max, sizeof(double));
	assert_int_equal(a->start, b->start);
	assert_int_equal(a->len, b->len);
	assert_int_equal(a->big_endian, b->big_endian);
	assert_int_equal(a->is_signed, b->is_signed);
	assert_int_equal(a->mux, b->mux);
	assert_int_equal(a->mux_value, b->mux_value);
	assert_int_equal(a->n_values, b->n_values);
	for (uint32_t i = 0; i < a->n_values; i++) {
		assert_int_equal(a->values[i].raw, b->values[i].raw);
		assert_string_equal(a->values[i].text, b->values[i].text);
	}
}

static void assert_message_equal(const struct dbc_message *a, const struct dbc_message *b)
{
	assert_string_equal(a->name, b->name);
	assert_int_equal(a->id, b->id);
	assert_int_equal(a->cycle_ms, b->cycle_ms);
	assert_int_equal(a->size, b->size);
	assert_int_equal(a->is_fd, b->is_fd);
	assert_int_equal(a->has_data_id, b->has_data_id);
	assert_memory_equal(a->data_id, b->data_id, DBC_DATA_IDS);
	assert_int_equal(a->mux ? a->mux - a->signals : -1, b->mux ? b->mux - b->signals : -1);
	assert_int_equal(a->n_signals, b->n_signals);
	for (uint32_t i = 0; i < a->n_signals; i++) {
		assert_signal_equal(&a->signals[i], &b->signals[i]);
	}
}

static void table_equals_loaded_file(void **state)
{
	(void)state;
	struct dbc *dbc = load();
	assert_non_null(dbc);
	assert_int_equal(dbc->n_messages, contract.n_messages);
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		assert_message_equal(&dbc->messages[i], &contract.messages[i]);
	}
	assert_true(dbc_hash(dbc) == dbc_hash(&contract));
	dbc_free(dbc);
}

/* Every message: classic, cyclic, protected by a list of its own whose bytes no other message has at that counter. */
static void messages_are_protected_apart(void **state)
{
	(void)state;
	for (uint32_t i = 0; i < contract.n_messages; i++) {
		const struct dbc_message *m = &contract.messages[i];
		assert_int_equal(m->size, 8);
		assert_false(m->is_fd);
		assert_true(m->cycle_ms >= 10);
		assert_true(m->has_data_id);
		assert_string_equal(m->signals[0].name, "CRC");
		assert_int_equal(m->signals[0].start, 0);
		assert_int_equal(m->signals[0].len, 8);
		assert_string_equal(m->signals[1].name, "COUNTER");
		assert_int_equal(m->signals[1].start, 8);
		assert_int_equal(m->signals[1].len, 4);
		for (uint32_t k = 0; k < i; k++) {
			for (int c = 0; c < DBC_DATA_IDS; c++) {
				assert_int_not_equal(m->data_id[c],
						     contract.messages[k].data_id[c]);
			}
		}
	}
}

static unsigned undetected(const struct e2e_config *cfg, const uint8_t good[8], uint64_t flips)
{
	uint8_t bad[8];
	for (int i = 0; i < 8; i++) {
		bad[i] = (uint8_t)(good[i] ^ flips >> 8 * i);
	}
	struct e2e_state st = {0};
	return e2e_check(cfg, &st, bad, 8) != E2E_WRONG_CRC;
}

/* A flipped counter bit changes the byte of the DataIDList that the CRC covers, so that lists can spoil the CRC's Hamming
 * distance of 4. Ours do not: no error of one, two or three bits in the whole frame passes, at any counter. */
static void three_bit_errors_are_found(void **state)
{
	(void)state;
	unsigned passed = 0, tried = 0;
	for (unsigned i = 0; i < 16 * contract.n_messages; i++) {
		const struct e2e_config cfg = {E2E_P2, &contract.messages[i / 16], NULL};
		struct e2e_state tx = {.counter = i % 16};
		uint8_t good[8] = {0};
		e2e_protect(&cfg, &tx, good);
		for (unsigned a = 0; a < 64; a++) {
			passed += undetected(&cfg, good, 1ull << a);
			tried++;
			for (unsigned b = 0; b < a; b++) {
				passed += undetected(&cfg, good, 1ull << a | 1ull << b);
				tried++;
				for (unsigned c = 0; c < b; c++) {
					passed += undetected(&cfg, good,
							     1ull << a | 1ull << b | 1ull << c);
					tried++;
				}
			}
		}
	}
	assert_int_equal(tried, 16 * 5 * (64 + 64 * 63 / 2 + 64 * 63 * 62 / 6));
	assert_int_equal(passed, 0);
}

/* "No data" and "no risk" are different raw values: wherever a not-available value exists it is outside the range. */
static void not_available_is_out_of_range(void **state)
{
	(void)state;
	unsigned found = 0;
	for (int i = 0; i < CONTRACT_SIGNALS; i++) {
		const struct dbc_signal *s = &contract_signal[i];
		uint64_t raw;
		if (!dbc_value_raw(s, "not available", &raw)) {
			found++;
			assert_true(raw == codec_mask(s));
			assert_false(codec_in_range(s, raw));
			assert_true(codec_in_range(s, 0));
		}
	}
	assert_int_equal(found, 23);
}

static void an_empty_frame_asks_for_nothing(void **state)
{
	(void)state;
	uint8_t data[8] = {0};
	assert_int_equal(codec_raw(&contract_signal[AEB_REQUEST_REQUEST], data),
			 AEB_REQUEST_REQUEST_INVALID_LOW);
	assert_int_equal(codec_raw(&contract_signal[AEB_REQUEST_STATE], data),
			 AEB_REQUEST_STATE_INIT);
	assert_int_equal(codec_raw(&contract_signal[AEB_REQUEST_TTL], data), 0);
	assert_int_equal(codec_raw(&contract_signal[AEB_REQUEST_EVAL_ID], data),
			 AEB_REQUEST_EVAL_ID_NONE);
}

/* Bytes worked out by hand from the layout: the contract is what a brake controller was built for. */
static void request_frame_known_answer(void **state)
{
	(void)state;
	uint8_t data[8] = {0};
	assert_int_equal(codec_set_raw(&contract_signal[AEB_REQUEST_REQUEST], data,
				       AEB_REQUEST_REQUEST_BRAKE),
			 0);
	assert_int_equal(
		codec_set_raw(&contract_signal[AEB_REQUEST_STAGE], data, AEB_REQUEST_STAGE_FULL),
		0);
	assert_int_equal(
		codec_set_raw(&contract_signal[AEB_REQUEST_STATE], data, AEB_REQUEST_STATE_BRAKE),
		0);
	assert_int_equal(codec_set_raw(&contract_signal[AEB_REQUEST_P_IS_BOUND], data, 1), 0);
	assert_int_equal(codec_set_phys(&contract_signal[AEB_REQUEST_TTL], data, 150), 0);
	assert_int_equal(codec_set_raw(&contract_signal[AEB_REQUEST_EVAL_ID], data, 0xA5), 0);
	assert_int_equal(codec_set_phys(&contract_signal[AEB_REQUEST_DECEL], data, -6.0), 0);
	assert_int_equal(codec_set_phys(&contract_signal[AEB_REQUEST_P_COLLISION], data, 0.001), 0);
	const struct e2e_config cfg = {E2E_P2, &contract_message[AEB_REQUEST], NULL};
	struct e2e_state st = {0};
	e2e_protect(&cfg, &st, data);
	const uint8_t want[] = {0x00, 0xE0, 0x6A, 0x09, 0xA5, 0x78, 0x40, 0x00};
	assert_memory_equal(data + 1, want + 1, 7);
	const uint8_t covered[] = {0xE0, 0x6A, 0x09, 0xA5, 0x78, 0x40, 0x00, 0xFC};
	assert_int_equal(data[0], e2e_crc8h2f(0, covered, sizeof(covered)));
}

static void positive_acceleration_is_refused(void **state)
{
	(void)state;
	uint8_t data[8] = {0};
	const struct dbc_signal *decel = &contract_signal[AEB_REQUEST_DECEL];
	assert_int_equal(codec_set_phys(decel, data, 0.05), -ERANGE);
	assert_int_equal(codec_set_phys(decel, data, -12.75), -ERANGE);
	assert_int_equal(codec_set_phys(decel, data, -12.7), 0);
	assert_int_equal(codec_raw(decel, data), 254);
}

/* A change of the contract is a change of the hash, and has to be made here knowingly. */
static void hash_is_pinned(void **state)
{
	(void)state;
	assert_int_equal(contract_hash(), 0xd021);
}

int main(int argc, char **argv)
{
	if (argc == 2 && !strcmp(argv[1], "--generate")) {
		return generate();
	}
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(def_is_generated_from_dbc),
		cmocka_unit_test(table_equals_loaded_file),
		cmocka_unit_test(messages_are_protected_apart),
		cmocka_unit_test(three_bit_errors_are_found),
		cmocka_unit_test(not_available_is_out_of_range),
		cmocka_unit_test(an_empty_frame_asks_for_nothing),
		cmocka_unit_test(request_frame_known_answer),
		cmocka_unit_test(positive_acceleration_is_refused),
		cmocka_unit_test(hash_is_pinned),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
