/* SPDX-License-Identifier: MIT
 * The event recorder: what is written around an event, that no trigger goes without its time before and after or without
 * a word, what is removed, what a disk without room does, and that a recorded request reads back whole or not at all.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clock.h"
#include "ring.h"

/* The ring that has no memory; 0: all have. */
static int scarce;

static int scarce_ring(uint32_t count, uint32_t bytes, struct ring **ret)
{
	return scarce && --scarce == 0 ? -ENOMEM : ring_open(count, bytes, ret);
}
#define ring_open scarce_ring
#include "../daemon/recorder.c"
#undef ring_open

#define S  CLOCK_NS_PER_S
#define MS CLOCK_NS_PER_MS

static const char *const iface[] = {"can0", "can1"};
static char dir[64];
static char err[256];

static int make_dir(void **state)
{
	(void)state;
	strcpy(dir, "/tmp/aebmc-recorder-XXXXXX");
	return mkdtemp(dir) ? 0 : -1;
}

static int remove_dir(void **state)
{
	char cmd[128];

	(void)state;
	snprintf(cmd, sizeof(cmd), "rm -rf %s", dir);
	return system(cmd);
}

static struct recorder *open_with(int64_t before_ns, int64_t after_ns, uint32_t per_s,
				  uint64_t bytes_max)
{
	const struct recorder_params p = {.dir = dir,
					  .ifaces = iface,
					  .n_ifaces = 2,
					  .before_ns = before_ns,
					  .after_ns = after_ns,
					  .frames_per_s = per_s,
					  .requests_per_s = per_s,
					  .bytes_max = bytes_max};
	struct recorder *r = NULL;

	assert_int_equal(recorder_open(&p, &r, err, sizeof(err)), 0);
	return r;
}

static struct recorder *open_recorder(uint64_t bytes_max)
{
	return open_with(20 * S, 10 * S, 1, bytes_max);
}

static void put(struct recorder *r, int64_t t_ns)
{
	const int64_t t = t_ns / S;
	const struct bus_frame f = {
		.t_ns = t_ns, .id = 0x100, .iface = 1, .len = 2, .data = {0xAB, (uint8_t)t}};
	struct mc_request req;
	const struct mc_result res = {
		.n = 16, .n_futures = 1, .risk = {{.hits = (uint64_t)t, .lo = 0.25, .hi = 0.5}}};

	mc_preset_paper(&req, 100.0f, 16);
	req.id = (uint64_t)t;
	recorder_frame(r, &f);
	recorder_evaluation(r, t_ns, &req, &res);
}

static void put_second(struct recorder *r, int64_t t)
{
	put(r, t * S);
}

/* Lines with @needle; comments only if it is one. */
static int count_lines(const char *path, const char *needle)
{
	FILE *f = fopen(path, "r");
	char line[4096];
	int n = 0;

	assert_non_null(f);
	while (fgets(line, sizeof(line), f)) {
		n += strstr(line, needle) && (line[0] == '#') == (needle[0] == '#');
	}
	fclose(f);
	return n;
}

static const char *words(const struct recorder *r, int missing)
{
	static char line[256];

	assert_int_equal(recorder_words(r, line, sizeof(line)), missing);
	return line;
}

static char *requests_of(const char *log)
{
	static char path[RECORDER_PATH_MAX + 16];

	snprintf(path, sizeof(path), "%.*s.requests", (int)(strlen(log) - 4), log);
	return path;
}

static void test_writes_what_came_before_and_after(void **state)
{
	struct recorder *r = open_recorder(1 << 20);
	char path[RECORDER_PATH_MAX] = "";

	(void)state;
	for (int64_t t = 1; t <= 70; t++) {
		put_second(r, t);
		if (t == 50) {
			recorder_trigger(r, RECORDER_WARN, t * S);
		}
		assert_int_equal(recorder_service(r, t * S, 1000 * S, 0, path), t == 60 ? 1 : 0);
	}
	assert_non_null(strstr(path, "/event-000001-warn.log"));
	assert_int_equal(count_lines(path, "can1 100#AB"), 31); /* 30..60 s */
	assert_int_equal(count_lines(path, "(0000001030.000000) can1 100#AB1E"), 1);
	assert_int_equal(count_lines(path, "(0000001060.000000)"), 1);
	assert_int_equal(count_lines(requests_of(path), "(00000010"), 31);
	recorder_close(r);

	r = open_recorder(1 << 20); /* numbering goes on */
	put_second(r, 100);
	recorder_trigger(r, RECORDER_MARK, 100 * S);
	assert_int_equal(recorder_service(r, 101 * S, 0, 0, path), 0);
	assert_int_equal(recorder_service(r, 101 * S, 0, 1, path), 1); /* at exit what there is */
	assert_non_null(strstr(path, "/event-000002-mark.log"));
	recorder_close(r);
}

