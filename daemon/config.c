/* SPDX-License-Identifier: MIT
 * Reading, checking, printing and hashing the options. What one value may be is said by its row in config.def; what
 * values may be together, by the table of checks.
 */
#include <errno.h>
#include <string.h>

#include "config.h"
#include "config_row.h"
#include "contract.h"
#include "hash.h"
#include "ini.h"
#include "mapping.h"
#include "text.h"

void config_defaults(struct config *c)
{
	*c = (struct config){0};
	for (size_t i = 0; i < config_rows_len; i++) {
		config_row_default(&config_rows[i], c);
	}
}

static const struct config_row *find_row(const char *section, const char *key)
{
	for (size_t i = 0; i < config_rows_len; i++) {
		const struct config_row *r = &config_rows[i];

		if (!strcmp(r->section, section) && !strcmp(r->key, key)) {
			return r;
		}
	}
	return NULL;
}

/* set - one key of an option's section */
static int set(const struct ini *ini, const struct ini_entry *e, struct config *c)
{
	const struct config_row *r = find_row(e->section, e->key);
	char name[2 * INI_NAME_MAX];

	if (r) {
		return config_row_parse(r, ini, e, c);
	}
	snprintf(name, sizeof(name), "%s.%s", e->section, e->key);
	return ini_fail(
		ini, e, "no such option (nearest: %s); --print-config lists all",
		text_nearest(name, &config_rows[0].name, config_rows_len, sizeof(config_rows[0])));
}

int config_set(struct config *c, const char *assignment, char *err, int err_len)
{
	const struct ini ini = {.path = "--set", .err = err, .err_len = err_len};
	struct ini_entry e;
	int rc = ini_split(&ini, assignment, &e);

	return rc ? rc : set(&ini, &e, c);
}

/* ---- interfaces ---- */

/* add_interface - append @word to @name[0..n-1]. 0 or -EINVAL. */
static int add_interface(char name[][BUS_NAME_MAX], int n, const char *word)
{
	if (n == BUS_IFACES_MAX || strlen(word) >= BUS_NAME_MAX) {
		return -EINVAL;
	}
	for (int i = 0; i < n; i++) {
		if (!strcmp(name[i], word)) {
			return -EINVAL;
		}
	}
	memset(name[n], 0, BUS_NAME_MAX);
	memcpy(name[n], word, strlen(word));
	return 0;
}

int config_interfaces(const struct config *c, char name[BUS_IFACES_MAX][BUS_NAME_MAX])
{
	char names[CONFIG_STR_MAX], *rest = names, *word;
	int n = 0;

	memcpy(names, c->bus_interfaces, sizeof(names));
	for (; (word = text_word(&rest)); n++) {
		if (add_interface(name, n, word)) {
			return -EINVAL;
		}
	}
	return n ? n : -EINVAL;
}

int config_out_interface(const struct config *c)
{
	char name[BUS_IFACES_MAX][BUS_NAME_MAX];
	int n = config_interfaces(c, name);

	for (int i = 0; i < n; i++) {
		if (!c->bus_out_interface[0] || !strcmp(name[i], c->bus_out_interface)) {
			return i;
		}
	}
	return -EINVAL;
}

/* ---- options that depend on each other ---- */

static int bad_target(const struct config *c)
{
	return c->mc_target > c->mc_budget;
}

static int bad_weights(const struct config *c)
{
	return c->lead_hold_weight + c->lead_decay_weight + c->lead_harder_weight +
		       c->lead_ease_weight <=
	       0.0;
}

static int bad_mass_floor(const struct config *c)
{
	return c->vehicle_mass_floor > c->vehicle_mass;
}

static int bad_mu_floor(const struct config *c)
{
	return c->road_mu_floor > c->road_mu;
}

static int bad_partial(const struct config *c)
{
	return c->brake_accel_partial < c->brake_accel;
}

static int bad_samples(const struct config *c)
{
	return c->decision_samples_min > c->mc_samples;
}

static int bad_release(const struct config *c)
{
	return c->decision_p_release > c->decision_p_nobody;
}

static int bad_speeds(const struct config *c)
{
	return c->decision_speed_min >= c->decision_speed_max;
}

static int bad_priority(const struct config *c)
{
	return c->rt_compute_priority >= c->rt_priority;
}

static int bad_gap(const struct config *c)
{
	return c->radar_scan_gap >= c->radar_period;
}

static int bad_interfaces(const struct config *c)
{
	char name[BUS_IFACES_MAX][BUS_NAME_MAX];

	return config_interfaces(c, name) < 0;
}

static int bad_out(const struct config *c)
{
	return config_out_interface(c) < 0;
}

static int bad_ids(const struct config *c)
{
	int64_t last = c->bus_request_id + CONTRACT_MESSAGES - 1;

	return last > BUS_ID_MASK || (c->bus_request_id <= 0x7FF && last > 0x7FF);
}

