/* SPDX-License-Identifier: MIT
 * Mutations of the shipped DBC files, the same each time: whatever they are turned into is loaded or refused with one
 * line; what loads packs and unpacks within its frame. Meant for the sanitizers.
 */
#include <errno.h>
#include "codec.h"
#include "fuzz.h"

#define MUTANTS 21000 /* of all files */

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
	static struct fuzz z = {20240601, pieces, sizeof(pieces) / sizeof(pieces[0])};
	const uint32_t mutants = fuzz_inputs(MUTANTS, 3);
	char *whole = malloc(FUZZ_TEXT_MAX), *text = malloc(FUZZ_TEXT_MAX);
	uint32_t loaded = 0;

	assert_non_null(whole);
	assert_non_null(text);
	size_t whole_len = fuzz_read(*state, whole);
	for (uint32_t i = 0; i < mutants; i++) {
		memcpy(text, whole, whole_len);
		size_t len = fuzz_mutate(&z, text, whole_len, 4);
		char *exact =
			malloc(len ? len : 1); /* so that a sanitizer sees any read past the end */
		assert_non_null(exact);
		memcpy(exact, text, len);
		loaded += (uint32_t)try(exact, len);
		free(exact);
	}
	free(whole);
	free(text);
	print_message("# %u DBC files: %u loaded, %u refused\n", mutants, loaded, mutants - loaded);
	assert_in_range(loaded, mutants / 10, mutants * 9 / 10);
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
