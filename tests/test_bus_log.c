/* SPDX-License-Identifier: MIT
 * candump lines, virtual time, and what a hostile log or a lost reader does to the log bus.
 */
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>
#include <cmocka.h>
#include "bus.h"
#include "clock.h"

#define MS CLOCK_NS_PER_MS
#define D8 "1122334455667788"

static const char *const ifaces[] = {"can0", "can1"};

/* ---- lines ---------------------------------------------------------------------------------- */

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

/* ---- files ---------------------------------------------------------------------------------- */

static void write_file(const char *path, const void *data, size_t size)
{
	FILE *f = fopen(path, "w");

	assert_non_null(f);
	assert_int_equal(fwrite(data, 1, size, f), size);
	assert_int_equal(fclose(f), 0);
}

static int make_dir(void **state)
{
	static char dir[64];

	snprintf(dir, sizeof(dir), "/tmp/aebmc_bus_log_XXXXXX");
	*state = mkdtemp(dir);
	return *state && chdir(dir) == 0 ? 0 : -1;
}

static int remove_dir(void **state)
{
	(void)remove("in.log");
	(void)remove("out.log");
	return chdir("/") == 0 && rmdir(*state) == 0 ? 0 : -1;
}

static struct bus *open_text(const char *text, size_t size, const char *out)
{
	struct bus *b = NULL;
	char err[256] = "";

	write_file("in.log", text, size);
	assert_int_equal(bus_log_open("in.log", out, ifaces, 2, &b, err, sizeof(err)), 0);
	return b;
}

/* Reads to the end; returns the number of frames. */
static int drain(struct bus *b)
{
	struct bus_frame f[8];
	int64_t now;
	int n, total = 0;

	while ((n = b->ops->recv(b, f, 8, CLOCK_NEVER, &now)) > 0) {
		total += n;
	}
	assert_int_equal(n, -ENODATA);
	return total;
}

static void virtual_time_stops_at_every_deadline(void **state)
{
	static const char text[] = "(100.000000) can0 001#\n"
				   "(100.000000) can1 002#\n"
				   "(100.030000) can0 003#\n";
	struct bus *b = open_text(text, strlen(text), NULL);
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
	assert_int_equal(b->ops->recv(b, f, 8, t0 + 40 * MS, &now), -ENODATA);
	assert_int_equal(b->ops->recv(b, f, 8, t0 + 40 * MS, &now), -ENODATA);
	assert_int_equal(b->ops->stats(b)->received, 3);
	b->ops->close(b);
}

static void frames_of_one_stamp_may_need_several_calls(void **state)
{
	static const char text[] =
		"(1.000000) can0 001#\n(1.000000) can0 002#\n(1.000000) can0 003#\n";
	struct bus *b = open_text(text, strlen(text), NULL);
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
	struct bus *b = open_text(text, strlen(text), NULL);
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
	struct bus *b = open_text(text, strlen(text), NULL);
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
	struct bus *b = open_text(text, sizeof(text) - 1, NULL);

	(void)state;
	assert_int_equal(drain(b), 3);
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
	struct bus *b = open_text(text, strlen(text), NULL);
	int64_t got, total;

	(void)state;
	assert_int_equal(drain(b), 2);
	bus_log_progress(b, &got, &total);
	assert_int_equal(got, strlen(text));
	assert_int_equal(total, strlen(text));
	b->ops->close(b);
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

	struct bus *b = open_text(text, size, NULL);

	assert_int_equal(drain(b), 3);
	assert_int_equal(b->ops->stats(b)->malformed, 2);
	b->ops->close(b);
	/* the same without its end */
	b = open_text(text, size - strlen(frame) - 1, NULL);
	assert_int_equal(drain(b), 2);
	assert_int_equal(b->ops->stats(b)->malformed, 2);
	b->ops->close(b);
	free(text);
}

static void empty_log_ends_at_once(void **state)
{
	struct bus *b = open_text("", 0, NULL);

	(void)state;
	assert_int_equal(drain(b), 0);
	assert_int_equal(b->ops->stats(b)->malformed, 0);
	b->ops->close(b);
}

static void read_errors_are_reported(void **state)
{
	int saved = dup(STDIN_FILENO), write_only;
	struct bus *b;
	struct bus_frame f;
	int64_t now;
	char err[256];

	(void)state;
	write_file("in.log", "", 0);
	write_only = open("in.log", O_WRONLY);
	dup2(write_only, STDIN_FILENO);
	close(write_only);
	assert_int_equal(bus_log_open("-", NULL, ifaces, 2, &b, err, sizeof(err)), 0);
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -EBADF);
	b->ops->close(b);
	dup2(saved, STDIN_FILENO);
	close(saved);
}

