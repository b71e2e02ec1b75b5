/* SPDX-License-Identifier: MIT
 * Options: every way to get one wrong and the line that says so; printing, hashing, overriding.
 */
#include "conf_dir.h"

#include <errno.h>
#include <math.h>

#include "config.h"
#include "config_row.h"
#include "ini.h"

#define PATH_MAX_ (2 * CONF_DIR_PATH)

static char dir[CONF_DIR_PATH];

static int load_text(const char *text, size_t len, const char *const *set, int n_set,
		     struct config *c, char *err)
{
	char path[PATH_MAX_];

	conf_dir_write(dir, "test.conf", text, len, path);
	return config_load(path, set, n_set, c, NULL, err, 1024);
}

/* refused - one line, "DIR/test.conf" and then @want */
static void refused(const char *text, size_t len, const char *want)
{
	struct config c, before;
	char err[1024] = "", start[PATH_MAX_ + 256];

	memset(&c, 0x5A, sizeof(c));
	before = c;
	assert_int_equal(load_text(text, len, NULL, 0, &c, err), -EINVAL);
	snprintf(start, sizeof(start), "%s/test.conf%s", dir, want);
	if (strncmp(err, start, strlen(start)) != 0) {
		fail_msg("wanted %s, got %s", start, err);
	}
	assert_null(strchr(err, '\n'));
	assert_memory_equal(&c, &before, sizeof(c));
}

