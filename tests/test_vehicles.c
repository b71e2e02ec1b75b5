/* SPDX-License-Identifier: MIT
 * The cars that come with the program: what their files say, that they print and hash as they should, and what becomes
 * of 20,000 spoilt copies.
 */
#include "conf_dir.h"

#include "config.h"
#include "mapping.h"

#define TEXT_MAX 16384 /* longest shipped file */

static char dir[CONF_DIR_PATH];

static const char *const cars[] = {"generic", "toyota-tss-p", "hyundai-kia-scc11", "ars408",
				   "generic-objects"};

static struct mapping *load_car(const char *car, struct config *c, const char *const *set,
				int n_set)
{
	char path[128], err[1024];
	struct mapping *m = NULL;

	snprintf(path, sizeof(path), "can-dbc/vehicles/%s.conf", car);
	if (config_load(path, set, n_set, c, &m, err, sizeof(err))) {
		fail_msg("%s", err);
	}
	return m;
}

static void shipped_toyota(void **state)
{
	struct config c;
	struct mapping *m = load_car("toyota-tss-p", &c, NULL, 0);

	(void)state;
	assert_int_equal(m->n_messages, 17);
	assert_int_equal(m->n_tracks, 16);
	assert_true(m->role[MAP_EGO_SPEED].n == 1 &&
		    m->role[MAP_EGO_SPEED].signal[0].gain == 1.0 / 3.6);
	for (int i = 0; i < 16; i++) {
		const struct map_track *t = &m->track[i];
		const struct map_message *msg = &m->message[t->message];

		assert_int_equal(msg->msg->id, 0x210 + i);
		assert_true(msg->iface == 1 && msg->check == E2E_TOYOTA &&
			    msg->period_ns == 50000000);
		assert_string_equal(msg->counter->name, "COUNTER");
		assert_true(t->distance.has_na && t->distance.na_raw == 0x1FFF &&
			    t->distance.offset == 0.0);
		assert_true(t->lateral.gain == -1.0 && t->rel_speed.gain == 1.0);
		assert_true(t->valid.sig && t->fresh.sig && !t->existence.sig);
	}
	config_mapping_free(m);
}

static void shipped_generic(void **state)
{
	struct config c;
	struct mapping *m = load_car("generic", &c, NULL, 0);

	(void)state;
	assert_int_equal(m->n_messages, 3);
	assert_int_equal(m->n_tracks, 1);
	for (int i = 0; i < 3; i++) {
		assert_true(m->message[i].check == E2E_P2 && m->message[i].iface == 0);
	}
	for (int r = 0; r < MAP_ROLES; r++) {
		assert_int_equal(m->role[r].n, 1);
		assert_true(m->role[r].signal[0].has_na);
	}
	assert_true(m->track[0].distance.has_na && m->track[0].existence.sig);
	config_mapping_free(m);
}

static void shipped_ars408(void **state)
{
	struct config c;
	struct mapping *m = load_car("ars408", &c, NULL, 0);
	const struct map_track *t = &m->track[0];

	(void)state;
	assert_int_equal(m->n_messages, 5);
	assert_int_equal(m->n_tracks, 1);
	assert_int_equal(m->message[m->list.header].msg->id, 0x60A);
	assert_int_equal(m->message[t->message].msg->id, 0x60B);
	assert_int_equal(m->message[m->list.quality].msg->id, 0x60C);
	assert_int_equal(t->existence.message, m->list.quality);
	assert_int_equal(t->existence.table->n, 8);
	assert_true(t->distance_sigma.table->n == 31 && t->rate_sigma.table->n == 31);
	assert_true(t->distance_sigma.has_na && t->distance_sigma.na_raw == 31);
	for (uint32_t i = 1; i < 31; i++) {
		assert_true(t->distance_sigma.table->value[i] >
			    t->distance_sigma.table->value[i - 1]);
		assert_true(t->rate_sigma.table->value[i] == t->distance_sigma.table->value[i]);
	}
	config_mapping_free(m);
}

