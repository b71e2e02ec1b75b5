/* SPDX-License-Identifier: MIT
 * candump lines to frames and back.
 */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "bus.h"
#include "clock.h"

#define D8 "1122334455667788"

static const struct {
	const char *line;
	int64_t t_ns;
	const char *iface;
	uint32_t id;
	uint8_t len, flags, first;
} good[] = {
	{"(0000046408.584954) can0 0B4#000000001D0B7A5E R", 46408584954000, "can0", 0xB4, 8, 0, 0},
	{"(1436509052.249713) vcan0 044#2A366C2BBA", 1436509052249713000, "vcan0", 0x44, 5, 0,
	 0x2A},
	{"(1.123456789) can1 7FF#ff T", 1123456789, "can1", 0x7FF, 1, BUS_LOCAL, 0xFF},
	{"  (1.000000)  can0\t12345678#DEAD  R \r", 1000000000, "can0", 0x12345678 | BUS_ID_EFF, 2,
	 0, 0xDE},
	{"(1.000000) can0 00000123#", 1000000000, "can0", 0x123 | BUS_ID_EFF, 0, 0, 0},
	{"(1.000000) can0 123#R", 1000000000, "can0", 0x123, 0, BUS_RTR, 0},
	{"(1.000000) c 123#R0", 1000000000, "c", 0x123, 0, BUS_RTR, 0},
	{"(1.000000) can0 123#R8 R", 1000000000, "can0", 0x123, 8, BUS_RTR, 0},
	{"(1.000000) can0 20000040#0000000000000000", 1000000000, "can0", 0x40, 8, BUS_ERR, 0},
	{"(1.000000) can0 123##0", 1000000000, "can0", 0x123, 0, BUS_FD, 0},
	{"(1.000000) can0 123##3112233445566778899AABBCC", 1000000000, "can0", 0x123, 12,
	 BUS_FD | BUS_BRS | BUS_ESI, 0x11},
	{"(1.000000) can0 123##711", 1000000000, "can0", 0x123, 1, BUS_FD | BUS_BRS | BUS_ESI,
	 0x11},
	{"(1.000000) can0 123##0" D8 D8 D8, 1000000000, "can0", 0x123, 24, BUS_FD, 0x11},
	{"(1.000000) can0 123##0" D8 D8 D8 D8, 1000000000, "can0", 0x123, 32, BUS_FD, 0x11},
	{"(1.000000) can0 123##0" D8 D8 D8 D8 D8 D8, 1000000000, "can0", 0x123, 48, BUS_FD, 0x11},
	{"(1.000000) can0 123##0" D8 D8 D8 D8 D8 D8 D8 D8, 1000000000, "can0", 0x123, 64, BUS_FD,
	 0x11},
	{"(4000000000.999999999) can0 123#", 4000000000999999999, "can0", 0x123, 0, 0, 0},
};

static void good_lines_parse(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
		char name[BUS_NAME_MAX];
		struct bus_frame f;

		print_message("# %s\n", good[i].line);
		assert_int_equal(bus_log_parse(good[i].line, name, &f), 0);
		assert_int_equal(f.t_ns, good[i].t_ns);
		assert_string_equal(name, good[i].iface);
		assert_int_equal(f.id, good[i].id);
		assert_int_equal(f.len, good[i].len);
		assert_int_equal(f.flags, good[i].flags);
		assert_int_equal(f.data[0], good[i].first);
		assert_int_equal(f.iface, 0);
	}
}

