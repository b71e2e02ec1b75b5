/* SPDX-License-Identifier: MIT
 * Least squares over stretches, medians over many of them: radars jump from target to target.
 */
#include "stretch.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"
#include "sort.h"

#define LONG_S       2.0
#define SHORT_S      1.0
#define SAMPLES_MIN  5
#define SILENCE_NS   (CLOCK_NS_PER_S / 2)
#define LEAP_M       1.0  /* noise of the distance */
#define LEAP_MPS     60.0 /* and the fastest approach */
#define SLOPE_MPS    0.5
#define SLOPE_SIGMAS 4.0

static double seconds(int64_t ns)
{
	return (double)ns / CLOCK_NS_PER_S;
}

static void start(struct stretch_run *r, const struct stretch_sample *s)
{
	*r = (struct stretch_run){
		.first_ns = s->t_ns, .first_m = s->distance_m, .first_lateral_m = s->lateral_m};
}

static void sum(struct stretch_run *r, const struct stretch_sample *s)
{
	const double t = seconds(s->t_ns - r->first_ns), d = s->distance_m - r->first_m;
	const double lateral = s->lateral_m - r->first_lateral_m;

	r->n++;
	r->t += t;
	r->tt += t * t;
	r->d += d;
	r->dd += d * d;
	r->td += t * d;
	r->lateral += lateral;
	r->t_lateral += t * lateral;
	r->distance += s->distance_m;
	r->rate += s->rate_mps;
	r->ego += s->ego_mps;
	r->yaw += s->yaw_radps;
	r->last_ns = s->t_ns;
	r->last_m = s->distance_m;
}

static int is_other(const struct stretch_run *r, const struct stretch_sample *s)
{
	const int64_t dt = s->t_ns - r->last_ns;

	return dt > SILENCE_NS || fabs(s->distance_m - r->last_m) > LEAP_M + LEAP_MPS * seconds(dt);
}

int stretch_end(struct stretch_run *r, struct stretch *done)
{
	const double n = r->n, var_t = n > 0 ? r->tt - r->t * r->t / n : 0;
	const int good = r->n >= SAMPLES_MIN && seconds(r->last_ns - r->first_ns) >= SHORT_S;

	if (good) {
		const double slope = (r->td - r->t * r->d / n) / var_t;
		const double rest = r->dd - r->d * r->d / n - slope * slope * var_t;

		*done = (struct stretch){
			.slope_mps = slope,
			.slope_se_mps = sqrt((rest > 0 ? rest : 0) / (n - 2) / var_t),
			.lateral_mps = (r->t_lateral - r->t * r->lateral / n) / var_t,
			.distance_m = r->distance / n,
			.rate_mps = r->rate / n,
			.ego_mps = r->ego / n,
			.yaw_radps = r->yaw / n,
		};
	}
	r->n = 0;
	return good;
}

int stretch_add(struct stretch_run *r, const struct stretch_sample *s, struct stretch *done)
{
	int ended = 0;

	if (r->n > 0 && (is_other(r, s) || seconds(s->t_ns - r->first_ns) > LONG_S)) {
		ended = stretch_end(r, done);
	}
	if (r->n == 0) {
		start(r, s);
	}
	sum(r, s);
	return ended;
}

void stretch_keep(struct stretch_list *l, const struct stretch *s)
{
	if (l->n == l->room && l->room < STRETCH_LIST_MAX) {
		const uint32_t room = l->room ? 2 * l->room : 64;
		struct stretch *more = realloc(l->at, room * sizeof(*more));

		l->at = more ? more : l->at;
		l->room = more ? room : l->room;
	}
	if (l->n == l->room) {
		l->lost++;
		return;
	}
	l->at[l->n++] = *s;
}

/* ---- medians ----------------------------------------------------------------------------------- */

static double middle(double *v, uint32_t n)
{
	sort_doubles(v, n);
	return (v[(n - 1) / 2] + v[n / 2]) / 2;
}

struct stretch_median stretch_median(double *v, uint32_t n)
{
	struct stretch_median m = {.n = n, .value = NAN, .se = NAN, .spread = NAN};

	if (n == 0) {
		return m;
	}
	m.value = middle(v, n);
	for (uint32_t i = 0; i < n; i++) {
		v[i] = fabs(v[i] - m.value);
	}
	m.spread = 1.4826 * middle(v, n);
	m.se = 1.2533 * m.spread / sqrt(n); /* sqrt(pi / 2): the median's price against the mean */
	return m;
}

struct stretch_median stretch_ratio(const struct stretch_list *l, int subtract_ego)
{
	double *ratio = malloc((l->n + 1) * sizeof(*ratio));
	uint32_t n = 0;

	for (uint32_t i = 0; ratio && i < l->n; i++) {
		const struct stretch *s = &l->at[i];
		const double said = s->rate_mps - (subtract_ego ? s->ego_mps : 0);

		if (fabs(s->slope_mps) > SLOPE_MPS &&
		    fabs(s->slope_mps) > SLOPE_SIGMAS * s->slope_se_mps && !isnan(said)) {
			ratio[n++] = said / s->slope_mps;
		}
	}
	const struct stretch_median m = stretch_median(ratio, n);

	free(ratio);
	return m;
}
