/* SPDX-License-Identifier: MIT
 * Loading DBC files: everything that is read ends up where it belongs, what does not matter is skipped.
 * `test_dbc --driver FILE` is the other end of tests/dbc_cantools.py: it lists the database, then packs and unpacks what
 * standard input asks for.
 */
#include <errno.h>
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>
#include "codec.h"
#include "nearest.h"

/* ---- driver -------------------------------------------------------------------------------------- */

static void list(const struct dbc *dbc)
{
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		const struct dbc_message *m = &dbc->messages[i];
		printf("message %s %" PRIu32 " %u %u %" PRIu32 "\n", m->name, m->id, m->size,
		       m->is_fd, m->cycle_ms);
		for (uint32_t k = 0; k < m->n_signals; k++) {
			const struct dbc_signal *s = &m->signals[k];
			printf("signal %s %u %u %u %u %u %" PRIu32
			       " %.17g %.17g %.17g %.17g %" PRIu32 " %s\n",
			       s->name, s->start, s->len, s->big_endian, s->is_signed, s->mux,
			       s->mux_value, s->scale, s->offset, s->min, s->max, s->n_values,
			       s->unit);
		}
	}
	printf("end\n");
}

static size_t read_hex(const char *hex, uint8_t data[DBC_DATA_MAX])
{
	size_t n = 0;
	while (n < DBC_DATA_MAX && sscanf(hex + 2 * n, "%2hhx", &data[n]) == 1) {
		n++;
	}
	return n;
}

static void print_signals(const struct dbc_message *m, const uint8_t *data)
{
	for (uint32_t i = 0; i < m->n_signals; i++) {
		const struct dbc_signal *s = &m->signals[i];
		uint64_t raw = codec_raw(s, data);
		if (!codec_present(m, s, data)) {
			continue;
		}
		if (s->is_signed) {
			printf("%s=%" PRId64, s->name, codec_int(s, raw));
		} else {
			printf("%s=%" PRIu64, s->name, raw);
		}
		printf("=%.17g ", codec_phys(s, raw));
	}
	printf("\n");
}

/* NAME=NUMBER words into the frame: integers for raw values, numbers for physical ones. */
static void pack(const struct dbc_message *m, int physical, char *words)
{
	uint8_t data[DBC_DATA_MAX] = {0};
	int rc = 0;
	for (char *w = strtok(words, " \n"); w && !rc; w = strtok(NULL, " \n")) {
		char *number = strchr(w, '=');
		*number++ = 0;
		const struct dbc_signal *s = dbc_find_signal(m, w);
		rc = !s             ? -ENOENT
		     : physical     ? codec_set_phys(s, data, strtod(number, NULL))
		     : s->is_signed ? codec_set_int(s, data, strtoll(number, NULL, 10))
				    : codec_set_raw(s, data, strtoull(number, NULL, 10));
	}
	for (int i = 0; !rc && i < m->size; i++) {
		printf("%02x", data[i]);
	}
	printf(rc ? "%d\n" : "\n", rc);
}

static int driver(const char *path)
{
	setvbuf(stdout, NULL, _IOLBF, 0);
	static char line[65536];
	struct dbc *dbc;
	char err[256], what[16], name[DBC_NAME_MAX + 1];
	if (dbc_load(path, &dbc, err, sizeof(err))) {
		printf("error %s\n", err);
		return 1;
	}
	list(dbc);
	while (fgets(line, sizeof(line), stdin)) {
		int at = 0;
		const struct dbc_message *m = sscanf(line, "%15s %128s %n", what, name, &at) == 2
						      ? dbc_find(dbc, name)
						      : NULL;
		if (!m) {
			printf("no such message\n");
		} else if (!strcmp(what, "unpack")) {
			uint8_t data[DBC_DATA_MAX] = {0};
			read_hex(line + at, data);
			print_signals(m, data);
		} else {
			pack(m, !strcmp(what, "physical"), line + at);
		}
	}
	dbc_free(dbc);
	return 0;
}

/* ---- loading ------------------------------------------------------------------------------------- */

static struct dbc *parse(const char *text)
{
	char err[256] = "";
	struct dbc *dbc = NULL;
	if (dbc_parse("test.dbc", text, strlen(text), &dbc, err, sizeof(err))) {
		print_error("%s\n", err);
	}
	assert_non_null(dbc);
	return dbc;
}