/* The longest that may be configured, at the rates that were announced, all of it. */
static void test_memory_holds_what_is_promised(void **state)
{
	struct recorder *r = open_with(30 * S, 60 * S, 20, 1 << 30);
	char path[RECORDER_PATH_MAX];

	(void)state;
	for (int64_t t_ns = S; t_ns <= 290 * S; t_ns += 50 * MS) {
		put(r, t_ns);
		if (t_ns == 200 * S || t_ns == 230 * S) {
			recorder_trigger(r, RECORDER_WARN, t_ns);
		}
	}
	assert_int_equal(recorder_service(r, 292 * S, 0, 0, path), 1);
	assert_int_equal(count_lines(path, "100#AB"), 120 * 20 + 1);
	assert_int_equal(count_lines(requests_of(path), "(0000000"), 120 * 20 + 1);
	assert_int_equal(count_lines(requests_of(path), "(0000000170.000000)"), 1);
	assert_string_equal(words(r, 0), "2 warn");
	recorder_close(r);
}

static void test_more_than_was_announced_is_said(void **state)
{
	struct recorder *r = open_recorder(1 << 20); /* 64 entries */
	char path[RECORDER_PATH_MAX];

	(void)state;
	for (int64_t t_ns = 100 * S; t_ns <= 140 * S; t_ns += S / 4) {
		put(r, t_ns);
		if (t_ns == 130 * S) {
			recorder_trigger(r, RECORDER_MARK, t_ns);
		}
	}
	assert_int_equal(recorder_service(r, 140 * S, 0, 0, path), 1);
	assert_int_equal(count_lines(path, "100#AB"), 64);
	assert_string_equal(words(r, 1),
			    "1 mark; the first 14.2 s are incomplete, memory holds no more");
	recorder_trigger(r, RECORDER_MARK, 190 * S);
	for (int64_t t_ns = 170 * S; t_ns <= 200 * S; t_ns += S) {
		put(r, t_ns);
	}
	assert_int_equal(recorder_service(r, 200 * S, 0, 0, path), 1);
	assert_string_equal(words(r, 0), "1 mark");
	recorder_close(r);
}

/* ---- more than one trigger ----------------------------------------------------------------------------------- */

struct step {
	int64_t t;
	enum recorder_reason why;
};

/* Seconds from 1 to @until with @n steps in them, served each; how many events were written: their paths. */
static int run(struct recorder *r, const struct step *step, int n, int64_t until,
	       char path[][RECORDER_PATH_MAX])
{
	int events = 0;

	for (int64_t t = 1; t <= until; t++) {
		put_second(r, t);
		for (; n && step->t == t; n--, step++) {
			recorder_trigger(r, step->why, t * S);
		}
		while (recorder_service(r, t * S, 0, 0, path[events])) {
			events++;
		}
	}
	assert_int_equal(n, 0);
	return events;
}

static void test_a_later_trigger_makes_the_event_longer(void **state)
{
	static const struct step step[] = {{30, RECORDER_WARN}, {39, RECORDER_REQUEST}};
	struct recorder *r = open_recorder(1 << 20);
	char path[2][RECORDER_PATH_MAX];

	(void)state;
	assert_int_equal(run(r, step, 2, 60, path), 1);
	assert_non_null(strstr(path[0], "/event-000001-warn.log"));
	assert_int_equal(count_lines(path[0], "100#AB"), 49 - 10 + 1);
	assert_int_equal(count_lines(path[0], "(0000000010.000000)"), 1);
	assert_int_equal(count_lines(requests_of(path[0]), "(0000000"), 49 - 10 + 1);
	assert_int_equal(count_lines(requests_of(path[0]),
				     "# 1 warn: (0000000030.000000) to (0000000030.000000)\n"),
			 1);
	assert_int_equal(count_lines(requests_of(path[0]),
				     "# 1 request: (0000000039.000000) to (0000000039.000000)\n"),
			 1);
	assert_string_equal(words(r, 0), "1 warn, 1 request");
	recorder_close(r);
}

