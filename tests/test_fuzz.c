/* SPDX-License-Identifier: MIT
 * Mutations of configurations, logs and DBC files through everything that reads them: the configuration and its mapping, the
 * log, the estimator, aebmc inputs and aebmc map. Each ends well or in one line. Meant for the sanitizers; `make fuzz` for many.
 */
#include "fuzz.h"
#include <errno.h>
#include <unistd.h>
#include "../tools/inputs.h"
#include "../tools/mapper.h"
#include "clock.h"
#include "conf_dir.h"
#include "estimator.h"

#define INPUTS      4000 /* of all kinds */
#define KINDS       4
#define LOG_LINES   150
#define FRAMES_EACH 60

/* What the files are made of, and what they should not be. */
static const char *const pieces[] = {
	"[bus]",       "[signal distance]",
	"[message X]", "from = ",
	"{0..15}",     "{9..1}",
	"{00..63}",    "unit = km/h",
	"table = ",    "na = -1",
	"= nan",       "1e308",
	"\n",          "\r\n",
	"#",           "=",
	"]",           "\xff",
	"\xC2\xB0/s",  "18446744073709551615",
	"0x",          "can0",
	" R\n",        "##1",
	"#R",          "(1700000000.000000) can0 100#",
	"(0.0)",       ".",
	" ",           "DEADBEEF",
	"SG_ ",        "BO_ ",
	"@0-",         "|64",
	"\"",          ";",
};

static struct fuzz z = {20260101, pieces, sizeof(pieces) / sizeof(pieces[0])};
static const char *const cars[] = {"generic", "toyota-tss-p", "ars408", "hyundai-kia-scc11",
				   "generic-objects"};
#define CARS (sizeof(cars) / sizeof(cars[0]))

struct file {
	size_t len;
	char text[FUZZ_TEXT_MAX];
};

static struct file conf[CARS], dbc[CARS], drive[CARS];
static char dir[CONF_DIR_PATH];
static FILE *nowhere;

/* ---- logs for the cars: frames of their messages, random but for their identifiers ------------------- */

static void random_frame(struct bus_frame *f, const struct dbc *d, int64_t t_ns)
{
	const struct dbc_message *m = &d->messages[fuzz_pick(&z, d->n_messages)];

	*f = (struct bus_frame){
		.t_ns = t_ns, .id = m->id, .len = m->size, .iface = (uint8_t)fuzz_pick(&z, 2)};
	for (int i = 0; i < f->len; i++) {
		f->data[i] = (uint8_t)fuzz_pick(&z, 256);
	}
}

static void write_drive(struct file *out, const struct dbc *d)
{
	for (int i = 0; i < LOG_LINES; i++) {
		struct bus_frame f;

		random_frame(&f, d, (1700000000000 + 10 * i) * CLOCK_NS_PER_MS);
		out->len += (size_t)bus_log_format(&f, f.iface ? "can1" : "can0",
						   out->text + out->len, 200);
		out->text[out->len++] = '\n';
	}
}

static int set_up(void **state)
{
	char path[2 * CONF_DIR_PATH], err[256];

	(void)state;
	conf_dir_open(dir);
	nowhere = fopen("/dev/null", "w");
	assert_non_null(nowhere);
	for (size_t i = 0; i < CARS; i++) {
		struct dbc *d;

		snprintf(path, sizeof(path), "can-dbc/vehicles/%s.conf", cars[i]);
		conf[i].len = fuzz_read(path, conf[i].text);
		snprintf(path, sizeof(path), "can-dbc/vehicles/%s.dbc", cars[i]);
		dbc[i].len = fuzz_read(path, dbc[i].text);
		assert_int_equal(dbc_parse(path, dbc[i].text, dbc[i].len, &d, err, sizeof(err)), 0);
		write_drive(&drive[i], d);
		dbc_free(d);
	}
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	fclose(nowhere);
	conf_dir_close(dir);
	return 0;
}

/* One line, and not an empty one. */
static void assert_line(const char *err)
{
	assert_true(err[0] != '\0');
	assert_null(strchr(err, '\n'));
}

static const struct file *mutant(const struct file *of, struct file *m, uint32_t most)
{
	memcpy(m->text, of->text, of->len);
	m->len = fuzz_mutate(&z, m->text, of->len, most);
	return m;
}