static void shipped_generic_objects(void **state)
{
	struct config c;
	struct mapping *m = load_car("generic-objects", &c, NULL, 0);

	(void)state;
	assert_int_equal(m->n_messages, 3);
	assert_true(m->list.count.sig && m->list.id.sig && m->list.quality == -1);
	assert_true(m->track[0].distance.has_na && m->track[0].existence.has_na);
	for (int i = 0; i < 3; i++) {
		assert_true(m->message[i].check == E2E_P2);
	}
	config_mapping_free(m);
}

static void shipped_hyundai_kia(void **state)
{
	struct config c;
	struct mapping *m = load_car("hyundai-kia-scc11", &c, NULL, 0);

	(void)state;
	assert_int_equal(m->n_messages, 4);
	assert_int_equal(m->n_tracks, 1);
	assert_int_equal(m->role[MAP_EGO_SPEED].n, 4);
	assert_int_equal(m->list.header, -1);
	assert_true(m->track[0].lateral.gain == -1.0);
	assert_string_equal(m->message[m->track[0].message].counter->name, "AliveCounterACC");
	config_mapping_free(m);
}

/* Decisions rest on thresholds that are the same for every car. */
static void shipped_thresholds_are_default(void **state)
{
	struct config c, d;

	(void)state;
	config_defaults(&d);
	for (size_t i = 0; i < sizeof(cars) / sizeof(cars[0]); i++) {
		config_mapping_free(load_car(cars[i], &c, NULL, 0));
		assert_true(c.decision_p_warn == d.decision_p_warn &&
			    c.decision_p_defer == d.decision_p_defer);
		assert_true(c.decision_p_driver == d.decision_p_driver &&
			    c.decision_p_nobody == d.decision_p_nobody);
		assert_true(c.decision_p_release == d.decision_p_release &&
			    c.brake_accel == d.brake_accel);
	}
}

static void hash_sees_the_mapping(void **state)
{
	static const char *const sets[] = {
		"signal distance.offset=0.5",   "signal distance.na=0x1FFE",
		"signal lateral.negate=no",     "signal ego_speed.from=WHEEL_SPEEDS.WHEEL_FR",
		"message SPEED.interface=can1", "message SPEED.check=none",
		"message SPEED.period=25",      "radar.scan_gap=13",
	};
	static const char *const same[] = {"mc.threads=4", "signal lateral.unit=m",
					   "message SPEED.period=24.0"};
	struct config c;
	struct mapping *m = load_car("toyota-tss-p", &c, NULL, 0);
	uint64_t hash = config_hash(&c, m);
	char *moved = strdup(c.dbc_file);

	(void)state;
	config_mapping_free(m);
	for (size_t i = 0; i < sizeof(sets) / sizeof(sets[0]); i++) {
		m = load_car("toyota-tss-p", &c, &sets[i], 1);
		if (config_hash(&c, m) == hash) {
			fail_msg("%s leaves the hash as it is", sets[i]);
		}
		config_mapping_free(m);
	}
	m = load_car("toyota-tss-p", &c, same, 2);
	assert_true(config_hash(&c, m) == hash);
	assert_string_equal(c.dbc_file, moved);
	config_mapping_free(m);
	free(moved);
}

static void print_round_trip(void **state)
{
	static char first[1 << 16], second[1 << 16];
	char path[2 * CONF_DIR_PATH], err[1024];

	(void)state;
	for (size_t i = 0; i < sizeof(cars) / sizeof(cars[0]); i++) {
		static const char *const set[] = {"signal distance.offset=0.1",
						  "signal yaw_rate.unit=rad/s"};
		struct config c;
		struct mapping *m = load_car(cars[i], &c, set, i ? 1 : 2);

		for (int pass = 0; pass < 2; pass++) {
			uint64_t hash = config_hash(&c, m);
			FILE *f;

			snprintf(path, sizeof(path), "%s/print.conf", dir);
			f = fopen(path, "w");
			config_print(&c, m, f);
			fclose(f);
			conf_dir_read(path, pass ? second : first, sizeof(first));
			config_mapping_free(m);
			if (config_load(path, NULL, 0, &c, &m, err, sizeof(err))) {
				fail_msg("%s", err);
			}
			assert_true(config_hash(&c, m) == hash);
		}
		assert_string_equal(first, second);
		config_mapping_free(m);
	}
}

/* ---- spoilt files ---- */