static void test_what_memory_cannot_hold_is_the_next_event(void **state)
{
	static const struct step step[] = {{30, RECORDER_WARN}, {39, RECORDER_MISS},
					   {48, RECORDER_MISS}, {57, RECORDER_MISS},
					   {60, RECORDER_MISS}, {61, RECORDER_MARK}};
	struct recorder *r = open_recorder(1 << 20);
	char path[3][RECORDER_PATH_MAX];

	(void)state;
	assert_int_equal(run(r, step, 6, 90, path), 2);
	assert_non_null(strstr(path[0], "/event-000001-warn.log"));
	assert_int_equal(count_lines(path[0], "100#AB"), 70 - 10 + 1);
	assert_int_equal(count_lines(requests_of(path[0]),
				     "# 4 miss: (0000000039.000000) to (0000000060.000000)\n"),
			 1);
	assert_non_null(strstr(path[1], "/event-000002-mark.log"));
	assert_int_equal(count_lines(path[1], "100#AB"), 71 - 41 + 1);
	assert_int_equal(count_lines(path[1], "(0000000041.000000)"), 1);
	assert_string_equal(words(r, 0), "1 mark");
	recorder_close(r);
}

static void test_what_comes_in_floods_gives_way_to_the_rest(void **state)
{
	static const struct step step[] = {
		{30, RECORDER_MISS},  {31, RECORDER_FAULT},   {32, RECORDER_MISS},
		{130, RECORDER_MISS}, {131, RECORDER_FAULT},  {132, RECORDER_MARK},
		{230, RECORDER_WARN}, {231, RECORDER_FAULT},  {232, RECORDER_MARK},
		{330, RECORDER_MISS}, {331, RECORDER_REQUEST}};
	static const char *const name[] = {"-fault.log", "-mark.log", "-warn.log", "-request.log"};
	struct recorder *r = open_recorder(1 << 20);
	char path[5][RECORDER_PATH_MAX];

	(void)state;
	assert_int_equal(run(r, step, 11, 350, path), 4);
	for (int i = 0; i < 4; i++) {
		assert_non_null(strstr(path[i], name[i]));
	}
	recorder_close(r);
}

/* At exit there may be two: the open one and what waits behind it. */
static void test_all_is_written_at_exit(void **state)
{
	static const struct step step[] = {
		{30, RECORDER_WARN}, {39, RECORDER_MISS}, {59, RECORDER_MISS}, {61, RECORDER_MARK}};
	struct recorder *r = open_with(20 * S, 60 * S, 1, 1 << 20);
	char path[RECORDER_PATH_MAX];

	(void)state;
	assert_int_equal(run(r, step, 4, 61, &path), 0);
	assert_int_equal(recorder_service(r, 61 * S, 0, 1, path), 1);
	assert_non_null(strstr(path, "-warn.log"));
	assert_int_equal(recorder_service(r, 61 * S, 0, 1, path), 1);
	assert_non_null(strstr(path, "-mark.log"));
	assert_int_equal(recorder_service(r, 61 * S, 0, 1, path), 0);
	recorder_close(r);
}

/* Of 900 seconds, which were triggers and are wholly within an event. */
struct kept {
	unsigned seed;
	int event[900], triggered[900], covered[900];
};

static void look_at_event(struct kept *k, const struct recorder *r, const char *path)
{
	const int from = (int)(r->last.from_ns / S), to = (int)(r->last.to_ns / S);

	assert_int_equal(count_lines(path, "100#AB"), to - from + 1);
	assert_int_equal(count_lines(requests_of(path), "(0000000"), to - from + 1);
	for (int t = from + 20; t <= to - 10; t++) {
		k->covered[t] = 1;
	}
}

static unsigned draw(struct kept *k, unsigned n)
{
	k->seed = k->seed * 1664525 + 1013904223;
	return (k->seed >> 16) % n;
}

