/* SPDX-License-Identifier: MIT
 * Mutations of the shipped DBC files, the same each time: whatever they are turned into is loaded or refused with one
 * line; what loads packs and unpacks within its frame. Meant for the sanitizers.
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

#define MUTANTS_PER_FILE 7000
#define TEXT_MAX         (1 << 16)

static uint64_t seed = 20240601;

static uint32_t pick(uint32_t n)
{
	seed = seed * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)((seed >> 33) % n);
}

/* What a DBC is made of, and what it should not be. */
static const char *const pieces[] = {
	"BO_ ",
	"SG_ ",
	"VAL_ ",
	"BA_ ",
	"CM_ ",
	"BA_DEF_ ",
	"NS_ :",
	"SG_MUL_VAL_ ",
	" M ",
	" m0 ",
	" m1M ",
	"\"",
	";",
	"|",
	"@0-",
	"@1+",
	"(0,0)",
	"(nan,inf)",
	"[1|0]",
	"\n",
	"\r\n",
	"4294967295",
	"-1",
	"64",
	"18446744073709551615",
	"1e308",
	"\\\"",
	"\xff",
	"8|64@0",
	":",
	"3221225472",
	"BA_DEF_DEF_ ",
	"\"VFrameFormat\"",
	"ENUM ",
	",",
	"E2EDataIDList",
};

static size_t read_text(const char *path, char *text)
{
	FILE *f = fopen(path, "r");
	assert_non_null(f);
	size_t n = fread(text, 1, TEXT_MAX / 2, f);
	assert_true(feof(f));
	fclose(f);
	return n;
}

/* Replaces @old bytes at @at by @new ones. */
static size_t splice(char *text, size_t len, size_t at, size_t old, const char *bytes, size_t new)
{
	memmove(text + at + new, text + at + old, len - at - old);
	memcpy(text + at, bytes, new);
	return len - old + new;
}

static size_t mutate(char *text, size_t len)
{
	char copy[64];
	size_t at = pick((uint32_t)len), rest = len - at;
	size_t some = 1 + pick(rest < sizeof(copy) ? (uint32_t)rest : sizeof(copy));
	some = some < rest ? some : rest;
	const char *piece = pieces[pick(sizeof(pieces) / sizeof(pieces[0]))];
	switch (pick(6)) {
	case 0: /* flip a bit */
		text[at] ^= (char)(1 << pick(8));
		return len;
	case 1: /* another digit, where there is one nearby */
		at += strcspn(text + at, "0123456789");
		if (at < len) {
			text[at] = (char)('0' + pick(10));
		}
		return len;
	case 2: /* remove */
		return splice(text, len, at, some, "", 0);
	case 3: /* repeat elsewhere */
		memcpy(copy, text + at, some);
		return splice(text, len, pick((uint32_t)len), 0, copy, some);
	case 4: /* insert or replace by a piece */
		return splice(text, len, at, pick(2) ? some : 0, piece, strlen(piece));
	default: /* cut off */
		return pick(8) ? len : at + 1;
	}
}

/* All signals of a message through a buffer of just its size. */
static void exercise(const struct dbc_message *m)
{
	uint8_t *data = malloc(m->size ? m->size : 1u);
	assert_non_null(data);
	memset(data, 0xA5, m->size);
	for (uint32_t i = 0; i < m->n_signals; i++) {
		const struct dbc_signal *s = &m->signals[i];
		uint64_t raw = codec_raw(s, data);
		assert_int_equal(codec_set_raw(s, data, raw ^ codec_mask(s)), 0);
		assert_true(codec_raw(s, data) == (raw ^ codec_mask(s)));
		codec_set_phys(s, data, codec_phys(s, raw));
		codec_present(m, s, data);
	}
	free(data);
}

static int try(const char *text, size_t len)
{
	char err[160] = "";
	struct dbc *dbc = NULL;
	int rc = dbc_parse("fuzz.dbc", text, len, &dbc, err, sizeof(err));
	if (rc) {
		assert_true(rc == -EINVAL || rc == -ENOTSUP);
		assert_int_equal(strncmp(err, "fuzz.dbc:", 9), 0);
		assert_null(strchr(err, '\n'));
		assert_null(dbc);
		return 0;
	}
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		exercise(&dbc->messages[i]);
	}
	dbc_free(dbc);
	return 1;
}

static void mutants_load_or_are_refused(void **state)
{
	const char *path = *state;
	char *whole = malloc(TEXT_MAX), *text = malloc(TEXT_MAX);
	assert_non_null(whole);
	assert_non_null(text);
	size_t whole_len = read_text(path, whole);
	unsigned loaded = 0;
	for (int i = 0; i < MUTANTS_PER_FILE; i++) {
		memcpy(text, whole, whole_len);
		size_t len = whole_len;
		for (uint32_t k = 1 + pick(4); k && len; k--) {
			text[len] = 0;
			len = mutate(text, len);
		}
		char *exact =
			malloc(len ? len : 1); /* so that a sanitizer sees any read past the end */
		assert_non_null(exact);
		memcpy(exact, text, len);
		loaded += (unsigned)try(exact, len);
		free(exact);
	}
	free(whole);
	free(text);
	assert_in_range(loaded, MUTANTS_PER_FILE / 10, MUTANTS_PER_FILE * 9 / 10);
}

int main(void)
{
	static char contract[] = "can-dbc/aebmc.dbc", generic[] = "can-dbc/vehicles/generic.dbc",
		    toyota[] = "can-dbc/vehicles/toyota-tss-p.dbc";
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(mutants_load_or_are_refused, contract),
		cmocka_unit_test_prestate(mutants_load_or_are_refused, generic),
		cmocka_unit_test_prestate(mutants_load_or_are_refused, toyota),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
