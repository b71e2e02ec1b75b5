/* SPDX-License-Identifier: MIT
 * The suites' rows. FMVSS No. 127 (49 CFR 571.127), Euro NCAP car-to-car rear (AEB C2C test protocol), and faults of the
 * sensors; what calls for nothing is in scenario_calm.c, what no regulation has in scenario_traffic.c.
 */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "scenario.h"

#define KMH(v)  ((v) / 3.6)
#define G(a)    ((a)*9.81)
#define LEAD_IN 3.0  /* s before anything happens: the daemon starts, filters settle */
#define TTC_S   5.0  /* FMVSS 127: tests begin this long before collision */
#define ONSET   0.05 /* g; what counts as a lead that brakes */
#define AFTER_S 9.0  /* from the event to the end, if nothing ends the run sooner */

struct list {
	struct scenario *row;
	int n, max;
};

static struct scenario *add(struct list *l, const struct scenario *like, const char *fmt, ...)
	__attribute__((format(printf, 3, 4)));

/* Beyond the end there is a spare place to write to. */
static struct scenario *add(struct list *l, const struct scenario *like, const char *fmt, ...)
{
	struct scenario *s = &l->row[l->n < l->max ? l->n : l->max - 1];
	va_list ap;

	l->n++;
	*s = *like;
	va_start(ap, fmt);
	vsnprintf(s->name, sizeof(s->name), fmt, ap);
	va_end(ap);
	return s;
}

/* ---- approaches and braking leads ------------------------------------------------------------- */

static struct scenario approach(double ego_kmh, double lead_kmh, enum scenario_driver driver)
{
	const double closing = KMH(ego_kmh - lead_kmh);

	return (struct scenario){
		.drive = {.end_s = LEAD_IN + TTC_S + AFTER_S,
			  .ego.speed_mps = KMH(ego_kmh),
			  .n = 1,
			  .target = {{.gap_m = closing * (TTC_S + LEAD_IN),
				      .path.speed_mps = KMH(lead_kmh)}}},
		.driver = driver,
	};
}

/* The lead's deceleration begins at the onset's threshold and reaches its value after @ramp_s. */
static struct scenario braking(double kmh, double gap_m, double decel_mps2, double ramp_s,
			       enum scenario_driver driver)
{
	const double jerk = ramp_s > 0 ? (decel_mps2 - G(ONSET)) / ramp_s : INFINITY;

	return (struct scenario){
		.drive = {.end_s = LEAD_IN + AFTER_S + KMH(kmh) / decel_mps2,
			  .ego.speed_mps = KMH(kmh),
			  .n = 1,
			  .target = {{.gap_m = gap_m,
				      .path = {KMH(kmh),
					       {{LEAD_IN, -G(ONSET), INFINITY},
						{LEAD_IN + DRIVE_STEP_S, -decel_mps2, jerk}}}}}},
		.driver = driver,
		.onset_s = LEAD_IN,
	};
}

/* ---- FMVSS 127 -------------------------------------------------------------------------------- */

static const char *driver_suffix(enum scenario_driver d)
{
	return d == DRIVER_WARNED ? "-driver" : "";
}

static void add_approaches(struct list *l, const char *what, double lead_kmh, int from_kmh,
			   int to_kmh, enum scenario_driver driver)
{
	for (int v = from_kmh; v <= to_kmh; v += 10) {
		const struct scenario s = approach(v, lead_kmh, driver);

		add(l, &s, "%s-%d%s", what, v, driver_suffix(driver))->in_short =
			v == to_kmh || (v == from_kmh && driver == DRIVER_PATH);
	}
}

static void add_braking(struct list *l, int kmh, int gap_m, double g, double ramp_s)
{
	for (enum scenario_driver d = DRIVER_PATH; d <= DRIVER_WARNED; d++) {
		const struct scenario s = braking(kmh, gap_m, G(g), ramp_s, d);

		add(l, &s, "brake-%d-%dm-%gg-%s%s", kmh, gap_m, g, ramp_s > 0 ? "ramp" : "step",
		    driver_suffix(d))
			->in_short = (gap_m == 12 || gap_m == 40) && g == 0.5 &&
				     (d == DRIVER_PATH || (gap_m == 12 && ramp_s > 0));
	}
}

static int fmvss127(struct scenario *row, int max)
{
	static const double g[] = {0.3, 0.4, 0.5}, ramp_s[] = {1.5, 0};
	struct list l = {row, 0, max};

	add_approaches(&l, "stopped", 0, 10, 80, DRIVER_PATH);
	add_approaches(&l, "stopped", 0, 70, 100, DRIVER_WARNED);
	add_approaches(&l, "slower", 20, 40, 80, DRIVER_PATH);
	add_approaches(&l, "slower", 20, 70, 100, DRIVER_WARNED);
	for (int kmh = 50; kmh <= 80; kmh += 30) {
		for (int gap_m = 12; gap_m <= 40; gap_m += 4) {
			for (int i = 0; i < 3; i++) {
				add_braking(&l, kmh, gap_m, g[i], ramp_s[0]);
				add_braking(&l, kmh, gap_m, g[i], ramp_s[1]);
			}
		}
	}
	return l.n;
}