/* The option named is the one to look at; it need not be in the file. */
static const struct check {
	const char *section, *key;
	int (*bad)(const struct config *c);
	const char *what;
} checks[] = {
	{"mc", "target", bad_target, "longer than mc.budget; lower it"},
	{"lead", "hold_weight", bad_weights, "all four weights of [lead] are 0; give one a weight"},
	{"vehicle", "mass_floor", bad_mass_floor, "above vehicle.mass; lower it"},
	{"road", "mu_floor", bad_mu_floor, "above road.mu; lower it"},
	{"brake", "accel_partial", bad_partial,
	 "brakes harder than brake.accel; raise it towards 0"},
	{"decision", "samples_min", bad_samples,
	 "above mc.samples: nothing would ever be evidence"},
	{"decision", "p_release", bad_release,
	 "above decision.p_nobody, a request would flicker; lower it"},
	{"decision", "speed_min", bad_speeds, "not below decision.speed_max; lower it"},
	{"radar", "scan_gap", bad_gap,
	 "not shorter than radar.period, scans would run together; lower it"},
	{"rt", "compute_priority", bad_priority, "not below rt.priority; lower it"},
	{"bus", "interfaces", bad_interfaces,
	 "must be 1 to 8 different names of up to 15 characters"},
	{"bus", "out_interface", bad_out,
	 "not among bus.interfaces; add it there, or leave it empty"},
	{"bus", "request_id", bad_ids,
	 "our other frames follow it and must be of one length; stay below 0x7FC or above 0x7FF"},
};

static int check_all(const struct ini *ini, const struct config *c)
{
	for (size_t i = 0; i < sizeof(checks) / sizeof(checks[0]); i++) {
		const struct check *k = &checks[i];
		const struct ini_entry *e = ini_get(ini, k->section, k->key);

		if (!k->bad(c)) {
			continue;
		}
		return e ? ini_fail(ini, e, "%s", k->what)
			 : ini_fail(ini, NULL, "%s.%s: %s", k->section, k->key, k->what);
	}
	return 0;
}

/* ---- a file ---- */

static const char *nearest_section(const char *section)
{
	char word[INI_NAME_MAX];
	const char *names[] = {NULL, "message", "signal"};

	snprintf(word, sizeof(word), "%.*s", (int)strcspn(section, " "), section);
	names[0] = text_nearest(word, &config_rows[0].section, config_rows_len,
				sizeof(config_rows[0]));
	return text_nearest(word, names, 3, sizeof(names[0]));
}

static int check_section(const struct ini *ini, const struct ini_entry *e)
{
	for (size_t i = 0; i < config_rows_len; i++) {
		if (!strcmp(config_rows[i].section, e->section)) {
			return 0;
		}
	}
	return ini_fail(ini, e, "no such section (nearest: %s)", nearest_section(e->section));
}

/* apply - options and overrides from @ini to @c, which holds the defaults */
static int apply(const struct ini *ini, struct config *c)
{
	int rc = 0;

	for (int i = 0; i < ini->n && !rc; i++) {
		const struct ini_entry *e = &ini->entry[i];

		if (!mapping_section(e->section)) {
			rc = e->key[0] ? set(ini, e, c) : check_section(ini, e);
		}
	}
	return rc ? rc : check_all(ini, c);
}

int config_load(const char *path, const char *const *sets, int n_set, struct config *c,
		struct mapping **map, char *err, int err_len)
{
	struct config loaded;
	struct ini *ini;
	int rc = ini_read(path, err, err_len, &ini);

	if (rc) {
		return rc;
	}
	for (int i = 0; i < n_set && !rc; i++) {
		rc = ini_override(ini, sets[i]);
	}
	if (!rc) {
		config_defaults(&loaded);
		rc = apply(ini, &loaded);
	}
	if (!rc && map) {
		rc = mapping_load(ini, &loaded, map);
	}
	if (rc || !map) {
		ini_free(ini);
	}
	if (!rc) {
		*c = loaded;
	}
	return rc;
}

void config_mapping_free(struct mapping *map)
{
	mapping_free(map);
}

uint64_t config_hash(const struct config *c, const struct mapping *map)
{
	char text[CONFIG_TEXT_MAX];
	uint64_t h = HASH_START;

	for (size_t i = 0; i < config_rows_len; i++) {
		if (config_rows[i].hashed) {
			config_row_print(&config_rows[i], c, text);
			h = hash_text(hash_text(h, config_rows[i].name), text);
		}
	}
	return map ? mapping_hash(map, h) : h;
}

/* ---- printing ---- */

void config_print(const struct config *c, const struct mapping *map, FILE *out)
{
	const char *section = "";
	char value[CONFIG_TEXT_MAX], limits[CONFIG_TEXT_MAX];

	for (size_t i = 0; i < config_rows_len; i++) {
		const struct config_row *r = &config_rows[i];

		if (strcmp(r->section, section)) {
			section = r->section;
			fprintf(out, "%s[%s]\n", i ? "\n" : "", section);
		}
		config_row_print(r, c, value);
		config_row_limits(r, limits);
		fprintf(out, "# %s [%s]\n%s =%s%s\n", r->doc, limits, r->key, *value ? " " : "",
			value);
	}
	if (map) {
		mapping_print(map, out);
	}
}

void config_print_options(FILE *out)
{
	struct config c;
	char value[CONFIG_TEXT_MAX], limits[CONFIG_TEXT_MAX];

	config_defaults(&c);
	for (size_t i = 0; i < config_rows_len; i++) {
		const struct config_row *r = &config_rows[i];

		config_row_print(r, &c, value);
		config_row_limits(r, limits);
		fprintf(out, "*%s* (%s; default %s)\n\t%s\n\n", r->name, limits,
			*value ? value : "empty", r->doc);
	}
	mapping_print_options(out);
}
