/* SPDX-License-Identifier: MIT
 * The log bus: virtual time, and what a hostile log does to it.
 */
#include <errno.h>
#include <string.h>
#include "log_file.h"

#define MS CLOCK_NS_PER_MS

static void virtual_time_stops_at_every_deadline(void **state)
{
	static const char text[] = "(100.000000) can0 001#\n"
				   "(100.000000) can1 002#\n"
				   "(100.030000) can0 003#\n";
	struct bus *b = log_open(text, strlen(text), NULL);
	struct bus_frame f[8];
	int64_t now = -1, t0 = 100 * CLOCK_NS_PER_S;

	(void)state;
	/* the first call sets the clock, whatever its deadline */
	assert_int_equal(b->ops->recv(b, f, 8, 0, &now), 2);
	assert_int_equal(now, t0);
	assert_int_equal(f[0].iface, 0);
	assert_int_equal(f[1].iface, 1);
	assert_int_equal(f[1].id, 2);
	assert_int_equal(b->ops->recv(b, f, 8, t0 + 20 * MS, &now), 0);
	assert_int_equal(now, t0 + 20 * MS);
	assert_int_equal(b->ops->recv(b, f, 8, t0 + 10 * MS, &now), 0);
	assert_int_equal(now, t0 + 20 * MS); /* never backwards */
	assert_int_equal(b->ops->recv(b, f, 8, t0 + 40 * MS, &now), 1);
	assert_int_equal(now, t0 + 30 * MS);
	assert_int_equal(f[0].t_ns, now);
	now = 0;
	assert_int_equal(b->ops->recv(b, f, 8, t0 + 40 * MS, &now), -ENODATA);
	assert_int_equal(now, t0 + 30 * MS); /* it ends with the last frame */
	assert_int_equal(b->ops->recv(b, f, 8, t0 + 40 * MS, &now), -ENODATA);
	assert_int_equal(b->ops->stats(b)->received, 3);
	b->ops->close(b);
}

static void frames_of_one_stamp_may_need_several_calls(void **state)
{
	static const char text[] =
		"(1.000000) can0 001#\n(1.000000) can0 002#\n(1.000000) can0 003#\n";
	struct bus *b = log_open(text, strlen(text), NULL);
	struct bus_frame f[2];
	int64_t now;

	(void)state;
	assert_int_equal(b->ops->recv(b, f, 2, CLOCK_NEVER, &now), 2);
	assert_int_equal(b->ops->recv(b, f, 2, CLOCK_NS_PER_S, &now), 1);
	assert_int_equal(f[0].id, 3);
	b->ops->close(b);
}

static void disorder_is_clamped_and_counted(void **state)
{
	static const char text[] = "(100.000000) can0 001#\n"
				   "(99.500000) can0 002#\n"  /* late: clamped to 100 */
				   "(100.100000) can0 003#\n" /* 100.1 */
				   "(50.000000) can0 004#\n"  /* clock set back: goes on at 100.1 */
				   "(50.250000) can0 005#\n"  /* 100.35 */
				   "(1700000000.000000) can0 006#\n"  /* set ahead: 100.35 */
				   "(1700000001.000000) can0 007#\n"; /* 101.35 */
	static const int64_t want_ms[] = {100000, 100000, 100100, 100100, 100350, 100350, 101350};
	struct bus *b = log_open(text, strlen(text), NULL);
	struct bus_frame f[8];
	int64_t now;
	int seen = 0;

	(void)state;
	for (int n; (n = b->ops->recv(b, f, 8, CLOCK_NEVER, &now)) > 0; seen += n) {
		for (int i = 0; i < n; i++) {
			assert_int_equal(f[i].t_ns, want_ms[seen + i] * MS);
		}
	}
	assert_int_equal(seen, 7);
	assert_int_equal(b->ops->stats(b)->disorder, 3);
	b->ops->close(b);
}

static void only_a_minute_is_believed(void **state)
{
	static const char text[] = "(100.000000) can0 001#\n"
				   "(160.000000) can0 002#\n"
				   "(220.000001) can0 003#\n";
	struct bus *b = log_open(text, strlen(text), NULL);
	struct bus_frame f[8];
	int64_t now;

	(void)state;
	assert_int_equal(b->ops->recv(b, f, 8, CLOCK_NEVER, &now), 1);
	assert_int_equal(b->ops->recv(b, f, 8, CLOCK_NEVER, &now), 2);
	assert_int_equal(f[0].t_ns, 160000 * MS);
	assert_int_equal(f[1].t_ns, 160000 * MS);
	assert_int_equal(b->ops->stats(b)->disorder, 1);
	b->ops->close(b);
}

static void a_second_back_moves_nothing(void **state)
{
	static const char text[] = "(100.000000) can0 001#\n"
				   "(99.000000) can0 002#\n"
				   "(100.100000) can0 003#\n";
	struct bus *b = log_open(text, strlen(text), NULL);
	struct bus_frame f[8];
	int64_t now;

	(void)state;
	assert_int_equal(b->ops->recv(b, f, 8, CLOCK_NEVER, &now), 2);
	assert_int_equal(f[1].t_ns, 100000 * MS);
	assert_int_equal(b->ops->recv(b, f, 8, CLOCK_NEVER, &now), 1);
	assert_int_equal(f[0].t_ns, 100100 * MS);
	assert_int_equal(b->ops->stats(b)->disorder, 1);
	b->ops->close(b);
}