/* Whatever the triggers and whenever the writer comes, a second late at most. */
static void check_no_trigger_goes_without(unsigned seed, unsigned rarity)
{
	struct recorder *r = open_recorder(1 << 30);
	struct kept k = {.seed = seed};
	char path[RECORDER_PATH_MAX];

	for (int t = 1; t < 900; t++) {
		put_second(r, t);
		if (t > 20 && t < 800 && draw(&k, rarity) == 0) {
			k.triggered[t] = 1;
			recorder_trigger(r, (enum recorder_reason)draw(&k, RECORDER_REASONS),
					 t * S);
		}
		while ((t % 2 || draw(&k, 2)) && recorder_service(r, t * S, 0, 0, path)) {
			look_at_event(&k, r, path);
			words(r, 0);
		}
	}
	for (int t = 0; t < 900; t++) {
		assert_true(k.covered[t] || !k.triggered[t]);
	}
	recorder_close(r);
}

static void test_no_trigger_goes_without(void **state)
{
	(void)state;
	for (unsigned seed = 1; seed <= 10; seed++) {
		check_no_trigger_goes_without(seed, 1);
		check_no_trigger_goes_without(seed, 8);
		check_no_trigger_goes_without(seed, 40);
	}
}

/* 20 a second for five minutes, with a mark among them. */
static void test_a_flood_hides_nothing(void **state)
{
	struct recorder *r = open_recorder(1 << 20);
	char path[RECORDER_PATH_MAX];
	uint64_t misses = 0;
	int events = 0, marks = 0;

	(void)state;
	for (int64_t t = 1; t <= 400; t++) {
		put_second(r, t);
		for (int i = 0; i < 20 && t > 30 && t <= 330; i++) {
			recorder_trigger(r, RECORDER_MISS, t * S);
		}
		if (t == 137) {
			recorder_trigger(r, RECORDER_MARK, t * S);
		}
		if (recorder_service(r, t * S, 0, 0, path)) {
			events++;
			misses += r->last.of[RECORDER_MISS].n;
			marks += strstr(path, "-mark.log") != NULL;
		}
	}
	assert_int_equal(events, 10);
	assert_int_equal(misses, 300 * 20);
	assert_int_equal(marks, 1);
	recorder_close(r);
}

static void test_lost_triggers_are_counted(void **state)
{
	struct recorder *r = open_recorder(1 << 20);
	char path[RECORDER_PATH_MAX];

	(void)state;
	for (int i = 0; i < 20000; i++) {
		recorder_trigger(r, RECORDER_MISS, 30 * S);
	}
	assert_int_equal(recorder_service(r, 40 * S, 0, 0, path), 1);
	assert_string_equal(words(r, 1),
			    "16384 miss; 3616 triggers before were lost, the disk is too slow");
	recorder_trigger(r, RECORDER_MISS, 50 * S);
	assert_int_equal(recorder_service(r, 60 * S, 0, 0, path), 1);
	assert_string_equal(words(r, 0), "1 miss");
	recorder_close(r);
}

/* ---- two threads ------------------------------------------------------------------------------------------------ */

#define RACE_S 4000

struct race {
	struct recorder *r;
	int64_t t; /* atomic: seconds put */
};

static void *put_all(void *arg)
{
	struct race *x = arg;

	for (int64_t t = 1; t <= RACE_S; t++) {
		put_second(x->r, t);
		recorder_trigger(x->r, (enum recorder_reason)(t % RECORDER_REASONS), t * S);
		__atomic_store_n(&x->t, t, __ATOMIC_RELEASE);
	}
	return NULL;
}

/* A writer that cannot keep up loses nothing without a word. */
static void test_a_race_loses_no_trigger_unsaid(void **state)
{
	struct race x = {.r = open_recorder(1 << 20)};
	char path[RECORDER_PATH_MAX];
	uint64_t triggers = 0;
	pthread_t thread;

	(void)state;
	assert_int_equal(pthread_create(&thread, NULL, put_all, &x), 0);
	while (triggers < RACE_S) {
		const int64_t t = __atomic_load_n(&x.t, __ATOMIC_ACQUIRE);

		if (recorder_service(x.r, t * S, 0, t == RACE_S, path)) {
			for (int i = 0; i < RECORDER_REASONS; i++) {
				triggers += x.r->last.of[i].n;
			}
			triggers += x.r->last.lost;
			assert_true(x.r->last.complete_ns > x.r->last.from_ns ||
				    count_lines(path, "100#AB") >= 1);
		}
	}
	assert_int_equal(triggers, RACE_S);
	pthread_join(thread, NULL);
	recorder_close(x.r);
}