static const struct {
	const char *text, *want;
} bad[] = {
	/* names */
	{"[vehicl]\n", ":1: [vehicl]: no such section (nearest: vehicle)"},
	{"[VEHICLE]\n", ":1: [VEHICLE]: no such section (nearest: vehicle)"},
	{"[signals distance]\n", ":1: [signals distance]: no such section (nearest: signal)"},
	{"[mesage SPEED]\n", ":1: [mesage SPEED]: no such section (nearest: message)"},
	{"[vehicle]\n\nmas = 1\n", ":3: vehicle.mas: no such option (nearest: vehicle.mass)"},
	{"[vehicle]\nMASS = 1500\n", ":2: vehicle.MASS: no such option (nearest: vehicle.mass)"},
	{"[mc]\nsample = 1\n", ":2: mc.sample: no such option (nearest: mc.samples)"},
	{"[mc]\nthe samples = 1\n", ":2: mc.the samples: no such option"},
	/* numbers */
	{"[vehicle]\nmass = heavy\n",
	 ":2: vehicle.mass: 'heavy' is not a number; allowed: 300 to 60000 kg"},
	{"[vehicle]\nmass =\n", ":2: vehicle.mass: '' is not a number"},
	{"[vehicle]\nmass = 1500kg\n",
	 ":2: vehicle.mass: '1500kg' is not a number; allowed: 300 to 60000 kg"},
	{"[vehicle]\nmass = 1500 1600\n", ":2: vehicle.mass: '1500 1600' is not a number"},
	{"[vehicle]\nmass = 1,5\n", ":2: vehicle.mass: '1,5' is not a number"},
	{"[vehicle]\nmass = nan\n", ":2: vehicle.mass: 'nan' is not finite"},
	{"[vehicle]\nmass = NAN(1)\n", ":2: vehicle.mass: 'NAN(1)' is not finite"},
	{"[vehicle]\nmass = inf\n", ":2: vehicle.mass: 'inf' is not finite"},
	{"[vehicle]\nmass = -infinity\n", ":2: vehicle.mass: '-infinity' is not finite"},
	{"[vehicle]\nmass = 1e999\n", ":2: vehicle.mass: '1e999' is not finite"},
	{"[vehicle]\nmass = 299.9\n",
	 ":2: vehicle.mass: '299.9' is out of range; allowed: 300 to 60000 kg"},
	{"[vehicle]\nmass = 60001\n",
	 ":2: vehicle.mass: '60001' is out of range; allowed: 300 to 60000 kg"},
	{"[road]\nmu_sigma = -0.1\n",
	 ":2: road.mu_sigma: '-0.1' is out of range; allowed: 0 to 0.5"},
	{"[mc]\nsamples = 1e4\n",
	 ":2: mc.samples: '1e4' is not a whole number; allowed: 256 to 16777216"},
	{"[mc]\nsamples = 1000.0\n", ":2: mc.samples: '1000.0' is not a whole number"},
	{"[mc]\nsamples = 0x\n", ":2: mc.samples: '0x' is not a whole number"},
	{"[mc]\nsamples = 0x1G\n", ":2: mc.samples: '0x1G' is not a whole number"},
	{"[mc]\nsamples =\n", ":2: mc.samples: '' is not a whole number"},
	{"[mc]\nsamples = 255\n",
	 ":2: mc.samples: '255' is out of range; allowed: 256 to 16777216"},
	{"[mc]\nsamples = 16777217\n", ":2: mc.samples: '16777217' is out of range"},
	{"[mc]\nseed = 9223372036854775808\n",
	 ":2: mc.seed: '9223372036854775808' is out of range"},
	{"[mc]\nseed = -1\n", ":2: mc.seed: '-1' is out of range"},
	{"[bus]\nrequest_id = 0x20000000\n", ":2: bus.request_id: '0x20000000' is out of range"},
	{"[decision]\npartial = maybe\n",
	 ":2: decision.partial: 'maybe' is neither yes nor no; allowed: yes|no"},
	{"[decision]\npartial =\n", ":2: decision.partial: '' is neither yes nor no"},
	{"[mc]\ndraws = halton\n",
	 ":2: mc.draws: 'halton' is not among the choices; allowed: sobol|philox"},
	{"[mc]\ndraws = sobol|philox\n", ":2: mc.draws: 'sobol|philox' is not among the choices"},
	{"[mc]\ndraws =\n", ":2: mc.draws: '' is not among the choices"},
	/* options that depend on each other */
	{"[mc]\nbudget = 100\ntarget = 101\n", ":3: mc.target: longer than mc.budget"},
	{"[mc]\nbudget = 19\n", ": mc.target: longer than mc.budget"},
	{"[lead]\nhold_weight = 0\ndecay_weight = 0\nharder_weight = 0\nease_weight = 0\n",
	 ":2: lead.hold_weight: all four weights of [lead] are 0"},
	{"[vehicle]\nmass_floor = 1501\n", ":2: vehicle.mass_floor: above vehicle.mass"},
	{"[road]\nmu = 0.3\nmu_floor = 0.31\n", ":3: road.mu_floor: above road.mu"},
	{"[rt]\npriority = 60\n", ": rt.compute_priority: not below rt.priority"},
	{"[brake]\naccel_partial = -7\n",
	 ":2: brake.accel_partial: brakes harder than brake.accel"},
	{"[mc]\nsamples = 512\n[decision]\nsamples_min = 513\n",
	 ":4: decision.samples_min: above mc.samples"},
	{"[decision]\np_release = 0.6\n", ":2: decision.p_release: above decision.p_nobody"},
	{"[decision]\nspeed_max = 2\n", ": decision.speed_min: not below decision.speed_max"},
	{"[radar]\nperiod = 12\n", ": radar.scan_gap: not shorter than radar.period"},
	{"[bus]\ninterfaces = \n", ":2: bus.interfaces: must be 1 to 8 different names"},
	{"[bus]\ninterfaces = can0 can0\n", ":2: bus.interfaces: must be 1 to 8 different names"},
	{"[bus]\ninterfaces = interface-name16\n",
	 ":2: bus.interfaces: must be 1 to 8 different names"},
	{"[bus]\ninterfaces = a b c d e f g h i\n",
	 ":2: bus.interfaces: must be 1 to 8 different names"},
	{"[bus]\nout_interface = can1\n", ":2: bus.out_interface: not among bus.interfaces"},
	{"[bus]\nrequest_id = 0x7FC\n", ":2: bus.request_id: our other frames follow it"},
};

