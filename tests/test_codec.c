/* SPDX-License-Identifier: MIT
 * Signals into and out of frames: every place and length in both byte orders against plain 64-bit shifts, the limits of
 * integers and physical values, multiplexing.
 */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>
#include "codec.h"

/* splitmix64: any bits will do, the same each time. */
static uint64_t random_bits(uint64_t *seed)
{
	uint64_t z = *seed += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

static uint64_t load_le(const uint8_t d[8])
{
	uint64_t v = 0;
	for (int i = 7; i >= 0; i--) {
		v = v << 8 | d[i];
	}
	return v;
}

static uint64_t load_be(const uint8_t d[8])
{
	uint64_t v = 0;
	for (int i = 0; i < 8; i++) {
		v = v << 8 | d[i];
	}
	return v;
}

/* The signal of @len bits whose LSB is bit @shift of the frame read as one number of its byte order. */
static struct dbc_signal place(int big_endian, unsigned shift, unsigned len)
{
	struct dbc_signal s = {.scale = 1, .len = (uint8_t)len, .big_endian = (uint8_t)big_endian};
	unsigned msb = shift + len - 1;
	s.start = (uint16_t)(big_endian ? (7 - msb / 8) * 8 + msb % 8 : shift);
	return s;
}

static void every_place_and_length(void **state)
{
	(void)state;
	uint64_t seed = 1;
	for (int big = 0; big <= 1; big++) {
		for (unsigned shift = 0; shift < 64; shift++) {
			for (unsigned len = 1; len <= 64 - shift; len++) {
				struct dbc_signal s = place(big, shift, len);
				uint64_t mask = codec_mask(&s), raw = random_bits(&seed) & mask;
				uint64_t noise = random_bits(&seed);
				uint8_t data[8];
				memcpy(data, &noise, 8);
				uint64_t before = big ? load_be(data) : load_le(data);
				assert_true(codec_raw(&s, data) == (before >> shift & mask));
				assert_int_equal(codec_set_raw(&s, data, raw), 0);
				uint64_t after = big ? load_be(data) : load_le(data);
				assert_true(after == ((before & ~(mask << shift)) | raw << shift));
				assert_true(codec_raw(&s, data) == raw);
			}
		}
	}
}

/* Start bits as a DBC gives them, worked out by hand: big-endian ones count from the most significant bit. */
static void known_places(void **state)
{
	(void)state;
	const uint8_t data[] = {0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0};
	static const struct {
		struct dbc_signal s;
		uint64_t raw;
	} kat[] = {
		{{.start = 0, .len = 16}, 0x3412},
		{{.start = 4, .len = 8}, 0x41},
		{{.start = 7, .len = 16, .big_endian = 1}, 0x1234},
		{{.start = 3, .len = 8, .big_endian = 1}, 0x23},
		{{.start = 47, .len = 16, .big_endian = 1}, 0xBCDE},
		{{.start = 15, .len = 13, .big_endian = 1}, 0x3456 >> 3},
		{{.start = 63, .len = 8, .big_endian = 1}, 0xF0},
		{{.start = 0, .len = 64}, 0xF0DEBC9A78563412},
		{{.start = 7, .len = 64, .big_endian = 1}, 0x123456789ABCDEF0},
	};
	for (size_t i = 0; i < sizeof(kat) / sizeof(kat[0]); i++) {
		assert_true(codec_raw(&kat[i].s, data) == kat[i].raw);
	}
}

static void last_bits_of_an_fd_frame(void **state)
{
	(void)state;
	uint8_t data[64] = {0};
	const struct dbc_signal le = {.scale = 1, .start = 448, .len = 64};
	const struct dbc_signal be = {.scale = 1, .start = 455, .len = 64, .big_endian = 1};
	assert_int_equal(codec_set_raw(&le, data, 0x0102030405060708), 0);
	assert_int_equal(data[63], 0x01);
	assert_int_equal(codec_set_raw(&be, data, 0x0102030405060708), 0);
	assert_int_equal(data[63], 0x08);
	assert_true(codec_raw(&be, data) == 0x0102030405060708);
}

static void too_large_raw_is_refused(void **state)
{
	(void)state;
	uint8_t data[8] = {0}, zero[8] = {0};
	const struct dbc_signal s = {.scale = 1, .start = 3, .len = 12};
	assert_int_equal(codec_set_raw(&s, data, 0x1000), -ERANGE);
	assert_int_equal(codec_set_raw(&s, data, UINT64_MAX), -ERANGE);
	assert_memory_equal(data, zero, 8);
	assert_int_equal(codec_set_raw(&s, data, 0xFFF), 0);
	assert_int_equal(codec_raw(&s, data), 0xFFF);
}

static void integers_are_exact(void **state)
{
	(void)state;
	for (unsigned len = 1; len <= 64; len++) {
		uint8_t data[8] = {0};
		struct dbc_signal s = {.scale = 1, .len = (uint8_t)len, .is_signed = 1};
		int64_t low = (int64_t)(UINT64_MAX << (len - 1)), high = ~low;
		assert_int_equal(codec_set_int(&s, data, low), 0);
		assert_true(codec_int(&s, codec_raw(&s, data)) == low);
		assert_int_equal(codec_set_int(&s, data, high), 0);
		assert_true(codec_int(&s, codec_raw(&s, data)) == high);
		if (len < 64) {
			assert_int_equal(codec_set_int(&s, data, high + 1), -ERANGE);
			assert_int_equal(codec_set_int(&s, data, low - 1), -ERANGE);
			assert_true(codec_int(&s, codec_raw(&s, data)) == high);
		}
		s.is_signed = 0;
		assert_int_equal(codec_set_int(&s, data, -1), -ERANGE);
		assert_int_equal(codec_set_int(&s, data, INT64_MIN), -ERANGE);
		assert_int_equal(codec_set_int(&s, data, high), 0);
		assert_true(codec_int(&s, codec_raw(&s, data)) == high);
	}
}

static void physical_values(void **state)
{
	(void)state;
	const struct dbc_signal wheel = {
		.scale = 0.01, .offset = -67.67, .start = 6, .len = 15, .big_endian = 1};
	const uint8_t rest[] = {0x1A, 0x6F, 0, 0, 0, 0, 0, 0};
	assert_true(fabs(codec_phys(&wheel, codec_raw(&wheel, rest))) < 1e-12);
	const struct dbc_signal speed = {.scale = 0.025, .len = 12, .is_signed = 1};
	assert_true(codec_phys(&speed, 0xFFF) == -0.025);
	assert_true(codec_phys(&speed, 0x800) == -2048 * 0.025);
	const struct dbc_signal wide = {.scale = 1, .len = 64};
	assert_true(codec_phys(&wide, UINT64_MAX) == 0x1p64);
}

/* Whatever is written comes back as the nearest step; ties go up. */
static void rounding(void **state)
{
	(void)state;
	uint8_t data[8] = {0};
	const struct dbc_signal s = {.scale = 0.5, .offset = -8, .len = 5, .is_signed = 0};
	static const struct {
		double value;
		uint64_t raw;
	} kat[] = {{-8, 0},     {-7.76, 0}, {-7.75, 1}, {-7.51, 1}, {0, 16},
		   {0.249, 16}, {0.25, 17}, {7.5, 31},  {7.74, 31}};
	for (size_t i = 0; i < sizeof(kat) / sizeof(kat[0]); i++) {
		assert_int_equal(codec_set_phys(&s, data, kat[i].value), 0);
		assert_int_equal(codec_raw(&s, data), kat[i].raw);
	}
	const struct dbc_signal t = {.scale = 1, .len = 8, .is_signed = 1};
	assert_int_equal(codec_set_phys(&t, data, -2.5), 0);
	assert_true(codec_int(&t, codec_raw(&t, data)) == -2);
	assert_int_equal(codec_set_phys(&t, data, 0.49999999999999994), 0);
	assert_int_equal(codec_raw(&t, data), 0);
}

static void physical_limits(void **state)
{
	(void)state;
	static const double bad[] = {7.75, -8.26, 1e300, -1e300, INFINITY, -INFINITY, NAN};
	uint8_t data[8] = {0x5A};
	const struct dbc_signal s = {.scale = 0.5, .offset = -8, .len = 5};
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		assert_int_equal(codec_set_phys(&s, data, bad[i]), -ERANGE);
		assert_int_equal(data[0], 0x5A);
	}
	const struct dbc_signal u64 = {.scale = 1, .len = 64},
				i64 = {.scale = 1, .len = 64, .is_signed = 1};
	assert_int_equal(codec_set_phys(&u64, data, 0x1p64), -ERANGE);
	assert_int_equal(codec_set_phys(&u64, data, nextafter(0x1p64, 0)), 0);
	assert_true(codec_raw(&u64, data) == 0xFFFFFFFFFFFFF800);
	const struct dbc_signal i8 = {.scale = 1, .len = 8, .is_signed = 1};
	assert_int_equal(codec_set_phys(&i8, data, -128), 0);
	assert_int_equal(codec_set_phys(&i8, data, -129), -ERANGE);
	assert_int_equal(codec_set_phys(&i64, data, 0x1p63), -ERANGE);
	assert_int_equal(codec_set_phys(&i64, data, -0x1p63), 0);
	assert_true(codec_int(&i64, codec_raw(&i64, data)) == INT64_MIN);
}