static uint64_t next(uint64_t *seed)
{
	*seed ^= *seed << 13;
	*seed ^= *seed >> 7;
	*seed ^= *seed << 17;
	return *seed * 0x2545F4914F6CDD1Du >> 32;
}

/* spoil - one change: a byte replaced, removed or inserted, a stretch doubled or removed, or a line replaced */
static size_t spoil(char *text, size_t n, uint64_t *seed)
{
	static const char *const lines[] = {"\n[", "\nmass = nan\n", "\n[signal ", "{0..99}", "=",
					    "#",   " = 0x",          "\r\n"};
	size_t at = next(seed) % (n + 1), len = 1 + next(seed) % 24;
	const char *line = lines[next(seed) % 8];

	len = at + len > n ? n - at : len;
	switch (next(seed) % 6) {
	case 0:
		text[at] = (char)next(seed);
		return at == n ? n + 1 : n;
	case 1:
		memmove(text + at, text + at + len, n - at - len);
		return n - len;
	case 2:
		memmove(text + at + len, text + at, n - at);
		return n + len;
	case 3:
		memmove(text + at + 1, text + at, n - at);
		text[at] = (char)(' ' + next(seed) % 95);
		return n + 1;
	case 4:
		if (at < n) {
			text[at] = (char)(text[at] ^ (1 << next(seed) % 8));
		}
		return n;
	default:
		memmove(text + at + strlen(line), text + at, n - at);
		memcpy(text + at, line, strlen(line));
		return n + strlen(line);
	}
}

/* try_spoilt - either it loads, and what is printed loads as the same; or there is one line that says why not */
static int try_spoilt(const char *text, size_t n)
{
	char path[2 * CONF_DIR_PATH], err[1024] = "";
	struct mapping *m = NULL;
	struct config c;
	uint64_t hash;
	FILE *f;

	conf_dir_write(dir, "spoilt.conf", text, n, path);
	if (config_load(path, NULL, 0, &c, &m, err, sizeof(err))) {
		assert_true(strlen(err) > strlen(path));
		assert_null(strchr(err, '\n'));
		assert_null(m);
		return 0;
	}
	hash = config_hash(&c, m);
	unlink(path);
	f = fopen(path, "w");
	config_print(&c, m, f);
	fclose(f);
	config_mapping_free(m);
	if (config_load(path, NULL, 0, &c, &m, err, sizeof(err))) {
		fail_msg("what was printed does not load: %s", err);
	}
	assert_true(config_hash(&c, m) == hash);
	config_mapping_free(m);
	return 1;
}

static void spoilt_files(void **state)
{
	char car[TEXT_MAX], text[2 * TEXT_MAX], path[2 * CONF_DIR_PATH], name[32];
	uint64_t seed = 20240229;
	int loaded = 0;

	(void)state;
	for (size_t k = 0; k < sizeof(cars) / sizeof(cars[0]); k++) {
		size_t len;

		snprintf(path, sizeof(path), "can-dbc/vehicles/%s.dbc", cars[k]);
		len = conf_dir_read(path, text, sizeof(text));
		snprintf(name, sizeof(name), "%s.dbc", cars[k]);
		conf_dir_write(dir, name, text, len, path);
		snprintf(path, sizeof(path), "can-dbc/vehicles/%s.conf", cars[k]);
		len = conf_dir_read(path, car, sizeof(car));
		for (int i = 0; i < 10000; i++) {
			size_t n = len;

			memcpy(text, car, len);
			for (uint64_t changes = 1 + next(&seed) % 4; changes > 0; changes--) {
				n = spoil(text, n, &seed);
			}
			loaded += try_spoilt(text, n);
		}
	}
	assert_in_range(loaded, 2000, 18000); /* both ways were taken often */
}

static int setup(void **state)
{
	(void)state;
	conf_dir_open(dir);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	conf_dir_close(dir);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shipped_toyota),
		cmocka_unit_test(shipped_generic),
		cmocka_unit_test(shipped_ars408),
		cmocka_unit_test(shipped_generic_objects),
		cmocka_unit_test(shipped_hyundai_kia),
		cmocka_unit_test(shipped_thresholds_are_default),
		cmocka_unit_test(hash_sees_the_mapping),
		cmocka_unit_test(print_round_trip),
		cmocka_unit_test(spoilt_files),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