/* Files as a user has them; their path is the configuration's. */
static void write_car(size_t car, const struct file *c, const struct file *d, char path[])
{
	char name[64], ignored[2 * CONF_DIR_PATH];

	snprintf(name, sizeof(name), "%s.dbc", cars[car]);
	conf_dir_write(dir, name, d->text, d->len, ignored);
	conf_dir_write(dir, "car.conf", c->text, c->len, path);
}

/* ---- a mapping that loaded ------------------------------------------------------------------------------ */

static void judge(struct inputs *in)
{
	static struct inputs_judge j;

	inputs_judge(&j, in);
	for (int i = 0; i < j.n; i++) {
		assert_line(j.verdict[i].what);
	}
	inputs_table(in, 0, nowhere);
	inputs_verdicts(&j, nowhere);
	inputs_json(in, &j, "fuzz", 0, nowhere);
}

static void take_frame(struct estimator *e, struct inputs *in, const struct bus_frame *f)
{
	struct scene s;

	assert_true(f->len <= BUS_DATA_MAX);
	inputs_frame(in, f);
	if (estimator_frame(e, f)) {
		estimator_scene(e, f->t_ns, &s);
	}
}

static void exercise_mapping(const struct config *cfg, const struct mapping *map)
{
	struct estimator *e;
	struct inputs *in;
	struct bus_frame f;

	assert_int_equal(estimator_open(cfg, map, &e), 0);
	assert_int_equal(inputs_open(cfg, map, &in), 0);
	for (int i = 0; i < FRAMES_EACH; i++) {
		random_frame(&f, map->dbc, CLOCK_NS_PER_S + i * 7 * CLOCK_NS_PER_MS);
		f.len = fuzz_pick(&z, 20) ? f.len : (uint8_t)fuzz_pick(&z, BUS_DATA_MAX + 1);
		take_frame(e, in, &f);
	}
	judge(in);
	inputs_close(in);
	estimator_close(e);
}

static int try_config(const char *path)
{
	struct config cfg;
	struct mapping *map;
	char err[1024] = "";

	if (config_load(path, NULL, 0, &cfg, &map, err, sizeof(err))) {
		assert_line(err);
		return 0;
	}
	config_print(&cfg, map, nowhere);
	exercise_mapping(&cfg, map);
	config_mapping_free(map);
	return 1;
}

static void test_configurations(void **state)
{
	const uint32_t inputs = fuzz_inputs(INPUTS, KINDS);
	static struct file c, d;
	char path[2 * CONF_DIR_PATH];
	uint32_t good = 0;

	(void)state;
	for (uint32_t i = 0; i < inputs; i++) {
		const size_t car = fuzz_pick(&z, CARS);
		const int both = fuzz_pick(&z, 4) == 0;

		write_car(car, mutant(&conf[car], &c, 3),
			  both ? mutant(&dbc[car], &d, 2) : &dbc[car], path);
		good += (uint32_t)try_config(path);
	}
	print_message("# %u configurations: %u good, %u refused\n", inputs, good, inputs - good);
	assert_in_range(good, inputs / 10, inputs * 9 / 10);
}

/* ---- frames: a good mapping of a mutated DBC -------------------------------------------------------------- */

static void test_databases(void **state)
{
	const uint32_t inputs = fuzz_inputs(INPUTS, KINDS);
	static struct file d;
	char path[2 * CONF_DIR_PATH];
	uint32_t good = 0;

	(void)state;
	for (uint32_t i = 0; i < inputs; i++) {
		const size_t car = fuzz_pick(&z, CARS);

		write_car(car, &conf[car], mutant(&dbc[car], &d, 4), path);
		good += (uint32_t)try_config(path);
	}
	print_message("# %u databases behind configurations: %u good, %u refused\n", inputs, good,
		      inputs - good);
	assert_in_range(good, inputs / 20, inputs * 9 / 10);
}

/* ---- logs ------------------------------------------------------------------------------------------------ */