static void test_oldest_events_are_removed(void **state)
{
	struct recorder *r = open_recorder(3000);
	char path[RECORDER_PATH_MAX];
	off_t bytes = 0;
	int n = 0;
	DIR *d;

	(void)state;
	for (int64_t i = 1; i <= 20; i++) {
		put_second(r, 1000 * i);
		recorder_trigger(r, RECORDER_FAULT, 1000 * i * S);
		assert_int_equal(recorder_service(r, (1000 * i + 10) * S, 0, 0, path), 1);
	}
	assert_int_equal(access(path, R_OK), 0); /* the newest stays */
	d = opendir(dir);
	for (const struct dirent *e = readdir(d); e; e = readdir(d)) {
		struct stat st;

		if (e->d_name[0] != '.') {
			assert_int_equal(fstatat(dirfd(d), e->d_name, &st, 0), 0);
			bytes += st.st_size;
			n++;
		}
	}
	closedir(d);
	assert_in_range(n, 2, 39); /* of 40 */
	assert_in_range(bytes, 1, 3000);
	recorder_close(r);
}

/* An hour of faults and misses, and what was there before them. */
static void test_floods_leave_room_for_the_others(void **state)
{
	struct recorder *r = open_recorder(20000);
	char first[RECORDER_PATH_MAX], path[RECORDER_PATH_MAX];
	uint64_t bytes = 0;

	(void)state;
	put_second(r, 20);
	recorder_trigger(r, RECORDER_WARN, 20 * S);
	assert_int_equal(recorder_service(r, 30 * S, 0, 0, first), 1);
	for (int64_t t = 100; t <= 3700; t += 100) {
		put_second(r, t);
		recorder_trigger(r, t % 200 ? RECORDER_MISS : RECORDER_FAULT, t * S);
		assert_int_equal(recorder_service(r, (t + 10) * S, 0, 0, path), 1);
		assert_int_equal(access(path, F_OK), 0);
	}
	assert_int_equal(access(first, F_OK), 0);
	assert_int_equal(access(requests_of(first), F_OK), 0);
	for (unsigned i = 2; i <= r->serial; i++) {
		snprintf(path, sizeof(path), "%s/event-%06u-%s.log", dir, i,
			 i % 2 ? "fault" : "miss");
		bytes += size_of(path) + size_of(requests_of(path));
	}
	assert_in_range(bytes, 9000, 10000);
	recorder_close(r);
}

/* The bound keeps what is there, not what would not fit alone. */
static void check_too_large(uint64_t bytes_max, enum recorder_reason why, int want)
{
	struct recorder *r = open_recorder(bytes_max);
	char first[RECORDER_PATH_MAX], path[RECORDER_PATH_MAX];

	put_second(r, 1000);
	recorder_trigger(r, RECORDER_WARN, 1000 * S);
	assert_int_equal(recorder_service(r, 1010 * S, 0, 0, first), 1);
	for (int64_t t = 2000; t <= 2030; t++) {
		put_second(r, t);
	}
	recorder_trigger(r, why, 2020 * S);
	assert_int_equal(recorder_service(r, 2030 * S, 0, 0, path), want);
	assert_int_equal(r->last.of[why].n, 1);
	assert_int_equal(access(path, F_OK), want < 0 ? -1 : 0);
	assert_int_equal(access(requests_of(path), F_OK), want < 0 ? -1 : 0);
	assert_int_equal(access(first, F_OK), 0);
	assert_int_equal(access(requests_of(first), F_OK), 0);
	recorder_close(r);
}

static void test_an_event_larger_than_the_bound(void **state)
{
	(void)state;
	check_too_large(3000, RECORDER_MARK, -EFBIG);
	check_too_large(20000, RECORDER_MARK, 1);
	check_too_large(20000, RECORDER_MISS, -EFBIG);
	check_too_large(20000, RECORDER_FAULT, -EFBIG);
	check_too_large(40000, RECORDER_MISS, 1);
}

