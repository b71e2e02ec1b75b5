/* SPDX-License-Identifier: MIT
 * aebmc inputs on a live bus, which here is a script of frames; tables that are cut; who is counted where.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <pty.h>
#include <stdlib.h>
#include <sys/wait.h>
#include "../tools/cli.c"
#include "bus.h"

#define bus_socketcan_open    fake_open
#define bus_socketcan_service fake_service
static int fake_open(const struct bus_socketcan_params *p, struct bus **ret, char *err,
		     int err_len);
static void fake_service(struct bus *b);
#include "../tools/inputs.c"

/* ---- what is not under test ------------------------------------------------------------------------ */

const struct argp setup_argp; /* --config and --set are set below */

int setup_load(const char *name, const struct setup *s, struct config *cfg, struct mapping **map)
{
	char err[512];

	(void)name;
	return config_load(s->path, s->set, s->n_set, cfg, map, err, sizeof(err));
}

struct progress progress_start(const char *what)
{
	return (struct progress){.what = what};
}

void progress_update(struct progress *p, double share, const char *words)
{
	(void)p;
	(void)share;
	(void)words;
}

void progress_clear(struct progress *p)
{
	(void)p;
}

/* ---- the bus ---------------------------------------------------------------------------------------- */

static struct {
	struct bus bus;
	int refused, error; /* of opening; of receiving after a second */
	int n_input, services, closed;
	uint32_t first_id;
	int64_t now_ns, start_ns;
	uint8_t counter;
} fake;

/* EGO every 20 ms, without a check: 20 m/s; nothing else comes. */
static int fake_recv(struct bus *b, struct bus_frame *f, int max, int64_t until_ns, int64_t *now_ns)
{
	(void)b;
	assert_true(max >= 1);
	fake.now_ns += 20 * CLOCK_NS_PER_MS;
	if (fake.error && fake.now_ns - fake.start_ns > CLOCK_NS_PER_S) {
		return fake.error;
	}
	if (fake.now_ns > until_ns) {
		*now_ns = fake.now_ns = until_ns;
		return 0;
	}
	*f = (struct bus_frame){.t_ns = fake.now_ns, .id = 0x100, .len = 8};
	f->data[2] = (uint8_t)(0xD0 + fake.counter++ % 4); /* 2000 in 14 bits, 0.01 m/s each */
	f->data[3] = 0x07;
	*now_ns = fake.now_ns;
	return 1;
}

static void fake_close(struct bus *b)
{
	(void)b;
	fake.closed++;
}

static const struct bus_ops fake_ops = {.name = "fake", .recv = fake_recv, .close = fake_close};

static int fake_open(const struct bus_socketcan_params *p, struct bus **ret, char *err, int err_len)
{
	if (fake.refused) {
		snprintf(err, (size_t)err_len, "no CAN here");
		return fake.refused;
	}
	fake.bus.ops = &fake_ops;
	fake.n_input = p->n_input;
	fake.first_id = p->input[0].id;
	fake.now_ns = fake.start_ns = clock_now_ns();
	*ret = &fake.bus;
	return 0;
}

static void fake_service(struct bus *b)
{
	assert_ptr_equal(b, &fake.bus);
	fake.services++;
}

/* ---- running it -------------------------------------------------------------------------------------- */

/* Its exit code, with what it printed. */
static int run_inputs(char *text, size_t size, int is_json)
{
	char name[] = "aebmc inputs", source[] = "can0", seconds[] = "--seconds=3",
	     json[] = "--json";
	char *argv[] = {name, source, seconds, is_json ? json : NULL, NULL};
	struct args a = {.setup = {.path = "can-dbc/vehicles/generic.conf"}};
	char path[] = "/tmp/aebmc-test-XXXXXX";
	const int file = mkstemp(path), saved = dup(STDOUT_FILENO);
	struct config cfg;
	struct mapping *map;
	struct watch w = {.name = argv[0], .args = &a};

	assert_true(file >= 0 && saved >= 0);
	a.setup.set[a.setup.n_set++] = "message EGO.check=none";
	assert_int_equal(cli_parse(&argp, is_json ? 4 : 3, argv, &a), 0);
	assert_int_equal(setup_load(argv[0], &a.setup, &cfg, &map), 0);
	assert_int_equal(inputs_open(&cfg, map, &w.in), 0);
	fflush(stdout);
	dup2(file, STDOUT_FILENO);
	const int code = open_and_run(&w, map);

	fflush(stdout);
	dup2(saved, STDOUT_FILENO);
	const ssize_t n = pread(file, text, size - 1, 0);

	text[n > 0 ? n : 0] = '\0';
	unlink(path);
	close(file);
	close(saved);
	inputs_close(w.in);
	config_mapping_free(map);
	return code;
}

static void reset(void)
{
	memset(&fake, 0, sizeof(fake));
}

static void test_live(void **state)
{
	char text[8192];

	(void)state;
	reset();
	assert_int_equal(run_inputs(text, sizeof(text), 0),
			 CLI_FAILED); /* DRIVER and LEAD do not come */
	assert_int_equal(fake.n_input, 3);
	assert_int_equal(fake.first_id, 0x100);
	assert_int_equal(fake.closed, 1);
	assert_in_range(fake.services, 8, 30); /* each quarter of a second */
	assert_non_null(strstr(text, "EGO.SPEED                      ego_speed       20."));
	assert_non_null(strstr(text, "WRONG    DRIVER: nothing comes on can0 in 3."));
	assert_non_null(strstr(text, " s (and so: LEAD)\n"));
	assert_non_null(strstr(text, "good     EGO: a frame every 20"));
	assert_null(strchr(text, '\033'));
}

