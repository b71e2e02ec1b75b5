/* SPDX-License-Identifier: MIT
 * What the housekeeping thread decides: when the watchdog is fed, what a reload may change.
 */
#include "conf_dir.h"

#include <errno.h>

#include "clock.h"
#include "pipeline.h"
#include "service.h"

#define INTERVAL_NS CLOCK_NS_PER_S

static int fed;
static char logged[64], said[1100];   /* the last line of the log */
static const struct config *in_force; /* by the last reload */

static int told(const char *state)
{
	fed += !strcmp(state, "WATCHDOG=1");
	return 1;
}

static int64_t watchdog_ns(void)
{
	return INTERVAL_NS;
}

static void log_line(enum service_level level, const char *reason, const char *text)
{
	(void)level;
	snprintf(logged, sizeof(logged), "%s", reason);
	snprintf(said, sizeof(said), "%s", text);
}

static void take_config(struct pipeline *p, const struct config *cfg)
{
	(void)p;
	in_force = cfg;
}
#define service_notify      told
#define service_watchdog_ns watchdog_ns
#define service_log         log_line
#define pipeline_set_config take_config
#include "../daemon/housekeeping.c"
#undef service_notify
#undef service_watchdog_ns
#undef service_log
#undef pipeline_set_config

/* ---- sign of life -------------------------------------------------------------------------------- */

#define SHADOW AEB_STATUS_TRANSMIT_SHADOW

static void test_sign_of_life(void **state)
{
	static const struct {
		uint64_t steps, confirmed; /* since it was fed */
		int64_t transmit;
		uint32_t fault;
		int alive;
	} row[] = {
		{1, 1, SHADOW, 0, 1},
		{1, 0, SHADOW, 0, 0}, /* nothing came back, and the bus is fine */
		{1, 0, AEB_STATUS_TRANSMIT_ARMED, 0, 0},
		{1, 0, AEB_STATUS_TRANSMIT_NONE, 0, 1}, /* nothing is sent */
		{0, 1, SHADOW, 0, 0},                   /* the loop stands */
		{0, 0, AEB_STATUS_TRANSMIT_NONE, 0, 0},
		{1, 0, SHADOW, FAULT_BIT(BUS_DOWN), 1},
		{1, 0, SHADOW, FAULT_BIT(BUS_OFF), 1},
		{1, 0, SHADOW, FAULT_BIT(BUS_PASSIVE), 1},
		{1, 0, SHADOW, FAULT_BIT(TX_REFUSED), 1},
		{1, 0, AEB_STATUS_TRANSMIT_ARMED, FAULT_BIT(TX_REFUSED), 1},
		{0, 0, SHADOW, BUS_DEAD, 0},
		{1, 0, SHADOW, ~BUS_DEAD, 0}, /* no other reason excuses it */
	};

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct live l = {.fed_steps = 7, .fed_confirmed = 9};

		l.seen.steps = 7 + row[i].steps;
		l.seen.bus.confirmed = 9 + row[i].confirmed;
		l.seen.transmit = row[i].transmit;
		l.seen.now.fault = row[i].fault;
		print_message("row %zu\n", i);
		assert_int_equal(is_alive(&l), row[i].alive);
	}
}

static void test_watchdog_is_fed_by_new_signs_alone(void **state)
{
	struct live l = {.seen.steps = 1, .seen.bus.confirmed = 1, .seen.transmit = SHADOW};
	int64_t now_ns = CLOCK_NS_PER_S;

	(void)state;
	fed = 0;
	feed_watchdog(&l, now_ns);
	assert_int_equal(fed, 1);
	l.seen.steps++;
	feed_watchdog(&l, now_ns += INTERVAL_NS); /* the echo stays away */
	assert_int_equal(fed, 1);
	l.seen.bus.confirmed++;
	feed_watchdog(&l, now_ns);
	assert_int_equal(fed, 2);
	l.seen.bus.confirmed++;
	feed_watchdog(&l, now_ns += INTERVAL_NS); /* the loop stands */
	assert_int_equal(fed, 2);
	l.seen.steps++;
	feed_watchdog(&l, now_ns);
	l.seen.steps++;
	l.seen.bus.confirmed++;
	feed_watchdog(&l, now_ns += INTERVAL_NS / 8); /* not more often than it takes */
	assert_int_equal(fed, 3);
}

/* ---- reload ---------------------------------------------------------------------------------------- */

static char dir[CONF_DIR_PATH];

/* The shipped car, with @from in its DBC made @to. */
static void write_car(const char *from, const char *to)
{
	char text[16384], path[2 * CONF_DIR_PATH], *at;
	size_t len = conf_dir_read("can-dbc/vehicles/generic.conf", text, sizeof(text));

	conf_dir_write(dir, "car.conf", text, len, path);
	len = conf_dir_read("can-dbc/vehicles/generic.dbc", text, sizeof(text));
	at = strstr(text, from);
	assert_non_null(at);
	memcpy(at, to, strlen(to)); /* as long */
	conf_dir_write(dir, "generic.dbc", text, len, path);
}

