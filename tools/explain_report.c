/* SPDX-License-Identifier: MIT
 * What explain found, in words and as JSON.
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include "explain.h"
#include "recorder.h"
#include "words.h"

#define PI        3.14159265358979323846
#define SHARE_MIN 0.005 /* less is chance */

const char *const explain_future_name[FUTURES] = {[FUTURE_DEFER] = "defer",
						  [FUTURE_NOW] = "now",
						  [FUTURE_DRIVER] = "driver",
						  [FUTURE_NOBODY] = "nobody"};

static const char *const future_words[FUTURES] = {
	[FUTURE_DEFER] = "full braking comes one period later",
	[FUTURE_NOW] = "full braking comes now",
	[FUTURE_DRIVER] = "the driver brakes",
	[FUTURE_NOBODY] = "nobody brakes",
};

const char *const explain_input_name[EXPLAIN_INPUTS] = {
	[MODEL_HEADWAY] = "headway",
	[MODEL_EGO_SPEED] = "ego_speed",
	[MODEL_EGO_ACCEL] = "ego_accel",
	[MODEL_LEAD_SPEED] = "lead_speed",
	[MODEL_LEAD_ACCEL] = "lead_accel",
	[MODEL_MU] = "mu",
	[MODEL_GRADE] = "grade",
	[MODEL_MASS] = "mass",
	[MODEL_DRAG] = "drag",
	[MODEL_TAU] = "tau",
	[MODEL_DELAY] = "delay",
	[EXPLAIN_MET] = "met",
};

/* In words, with the unit they are told in and how many of those the SI unit is. */
static const struct {
	const char *words, *unit;
	double scale;
} input_table[EXPLAIN_INPUTS] = {
	[MODEL_HEADWAY] = {"headway", "m", 1},
	[MODEL_EGO_SPEED] = {"ego speed", "km/h", 3.6},
	[MODEL_EGO_ACCEL] = {"ego acceleration", "m/s2", 1},
	[MODEL_LEAD_SPEED] = {"lead speed", "km/h", 3.6},
	[MODEL_LEAD_ACCEL] = {"lead acceleration, to come", "m/s2", 1},
	[MODEL_MU] = {"friction", "", 1},
	[MODEL_GRADE] = {"grade", "deg", 180 / PI},
	[MODEL_MASS] = {"mass", "kg", 1},
	[MODEL_DRAG] = {"drag coefficient", "", 1},
	[MODEL_TAU] = {"brake time constant", "ms", 1000},
	[MODEL_DELAY] = {"brake delay", "ms", 1000},
	[EXPLAIN_MET] = {"which object is met", "", 1},
};

/* ---- words -------------------------------------------------------------------------------------- */

static void scene_words(FILE *out, const struct explain *x)
{
	const struct scene *s = &x->cycle.scene;
	const double ttc = words_ttc_s(s);

	fprintf(out,
		"%.2f s, evaluation %" PRIu64
		": ego %.1f km/h, lead %.1f m ahead at %.1f km/h, its "
		"acceleration %.1f m/s2",
		x->time_s, x->cycle.id, 3.6 * s->x[SCENE_EGO_SPEED], s->x[SCENE_HEADWAY],
		3.6 * s->x[SCENE_LEAD_SPEED], s->x[SCENE_LEAD_ACCEL]);
	if (isfinite(ttc)) {
		fprintf(out, "; %.1f s to collision as the speeds stand", ttc);
	}
	fprintf(out, "\nstage %s (%s); risk if %s: ", level_name[x->cycle.dec.level],
		cause_name[x->cycle.dec.cause], future_words[x->future]);
	if (x->risk.p_is_bound) {
		fprintf(out, "below %.3g %%\n", 100 * x->risk.hi);
	} else {
		fprintf(out, "%.3g %% (%.3g .. %.3g %%)\n", 100 * x->risk.p, 100 * x->risk.lo,
			100 * x->risk.hi);
	}
}

static void value(FILE *out, double v, double scale)
{
	if (isfinite(v)) {
		fprintf(out, " %10.4g", v * scale);
	} else {
		fprintf(out, " %10s", "");
	}
}

static void input_words(FILE *out, const struct explain_input *e)
{
	const double scale = input_table[e->input].scale;

	fprintf(out, "%-28s", input_table[e->input].words);
	if (e->share >= SHARE_MIN) {
		fprintf(out, " %8.1f %%", 100 * e->share);
	} else {
		fprintf(out, " %10s", "-");
	}
	value(out, e->mean, scale);
	value(out, e->sd, scale);
	value(out, e->mean_contact, scale);
	fprintf(out, " %-5s %12.3g %%\n", input_table[e->input].unit, 100 * e->p_known);
}