static void what_is_no_frame_is_counted_and_the_rest_used(void **state)
{
	static const char text[] = "# a comment\n\n"
				   "(1.000000) can0 001#00 R\n"
				   "junk\n"
				   "(1.000000) can0 002#00\0 R\n"
				   "\0\0\0\n"
				   "(1.000000) can7 003#00\n"
				   "(1.000000) can1 20000001#0000000000000000\n"
				   "(1.000000) can1 004#R\r\n"
				   "(1.000000) can1 005#0102030"; /* cut off */
	struct bus *b = log_open(text, sizeof(text) - 1, NULL);

	(void)state;
	assert_int_equal(log_drain(b), 3);
	const struct bus_stats *s = b->ops->stats(b);

	assert_int_equal(s->received, 3);
	assert_int_equal(s->malformed, 4);
	assert_int_equal(s->other_iface, 1);
	assert_int_equal(s->error_frames, 1);
	assert_int_equal(s->remote_frames, 1);
	assert_int_equal(s->disorder, 0);
	b->ops->close(b);
}

static void last_line_needs_no_newline(void **state)
{
	static const char text[] = "(1.000000) can0 001#00\n(1.000000) can0 002#00";
	struct bus *b = log_open(text, strlen(text), NULL);
	int64_t got, total;

	(void)state;
	assert_int_equal(log_drain(b), 2);
	bus_log_progress(b, &got, &total);
	assert_int_equal(got, strlen(text));
	assert_int_equal(total, strlen(text));
	b->ops->close(b);
}

static void last_line_may_be_a_single_character(void **state)
{
	static const char text[] = "(1.000000) can0 001#00\nx";
	struct bus *b = log_open(text, strlen(text), NULL);

	(void)state;
	assert_int_equal(log_drain(b), 1);
	assert_int_equal(b->ops->stats(b)->malformed, 1);
	b->ops->close(b);
}

/* Many times as long as what is read at once. */
static void every_line_of_a_long_log_arrives(void **state)
{
	enum { FRAMES = 20000, LINE = 36 };
	char *text = malloc(FRAMES * LINE), *p = text;
	struct bus_frame f;
	int64_t now;

	(void)state;
	assert_non_null(text);
	for (unsigned i = 0; i < FRAMES; i++) {
		p += sprintf(p, "(%u.000000) can0 %08X#%.*s\n", i, i, (int)(i % 3) * 2, "A5A5");
	}
	struct bus *b = log_open(text, (size_t)(p - text), NULL);

	for (unsigned i = 0; i < FRAMES; i++) {
		assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), 1);
		assert_int_equal(now, i * CLOCK_NS_PER_S);
		assert_int_equal(f.id, i | BUS_ID_EFF);
		assert_int_equal(f.len, i % 3);
	}
	assert_int_equal(log_drain(b), 0);
	assert_int_equal(b->ops->stats(b)->malformed, 0);
	b->ops->close(b);
	free(text);
}

static void endless_lines_are_skipped(void **state)
{
	static const char frame[] = "(1.000000) can0 001#00\n";
	size_t junk = 1 << 20, size = 2 * junk + 3 * strlen(frame) + 2;
	char *text = malloc(size + 1);
	char *p = text;

	(void)state;
	assert_non_null(text);
	for (int i = 0; i < 2; i++) {
		p = stpcpy(p, frame);
		memset(p, i ? '0' : '(', junk);
		p += junk;
		*p++ = '\n';
	}
	stpcpy(p, frame);

	struct bus *b = log_open(text, size, NULL);

	assert_int_equal(log_drain(b), 3);
	assert_int_equal(b->ops->stats(b)->malformed, 2);
	b->ops->close(b);
	/* the same without its end */
	b = log_open(text, size - strlen(frame) - 1, NULL);
	assert_int_equal(log_drain(b), 2);
	assert_int_equal(b->ops->stats(b)->malformed, 2);
	b->ops->close(b);
	free(text);
}

static void empty_log_ends_at_once(void **state)
{
	struct bus *b = log_open("", 0, NULL);
	struct bus_frame f;
	int64_t now = -1;

	(void)state;
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -ENODATA);
	assert_int_equal(now, -1); /* nothing set the clock */
	assert_int_equal(b->ops->stats(b)->malformed, 0);
	b->ops->close(b);
}

static void eight_interfaces_are_possible(void **state)
{
	static const char *const eight[] = {"a", "b", "c", "d", "e", "f", "g", "h"};
	static const char text[] = "(1.000000) h 001#\n(1.000000) i 002#\n";
	struct bus *b = NULL;
	struct bus_frame f[8];
	int64_t now;
	char err[256];

	(void)state;
	log_write("in.log", text, strlen(text));
	assert_int_equal(bus_log_open("in.log", NULL, eight, 8, &b, err, sizeof(err)), 0);
	assert_int_equal(b->ops->recv(b, f, 8, CLOCK_NEVER, &now), 1);
	assert_int_equal(f[0].iface, 7);
	assert_int_equal(log_drain(b), 0);
	assert_int_equal(b->ops->stats(b)->other_iface, 1);
	b->ops->close(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(virtual_time_stops_at_every_deadline),
		cmocka_unit_test(frames_of_one_stamp_may_need_several_calls),
		cmocka_unit_test(disorder_is_clamped_and_counted),
		cmocka_unit_test(only_a_minute_is_believed),
		cmocka_unit_test(a_second_back_moves_nothing),
		cmocka_unit_test(what_is_no_frame_is_counted_and_the_rest_used),
		cmocka_unit_test(last_line_needs_no_newline),
		cmocka_unit_test(last_line_may_be_a_single_character),
		cmocka_unit_test(every_line_of_a_long_log_arrives),
		cmocka_unit_test(endless_lines_are_skipped),
		cmocka_unit_test(empty_log_ends_at_once),
		cmocka_unit_test(eight_interfaces_are_possible),
	};

	return cmocka_run_group_tests(tests, log_make_dir, log_remove_dir);
}
