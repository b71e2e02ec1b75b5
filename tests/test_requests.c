/* SPDX-License-Identifier: MIT
 * aebmc replay --requests on a file that the recorder wrote: every result again, and every way not to.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <unistd.h>
#include <cmocka.h>
#include "../tools/cli.c"
#include "../tools/requests.c"
#include "../tools/setup.c"
#include "clock.h"

#define REQUESTS 12

static const char *const few[] = {"mc.samples=512", "mc.backend=cpu"};
static char dir[] = "/tmp/aebmc-requests-XXXXXX";
static char path[RECORDER_PATH_MAX];  /* as the recorder wrote it */
static char other[RECORDER_PATH_MAX]; /* a changed copy */

static struct replay_args args_of(const char *file)
{
	struct replay_args a = {.requests = file, .setup.n_set = 2};

	memcpy(a.setup.set, few, sizeof(few));
	return a;
}

static struct mc *open_few(void)
{
	struct replay_args a = args_of("");
	enum publish_backend which;
	struct config cfg;
	struct mc *mc;
	char err[256];

	assert_int_equal(setup_load("test", &a.setup, &cfg, NULL), 0);
	assert_int_equal(engine_open(&cfg, MC_INLINE, &mc, &which, err, sizeof(err)), 0);
	return mc;
}

static void record(struct recorder *r, struct mc *mc, uint64_t id)
{
	struct mc_request req;
	struct mc_result res;

	mc_preset_paper(&req, 60.0F + 5.0F * (float)id, 512);
	req.id = id;
	assert_int_equal(mc_submit(mc, &req), 0);
	assert_int_equal(mc_poll(mc, &res), 1);
	recorder_evaluation(r, (int64_t)id * CLOCK_NS_PER_S / 20, &req, &res);
}

static int write_file(void **state)
{
	const char *const iface[] = {"can0"};
	const struct recorder_params p = {.dir = mkdtemp(dir),
					  .ifaces = iface,
					  .n_ifaces = 1,
					  .before_ns = 20 * CLOCK_NS_PER_S,
					  .after_ns = CLOCK_NS_PER_S,
					  .frames_per_s = 1,
					  .requests_per_s = 20,
					  .bytes_max = 1 << 20};
	struct recorder *r;
	struct mc *mc = open_few();
	char err[256];

	(void)state;
	assert_int_equal(recorder_open(&p, &r, err, sizeof(err)), 0);
	for (uint64_t id = 1; id <= REQUESTS; id++) {
		record(r, mc, id);
	}
	recorder_trigger(r, RECORDER_MARK, CLOCK_NS_PER_S / 2);
	assert_int_equal(recorder_service(r, CLOCK_NS_PER_S, 0, 1, path), 1);
	unlink(path);
	strcpy(strrchr(path, '.'), ".requests");
	snprintf(other, sizeof(other), "%s/other.requests", dir);
	recorder_close(r);
	mc_close(mc);
	return 0;
}

static int remove_files(void **state)
{
	(void)state;
	unlink(path);
	unlink(other);
	return rmdir(dir);
}

/* Copies the file; in line @line the @column-th character becomes another hexadecimal digit, or the line ends there. */
static void copy(int line, int column, int cut)
{
	FILE *in = fopen(path, "r"), *out = fopen(other, "w");
	char *text = NULL;
	size_t size = 0;

	for (int i = 1; getline(&text, &size, in) >= 0; i++) {
		if (i == line && cut) {
			strcpy(text + column, "\n");
		} else if (i == line) {
			text[column] = text[column] == '0' ? '1' : '0';
		}
		fputs(text, out);
	}
	free(text);
	fclose(in);
	fclose(out);
}

static struct tally tally_of(const char *file)
{
	struct tally t = {0};
	struct mc *mc = open_few();
	FILE *in = fopen(file, "r");

	assert_int_equal(compare_all(in, mc, &t), 0);
	fclose(in);
	mc_close(mc);
	return t;
}

static int run_on(const char *file)
{
	struct replay_args a = args_of(file);

	return requests_run("test", &a);
}

static void test_all_equal(void **state)
{
	struct tally t = tally_of(path);

	(void)state;
	assert_int_equal(t.requests, REQUESTS);
	assert_int_equal(t.equal, REQUESTS);
	assert_int_equal(t.malformed, 0);
	assert_int_equal(run_on(path), CLI_GOOD);
}

/* "(0000000000.050000) REQUESTHASH16 RESULTHASH16 ...": the result's hash begins at 37. */
static void test_another_result(void **state)
{
	struct tally t;

	(void)state;
	copy(4, 37, 0);
	t = tally_of(other);
	assert_int_equal(t.requests, REQUESTS);
	assert_int_equal(t.equal, REQUESTS - 1);
	assert_int_equal(t.first_differing, 4);
	assert_int_equal(run_on(other), CLI_FAILED);
}

static void test_another_seed(void **state)
{
	struct replay_args a = args_of(path);

	(void)state;
	a.setup.set[a.setup.n_set++] = "mc.seed=2";
	assert_int_equal(requests_run("test", &a), CLI_FAILED);
}

static void test_other_threads(void **state)
{
	struct replay_args a = args_of(path);

	(void)state;
	a.threads = 2;
	assert_int_equal(requests_run("test", &a), CLI_GOOD);
}

static void test_damaged_line(void **state)
{
	(void)state;
	for (int cut = 0; cut < 2; cut++) {
		struct tally t;

		copy(3, 60, cut);
		t = tally_of(other);
		assert_int_equal(t.requests, REQUESTS - 1);
		assert_int_equal(t.equal, REQUESTS - 1);
		assert_int_equal(t.malformed, 1);
		assert_int_equal(t.first_malformed, 3);
		assert_int_equal(run_on(other), CLI_FAILED);
	}
}

static off_t first_line(void)
{
	FILE *f = fopen(path, "r");
	char line[256];

	assert_non_null(fgets(line, sizeof(line), f));
	fclose(f);
	return (off_t)strlen(line);
}

static void test_no_request(void **state)
{
	FILE *f = fopen(other, "w");

	(void)state;
	fputs("# nothing\n\n", f);
	fclose(f);
	assert_int_equal(run_on(other), CLI_FAILED);
	copy(2, 0, 1);
	assert_int_equal(truncate(other, first_line()), 0);
	assert_int_equal(run_on(other), CLI_GOOD); /* an event while nothing could be evaluated */
	assert_int_equal(run_on("/nonexistent/x.requests"), CLI_FAILED);
	assert_int_equal(run_on(dir), CLI_FAILED);
}

static void test_bad_configuration(void **state)
{
	struct replay_args a = args_of(path);

	(void)state;
	a.setup.set[a.setup.n_set++] = "mc.sed=2";
	assert_int_equal(requests_run("test", &a), CLI_CONFIG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_all_equal),         cmocka_unit_test(test_another_result),
		cmocka_unit_test(test_another_seed),      cmocka_unit_test(test_other_threads),
		cmocka_unit_test(test_damaged_line),      cmocka_unit_test(test_no_request),
		cmocka_unit_test(test_bad_configuration),
	};

	return cmocka_run_group_tests(tests, write_file, remove_files);
}