static void errors_are_named(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		refused(bad[i].text, strlen(bad[i].text), bad[i].want);
	}
}

static void long_string(void **state)
{
	char text[CONFIG_STR_MAX + 64];
	int n = snprintf(text, sizeof(text), "[bus]\ninterfaces = %0*d\n", CONFIG_STR_MAX, 0);

	(void)state;
	refused(text, (size_t)n, ":2: bus.interfaces: longer than 255 characters");
}

static const struct {
	const char *text;
	double mass;
	int64_t samples;
} good[] = {
	{"", 1500, 16384},
	{"\n\n# nothing\n", 1500, 16384},
	{"[vehicle]\nmass=1600", 1600, 16384},
	{"[vehicle]\r\nmass = 1600\r\n\r\n[mc]\r\nsamples = 4096\r\n", 1600, 4096},
	{"  [ vehicle ]  # \xC3\xA4\n\t mass\t=\t1.6e3 # kg\n", 1600, 16384},
	{"[vehicle]\nmass = +1600\n[mc]\nsamples = 0x1000\n", 1600, 4096},
	{"[vehicle]\nmass = 300\n[mc]\nsamples = 0256\n", 300, 256},
	{"[message X_{0..3}]\ninterface = can0\nanything = goes\n[signal y]\n[vehicle]\nmass = "
	 "60000\n",
	 60000, 16384},
};

static void good_files_are_read(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
		struct config c;
		char err[1024] = "";

		if (load_text(good[i].text, strlen(good[i].text), NULL, 0, &c, err)) {
			fail_msg("%s", err);
		}
		assert_true(c.vehicle_mass == good[i].mass);
		assert_int_equal(c.mc_samples, good[i].samples);
	}
}

static void every_kind_is_set(void **state)
{
	static const char text[] =
		"[mc]\nbackend = cuda\ndraws = philox\nseed = 9223372036854775807\n"
		"[decision]\npartial = yes\n[bus]\ninterfaces = can0  vcan1\n"
		"out_interface = vcan1\n[brake]\naccel = -9.5\n";
	char err[1024], name[BUS_IFACES_MAX][BUS_NAME_MAX];
	struct config c;

	(void)state;
	assert_int_equal(load_text(text, sizeof(text) - 1, NULL, 0, &c, err), 0);
	assert_int_equal(c.mc_backend, 2);
	assert_int_equal(c.mc_draws, 1);
	assert_true(c.mc_seed == INT64_MAX);
	assert_int_equal(c.decision_partial, 1);
	assert_true(c.brake_accel == -9.5);
	assert_int_equal(config_interfaces(&c, name), 2);
	assert_string_equal(name[0], "can0");
	assert_string_equal(name[1], "vcan1");
	assert_int_equal(config_out_interface(&c), 1);
	c.bus_out_interface[0] = '\0';
	assert_int_equal(config_out_interface(&c), 0);
}