/* @arg: one assignment in addition to the file, or NULL */
static int read_car(void *arg, struct config *cfg, struct mapping **map, char *err, int err_len)
{
	const char *const set = arg;
	char path[2 * CONF_DIR_PATH];

	snprintf(path, sizeof(path), "%s/car.conf", dir);
	return config_load(path, &set, set != NULL, cfg, map, err, err_len);
}

struct reload_row {
	const char *set;     /* one assignment in addition to the file, or NULL */
	const char *dbc[2];  /* what stands in the DBC, and what it becomes */
	const char *refused; /* what the log's line has; NULL: it is in force */
};

static void reload_one(const struct reload_row *row)
{
	char set[128] = "", err[1024] = "";
	struct mapping *map;
	struct config was;
	struct live l = {.cfg = &was, .reload = read_car};

	write_car("", "");
	assert_int_equal(read_car(NULL, &was, &map, err, sizeof(err)), 0);
	l.map = map;
	snprintf(set, sizeof(set), "%s", row->set ? row->set : "");
	l.reload_arg = row->set ? set : NULL;
	if (row->dbc[0]) {
		write_car(row->dbc[0], row->dbc[1]);
	}
	in_force = NULL;
	reload(&l);
	config_mapping_free(map);
	print_message("%s: %s\n", logged, said);
	assert_string_equal(logged, row->refused ? "RELOAD_REFUSED" : "RELOADED");
	assert_ptr_equal(in_force, row->refused ? NULL : &l.reloaded[1]);
	assert_true(!row->refused || strstr(said, row->refused));
	assert_null(strchr(said, '\n'));
}

static void test_reload_takes_what_it_may_and_refuses_the_rest(void **state)
{
	static const char mapping[] = "the mapping ([message], [signal]) or its DBC";
	static const struct reload_row row[] = {
		{.set = NULL},
		{.set = "decision.p_warn=0.2"},
		{.set = "driver.reaction=1.2"},
		{.set = "mc.samples=2048", .refused = "mc.samples: 16384 to 2048 takes a restart"},
		{.set = "rt.cpu=0", .refused = "rt.cpu: -1 to 0 takes a restart"},
		{.set = "decision.speed_min=3", .refused = "decision.speed_min: 2 to 3 takes"},
		{.set = "decision.samples_min=512", .refused = "decision.samples_min: 256 to 512"},
		{.set = "driver.override=0.8", .refused = "driver.override: 0.9 to 0.8 takes"},
		{.set = "dbc.file=can-dbc/vehicles/generic.dbc",
		 .refused = "generic.dbc takes a restart"},
		{.set = "signal rel_speed.negate=yes", .refused = mapping},
		{.set = "message EGO.period=30", .refused = mapping},
		{.dbc = {"(0.01,0)", "(0.02,0)"}, .refused = mapping},
		{.dbc = {" SPEED", " SPEEX"},
		 .refused = "SPEED"}, /* not valid: said by the file's reader */
		{.set = "decision.p_warn=7", .refused = "decision.p_warn"},
	};

	(void)state;
	conf_dir_open(dir);
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		reload_one(&row[i]);
	}
	conf_dir_close(dir);
}

/* The one in force is never the one that is filled. */
static void test_reloads_take_turns(void **state)
{
	char set[] = "decision.p_warn=0.2", err[1024];
	struct config was;
	struct mapping *map;
	struct live l = {.cfg = &was, .reload = read_car, .reload_arg = set};

	(void)state;
	conf_dir_open(dir);
	write_car("", "");
	assert_int_equal(read_car(NULL, &was, &map, err, sizeof(err)), 0);
	l.map = map;
	reload(&l);
	assert_ptr_equal(in_force, &l.reloaded[1]);
	set[sizeof(set) - 2] = '3';
	reload(&l);
	assert_ptr_equal(in_force, &l.reloaded[0]);
	assert_true(l.reloaded[1].decision_p_warn == 0.2 && l.reloaded[0].decision_p_warn == 0.3);
	set[sizeof(set) - 2] = 'x';
	reload(&l);
	assert_string_equal(logged, "RELOAD_REFUSED");
	assert_ptr_equal(in_force, &l.reloaded[0]);
	assert_true(l.reloaded[0].decision_p_warn == 0.3);
	config_mapping_free(map);
	conf_dir_close(dir);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_sign_of_life),
		cmocka_unit_test(test_watchdog_is_fed_by_new_signs_alone),
		cmocka_unit_test(test_reload_takes_what_it_may_and_refuses_the_rest),
		cmocka_unit_test(test_reloads_take_turns),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