static const struct dbc_signal *signal_of(const struct dbc *dbc, const char *msg, const char *sig)
{
	const struct dbc_message *m = dbc_find(dbc, msg);
	assert_non_null(m);
	const struct dbc_signal *s = dbc_find_signal(m, sig);
	assert_non_null(s);
	return s;
}

static const char full_text[] =
	"\xEF\xBB\xBFVERSION \"1.0\n\\\"beta\\\"\"\r\n"
	"NS_ :\n\tNS_DESC_\n\tCM_\n\tBA_DEF_\n\tSG_MUL_VAL_\n\nBS_: 500000 : 1,2\nBU_: ECU1 ECU2\n"
	"VAL_TABLE_ onoff 1 \"on\" 0 \"off\" ;\n\n"
	"BO_ 291 PLAIN: 8 ECU1\n"
	" SG_ A : 0|16@1+ (0.5,-10) [-10|32757.5] \"km/h\" ECU2,ECU1\n"
	" SG_ B:23|12@0-(1E-3,+.5)[0|0]\"\"  ECU2\n"
	"\n"
	"BO_ 2566844926 EXT : 6 Vector__XXX\n"
	" SG_ PAGE M : 0|4@1+ (1,0) [0|15] \"\" Vector__XXX\n"
	" SG_ ONE m0 : 8|8@1- (1,0) [-128|127] \"\xB0\x43\" Vector__XXX\n"
	" SG_ TWO m15 : 8|40@1+ (1,0) [0|0] \"\" Vector__XXX\n"
	"BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n"
	" SG_ LOST : 0|8@1+ (1,0) [0|0] \"\" Vector__XXX\n"
	" SG_ FOUND : 0|8@1+ (1,0) [0|0] \"\" Vector__XXX\n"
	"BO_ 5 BIG: 64 ECU1\n"
	" SG_ LAST : 448|64@1- (1,0) [0|0] \"\" ECU2\n"
	"BO_ 6 EMPTY: 0 ECU1\n"
	"BO_TX_BU_ 291 : ECU1,ECU2;\nEV_ Var: 0 [0|1] \"\" 0 1 DUMMY_NODE_VECTOR0 Vector__XXX;\n"
	"CM_ \"of; the\nfile\";\nCM_ SG_ 291 A \"two\nlines; with \\\"quotes\\\" and BO_ 1 X: 8 "
	"Y\" ;\n"
	"BA_DEF_ \"BusType\" STRING ;\nBA_DEF_ SG_ \"GenSigStartValue\" INT 0 1;\n"
	"BA_DEF_ BO_  \"GenMsgCycleTime\" INT 0 10000;\n"
	"BA_DEF_ BO_  \"VFrameFormat\" ENUM  "
	"\"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"StandardCAN_FD\";\n"
	"BA_DEF_ BO_ \"E2EDataIDList\" STRING ;\n"
	"BA_DEF_DEF_ \"BusType\" \"CAN\";\nBA_DEF_DEF_ \"GenMsgCycleTime\" 100;\n"
	"BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\nBA_DEF_DEF_ \"E2EDataIDList\" \"\";\n"
	"BA_ \"BusType\" \"CAN FD\";\nBA_ \"GenMsgCycleTime\" BO_ 291 20;\nBA_ \"GenMsgCycleTime\" "
	"BO_ 6 0;\n"
	"BA_ \"VFrameFormat\" BO_ 5 3;\nBA_ \"VFrameFormat\" BO_ 6 \"StandardCAN_FD\";\n"
	"BA_ \"GenSigStartValue\" SG_ 291 A 0;\n"
	"BA_ \"E2EDataIDList\" BO_ 291 \"00 01 02 03 04 05 06 07 08 09 0a 0B 0C 0D 0E fF\";\n"
	"VAL_ 291 A 65535 \"not available\" 65534 \"error\" ;\n"
	"VAL_ 2566844926 ONE -1 \"minus\" 127 \"top\" 255 \"same bits\" 300 \"never\" -129 "
	"\"never\" ;\n"
	"VAL_ Var 1 \"on\" ;\nVAL_ 3221225472 LOST 1 \"x\" ;\n"
	"SIG_GROUP_ 291 G 1 : A B;\nSIG_VALTYPE_ 291 A : 0;\nSIG_VALTYPE_ 291 B 0;\n";