/* ---- Euro NCAP -------------------------------------------------------------------------------- */

static void add_ccrb(struct list *l, int kmh, double gap_m, double decel_mps2, const char *protocol)
{
	const struct scenario s = braking(kmh, gap_m, decel_mps2, 1, DRIVER_PATH);

	add(l, &s, "ccrb%s-%d-%.0fm-%gmps2", protocol, kmh, gap_m, decel_mps2)->in_short =
		kmh == 50 || kmh == 80;
}

static void add_ccr(struct list *l, const char *what, int kmh, int lead_kmh, int is_short,
		    enum scenario_goal goal, enum scenario_driver driver)
{
	const struct scenario s = approach(kmh, lead_kmh, driver);
	struct scenario *r = add(l, &s, "%s-%d-%d%s", what, kmh, lead_kmh, driver_suffix(driver));

	r->in_short = is_short;
	r->goal = goal;
}

static int ncap_ccr(struct scenario *row, int max)
{
	struct list l = {row, 0, max};

	for (int v = 10; v <= 80; v += 5) {
		add_ccr(&l, "ccrs", v, 0, v % 40 == 10 || v == 80, GOAL_NO_CONTACT,
			v <= 50 ? DRIVER_PATH : DRIVER_WARNED);
	}
	for (int v = 30; v <= 80; v += 5) {
		add_ccr(&l, "ccrm", v, 20, v == 30 || v == 80, GOAL_NO_CONTACT, DRIVER_PATH);
	}
	for (int v = 90; v <= 130; v += 10) {
		add_ccr(&l, "ccrm2026", v, v - 60, v == 130, GOAL_STATED, DRIVER_PATH);
	}
	for (int gap_m = 12; gap_m <= 40; gap_m += 28) {
		add_ccrb(&l, 50, gap_m, 2, "");
		add_ccrb(&l, 50, gap_m, 6, "");
	}
	for (int v = 30; v <= 80; v += 10) {
		add_ccrb(&l, v, KMH(v), 4, "2026");
	}
	return l.n;
}

/* ---- faults of the sensors ---------------------------------------------------------------------- */

static const struct scenario_fault faults[] = {
	{.name = "10Hz", .doc = "10 scans a second", .period_s = 0.1, .set = {"radar.period=100"}},
	{.name = "noise-told",
	 .doc = "all noise doubled, and the filter told",
	 .noise = 2,
	 .set = {"radar.range_sigma=0.5", "radar.rate_sigma=0.2", "filter.ego_sigma=0.1"}},
	{.name = "noise-untold", .doc = "all noise doubled, the filter not told", .noise = 2},
	{.name = "dropouts",
	 .doc = "the radar misses 1 scan in 6, in bursts: 0.1 after a scan that saw, 0.5 after one "
		"that missed",
	 .dropout = 0.1,
	 .burst = 0.5},
	{.name = "latency", .doc = "150 ms old, assumed 75", .latency_s = 0.15},
	{.name = "rate-lag",
	 .doc = "the radar's relative speed lags by 0.15 s",
	 .rate_lag_s = 0.15},
};

static void add_faulty(struct list *l, const struct scenario_fault *f, const struct scenario *base,
		       int n)
{
	for (int i = 0; i < n; i++) {
		if (base[i].in_short) {
			struct scenario *s = add(l, &base[i], "%s/%s", f->name, base[i].name);

			s->fault = f;
			s->in_short = strstr(s->name, "/brake-80-12m-0.5g-ramp") ||
				      strstr(s->name, "/overtake");
		}
	}
}

static int degraded(struct scenario *row, int max)
{
	struct scenario *base = calloc(SCENARIO_ROWS_MAX, sizeof(*base));
	struct list l = {row, 0, max};

	if (!base) {
		return -ENOMEM;
	}
	int n = fmvss127(base, SCENARIO_ROWS_MAX);

	n += scenario_calm(base + n, SCENARIO_ROWS_MAX - n);
	for (size_t f = 0; f < sizeof(faults) / sizeof(faults[0]); f++) {
		add_faulty(&l, &faults[f], base, n);
	}
	free(base);
	return l.n;
}

const struct scenario_suite scenario_suites[] = {
	{"fmvss127", "FMVSS No. 127: stopped, slower and braking leads; no contact", fmvss127, 0},
	{"ncap-ccr", "Euro NCAP car-to-car rear; no contact", ncap_ccr, 0},
	{"false-activation", "nothing to brake for; no request", scenario_calm, 0},
	{"degraded", "rows of fmvss127 and false-activation with faulty sensors; stated", degraded,
	 1},
	{"traffic",
	 "cars that cut in, leave and uncover, targets that are none; of no regulation, stated",
	 scenario_traffic, 1},
	{0},
};
