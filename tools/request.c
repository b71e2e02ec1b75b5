/* SPDX-License-Identifier: MIT
 * From options to one Monte Carlo request: the paper's preset, or any scene under a configuration.
 */
#include "request.h"
#include <math.h>
#include <string.h>
#include "cli.h"
#include "pipeline.h"

#define HEADWAY_M \
	100.0f /* where the paper's preset is evaluated unless told; its curve does not depend on it */
#define SAMPLES 100000

static const char *const future_names[FUTURES] = {"defer", "now", "driver", "nobody"};

/* The range of each state input and of its standard deviation. */
static const struct state_range {
	const char *name;
	double min, max, sigma_max;
} state_range[MC_STATE_DIM] = {
	[MODEL_HEADWAY] = {"--headway", 0, 1000, 100},
	[MODEL_EGO_SPEED] = {"--speed", 0, 100, 20},
	[MODEL_EGO_ACCEL] = {"--accel", -12, 12, 10},
	[MODEL_LEAD_SPEED] = {"--lead-speed", 0, 100, 20},
	[MODEL_LEAD_ACCEL] = {"--lead-accel", -12, 12, 10},
};

enum { KEY_PRESET = 0x280, KEY_FUTURE, KEY_MEAN = 0x290, KEY_SIGMA = 0x2a0 };

static const struct argp_option options[] = {
	{"samples", 'n', "N", 0, "samples (default: mc.samples of a configuration, else 100000)",
	 1},
	{"preset", KEY_PRESET, "NAME", 0,
	 "paper: Sec. IV of the paper (default without --config, --set)", 1},
	{"future", KEY_FUTURE, "NAME", 0,
	 "with a configuration: now (default), defer, driver or nobody brakes", 1},
	{"headway", KEY_MEAN + MODEL_HEADWAY, "M", 0, "gap from ego front to lead rear (100)", 2},
	{"speed", KEY_MEAN + MODEL_EGO_SPEED, "M/S", 0, "ego speed (30)", 2},
	{"accel", KEY_MEAN + MODEL_EGO_ACCEL, "M/S2", 0,
	 "ego acceleration until the brake acts (0)", 2},
	{"lead-speed", KEY_MEAN + MODEL_LEAD_SPEED, "M/S", 0, "lead speed (0)", 2},
	{"lead-accel", KEY_MEAN + MODEL_LEAD_ACCEL, "M/S2", 0,
	 "lead acceleration, down to standstill (0)", 2},
	{"headway-sigma", KEY_SIGMA + MODEL_HEADWAY, "M", 0,
	 "standard deviation of the headway (0)", 3},
	{"speed-sigma", KEY_SIGMA + MODEL_EGO_SPEED, "M/S", 0, "of the speed (2)", 3},
	{"accel-sigma", KEY_SIGMA + MODEL_EGO_ACCEL, "M/S2", 0, "of the acceleration (0)", 3},
	{"lead-speed-sigma", KEY_SIGMA + MODEL_LEAD_SPEED, "M/S", 0, "of the lead speed (0)", 3},
	{"lead-accel-sigma", KEY_SIGMA + MODEL_LEAD_ACCEL, "M/S2", 0,
	 "of the lead acceleration (0)", 3},
	{0},
};
static const struct argp_child children[] = {{&setup_argp, 0, NULL, 0}, {0}};

struct request_args request_defaults(void)
{
	struct request_args a = {.future = FUTURE_NOW};

	for (int i = 0; i < MC_STATE_DIM; i++) {
		a.mean[i] = a.sigma[i] = NAN;
	}
	return a;
}

static error_t parse_state(int key, const char *arg, const struct argp_state *st,
			   struct request_args *a)
{
	int i = key >= KEY_SIGMA ? key - KEY_SIGMA : key - KEY_MEAN;
	const struct state_range *r = &state_range[i];
	char name[32];