static void messages_as_written(void **state)
{
	(void)state;
	struct dbc *dbc = parse(full_text);
	assert_int_equal(dbc->n_messages, 4);
	const struct dbc_message *m = dbc_find_id(dbc, 291);
	assert_ptr_equal(m, dbc_find(dbc, "PLAIN"));
	assert_int_equal(m->size, 8);
	assert_int_equal(m->cycle_ms, 20);
	assert_false(m->is_fd);
	assert_null(m->mux);
	assert_true(m->has_data_id);
	assert_int_equal(m->data_id[10], 0x0A);
	assert_int_equal(m->data_id[15], 0xFF);
	m = dbc_find(dbc, "EXT");
	assert_int_equal(m->id, DBC_ID_EXTENDED | 0x18FEF1FE);
	assert_int_equal(m->cycle_ms, 100);
	assert_false(m->has_data_id);
	m = dbc_find(dbc, "BIG");
	assert_int_equal(m->size, 64);
	assert_true(m->is_fd);
	m = dbc_find(dbc, "EMPTY");
	assert_true(m->is_fd);
	assert_int_equal(m->cycle_ms, 0);
	assert_null(dbc_find(dbc, "VECTOR__INDEPENDENT_SIG_MSG"));
	assert_null(dbc_find(dbc, "plain"));
	assert_null(dbc_find_id(dbc, 292));
	dbc_free(dbc);
}

static void signals_as_written(void **state)
{
	(void)state;
	struct dbc *dbc = parse(full_text);
	const struct dbc_signal *a = signal_of(dbc, "PLAIN", "A"),
				*b = signal_of(dbc, "PLAIN", "B");
	assert_string_equal(a->unit, "km/h");
	assert_true(a->scale == 0.5 && a->offset == -10 && a->min == -10 && a->max == 32757.5);
	assert_int_equal(a->start, 0);
	assert_int_equal(a->len, 16);
	assert_false(a->big_endian || a->is_signed);
	assert_true(b->scale == 1e-3 && b->offset == 0.5 && b->min == 0 && b->max == 0);
	assert_int_equal(b->start, 23);
	assert_int_equal(b->len, 12);
	assert_true(b->big_endian && b->is_signed);
	assert_null(dbc_find_signal(dbc_find(dbc, "PLAIN"), "ONE"));
	const struct dbc_message *m = dbc_find(dbc, "EXT");
	assert_ptr_equal(m->mux, &m->signals[0]);
	assert_int_equal(m->signals[1].mux, DBC_MULTIPLEXED);
	assert_int_equal(m->signals[1].mux_value, 0);
	assert_int_equal(m->signals[2].mux_value, 15);
	dbc_free(dbc);
}

static void values_as_written(void **state)
{
	(void)state;
	struct dbc *dbc = parse(full_text);
	const struct dbc_signal *a = signal_of(dbc, "PLAIN", "A"),
				*one = signal_of(dbc, "EXT", "ONE");
	uint64_t raw = 7;
	assert_string_equal(dbc_value_text(a, 65535), "not available");
	assert_null(dbc_value_text(a, 0));
	assert_int_equal(dbc_value_raw(a, "error", &raw), 0);
	assert_int_equal(raw, 65534);
	assert_int_equal(dbc_value_raw(a, "Error", &raw), -ENOENT);
	assert_int_equal(raw, 65534);
	assert_int_equal(one->n_values, 3);
	assert_string_equal(dbc_value_text(one, 255), "minus");
	assert_int_equal(dbc_value_raw(one, "same bits", &raw), 0);
	assert_int_equal(raw, 255);
	dbc_free(dbc);
}

#define BYTE(name, mux, at) " SG_ " name " " mux ": " at "|8@1+ (1,0) [0|0] \"\" X\n"

static void limits_are_within(void **state)
{
	(void)state;
	static const char *const size[] = {"0", "8", "12", "16", "20", "24", "32", "48", "64"};
	struct dbc *dbc;
	for (size_t i = 0; i < sizeof(size) / sizeof(size[0]); i++) {
		char text[64];
		snprintf(text, sizeof(text), "BO_ 1 M: %s X\n", size[i]);
		dbc = parse(text);
		assert_int_equal(dbc->messages[0].size, atoi(size[i]));
		assert_int_equal(dbc->messages[0].is_fd, i > 1); /* no other frame is so long */
		dbc_free(dbc);
	}
	dbc = parse("NS_ :\n\tCM_\nBU_: X\n"
		    "BO_ 2047 STD: 8 X\n" BYTE(
			    "A", "M",
			    "0") "BO_ 2684354559 EXT: 8 X\n"
				 " SG_ M M : 0|32@1+ (1,0) [0|0] \"\" X\n" BYTE(
					 "LAST", "m4294967295",
					 "32") "BA_DEF_ BO_ \"VFrameFormat\" ENUM\"A_FD\",\"B\";\n"
					       "BA_ \"VFrameFormat\" BO_ 2047 0;\n"
					       "BA_ \"GenMsgCycleTime\" BO_ 2047 4294967295;\n");
	assert_int_equal(dbc->n_messages, 2);
	assert_int_equal(dbc_find(dbc, "STD")->is_fd, 1);
	assert_true(dbc_find(dbc, "STD")->cycle_ms == UINT32_MAX);
	assert_true(signal_of(dbc, "EXT", "LAST")->mux_value == UINT32_MAX);
	dbc_free(dbc);
}