static void range_of_the_file(void **state)
{
	(void)state;
	uint8_t data[8] = {0};
	const struct dbc_signal s = {.scale = -0.05, .min = -12.7, .max = 0, .len = 8};
	for (unsigned raw = 0; raw < 255; raw++) {
		assert_true(codec_in_range(&s, raw));
	}
	assert_false(codec_in_range(&s, 255));
	assert_int_equal(codec_set_phys(&s, data, -12.7), 0);
	assert_int_equal(codec_set_phys(&s, data, -12.75), -ERANGE);
	const struct dbc_signal half = {.scale = 2, .offset = -1, .min = 0, .max = 253, .len = 8};
	assert_true(codec_in_range(&half, 0)); /* just half a step outside */
	assert_true(codec_in_range(&half, 127));
	assert_false(codec_in_range(&half, 128));
	const struct dbc_signal none = {.scale = 1, .len = 8};
	assert_true(codec_in_range(&none, 255));
	const struct dbc_signal all = {
		.scale = 1, .min = 0, .max = 18446744073709551615.0, .len = 64};
	assert_true(codec_in_range(&all, UINT64_MAX));
}

static void multiplexed_signals(void **state)
{
	(void)state;
	const struct dbc_signal signals[] = {
		{.scale = 1, .start = 0, .len = 4, .mux = DBC_MULTIPLEXOR},
		{.scale = 1, .start = 8, .len = 8, .mux = DBC_MULTIPLEXED, .mux_value = 3},
		{.scale = 1, .start = 16, .len = 8},
	};
	const struct dbc_message m = {
		.size = 8, .signals = signals, .mux = &signals[0], .n_signals = 3};
	for (uint8_t page = 0; page < 16; page++) {
		const uint8_t data[8] = {page};
		assert_int_equal(codec_present(&m, &signals[0], data), 1);
		assert_int_equal(codec_present(&m, &signals[1], data), page == 3);
		assert_int_equal(codec_present(&m, &signals[2], data), 1);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_place_and_length),
		cmocka_unit_test(known_places),
		cmocka_unit_test(last_bits_of_an_fd_frame),
		cmocka_unit_test(too_large_raw_is_refused),
		cmocka_unit_test(integers_are_exact),
		cmocka_unit_test(physical_values),
		cmocka_unit_test(rounding),
		cmocka_unit_test(physical_limits),
		cmocka_unit_test(range_of_the_file),
		cmocka_unit_test(multiplexed_signals),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