static void bad_lines_are_refused(void **state)
{
	static const char *const bad[] = {
		"junk",
		"(",
		"()",
		"(1x.000000) can0 123#00",
		"(1.000000)",
		"(1.000000) can0",
		"(1.000000) can0 123",
		"1.000000 can0 123#00",
		"(1000000) can0 123#00",
		"(1.00000) can0 123#00",
		"(1.0000000) can0 123#00",
		"(1.000000 can0 123#00",
		"(-1.000000) can0 123#00",
		"(.000000) can0 123#00",
		"(4000000001.000000) can0 123#00",
		"(99999999999999999999.000000) can0 123#00",
		"(00000000001.000000) can0 123#00",
		"(1.99999999999999999999) can0 123#00",
		"(1.000000) interface_name_16 123#00",
		"(1.000000) can0 12#00",
		"(1.000000) can0 1234#00",
		"(1.000000) can0 123456789#00",
		"(1.000000) can0 800#00",
		"(1.000000) can0 80000123#00",
		"(1.000000) can0 40000123#00",
		"(1.000000) can0 12G#00",
		"(1.000000) can0 123#0",
		"(1.000000) can0 123#000",
		"(1.000000) can0 123#0G",
		"(1.000000) can0 123#001122334455667788",
		"(1.000000) can0 123#R9",
		"(1.000000) can0 123##",
		"(1.000000) can0 123##G",
		"(1.000000) can0 123##0112233445566778899",
		"(1.000000) can0 123##00",
		"(1.000000) can0 123##0" D8 D8 D8 "11223344",
		"(1.000000) can0 123##0" D8 D8 D8 D8 D8 D8 D8 D8 "11",
		"(1.000000) can0 123###00",
		"(1.000000) can0 123#00 X",
		"(1.000000) can0 123#00 R T",
		"(1.000000) can0 123#00R",
	};

	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		char name[BUS_NAME_MAX];
		struct bus_frame f;

		print_message("# %s\n", bad[i]);
		assert_int_equal(bus_log_parse(bad[i], name, &f), -EBADMSG);
	}
}

static void comments_are_no_frames(void **state)
{
	static const char *const none[] = {"", "   ", "\t\r", "# can0 123#00", "  # note"};

	(void)state;
	for (size_t i = 0; i < sizeof(none) / sizeof(none[0]); i++) {
		char name[BUS_NAME_MAX];
		struct bus_frame f;

		assert_int_equal(bus_log_parse(none[i], name, &f), -ENOMSG);
	}
}

static void lines_are_written_as_candump_does(void **state)
{
	static const struct {
		const char *in, *out;
	} line[] = {
		{"(46408.584954999) can0 0b4#000000001d0b7a5e R",
		 "(0000046408.584954) can0 0B4#000000001D0B7A5E"},
		{"(1.000000) can1 00000123#", "(0000000001.000000) can1 00000123#"},
		{"(1.000000) can1 123#R4", "(0000000001.000000) can1 123#R4"},
		{"(1.000000) can1 123#R", "(0000000001.000000) can1 123#R"},
		{"(1.000000) can1 20000040#00", "(0000000001.000000) can1 20000040#00"},
		{"(1.000000) can1 123##5aa", "(0000000001.000000) can1 123##1AA"},
		{"(1.000000) can1 123##0", "(0000000001.000000) can1 123##0"},
		{"(1.000000) can1 123##2", "(0000000001.000000) can1 123##2"},
	};

	(void)state;
	for (size_t i = 0; i < sizeof(line) / sizeof(line[0]); i++) {
		char name[BUS_NAME_MAX], text[256];
		struct bus_frame f;

		assert_int_equal(bus_log_parse(line[i].in, name, &f), 0);
		assert_int_equal(bus_log_format(&f, name, text, sizeof(text)), strlen(line[i].out));
		assert_string_equal(text, line[i].out);
	}
}

static void longest_frame_fits_the_line(void **state)
{
	struct bus_frame f = {.id = BUS_ID_MASK | BUS_ID_EFF, .len = 64};
	struct bus_frame back;
	char text[200], name[BUS_NAME_MAX];

	(void)state;
	f.flags = BUS_FD | BUS_BRS;
	memset(f.data, 0xA5, sizeof(f.data));
	f.t_ns = 4000000000LL * CLOCK_NS_PER_S;
	assert_in_range(bus_log_format(&f, "interface_nam15", text, sizeof(text)), 150, 199);
	assert_int_equal(bus_log_parse(text, name, &back), 0);
	assert_memory_equal(&f, &back, sizeof(f));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(good_lines_parse),
		cmocka_unit_test(bad_lines_are_refused),
		cmocka_unit_test(comments_are_no_frames),
		cmocka_unit_test(lines_are_written_as_candump_does),
		cmocka_unit_test(longest_frame_fits_the_line),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