static void overrides(void **state)
{
	static const char text[] = "[vehicle]\nmass = 1600\n";
	static const char *const two[] = {"vehicle.mass=1700", "vehicle.mass = 1800",
					  "road.mu=0.5"};
	static const struct {
		const char *set, *want;
	} wrong[] = {
		{"vehicle.mass", "--set: 'vehicle.mass' is no assignment; write section.key=value"},
		{"mass=1", "--set: 'mass=1' is no assignment"},
		{"=1", "--set: '=1' is no assignment"},
		{"", "--set: '' is no assignment"},
		{".mass=1", "--set: empty name"},
		{"vehicle.=1", "--set: [vehicle]: empty name"},
		{"vehicle.mas=1", "--set: vehicle.mas: no such option (nearest: vehicle.mass)"},
		{"vehicl.mass=1", "--set: [vehicl]: no such section (nearest: vehicle)"},
		{"vehicle.mass=1",
		 "--set: vehicle.mass: '1' is out of range; allowed: 300 to 60000 kg"},
		{"vehicle.mass=1\n2", "--set: byte 0x0A in column 15 is no text"},
		{"mc.target=531", "--set: mc.target: '531' is out of range"},
		{"mc.budget=10", ": mc.target: longer than mc.budget"},
	};
	struct config c;
	char err[1024], longest[INI_LINE_MAX + 2];
	const char *set = longest;

	(void)state;
	assert_int_equal(load_text(text, sizeof(text) - 1, two, 3, &c, err), 0);
	assert_true(c.vehicle_mass == 1800.0 && c.road_mu == 0.5);
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		assert_int_equal(load_text(text, sizeof(text) - 1, &wrong[i].set, 1, &c, err),
				 -EINVAL);
		if (!strstr(err, wrong[i].want)) {
			fail_msg("wanted %s, got %s", wrong[i].want, err);
		}
		assert_null(strchr(err, '\n'));
	}
	memset(longest, 'x', sizeof(longest) - 1);
	longest[INI_LINE_MAX + 1] = '\0';
	assert_int_equal(load_text(text, sizeof(text) - 1, &set, 1, &c, err), -EINVAL);
	assert_non_null(strstr(err, "--set: longer than 1000 characters"));
}

static void set_alone(void **state)
{
	struct config c, before;
	char err[256];

	(void)state;
	config_defaults(&c);
	assert_int_equal(config_set(&c, "road.mu = 0.3", err, sizeof(err)), 0);
	assert_true(c.road_mu == 0.3);
	assert_int_equal(config_set(&c, "bus.interfaces=vcan0 vcan1", err, sizeof(err)), 0);
	assert_string_equal(c.bus_interfaces, "vcan0 vcan1");
	before = c;
	assert_int_equal(config_set(&c, "road.mu=3", err, sizeof(err)), -EINVAL);
	assert_string_equal(err, "--set: road.mu: '3' is out of range; allowed: 0.05 to 1.5");
	assert_int_equal(config_set(&c, "road.mew=3", err, sizeof(err)), -EINVAL);
	assert_string_equal(
		err,
		"--set: road.mew: no such option (nearest: road.mu); --print-config lists all");
	assert_int_equal(config_set(&c, "road.mu", err, sizeof(err)), -EINVAL);
	assert_memory_equal(&c, &before, sizeof(c));
}

/* What is printed loads as the same, bit for bit, and prints the same. */
static void print_round_trip(void **state)
{
	static char first[1 << 16], second[1 << 16];
	char path[PATH_MAX_], err[1024];
	struct config c, again;
	FILE *f;

	(void)state;
	config_defaults(&c);
	c.vehicle_mass = 0x1.76fffffffffffp+10; /* 17 digits */
	c.road_mu = 0.1 + 0.2;
	c.vehicle_rho = 4.9406564584124654e-324;
	c.mc_seed = INT64_MAX;
	c.mc_draws = 1;
	c.decision_partial = 1;
	strcpy(c.bus_interfaces, "can0 can1");
	strcpy(c.bus_out_interface, "can1");
	for (char *text = first; text; text = text == first ? second : NULL) {
		snprintf(path, sizeof(path), "%s/print.conf", dir);
		f = fopen(path, "w");
		config_print(&c, NULL, f);
		fclose(f);
		conf_dir_read(path, text, sizeof(first));
		if (config_load(path, NULL, 0, &again, NULL, err, sizeof(err))) {
			fail_msg("%s", err);
		}
		assert_memory_equal(&c, &again, sizeof(c));
		c = again;
	}
	assert_string_equal(first, second);
	assert_non_null(strstr(first, "\nrequest_id = 0x2A0\n"));
	assert_non_null(strstr(first, "\npartial = yes\n"));
	assert_non_null(strstr(first, "\n# mean mass (Sec. IV) [300 to 60000 kg]\nmass = "));
}

