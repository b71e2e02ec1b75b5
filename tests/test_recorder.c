/* SPDX-License-Identifier: MIT
 * The event recorder: what is written around an event, what is removed, what a disk without room does, and that a
 * recorded request reads back whole or not at all.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
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

static int count_lines(const char *path, const char *needle)
{
	FILE *f = fopen(path, "r");
	char line[4096];
	int n = 0;

	assert_non_null(f);
	while (fgets(line, sizeof(line), f)) {
		n += strstr(line, needle) != NULL;
	}
	fclose(f);
	return n;
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
			recorder_trigger(r, RECORDER_MISS, t * S); /* belongs to the open event */
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
	for (int64_t t_ns = S; t_ns <= 260 * S; t_ns += 50 * MS) {
		put(r, t_ns);
		if (t_ns == 200 * S) {
			recorder_trigger(r, RECORDER_WARN, t_ns);
		}
	}
	assert_int_equal(recorder_service(r, 261 * S, 0, 0, path), 1);
	assert_int_equal(count_lines(path, "100#AB"), 90 * 20 + 1);
	assert_int_equal(count_lines(requests_of(path), "(0000000"), 90 * 20 + 1);
	assert_int_equal(count_lines(requests_of(path), "(0000000170.000000)"), 1);
	recorder_close(r);
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
	for (int i = 1; i <= 2; i++) {
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
		cmocka_unit_test_setup_teardown(test_oldest_events_are_removed, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_a_failed_write_leaves_no_partial_file,
						make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_open_says_what_is_wrong, make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_requests_read_back, make_dir, remove_dir),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