static void on_alarm(int sig)
{
	(void)sig;
}

/* Again and again, so that one of them comes while recv() waits. */
static void signal_ends_the_wait(void **state)
{
	const struct sigaction act = {.sa_handler = on_alarm};
	const struct itimerval often = {{0, 10000}, {0, 10000}}, never = {{0, 0}, {0, 0}};
	static const char text[] = "(1.000000) can0 001#00\n";
	int saved = dup(STDIN_FILENO), fd[2];
	struct bus *b;
	struct bus_frame f;
	int64_t now;
	char err[256];

	(void)state;
	assert_int_equal(pipe(fd), 0);
	dup2(fd[0], STDIN_FILENO);
	close(fd[0]);
	assert_int_equal(bus_log_open("-", NULL, ifaces, 2, &b, err, sizeof(err)), 0);
	sigaction(SIGALRM, &act, NULL);
	setitimer(ITIMER_REAL, &often, NULL);
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -EINTR);
	setitimer(ITIMER_REAL, &never, NULL);
	assert_int_equal(write(fd[1], text, strlen(text)), strlen(text));
	close(fd[1]);
	assert_int_equal(drain(b), 1); /* nothing was lost */
	b->ops->close(b);
	signal(SIGALRM, SIG_DFL);
	dup2(saved, STDIN_FILENO);
	close(saved);
}

/* ---- input and output ----------------------------------------------------------------------- */

static void standard_input_is_read(void **state)
{
	static const char text[] = "(1.000000) can0 001#00\n";
	int saved = dup(STDIN_FILENO), fd[2];
	struct bus *b;
	char err[256];
	int64_t got, total;

	(void)state;
	assert_int_equal(pipe(fd), 0);
	assert_int_equal(write(fd[1], text, strlen(text)), strlen(text));
	close(fd[1]);
	dup2(fd[0], STDIN_FILENO);
	close(fd[0]);
	assert_int_equal(bus_log_open("-", NULL, ifaces, 2, &b, err, sizeof(err)), 0);
	assert_int_equal(drain(b), 1);
	bus_log_progress(b, &got, &total);
	assert_int_equal(got, strlen(text));
	assert_int_equal(total, 0);
	b->ops->close(b);
	assert_true(fcntl(STDIN_FILENO, F_GETFD) >= 0); /* not ours to close */
	dup2(saved, STDIN_FILENO);
	close(saved);
}

static void what_is_sent_can_be_replayed(void **state)
{
	struct bus *b = open_text("", 0, "out.log");
	struct bus_frame f = {.t_ns = 1500 * MS, .id = 0x2A0, .iface = 1, .len = 2, .data = {1, 2}};
	struct bus_frame back;
	int64_t now;
	char err[256];

	(void)state;
	assert_int_equal(b->ops->send(b, &f), 0);
	assert_int_equal(b->ops->stats(b)->sent, 1);
	f.iface = 2;
	assert_int_equal(b->ops->send(b, &f), -ENODEV);
	b->ops->close(b);

	assert_int_equal(bus_log_open("out.log", NULL, ifaces, 2, &b, err, sizeof(err)), 0);
	assert_int_equal(b->ops->recv(b, &back, 1, CLOCK_NEVER, &now), 1);
	f.iface = 1;
	assert_memory_equal(&f, &back, sizeof(f));
	assert_int_equal(b->ops->send(b, &f), 0); /* discarded */
	b->ops->close(b);
}

static void old_output_is_replaced(void **state)
{
	struct stat st;

	(void)state;
	write_file("out.log", "old old old\n", 12);
	struct bus *b = open_text("", 0, "out.log");

	b->ops->close(b);
	assert_int_equal(stat("out.log", &st), 0);
	assert_int_equal(st.st_size, 0);
}

static void lost_reader_is_reported(void **state)
{
	int saved = dup(STDOUT_FILENO), fd[2], ret;
	struct bus_frame f = {.id = 1};
	struct bus *b;
	char err[256];

	(void)state;
	signal(SIGPIPE, SIG_IGN);
	assert_int_equal(pipe(fd), 0);
	close(fd[0]);
	write_file("in.log", "", 0);
	assert_int_equal(bus_log_open("in.log", "-", ifaces, 2, &b, err, sizeof(err)), 0);
	fflush(stdout);
	dup2(fd[1], STDOUT_FILENO);
	close(fd[1]);
	ret = b->ops->send(b, &f);
	b->ops->close(b);
	dup2(saved, STDOUT_FILENO);
	close(saved);
	assert_int_equal(ret, -EPIPE);
}