	if (key < KEY_SIGMA) {
		return cli_number(st, r->name, arg, r->min, r->max, &a->mean[i]);
	}
	snprintf(name, sizeof(name), "%s-sigma", r->name);
	return cli_number(st, name, arg, 0, r->sigma_max, &a->sigma[i]);
}

static int configured(const struct request_args *a)
{
	return a->setup.path || a->setup.n_set;
}

static error_t check(const struct argp_state *st, const struct request_args *a)
{
	if (a->preset_paper && configured(a)) {
		return cli_bad(st, "--preset paper fixes what --config and --set would change");
	}
	if (a->future != FUTURE_NOW && !configured(a)) {
		return cli_bad(st,
			       "--future: the paper's preset brakes now; give --config or --set");
	}
	return 0;
}

static error_t parse(int key, char *arg, struct argp_state *st)
{
	static const char *const presets[] = {"paper"};
	struct request_args *a = st->input;
	size_t preset;

	if (key >= KEY_MEAN && key < KEY_SIGMA + MC_STATE_DIM) {
		return parse_state(key, arg, st, a);
	}
	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->setup;
		return 0;
	case 'n':
		return cli_count(st, "--samples", arg, 1, UINT32_MAX, &a->samples);
	case KEY_PRESET:
		a->preset_paper = 1;
		return cli_choice(st, "--preset", arg, presets, 1, &preset);
	case KEY_FUTURE:
		return cli_choice(st, "--future", arg, future_names, FUTURES, &a->future);
	case ARGP_KEY_END:
		return check(st, a);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

const struct argp request_argp = {options, parse, NULL, NULL, children, NULL, NULL};

/* What the pipeline submits for some scene; the state inputs are replaced afterwards. */
static int from_config(const char *name, const struct request_args *a, struct mc_request *req)
{
	struct scene s = {.ego_valid = 1, .lead_valid = 1};
	struct config cfg;
	int code = setup_load(name, &a->setup, &cfg, NULL);

	if (code) {
		return code;
	}
	for (int i = 0; i < SCENE_DIM; i++) {
		s.cov[i][i] = 1;
	}
	int error = pipeline_request(&cfg, &s, 1, req);

	req->hist_future = (uint32_t)a->future;
	return error ? cli_error(CLI_CONFIG, name, "this configuration makes no valid request") : 0;
}

static void set_state(struct mc_request *req, const struct mc_request *paper,
		      const struct request_args *a)
{
	memset(req->factor, 0, sizeof(req->factor));
	for (int i = 0; i < MC_STATE_DIM; i++) {
		int diagonal = i * (i + 3) / 2;

		req->mean[i] = isnan(a->mean[i]) ? paper->mean[i] : (float)a->mean[i];
		req->factor[diagonal] =
			isnan(a->sigma[i]) ? paper->factor[diagonal] : (float)a->sigma[i];
	}
}

static int lead_moves(const struct mc_request *req)
{
	int moves = req->mean[MODEL_LEAD_SPEED] != 0 || req->mean[MODEL_LEAD_ACCEL] != 0;

	for (int i = MODEL_LEAD_SPEED * (MODEL_LEAD_SPEED + 1) / 2; i < MC_FACTOR_LEN; i++) {
		moves |= req->factor[i] != 0;
	}
	return moves;
}

int request_build(const char *name, const struct request_args *a, struct mc_request *req)
{
	struct mc_request paper;

	mc_preset_paper(&paper, HEADWAY_M, SAMPLES);
	*req = paper;
	if (configured(a)) {
		int code = from_config(name, a, req);

		if (code) {
			return code;
		}
	}
	req->n = a->samples ? (uint32_t)a->samples : req->n;
	req->flags |= MC_WANT_HIST | MC_WANT_IMPACT;
	set_state(req, &paper, a);
	if (lead_moves(req)) {
		req->flags &= ~MC_ROLLING_IS_CONTACT;
	}
	return mc_check(req) ? cli_error(CLI_USAGE, name, "these figures make no valid request")
			     : 0;
}