/* The bytes that a message's signals take say nothing of the next one's. */
static void signals_of_two_messages_do_not_overlap(void **state)
{
	(void)state;
	dbc_free(parse("BO_ 1 M: 8 X\n" BYTE("A", "", "8") BYTE("B", "", "16") BYTE(
		"C", "", "0") "BO_ 2 N: 8 X\n" BYTE("A", "", "8") BYTE("B", "", "0")));
}

static void values_end_where_the_signal_does(void **state)
{
	(void)state;
	struct dbc *dbc = parse("BO_ 1 M: 8 X\n SG_ S : 0|8@1- (1,0) [0|0] \"\" X\n"
				" SG_ U : 8|8@1+ (1,0) [0|0] \"\" X\n"
				"VAL_ 1 S -128 \"bottom\" -129 \"never\" ;\n"
				"VAL_ 1 U -1 \"never\" 255 \"top\" ;\n");
	const struct dbc_signal *s = signal_of(dbc, "M", "S"), *u = signal_of(dbc, "M", "U");
	assert_int_equal(s->n_values, 1);
	assert_string_equal(dbc_value_text(s, 128), "bottom");
	assert_int_equal(u->n_values, 1);
	assert_string_equal(dbc_value_text(u, 255), "top");
	dbc_free(dbc);
}

static void shipped_files_load(void **state)
{
	(void)state;
	static const struct {
		const char *path;
		uint32_t messages;
	} files[] = {
		{"can-dbc/aebmc.dbc", 5},
		{"can-dbc/vehicles/generic.dbc", 3},
		{"can-dbc/vehicles/toyota-tss-p.dbc", 18},
	};
	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
		char err[256] = "";
		struct dbc *dbc = NULL;
		assert_int_equal(dbc_load(files[i].path, &dbc, err, sizeof(err)), 0);
		assert_string_equal(err, "");
		assert_int_equal(dbc->n_messages, files[i].messages);
		dbc_free(dbc);
	}
	dbc_free(NULL);
}

static void recorded_frames_decode(void **state)
{
	(void)state;
	char err[256];
	struct dbc *dbc = NULL;
	assert_int_equal(dbc_load("can-dbc/vehicles/toyota-tss-p.dbc", &dbc, err, sizeof(err)), 0);
	const uint8_t speed[] = {0, 0, 0, 0, 0x1D, 0x0B, 0x7A, 0x5E};
	const struct dbc_signal *s = signal_of(dbc, "SPEED", "SPEED");
	assert_true(codec_phys(s, codec_raw(s, speed)) == 2938 * 0.01);
	const uint8_t track[] = {0x93, 0x38, 0x26, 0x08, 0xAC, 0x09, 0x01, 0xC9};
	static const struct {
		const char *name;
		double value;
	} want[] = {{"COUNTER", 147}, {"LONG_DIST", 1796 * 0.04}, {"LAT_DIST", 69 * 0.04},
		    {"NEW_TRACK", 0}, {"REL_SPEED", 0.025 * 144}, {"VALID", 1},
		    {"CHECKSUM", 201}};
	for (size_t i = 0; i < sizeof(want) / sizeof(want[0]); i++) {
		s = signal_of(dbc, "TRACK_A_0", want[i].name);
		assert_true(codec_phys(s, codec_raw(s, track)) == want[i].value);
	}
	dbc_free(dbc);
}

/* ---- names --------------------------------------------------------------------------------------- */

static void distances(void **state)
{
	(void)state;
	char longer[300];
	memset(longer, 'x', sizeof(longer) - 1);
	longer[sizeof(longer) - 1] = 0;
	assert_int_equal(nearest_distance("", ""), 0);
	assert_int_equal(nearest_distance("", "abc"), 3);
	assert_int_equal(nearest_distance("abc", ""), 3);
	assert_int_equal(nearest_distance("Speed", "SPEED"), 0);
	assert_int_equal(nearest_distance("kitten", "sitting"), 3);
	assert_int_equal(nearest_distance("SPED", "SPEED"), 1);
	assert_int_equal(nearest_distance(longer, ""), NEAREST_LEN);
	assert_int_equal(nearest_distance(longer, longer), 0);
}

