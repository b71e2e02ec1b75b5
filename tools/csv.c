/* SPDX-License-Identifier: MIT
 * One row per evaluation, for PlotJuggler or pandas.
 */
#include "csv.h"
#include <inttypes.h>
#include <math.h>
#include "clock.h"
#include "words.h"

static const char *const future_column[FUTURES] = {
	[FUTURE_DEFER] = "defer",
	[FUTURE_NOW] = "now",
	[FUTURE_DRIVER] = "driver",
	[FUTURE_NOBODY] = "nobody",
};

static const char *const scene_column[SCENE_DIM] = {
	[SCENE_HEADWAY] = "headway_m",          [SCENE_EGO_SPEED] = "ego_speed_mps",
	[SCENE_EGO_ACCEL] = "ego_accel_mps2",   [SCENE_LEAD_SPEED] = "lead_speed_mps",
	[SCENE_LEAD_ACCEL] = "lead_accel_mps2",
};

void csv_head(FILE *out)
{
	fputs("time_s,evaluation", out);
	for (int i = 0; i < SCENE_DIM; i++) {
		fprintf(out, ",%s", scene_column[i]);
	}
	for (int i = 0; i < SCENE_DIM; i++) {
		fprintf(out, ",sigma_%s", scene_column[i]);
	}
	fputs(",lateral_m,ttc_s,lead_id,p_lead", out);
	for (int i = 0; i < FUTURES; i++) {
		const char *f = future_column[i];

		fprintf(out, ",p_%s,p_%s_lo,p_%s_hi,impact_%s_mps", f, f, f, f);
	}
	fputs(",stop_mean_m,stop_sd_m,safe_headway_5pct_m,safe_headway_1pct_m,safe_headway_01pct_m"
	      ",level,level_name,cause,state,accel_request_mps2,samples,floored,input_age_ms,"
	      "fault\n",
	      out);
}

static void field(FILE *out, int known, double v)
{
	if (known && isfinite(v)) {
		fprintf(out, ",%.9g", v);
	} else {
		fputc(',', out);
	}
}

static void scene_fields(FILE *out, const struct scene *s)
{
	const int known[SCENE_DIM] = {s->lead_valid, s->ego_valid, s->ego_valid, s->lead_valid,
				      s->lead_valid};

	for (int i = 0; i < SCENE_DIM; i++) {
		field(out, known[i], s->x[i]);
	}
	for (int i = 0; i < SCENE_DIM; i++) {
		field(out, known[i], sqrt(s->cov[i][i]));
	}
	field(out, s->lead_valid, s->lateral_m);
	field(out, s->lead_valid, words_ttc_s(s));
	fprintf(out, ",%" PRIu32, s->lead_valid ? s->lead_id : 0);
	field(out, s->lead_valid, scene_lead_p(s));
}

static void result_fields(FILE *out, const struct mc_result *r)
{
	for (uint32_t i = 0; i < FUTURES; i++) {
		int known = r->n > 0 && i < r->n_futures;

		field(out, known, r->risk[i].p);
		field(out, known, r->risk[i].lo);
		field(out, known, r->risk[i].hi);
		field(out, known, r->risk[i].impact_mps);
	}
	field(out, r->n > 0, r->stop_mean_m);
	field(out, r->n > 0, r->stop_sd_m);
	for (int i = 0; i < MC_RISKS; i++) {
		field(out, r->n > 0, r->headway_m[i]);
	}
}

void csv_row(FILE *out, const struct cycle *c, enum state state, int64_t start_ns)
{
	fprintf(out, "%.6f,%" PRIu64, (double)(c->scene.scan_ns - start_ns) / CLOCK_NS_PER_S,
		c->id);
	scene_fields(out, &c->scene);
	result_fields(out, &c->res);
	fprintf(out, ",%d,%s,%s,%s,%.9g,%" PRIu64 ",%" PRIu64 ",%.3f,%" PRIu32 "\n",
		(int)c->dec.level, level_name[c->dec.level], cause_name[c->dec.cause],
		state_name[state], c->dec.accel_mps2, c->res.n, c->res.floored,
		(double)c->scene.oldest_input_ns / CLOCK_NS_PER_MS, c->scene.fault);
}