static uint64_t read_log(const char *path, const struct config *cfg, const struct mapping *map)
{
	static const char *const iface[] = {"can0", "can1"};
	struct estimator *e;
	struct inputs *in;
	struct bus_frame f[8];
	struct bus *bus;
	char err[512];
	int64_t now_ns = 0, before_ns = INT64_MIN;
	int n;

	assert_int_equal(bus_log_open(path, NULL, iface, 2, &bus, err, sizeof(err)), 0);
	assert_int_equal(estimator_open(cfg, map, &e), 0);
	assert_int_equal(inputs_open(cfg, map, &in), 0);
	while ((n = bus->ops->recv(bus, f, 8, CLOCK_NEVER, &now_ns)) > 0) {
		for (int i = 0; i < n; i++) {
			assert_true(f[i].t_ns >= before_ns);
			before_ns = f[i].t_ns;
			take_frame(e, in, &f[i]);
		}
	}
	assert_int_equal(n, -ENODATA);
	judge(in);
	const uint64_t frames = in->frames;

	inputs_close(in);
	estimator_close(e);
	bus->ops->close(bus);
	return frames;
}

static void test_logs(void **state)
{
	const uint32_t inputs = fuzz_inputs(INPUTS, KINDS);
	static struct file m;
	char path[2 * CONF_DIR_PATH], names[BUS_IFACES_MAX][BUS_NAME_MAX], err[512];
	uint64_t frames = 0;

	(void)state;
	for (size_t car = 0; car < CARS; car++) {
		struct config cfg;
		struct mapping *map;

		write_car(car, &conf[car], &dbc[car], path);
		assert_int_equal(config_load(path, NULL, 0, &cfg, &map, err, sizeof(err)), 0);
		for (uint32_t i = 0; i < inputs / CARS; i++) {
			mutant(&drive[car], &m, 12);
			conf_dir_write(dir, "drive.log", m.text, m.len, path);
			frames += read_log(path, &cfg, map);
			assert_in_range(census_interfaces(path, names, 0), 0, BUS_IFACES_MAX);
		}
		config_mapping_free(map);
	}
	print_message("# %u logs: %llu frames\n", inputs, (unsigned long long)frames);
	assert_true(frames > (uint64_t)inputs * LOG_LINES / 4);
}

/* ---- aebmc map ------------------------------------------------------------------------------------------- */

static void rank_all(const struct mapper *m, struct mapper_choice choice[MAPPER_ROLES])
{
	const struct mapper_candidate *distance = NULL;

	for (int r = 0; r < MAPPER_ROLES; r++) {
		const int beside = mapper_role_table[r].whose != MAPPER_CAR && r != MAPPER_distance;

		choice[r].taken = -1;
		if (!beside || distance) {
			mapper_rank(m, (enum mapper_role)r, beside ? distance->family : -1,
				    distance, &choice[r]);
			choice[r].taken = choice[r].n ? 0 : -1;
		}
		if (r == MAPPER_distance && choice[r].n) {
			distance = &choice[r].at[0];
		}
	}
	if (distance) {
		mapper_write(m, choice, "fuzz.dbc", "can0", nowhere);
	}
}

static int try_map(const struct file *text)
{
	static struct mapper_choice choice[MAPPER_ROLES];
	struct mapper *m;
	struct bus_frame f;
	struct dbc *d;
	char err[256] = "";

	if (dbc_parse("fuzz.dbc", text->text, text->len, &d, err, sizeof(err))) {
		assert_line(err);
		return 0;
	}
	assert_int_equal(mapper_open(d, &m), 0);
	for (int i = 0; i < FRAMES_EACH; i++) {
		random_frame(&f, d, CLOCK_NS_PER_S + i * 30 * CLOCK_NS_PER_MS);
		mapper_frame(m, &f);
	}
	rank_all(m, choice);
	mapper_close(m);
	dbc_free(d);
	return 1;
}

static void test_map(void **state)
{
	const uint32_t inputs = fuzz_inputs(INPUTS, KINDS);
	static struct file d;
	uint32_t good = 0;

	(void)state;
	for (uint32_t i = 0; i < inputs; i++) {
		good += (uint32_t)try_map(mutant(&dbc[fuzz_pick(&z, CARS)], &d, 3));
	}
	print_message("# %u databases through map: %u good, %u refused\n", inputs, good,
		      inputs - good);
	assert_in_range(good, inputs / 20, inputs * 9 / 10);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_configurations),
		cmocka_unit_test(test_databases),
		cmocka_unit_test(test_logs),
		cmocka_unit_test(test_map),
	};

	return cmocka_run_group_tests(tests, set_up, tear_down);
}
