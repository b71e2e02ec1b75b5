/* SPDX-License-Identifier: MIT
 * The options --config FILE and --set SECTION.KEY=VALUE of the subcommands that need a car.
 */
#include "setup.h"
#include <stdio.h>
#include <unistd.h>
#include "cli.h"
#include "program.h"

#define VEHICLES "can-dbc/vehicles/"

/* From the program's folder: where it is built, and where it is installed. */
static const char *const place[] = {"../" VEHICLES, "../share/aebmc/vehicles/"};
#define PLACES (sizeof(place) / sizeof(place[0]))

enum { KEY_CONFIG = 0x240, KEY_SET };

static const struct argp_option options[] = {
	{"config", KEY_CONFIG, "FILE", 0,
	 "configuration: car, road, thresholds, mapping of the buses", 5},
	{"set", KEY_SET, "SECTION.KEY=VALUE", 0, "override one option, may be given again", 5},
	{0},
};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct setup *s = st->input;

	switch (key) {
	case KEY_CONFIG:
		s->path = arg;
		return 0;
	case KEY_SET:
		if (s->n_set == SETUP_SETS_MAX) {
			return cli_bad(st, "--set: more than %d of them; use a file",
				       SETUP_SETS_MAX);
		}
		s->set[s->n_set++] = arg;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

const struct argp setup_argp = {options, parse, NULL, NULL, NULL, NULL, NULL};

void setup_bundled(struct setup *s, const char *file)
{
	snprintf(s->bundled, sizeof(s->bundled), VEHICLES "%s", file);
	if (access(s->bundled, F_OK) != 0) {
		program_file(place, PLACES, file, s->bundled);
	}
	s->path = s->bundled;
}

int setup_load(const char *name, const struct setup *s, struct config *cfg, struct mapping **map)
{
	char err[512] = "";
	int error = 0;

	if (s->path) {
		error = config_load(s->path, s->set, s->n_set, cfg, map, err, sizeof(err));
		return error ? cli_error(CLI_CONFIG, name, "%s", err) : 0;
	}
	config_defaults(cfg);
	for (int i = 0; i < s->n_set && !error; i++) {
		error = config_set(cfg, s->set[i], err, sizeof(err));
	}
	return error ? cli_error(CLI_CONFIG, name, "%s", err) : 0;
}