static void test_live_json(void **state)
{
	char text[8192];

	(void)state;
	reset();
	assert_int_equal(run_inputs(text, sizeof(text), 1), CLI_FAILED);
	assert_non_null(strstr(text, "\"schema\":\"aebmc.inputs.1\""));
	assert_non_null(strstr(text, "\"wrong\":true"));
}

static void test_live_errors(void **state)
{
	char text[8192];

	(void)state;
	reset();
	fake.refused = -EAFNOSUPPORT;
	assert_int_equal(run_inputs(text, sizeof(text), 0), CLI_FAILED);
	assert_string_equal(text, "");
	assert_int_equal(fake.closed, 0);
	reset();
	fake.error = -EIO;
	assert_int_equal(run_inputs(text, sizeof(text), 0), CLI_FAILED);
	assert_string_equal(text, "");
	assert_int_equal(fake.closed, 1);
	reset();
}

/* In a process of its own, with a terminal of 10 lines. */
static void test_terminal(void **state)
{
	const struct winsize size = {.ws_row = 10, .ws_col = 100};
	char text[65536];
	size_t n = 0;
	ssize_t got;
	int master, status;

	(void)state;
	reset();
	const pid_t child = forkpty(&master, NULL, NULL, &size);

	if (child == 0) {
		struct args a = {.setup = {.path = "can-dbc/vehicles/generic.conf"},
				 .source = "can0",
				 .seconds = 1};
		struct config cfg;
		struct mapping *map;
		struct watch w = {.name = "aebmc inputs", .args = &a};
		const int failed =
			setup_load("", &a.setup, &cfg, &map) || inputs_open(&cfg, map, &w.in);
		const int code = failed ? 99 : open_and_run(&w, map);

		fflush(stdout);
		_exit(code);
	}
	assert_true(child > 0);
	while (n < sizeof(text) - 1 && (got = read(master, text + n, sizeof(text) - 1 - n)) > 0) {
		n += (size_t)got;
	}
	text[n] = '\0';
	assert_int_equal(waitpid(child, &status, 0), child);
	close(master);
	assert_true(WIFEXITED(status) && WEXITSTATUS(status) == CLI_FAILED);
	assert_non_null(strstr(text, "\033[H\033[J"));
	assert_non_null(strstr(text, "... 6 more rows"));
}

/* ---- the table, the census ----------------------------------------------------------------------------- */

static void test_table_is_cut(void **state)
{
	struct config cfg;
	struct mapping *map;
	struct inputs *in;
	char err[512], *text = NULL;
	size_t len;

	(void)state;
	assert_int_equal(config_load("can-dbc/vehicles/toyota-tss-p.conf", NULL, 0, &cfg, &map, err,
				     sizeof(err)),
			 0);
	assert_int_equal(inputs_open(&cfg, map, &in), 0);
	for (int lines = 5; lines < 40; lines += 7) {
		FILE *out = open_memstream(&text, &len);
		int n = 0;

		inputs_table(in, lines, out);
		fclose(out);
		for (const char *p = text; *p; p++) {
			n += *p == '\n';
		}
		assert_in_range(n, 3, lines - 1);
		assert_non_null(strstr(text, "more rows"));
		free(text);
	}
	inputs_close(in);
	config_mapping_free(map);
}

static void test_census(void **state)
{
	static struct census c;

	(void)state;
	for (uint32_t i = 0; i < 2 * CENSUS_MAX; i++) {
		census_add(&c, i % 3 == 0, 3 * i);
		census_add(&c, 1, 0x700);
	}
	assert_int_equal(c.n, CENSUS_MAX); /* further ones are not counted */
	assert_true(census_find(&c, 1, 0x700)->frames >= 2 * CENSUS_MAX - 1);
	assert_null(census_find(&c, 0, 0x700));
	assert_int_equal(census_elsewhere(&c, 0x700)->iface, 1);
	assert_null(census_elsewhere(&c, 1));
	assert_int_equal(census_nearest(&c, 0, 4)->id, 3);
	assert_int_equal(census_nearest(&c, 0, 100)->id, 102);
	assert_null(census_nearest(&c, 5, 100));
}

static void test_interfaces(void **state)
{
	char name[BUS_IFACES_MAX][BUS_NAME_MAX] = {"can0"}, path[] = "/tmp/aebmc-test-XXXXXX";
	FILE *f = fdopen(mkstemp(path), "w");

	(void)state;
	assert_non_null(f);
	fputs("(1.000000) can0 100#00\nnonsense\n(1.000000) can5 100#00\n(1.000000) \033[31m "
	      "100#00\n",
	      f);
	for (int i = 0; i < 2 * BUS_IFACES_MAX; i++) {
		fprintf(f, "(1.000000) v%d 100#00\n", i);
	}
	fclose(f);
	assert_int_equal(census_interfaces(path, name, 1), BUS_IFACES_MAX);
	assert_string_equal(name[1], "can5");
	assert_string_equal(name[2], "v0");
	unlink(path);
	assert_int_equal(census_interfaces(path, name, 1), 1);
	assert_int_equal(census_interfaces("/tmp", name, 1), 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_live),         cmocka_unit_test(test_live_json),
		cmocka_unit_test(test_live_errors),  cmocka_unit_test(test_terminal),
		cmocka_unit_test(test_table_is_cut), cmocka_unit_test(test_census),
		cmocka_unit_test(test_interfaces),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