static void nearest_names(void **state)
{
	(void)state;
	struct dbc *dbc = parse(full_text);
	assert_string_equal(dbc_nearest(dbc, NULL, "PLANE"), "PLAIN");
	assert_string_equal(dbc_nearest(dbc, dbc_find(dbc, "EXT"), "tow"), "TWO");
	assert_string_equal(dbc_nearest(dbc, dbc_find(dbc, "EMPTY"), "tow"), "");
	dbc_free(dbc);
	dbc = parse("BO_ 1 AB: 8 X\nBO_ 2 AC: 8 X\n");
	assert_string_equal(dbc_nearest(dbc, NULL, "AD"), "AB"); /* the first of equals */
	dbc_free(dbc);
}

/* FNV-1a over what the header lists, computed by another program. */
static void hash_has_a_known_answer(void **state)
{
	(void)state;
	struct dbc *dbc =
		parse("BO_ 1 MSG: 8 X\n SG_ A : 0|8@1+ (0.5,-3) [1|9] \"m\" X\n"
		      " SG_ B : 15|8@0- (1,0) [0|0] \"s\" X\nBO_ 2 N: 4 X\n"
		      "BA_ \"GenMsgCycleTime\" BO_ 1 20;\nVAL_ 1 A 1 \"a\" 2 \"b\" ;\n"
		      "BA_ \"E2EDataIDList\" BO_ 1 \"1 2 3 4 5 6 7 8 9 a b c d e f 10\";\n");
	uint64_t raw;
	const struct dbc_signal *a = dbc_find_signal(dbc_find(dbc, "MSG"), "A");
	assert_true(dbc_hash(dbc) == 0xa64bca5fcb60e1a2);
	assert_string_equal(dbc_value_text(a, 2), "b");
	assert_null(dbc_value_text(a, 3));
	assert_int_equal(dbc_value_raw(a, "a", &raw), 0);
	assert_int_equal(raw, 1);
	dbc_free(dbc);
}

/* Every field that a reader of a frame relies on changes the hash. */
static void hash_sees_content(void **state)
{
	(void)state;
	static const char *const variants[] = {
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\n",
		"BO_ 2 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\n",
		"BO_ 1 N: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 7 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ T : 0|8@1+ (1,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 1|8@1+ (1,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|7@1+ (1,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 7|8@0+ (1,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1- (1,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (2,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,1) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [-1|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|1] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"s\" X\n",
		"BO_ 1 M: 8 X\n SG_ S M : 0|8@1+ (1,0) [0|0] \"m\" X\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\nVAL_ 1 S 1 \"a\" ;\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\nVAL_ 1 S 1 \"b\" ;\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\nVAL_ 1 S 2 \"a\" ;\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\nBA_ \"GenMsgCycleTime\" BO_ 1 "
		"5;\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\nBA_ \"VFrameFormat\" BO_ 1 "
		"\"StandardCAN_FD\";\n",
		"BO_ 1 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"m\" X\n"
		"BA_ \"E2EDataIDList\" BO_ 1 \"1 2 3 4 5 6 7 8 9 a b c d e f 10\";\n",
	};
	enum { N = sizeof(variants) / sizeof(variants[0]) };
	uint64_t hash[N];
	for (size_t i = 0; i < N; i++) {
		struct dbc *dbc = parse(variants[i]);
		hash[i] = dbc_hash(dbc);
		dbc_free(dbc);
		for (size_t k = 0; k < i; k++) {
			assert_true(hash[i] != hash[k]);
		}
	}
}

int main(int argc, char **argv)
{
	if (argc == 3 && !strcmp(argv[1], "--driver")) {
		return driver(argv[2]);
	}
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(messages_as_written),
		cmocka_unit_test(signals_as_written),
		cmocka_unit_test(values_as_written),
		cmocka_unit_test(values_end_where_the_signal_does),
		cmocka_unit_test(limits_are_within),
		cmocka_unit_test(signals_of_two_messages_do_not_overlap),
		cmocka_unit_test(shipped_files_load),
		cmocka_unit_test(recorded_frames_decode),
		cmocka_unit_test(distances),
		cmocka_unit_test(nearest_names),
		cmocka_unit_test(hash_has_a_known_answer),
		cmocka_unit_test(hash_sees_content),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