static void full_disk_is_reported(void **state)
{
	static const char frame[] = "(1.000000) can0 001#00\n";
	struct bus *b = open_text("", 0, "/dev/full");
	struct bus_frame f = {.id = 1};
	int64_t now;

	(void)state;
	assert_int_equal(bus_log_finish(b), 0);
	b->ops->close(b);
	b = open_text(frame, strlen(frame), "/dev/full");
	assert_int_equal(b->ops->send(b, &f), -ENOSPC);
	assert_int_equal(b->ops->stats(b)->sent, 0);
	/* whoever does not look at send() learns it here */
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -ENOSPC);
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -ENOSPC);
	assert_int_equal(b->ops->stats(b)->received, 0);
	assert_int_equal(bus_log_finish(b), -ENOSPC);
	assert_int_equal(bus_log_finish(b), -ENOSPC);
	b->ops->close(b);
}

static void error_of_close_is_reported(void **state)
{
	struct bus *b = open_text("", 0, "out.log");
	int next = open("/dev/null", O_RDONLY);

	(void)state;
	close(next);
	close(next - 1); /* the output's: the last one opened before */
	assert_int_equal(bus_log_finish(b), -EBADF);
	b->ops->close(b);
}

static void refuse_open(const char *in, const char *out, int n_ifaces, int error, const char *words)
{
	static const char *const many[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
	static const char *const wide[] = {"sixteen_letters_"};
	struct bus *b = NULL;
	char err[256] = "";

	assert_int_equal(bus_log_open(in, out, n_ifaces < 0 ? wide : many, abs(n_ifaces), &b, err,
				      sizeof(err)),
			 error);
	assert_null(b);
	assert_non_null(strstr(err, words));
	assert_null(strchr(err, '\n'));
}

static void what_cannot_be_opened_is_named(void **state)
{
	(void)state;
	write_file("in.log", "x", 1);
	refuse_open("missing.log", NULL, 1, -ENOENT, "missing.log: cannot read: No such file");
	refuse_open(".", NULL, 1, -EISDIR, ".: is a directory");
	refuse_open("in.log", "none/out.log", 1, -ENOENT, "none/out.log: cannot write");
	refuse_open("in.log", ".", 1, -EISDIR, ".: cannot write: Is a directory");
	refuse_open("in.log", "in.log", 1, -EINVAL, "in.log: is the input as well");
	refuse_open("in.log", NULL, 0, -EINVAL, "0 interfaces");
	refuse_open("in.log", NULL, 9, -EINVAL, "9 interfaces");
	refuse_open("in.log", NULL, -1, -EINVAL, "'sixteen_letters_'");

	struct stat st;

	assert_int_equal(stat("in.log", &st), 0);
	assert_int_equal(st.st_size, 1); /* refused before it was emptied */
}

static void close_takes_null(void **state)
{
	struct bus *b = open_text("", 0, NULL);

	(void)state;
	assert_string_equal(b->ops->name, "log");
	b->ops->close(NULL);
	b->ops->close(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(good_lines_parse),
		cmocka_unit_test(bad_lines_are_refused),
		cmocka_unit_test(comments_are_no_frames),
		cmocka_unit_test(lines_are_written_as_candump_does),
		cmocka_unit_test(longest_frame_fits_the_line),
		cmocka_unit_test(virtual_time_stops_at_every_deadline),
		cmocka_unit_test(frames_of_one_stamp_may_need_several_calls),
		cmocka_unit_test(disorder_is_clamped_and_counted),
		cmocka_unit_test(only_a_minute_is_believed),
		cmocka_unit_test(what_is_no_frame_is_counted_and_the_rest_used),
		cmocka_unit_test(last_line_needs_no_newline),
		cmocka_unit_test(endless_lines_are_skipped),
		cmocka_unit_test(empty_log_ends_at_once),
		cmocka_unit_test(read_errors_are_reported),
		cmocka_unit_test(signal_ends_the_wait),
		cmocka_unit_test(standard_input_is_read),
		cmocka_unit_test(what_is_sent_can_be_replayed),
		cmocka_unit_test(old_output_is_replaced),
		cmocka_unit_test(lost_reader_is_reported),
		cmocka_unit_test(full_disk_is_reported),
		cmocka_unit_test(error_of_close_is_reported),
		cmocka_unit_test(what_cannot_be_opened_is_named),
		cmocka_unit_test(close_takes_null),
	};

	return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