static void sample_words(FILE *out, const struct explain_sample *s)
{
	fprintf(out, "sample %" PRIu32 ": ", s->index);
	if (s->impact_mps > 0) {
		fprintf(out, "impact at %.1f km/h", 3.6 * s->impact_mps);
	} else {
		fprintf(out, "no impact speed, %.1f m left", s->gap_m);
	}
	fprintf(out, "; %s\n   ", pipeline_prior_words[s->prior]);
	for (int i = 0; i < MODEL_INPUTS; i++) {
		fprintf(out, "%s %s %.4g%s%s", i ? "," : "", input_table[i].words,
			(double)s->in[i] * input_table[i].scale, *input_table[i].unit ? " " : "",
			input_table[i].unit);
	}
	fputc('\n', out);
}

void explain_words(FILE *out, const struct explain *x)
{
	scene_words(out, x);
	fprintf(out, "\n%-28s %10s %10s %10s %10s %-5s %14s\n", "input",
		x->by_gap ? "gap" : "contact", "mean", "sd", "contact at", "", "risk if known");
	for (int i = 0; i < EXPLAIN_INPUTS; i++) {
		input_words(out, &x->input[i]);
	}
	fprintf(out,
		"\nShares: of the variance of %s over %" PRIu32
		" samples that the input explains by itself; what is\nmissing to 100 %% is joint "
		"effects. "
		"Risk if known: with this input at its mean, the others as they are.\n",
		x->by_gap ? "the gap to the lead (contact is all but certain, or excluded)"
			  : "contact",
		x->n);
	fputs(x->n_worst ? "\nWorst samples:\n" : "", out);
	for (int i = 0; i < x->n_worst; i++) {
		sample_words(out, &x->worst[i]);
	}
}

/* ---- JSON --------------------------------------------------------------------------------------- */

static void json_input(struct json *j, const struct explain_input *e)
{
	json_open(j, NULL, '{');
	json_str(j, "name", explain_input_name[e->input]);
	json_num(j, "share", e->share);
	json_num(j, "mean", e->mean);
	json_num(j, "sd", e->sd);
	json_num(j, "mean_contact", e->mean_contact);
	json_num(j, "p_known", e->p_known);
	json_close(j, '}');
}

/* The line of a .requests file. */
static void json_request(struct json *j, const struct explain *x, const struct explain_sample *s)
{
	char *line = NULL;
	size_t size = 0;
	FILE *f = open_memstream(&line, &size);

	if (f) {
		recorder_write(f, x->cycle.scene.scan_ns, &s->req, s->result_hash);
		fclose(f);
	}
	if (line && size) {
		line[size - 1] = '\0'; /* the end of the line */
	}
	json_str(j, "request", line);
	free(line);
}

static void json_sample(struct json *j, const struct explain *x, const struct explain_sample *s)
{
	json_open(j, NULL, '{');
	json_uint(j, "index", s->index);
	json_num(j, "impact_mps", s->impact_mps);
	json_num(j, "gap_m", s->gap_m);
	json_str(j, "prior", pipeline_prior_words[s->prior]);
	json_open(j, "inputs", '{');
	for (int i = 0; i < MODEL_INPUTS; i++) {
		json_num(j, explain_input_name[i], (double)s->in[i]);
	}
	json_close(j, '}');
	json_request(j, x, s);
	json_close(j, '}');
}

void explain_json(const struct explain *x, uint64_t config_hash)
{
	struct json j = json_start(stdout);
	char hash[20];

	snprintf(hash, sizeof(hash), "%016" PRIx64, config_hash);
	json_head(&j, "explain");
	json_num(&j, "time_s", x->time_s);
	json_uint(&j, "evaluation", x->cycle.id);
	json_str(&j, "level", level_name[x->cycle.dec.level]);
	json_str(&j, "cause", cause_name[x->cycle.dec.cause]);
	json_str(&j, "future", explain_future_name[x->future]);
	json_uint(&j, "samples", x->n);
	json_num(&j, "p", x->risk.p);
	json_num(&j, "lo", x->risk.lo);
	json_num(&j, "hi", x->risk.hi);
	json_num(&j, "impact_mps", x->risk.impact_mps);
	json_str(&j, "variance_of", x->by_gap ? "gap" : "contact");
	json_open(&j, "inputs", '[');
	for (int i = 0; i < EXPLAIN_INPUTS; i++) {
		json_input(&j, &x->input[i]);
	}
	json_close(&j, ']');
	json_open(&j, "worst", '[');
	for (int i = 0; i < x->n_worst; i++) {
		json_sample(&j, x, &x->worst[i]);
	}
	json_close(&j, ']');
	json_str(&j, "config_hash", hash);
	json_close(&j, '}');
}
