/* SPDX-License-Identifier: MIT
 * What aebmc doctor makes of a bus: each verdict from what a controller may say; lists of processors.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "../tools/doctor_bus.c"
#include "../tools/doctor_file.c"

/* doctor_table.c wants every check; only those of the bus are here. */
enum doctor_verdict doctor_say(doctor_text is, enum doctor_verdict verdict, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(is, DOCTOR_TEXT_MAX, fmt, ap);
	va_end(ap);
	return verdict;
}

static struct doctor_bus good_bus(void)
{
	const struct link_state l = {.known = 1,
				     .state = "error-active",
				     .bitrate = 500000,
				     .sample_point = 0.875,
				     .restart_ms = 100};

	return (struct doctor_bus){.name = "can0",
				   .there = 1,
				   .up = 1,
				   .window_s = 2,
				   .frames = 100,
				   .before = l,
				   .after = l,
				   .bitrate = 500000,
				   .sample_point = 0.875};
}

typedef enum doctor_verdict check(const struct doctor_bus *b, doctor_text is);

static void expect(check *c, const struct doctor_bus *b, enum doctor_verdict want,
		   const char *words)
{
	doctor_text is;

	assert_int_equal(c(b, is), want);
	assert_non_null(strstr(is, words));
}

static void test_good(void **state)
{
	const struct doctor_bus b = good_bus();

	(void)state;
	expect(doctor_bus_up, &b, DOCTOR_GOOD, "up");
	expect(doctor_bus_frames, &b, DOCTOR_GOOD, "100 frames in 2 s");
	expect(doctor_bus_acknowledged, &b, DOCTOR_GOOD, "error-active");
	expect(doctor_bus_bit_rate, &b, DOCTOR_GOOD, "500000 bit/s");
	expect(doctor_bus_sample_point, &b, DOCTOR_GOOD, "0.875");
	expect(doctor_bus_restart_ms, &b, DOCTOR_GOOD, "100 ms");
}

static void test_up(void **state)
{
	struct doctor_bus b = good_bus();

	(void)state;
	b.up = 0;
	expect(doctor_bus_up, &b, DOCTOR_MISSING, "down");
	expect(doctor_bus_frames, &b, DOCTOR_NONE, "not looked at");
	b.there = 0;
	expect(doctor_bus_up, &b, DOCTOR_MISSING, "no such interface");
}

static void test_frames(void **state)
{
	struct doctor_bus b = good_bus();

	(void)state;
	b.frames = 0;
	expect(doctor_bus_frames, &b, DOCTOR_MISSING, "0 frames in 2 s");
	b.frames = -1;
	expect(doctor_bus_frames, &b, DOCTOR_NONE, "not looked at");
	b = good_bus();
	b.window_s = 0;
	expect(doctor_bus_frames, &b, DOCTOR_NONE, "not looked at");
}

static void test_acknowledged(void **state)
{
	struct doctor_bus b = good_bus();

	(void)state;
	b.before.tx_errors = b.after.tx_errors = 96;
	expect(doctor_bus_acknowledged, &b, DOCTOR_GOOD, "96 to 96");
	b.before.tx_errors = 8;
	b.after.tx_errors = 95;
	expect(doctor_bus_acknowledged, &b, DOCTOR_GOOD, "8 to 95");
	b.after.tx_errors = 96;
	expect(doctor_bus_acknowledged, &b, DOCTOR_MISSING, "8 to 96");
	b.before.tx_errors = b.after.tx_errors = 128;
	b.after.state = "error-passive";
	expect(doctor_bus_acknowledged, &b, DOCTOR_MISSING, "error-passive");
	b = good_bus();
	b.after.state = "bus-off";
	expect(doctor_bus_acknowledged, &b, DOCTOR_MISSING, "bus-off");
	b = good_bus();
	b.after.state = "error-passive"; /* by receiving errors */
	b.after.rx_errors = 130;
	expect(doctor_bus_acknowledged, &b, DOCTOR_GOOD, "error-passive");
}

static void test_bit_rate(void **state)
{
	struct doctor_bus b = good_bus();

	(void)state;
	b.after.bitrate = 250000;
	expect(doctor_bus_bit_rate, &b, DOCTOR_MISSING, "250000 bit/s");
	b.bitrate = 250000;
	expect(doctor_bus_bit_rate, &b, DOCTOR_GOOD, "250000 bit/s");
	b.after.rx_errors = 96;
	expect(doctor_bus_bit_rate, &b, DOCTOR_GOOD, "250000 bit/s");
	b.frames = 0;
	expect(doctor_bus_bit_rate, &b, DOCTOR_MISSING, "errors instead of frames");
}

static void test_sample_point(void **state)
{
	struct doctor_bus b = good_bus();

	(void)state;
	b.after.sample_point = 0.85;
	expect(doctor_bus_sample_point, &b, DOCTOR_GOOD, "0.850");
	b.after.sample_point = 0.8;
	expect(doctor_bus_sample_point, &b, DOCTOR_ADVICE, "0.800");
}

static void test_restart(void **state)
{
	struct doctor_bus b = good_bus();

	(void)state;
	b.after.restart_ms = 0;
	expect(doctor_bus_restart_ms, &b, DOCTOR_MISSING, "0 ms");
}

static void test_virtual(void **state)
{
	struct doctor_bus b = good_bus();

	(void)state;
	b.before = b.after = (struct link_state){.state = "unknown"};
	expect(doctor_bus_acknowledged, &b, DOCTOR_NONE, "virtual");
	expect(doctor_bus_bit_rate, &b, DOCTOR_NONE, "virtual");
	expect(doctor_bus_sample_point, &b, DOCTOR_NONE, "virtual");
	expect(doctor_bus_restart_ms, &b, DOCTOR_NONE, "virtual");
}

static void test_cpus(void **state)
{
	cpu_set_t set = doctor_file_cpus("2-3,5,8-9");

	(void)state;
	assert_int_equal(CPU_COUNT(&set), 5);
	assert_true(CPU_ISSET(2, &set) && CPU_ISSET(3, &set) && CPU_ISSET(5, &set));
	assert_true(CPU_ISSET(8, &set) && CPU_ISSET(9, &set));
	set = doctor_file_cpus("");
	assert_int_equal(CPU_COUNT(&set), 0);
	set = doctor_file_cpus("none");
	assert_int_equal(CPU_COUNT(&set), 0);
	set = doctor_file_cpus("3-1,0-99999999999999999999");
	assert_int_equal(CPU_COUNT(&set), CPU_SETSIZE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_good),     cmocka_unit_test(test_up),
		cmocka_unit_test(test_frames),   cmocka_unit_test(test_acknowledged),
		cmocka_unit_test(test_bit_rate), cmocka_unit_test(test_sample_point),
		cmocka_unit_test(test_restart),  cmocka_unit_test(test_virtual),
		cmocka_unit_test(test_cpus),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