static void options_list_every_row(void **state)
{
	static char text[1 << 16];
	char path[PATH_MAX_], name[64];
	FILE *f;

	(void)state;
	snprintf(path, sizeof(path), "%s/options", dir);
	f = fopen(path, "w");
	config_print_options(f);
	fclose(f);
	conf_dir_read(path, text, sizeof(text));
	assert_true(config_rows_len > 70);
	for (size_t i = 0; i < config_rows_len; i++) {
		snprintf(name, sizeof(name), "*%s* (", config_rows[i].name);
		assert_non_null(strstr(text, name));
		assert_non_null(strstr(text, config_rows[i].doc));
	}
	assert_non_null(
		strstr(text, "*vehicle.mass* (300 to 60000 kg; default 1500)\n\tmean mass"));
	assert_non_null(strstr(text, "*mc.draws* (sobol|philox; default sobol)\n"));
	assert_non_null(strstr(text, "*bus.out_interface* (name; default empty)\n"));
	assert_non_null(strstr(text, "*[signal distance]* (required)\n"));
	assert_non_null(strstr(text, "*negate*\n"));
}

/* Every row is sound: its default within its range, its limits said. */
static void rows_are_sound(void **state)
{
	struct config c, again;

	(void)state;
	config_defaults(&c);
	for (size_t i = 0; i < config_rows_len; i++) {
		char value[CONFIG_TEXT_MAX], limits[CONFIG_TEXT_MAX], set[2 * CONFIG_TEXT_MAX],
			err[256] = "";

		again = c;
		config_row_print(&config_rows[i], &c, value);
		config_row_limits(&config_rows[i], limits);
		snprintf(set, sizeof(set), "%s=%s", config_rows[i].name, value);
		if (config_set(&again, set, err, sizeof(err))) {
			fail_msg("%s", err);
		}
		assert_memory_equal(&c, &again, sizeof(c));
		assert_true(limits[0] != '\0');
	}
}

/* change - another value of @r than @c has */
static void change(const struct config_row *r, struct config *c)
{
	void *field = (char *)c + r->offset;

	switch (r->kind) {
	case CONFIG_KIND_num:
		*(double *)field = nextafter(*(double *)field, INFINITY);
		break;
	case CONFIG_KIND_int:
		*(int64_t *)field ^= 1;
		break;
	case CONFIG_KIND_bool:
	case CONFIG_KIND_choice:
		*(int32_t *)field ^= 1;
		break;
	case CONFIG_KIND_str:
		strcat(field, "x");
		break;
	}
}

static void hash_sees_every_change(void **state)
{
	struct config c;
	uint64_t hash;
	int unhashed = 0;

	(void)state;
	config_defaults(&c);
	hash = config_hash(&c, NULL);
	for (size_t i = 0; i < config_rows_len; i++) {
		config_defaults(&c);
		assert_true(config_hash(&c, NULL) == hash);
		change(&config_rows[i], &c);
		assert_int_equal(config_hash(&c, NULL) != hash, config_rows[i].hashed);
		unhashed += !config_rows[i].hashed;
	}
	assert_int_equal(
		unhashed,
		17); /* mc.backend, mc.calibration, mc.samples_cuda, mc.threads, dbc.file, tracing; this machine alone */
}

static void minus_zero_is_zero(void **state)
{
	struct config c, zero;
	char err[256];

	(void)state;
	config_defaults(&c);
	zero = c;
	assert_int_equal(config_set(&c, "road.grade=-0", err, sizeof(err)), 0);
	assert_memory_equal(&c, &zero, sizeof(c));
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
		cmocka_unit_test(errors_are_named),    cmocka_unit_test(long_string),
		cmocka_unit_test(good_files_are_read), cmocka_unit_test(every_kind_is_set),
		cmocka_unit_test(overrides),           cmocka_unit_test(set_alone),
		cmocka_unit_test(print_round_trip),    cmocka_unit_test(options_list_every_row),
		cmocka_unit_test(rows_are_sound),      cmocka_unit_test(hash_sees_every_change),
		cmocka_unit_test(minus_zero_is_zero),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