static void test_a_failed_write_leaves_no_partial_file(void **state)
{
	struct recorder *r = open_recorder(1 << 20);
	char path[RECORDER_PATH_MAX], cmd[128];

	(void)state;
	put_second(r, 1);
	recorder_trigger(r, RECORDER_REQUEST, S);
	snprintf(cmd, sizeof(cmd), "rm -rf %s", dir);
	assert_int_equal(system(cmd), 0);
	assert_int_equal(recorder_service(r, 20 * S, 0, 0, path), -ENOENT);
	assert_int_equal(recorder_service(r, 21 * S, 0, 0, path),
			 0); /* and the next event may come */
	assert_int_equal(mkdir(dir, 0700), 0);
	put_second(r, 30);
	recorder_trigger(r, RECORDER_REQUEST, 30 * S);
	assert_int_equal(recorder_service(r, 40 * S, 0, 0, path), 1);
	recorder_close(r);
}

static void test_open_says_what_is_wrong(void **state)
{
	struct recorder_params p = {
		.dir = "/nonexistent/x", .frames_per_s = 1, .requests_per_s = 1};
	struct recorder *r = NULL;

	(void)state;
	assert_int_equal(recorder_open(&p, &r, err, sizeof(err)), -ENOENT);
	assert_non_null(strstr(err, "/nonexistent/x"));
	p.dir = dir;
	for (int i = 1; i <= 3; i++) {
		scarce = i;
		assert_int_equal(recorder_open(&p, &r, err, sizeof(err)), -ENOMEM);
		assert_non_null(strstr(err, dir));
	}
	assert_null(r);
	recorder_close(NULL);
}

static void test_requests_read_back(void **state)
{
	struct recorder *r = open_recorder(1 << 20);
	char path[RECORDER_PATH_MAX], line[4096], bad[4096];
	struct mc_request req, want;
	uint64_t hash;
	FILE *f;

	(void)state;
	put_second(r, 7);
	recorder_trigger(r, RECORDER_MARK, 7 * S);
	assert_int_equal(recorder_service(r, 0, 0, 1, path), 1);
	f = fopen(requests_of(path), "r");
	assert_non_null(fgets(line, sizeof(line), f));
	assert_int_equal(recorder_parse(line, &req, &hash), -ENOMSG);
	assert_non_null(fgets(line, sizeof(line), f));
	assert_string_equal(line, "# 1 mark: (0000000007.000000) to (0000000007.000000)\n");
	assert_int_equal(recorder_parse(line, &req, &hash), -ENOMSG);
	assert_non_null(fgets(line, sizeof(line), f));
	fclose(f);
	mc_preset_paper(&want, 100.0f, 16);
	want.id = 7;
	assert_int_equal(recorder_parse(line, &req, &hash), 0);
	assert_int_equal(req.id, want.id);
	assert_true(mc_request_hash(&req) == mc_request_hash(&want));

	const struct mc_result res = {
		.n = 16, .n_futures = 1, .risk = {{.hits = 7, .lo = 0.25, .hi = 0.5}}};
	assert_int_equal(hash, recorder_result_hash(&res));

	snprintf(bad, sizeof(bad), "%.100s", line); /* cut */
	assert_int_equal(recorder_parse(bad, &req, &hash), -EBADMSG);
	strcpy(bad, line);
	bad[22] = bad[22] == '0' ? '1' : '0'; /* another hash */
	assert_int_equal(recorder_parse(bad, &req, &hash), -EBADMSG);
	snprintf(bad, sizeof(bad), "%.*s 0\n", (int)strcspn(line, "\n"),
		 line); /* a word too many */
	assert_int_equal(recorder_parse(bad, &req, &hash), -EBADMSG);
	assert_int_equal(recorder_parse("\n", &req, &hash), -ENOMSG);
	assert_int_equal(recorder_parse("hello", &req, &hash), -EBADMSG);
	recorder_close(r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(test_writes_what_came_before_and_after, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_memory_holds_what_is_promised, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_more_than_was_announced_is_said, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_a_later_trigger_makes_the_event_longer,
						make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_what_memory_cannot_hold_is_the_next_event,
						make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_what_comes_in_floods_gives_way_to_the_rest,
						make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_all_is_written_at_exit, make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_no_trigger_goes_without, make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_a_flood_hides_nothing, make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_lost_triggers_are_counted, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_a_race_loses_no_trigger_unsaid, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_floods_leave_room_for_the_others, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_an_event_larger_than_the_bound, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_oldest_events_are_removed, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_a_failed_write_leaves_no_partial_file,
						make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_open_says_what_is_wrong, make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_requests_read_back, make_dir, remove_dir),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
