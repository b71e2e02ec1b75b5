/* SPDX-License-Identifier: MIT
 * What a replay has to tell, in plain words.
 */
#include "words.h"
#include <math.h>

#define KMPH_PER_MPS 3.6

double words_ttc_s(const struct scene *s)
{
	double closing_mps = s->x[SCENE_EGO_SPEED] - s->x[SCENE_LEAD_SPEED];

	return s->lead_valid && closing_mps > 0 ? s->x[SCENE_HEADWAY] / closing_mps : NAN;
}

static void scene_words(FILE *out, const struct scene *s)
{
	double ttc_s = words_ttc_s(s);

	fprintf(out, "            ego %.1f km/h", s->x[SCENE_EGO_SPEED] * KMPH_PER_MPS);
	if (!s->lead_valid) {
		fputs(", no lead\n", out);
		return;
	}
	fprintf(out, ", lead %.1f m ahead at %.1f km/h, its acceleration %.1f m/s2",
		s->x[SCENE_HEADWAY], s->x[SCENE_LEAD_SPEED] * KMPH_PER_MPS, s->x[SCENE_LEAD_ACCEL]);
	if (isnan(ttc_s)) {
		fputs("; the gap is not closing\n", out);
	} else {
		fprintf(out, "; %.1f s to collision as the speeds stand\n", ttc_s);
	}
}

static void risk_words(FILE *out, const struct mc_risk *r, const char *when)
{
	if (r->p_is_bound) {
		fprintf(out, " below %.2g %% %s", r->hi * 100, when);
	} else {
		fprintf(out, " %.3g %% %s", r->p * 100, when);
	}
}

static void result_words(FILE *out, const struct mc_result *res)
{
	if (!res->n || res->n_futures < FUTURES) {
		return;
	}
	fputs("            collision risk", out);
	risk_words(out, &res->risk[FUTURE_NOBODY], "if nobody brakes,");
	risk_words(out, &res->risk[FUTURE_DRIVER], "if the driver does,");
	risk_words(out, &res->risk[FUTURE_NOW], "with full braking now,");
	risk_words(out, &res->risk[FUTURE_DEFER], "with full braking one period later\n");
}

static void level_words(FILE *out, const struct decision *d, enum stage_level before)
{
	switch (d->level) {
	case LEVEL_NONE:
		fprintf(out, "released (%s)\n", cause_name[d->cause]);
		return;
	case LEVEL_WARN:
		fputs(before > LEVEL_WARN ? "braking released, warning stays\n"
					  : "WARNING to the driver\n",
		      out);
		return;
	default:
		fprintf(out, "%s BRAKING requested, %.1f m/s2\n",
			d->level == LEVEL_FULL ? "FULL" : "PARTIAL", d->accel_mps2);
	}
}

void words_level(FILE *out, double time_s, const struct publish_in *now, enum stage_level before)
{
	fprintf(out, "%8.2f s  ", time_s);
	level_words(out, &now->dec, before);
	scene_words(out, &now->scene);
	if (now->dec.level > LEVEL_NONE && now->have_result) {
		result_words(out, &now->res);
	}
}

void words_state(FILE *out, double time_s, const struct publish_in *now, enum state before)
{
	fprintf(out, "%8.2f s  state %s, was %s", time_s, state_name[now->state],
		state_name[before]);
	for (int i = 0; i < FAULTS; i++) {
		if (now->fault & 1u << i) {
			fprintf(out, "; %s", fault_table[i].doc);
		}
	}
	fputc('\n', out);
}
