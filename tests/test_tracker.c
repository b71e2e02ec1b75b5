/* SPDX-License-Identifier: MIT
 * Objects over scans: who is followed, who is believed, who leads. Scans are made here from a table of vehicles.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
#include "../tools/noise.h"
#include "clock.h"
#include "tracker.h"

#define MS      CLOCK_NS_PER_MS
#define SCAN_MS 50
#define EGO_MPS 20.0
#define CARS    4

struct car {
	double gap_m, speed_mps, accel_mps2, lateral_m;
	int hidden, fresh, twice; /* not seen; flagged as new; reported by two detections */
};

struct road {
	struct config cfg;
	struct tracker t;
	struct noise r;
	struct car car[CARS];
	int n;
	int64_t ms;
	double noise; /* of everything, in sigmas */
};

static void open_road(struct road *w)
{
	memset(w, 0, sizeof(*w));
	config_defaults(&w->cfg);
	tracker_open(&w->t, &w->cfg);
	w->r.seed = 3;
	w->noise = 1;
}

static struct detection look(struct road *w, const struct car *c)
{
	return (struct detection){
		.distance_m = c->gap_m + 0.25 * w->noise * noise_normal(&w->r),
		.rate_mps = c->speed_mps - EGO_MPS + 0.1 * w->noise * noise_normal(&w->r),
		.lateral_m = c->lateral_m + 0.1 * w->noise * noise_normal(&w->r),
		.existence = 0.9,
		.fresh = c->fresh,
	};
}

static void move(struct road *w, double dt)
{
	for (int i = 0; i < w->n; i++) {
		struct car *c = &w->car[i];

		c->gap_m += (c->speed_mps - EGO_MPS) * dt + c->accel_mps2 * dt * dt / 2;
		c->speed_mps += c->accel_mps2 * dt;
		if (c->speed_mps < 0 && c->accel_mps2 < 0) {
			c->speed_mps = c->accel_mps2 = 0;
		}
	}
}

static void shuffle(struct road *w, struct tracker_scan *s)
{
	for (int i = s->n - 1; i > 0; i--) {
		const int j = (int)(noise_uniform(&w->r) * (i + 1));
		const struct detection d = s->det[i];

		s->det[i] = s->det[j];
		s->det[j] = d;
	}
}

/* One scan, in slots of its own choice, after two ego speeds. */
static const struct tracker_object *scan(struct road *w)
{
	struct tracker_scan s = {.t_ns = w->ms * MS, .seen_ns = (w->ms + 75) * MS};

	tracker_ego_speed(&w->t, (w->ms - 20) * MS,
			  EGO_MPS + 0.05 * w->noise * noise_normal(&w->r));
	tracker_ego_speed(&w->t, w->ms * MS, EGO_MPS + 0.05 * w->noise * noise_normal(&w->r));
	for (int i = 0; i < w->n; i++) {
		for (int k = 0; k <= w->car[i].twice && !w->car[i].hidden; k++) {
			s.det[s.n++] = look(w, &w->car[i]);
		}
	}
	shuffle(w, &s);
	tracker_scan(&w->t, &s);
	w->ms += SCAN_MS;
	move(w, SCAN_MS / 1000.0);
	return tracker_lead(&w->t);
}

static const struct tracker_object *scans(struct road *w, int n)
{
	const struct tracker_object *lead = NULL;

	for (int i = 0; i < n; i++) {
		lead = scan(w);
	}
	return lead;
}

static void add(struct road *w, double gap_m, double speed_mps, double lateral_m)
{
	w->car[w->n++] =
		(struct car){.gap_m = gap_m, .speed_mps = speed_mps, .lateral_m = lateral_m};
}

/* The lead is car @i. */
static void assert_leads(const struct road *w, const struct tracker_object *lead, int i)
{
	assert_non_null(lead);
	/* the filter stands where the scan was, the car has moved on */
	const double gap = w->car[i].gap_m - (w->car[i].speed_mps - EGO_MPS) * SCAN_MS / 1000.0;

	if (!(fabs(lead->k.x[SCENE_HEADWAY] - gap) < 1)) {
		fail_msg("lead at %g m, car %d at %g m", lead->k.x[SCENE_HEADWAY], i, gap);
	}
}

/* ---- believing ------------------------------------------------------------------------------ */

static void nothing_happens_without_an_ego_speed(void **state)
{
	struct road w;
	struct tracker_scan s = {.n = 1, .det = {{.distance_m = 30}}};

	(void)state;
	open_road(&w);
	tracker_scan(&w.t, &s);
	assert_int_equal(w.t.n, 0);
	assert_null(tracker_lead(&w.t));
}

static void an_object_counts_after_four_scans(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 30, 18, 0);
	for (int i = 1; i <= 6; i++) {
		const struct tracker_object *lead = scan(&w);

		assert_int_equal(w.t.n, 1);
		assert_int_equal(lead != NULL, i >= 4);
		assert_int_equal(w.t.object[0].hits, i);
	}
	assert_leads(&w, tracker_lead(&w.t), 0);
	assert_int_equal(tracker_lead(&w.t)->id, 1);
	assert_true(tracker_lead(&w.t)->existence == 0.9);
	assert_int_equal(tracker_lead(&w.t)->seen_ns, (5 * SCAN_MS + 75) * MS);
}

static void fresh_detections_do_not_count(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 30, 18, 0);
	w.car[0].fresh = 1;
	assert_null(scans(&w, 10));
	assert_int_equal(w.t.n, 1);
	assert_int_equal(w.t.object[0].hits, 0);
	w.car[0].fresh = 0;
	assert_null(scans(&w, 3));
	assert_non_null(scan(&w));
	/* once it counts, a change of slot does not matter */
	w.car[0].fresh = 1;
	assert_leads(&w, scans(&w, 20), 0);
	assert_int_equal(tracker_lead(&w.t)->id, 1);
}

static void ghosts_never_lead(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 60, 20, 0);
	add(&w, 10, 20, 0);
	for (int i = 0; i < 200; i++) {
		w.car[1].hidden = i % 3 != 0; /* one scan, now here, now there */
		w.car[1].gap_m = 5 + 40 * noise_uniform(&w.r);
		w.car[1].speed_mps = 30 * noise_uniform(&w.r);
		const struct tracker_object *lead = scan(&w);

		if (i >= 3) {
			assert_leads(&w, lead, 0);
		}
	}
	assert_in_range(w.t.n, 1, 3);
}

static void what_was_seen_once_is_soon_forgotten(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 30, 20, 0);
	w.car[0].fresh = 1;
	scan(&w);
	w.car[0].hidden = 1;
	scan(&w);
	assert_int_equal(w.t.n, 0);
	w.car[0].hidden = w.car[0].fresh = 0;
	scan(&w);
	w.car[0].hidden = 1;
	scan(&w);
	assert_int_equal(w.t.n, 1);
	scan(&w);
	assert_int_equal(w.t.n, 0);
}

/* ---- following ------------------------------------------------------------------------------ */

static void slots_mean_nothing(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 30, 19, 0);
	add(&w, 33, 22, 3.5);
	add(&w, 28, 17, -3.5);
	add(&w, 90, 21, 0.5);
	scans(&w, 4);
	for (int i = 0; i < 100; i++) {
		assert_leads(&w, scan(&w), 0);
		assert_int_equal(w.t.n, 4);
	}
	assert_in_range(w.t.last_id, 4, 4);
}

static void cars_side_by_side_are_told_apart(void **state)
{
	struct road w;
	uint32_t id = 0;

	(void)state;
	open_road(&w);
	add(&w, 30, 20, 0);
	add(&w, 30, 20, 3.2);
	for (int i = 0; i < 200; i++) {
		const struct tracker_object *lead = scan(&w);

		if (i >= 4) {
			id = id ? id : lead->id;
			assert_int_equal(lead->id, id);
			assert_true(fabs(lead->lateral_m) < 0.5);
		}
		assert_int_equal(w.t.n, 2);
	}
}

static void a_braking_lead_is_followed(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 60, 20, 0);
	scans(&w, 20);
	w.car[0].accel_mps2 = -6; /* from one moment to the next */
	for (int i = 0; i < 60; i++) {
		assert_leads(&w, scan(&w), 0);
		assert_int_equal(tracker_lead(&w.t)->id, 1);
	}
}

static void short_gaps_are_bridged(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 40, 18, 0);
	scans(&w, 10);
	for (int i = 1; i <= 4; i++) {
		const struct kalman before = tracker_lead(&w.t)->k;

		w.car[0].hidden = 1;
		assert_leads(&w, scan(&w), 0);
		assert_int_equal(tracker_lead(&w.t)->missed, i);
		/* the longer unseen, the less is known */
		const struct kalman *k = &tracker_lead(&w.t)->k;

		assert_true(k->p[SCENE_HEADWAY][SCENE_HEADWAY] >
			    before.p[SCENE_HEADWAY][SCENE_HEADWAY]);
		assert_true(k->p[SCENE_LEAD_SPEED][SCENE_LEAD_SPEED] >
			    before.p[SCENE_LEAD_SPEED][SCENE_LEAD_SPEED]);
	}
	w.car[0].hidden = 0;
	assert_leads(&w, scan(&w), 0);
	assert_int_equal(tracker_lead(&w.t)->id, 1);
	assert_int_equal(tracker_lead(&w.t)->missed, 0);
}

static void long_gaps_are_not(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 40, 18, 0);
	scans(&w, 10);
	w.car[0].hidden = 1;
	assert_non_null(scans(&w, 4));
	assert_null(scan(&w));
	assert_int_equal(w.t.n, 0);
	w.car[0].hidden = 0;
	assert_null(scans(&w, 3));
	assert_leads(&w, scan(&w), 0);
	assert_int_equal(tracker_lead(&w.t)->id, 2);
}

static void random_dropouts_do_not_lose_the_lead(void **state)
{
	struct road w;
	int lost = 0;

	(void)state;
	open_road(&w);
	add(&w, 40, 20, 0);
	scans(&w, 10);
	for (int i = 0; i < 2000; i++) {
		w.car[0].hidden = noise_uniform(&w.r) < 0.1;
		lost += scan(&w) == NULL;
	}
	assert_int_equal(lost, 0);
	assert_in_range(w.t.last_id, 1, 3); /* an outlier may start a second object */
}

static void a_silent_radar_makes_a_new_start(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 40, 20, 0);
	assert_non_null(scans(&w, 10));
	w.ms += 150; /* and the period: more than three of them */
	assert_null(scan(&w));
	assert_int_equal(w.t.object[0].id, 2);
}

static void a_reset_forgets_everything(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 40, 20, 0);
	assert_non_null(scans(&w, 10));
	tracker_reset(&w.t);
	assert_null(tracker_lead(&w.t));
	assert_false(w.t.ego_valid);
	assert_null(scans(&w, 3));
	assert_non_null(scan(&w));
}

static void lateral_motion_is_followed(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	w.noise = 0.1;
	add(&w, 40, 20, 3.5);
	scans(&w, 20);
	assert_true(fabs(w.t.object[0].lateral_mps) < 0.1);
	for (int i = 0; i < 30; i++) {
		w.car[0].lateral_m -= 1.2 * SCAN_MS / 1000;
		scan(&w);
	}
	assert_true(fabs(w.t.object[0].lateral_mps + 1.2) < 0.1);
	assert_true(fabs(w.t.object[0].lateral_m - w.car[0].lateral_m) < 0.1); /* it does not lag */
	/* unseen, it goes on as it did */
	w.car[0].hidden = 1;
	const double before = w.t.object[0].lateral_m;

	scans(&w, 2);
	assert_true(fabs(before - w.t.object[0].lateral_m - 0.12) < 0.02);
}

/* Two scans of one time say nothing of a rate. */
static void a_scan_without_time_keeps_the_rate(void **state)
{
	struct road w;
	struct tracker_scan s = {.n = 1, .det = {{.distance_m = 30, .existence = 1}}};

	(void)state;
	open_road(&w);
	tracker_ego_speed(&w.t, 0, EGO_MPS);
	s.t_ns = MS;
	tracker_scan(&w.t, &s);
	s.det[0].lateral_m = 0.5;
	tracker_scan(&w.t, &s);
	assert_int_equal(w.t.n, 1);
	assert_true(w.t.object[0].lateral_m == 0.2 && w.t.object[0].lateral_mps == 0);
}

/* ---- duplicates ----------------------------------------------------------------------------- */

static void one_car_seen_twice_is_one_object(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 40, 20, 0);
	w.car[0].twice = 1;
	for (int i = 0; i < 300; i++) {
		scan(&w);
		assert_in_range(w.t.n, 1, 2);
		if (i >= 4) {
			assert_leads(&w, tracker_lead(&w.t), 0);
			assert_int_equal(tracker_lead(&w.t)->id, w.t.object[0].id);
		}
	}
	assert_in_range(w.t.last_id, 1, 600);
	assert_int_equal(w.t.object[0].id, 1);
}

static void objects_that_become_one_are_merged(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	w.noise = 0.1;
	add(&w, 40, 20, 0);
	add(&w, 42, 19.8, 0);
	scans(&w, 20);
	assert_int_equal(w.t.n, 2);
	const uint32_t older = w.t.object[0].id;

	for (int i = 0; w.car[1].gap_m > w.car[0].gap_m; i++) {
		assert_in_range(i, 0, 200);
		scan(&w);
	}
	assert_int_equal(w.t.n, 1);
	assert_int_equal(w.t.object[0].id, older);
}

/* @n scans of as many objects as the radar knows, from @gap_m on. */
static void fill_road(struct road *w, struct tracker_scan *s, double gap_m, int n)
{
	for (int j = 0; j < MAP_TRACKS_MAX; j++) {
		s->det[s->n = j] = (struct detection){.distance_m = gap_m + 3 * j, .existence = 1};
	}
	for (s->n++; n > 0; n--) {
		s->t_ns += SCAN_MS * MS;
		tracker_ego_speed(&w->t, s->t_ns, EGO_MPS);
		tracker_scan(&w->t, s);
	}
}

static void more_objects_than_fit_are_left_out(void **state)
{
	struct road w;
	struct tracker_scan s = {0};

	(void)state;
	open_road(&w);
	tracker_ego_speed(&w.t, 0, EGO_MPS);
	fill_road(&w, &s, 2, 4);
	fill_road(&w, &s, 200, 4); /* the others are still believed to be there */
	assert_int_equal(w.t.n, TRACKER_OBJECTS_MAX);
	assert_int_equal(tracker_lead(&w.t)->id, 1);
	fill_road(&w, &s, 400, 1); /* no longer: the next scan has room */
	assert_int_equal(w.t.n, MAP_TRACKS_MAX);
	assert_int_equal(w.t.last_id, TRACKER_OBJECTS_MAX);
	fill_road(&w, &s, 400, 1);
	assert_int_equal(w.t.n, TRACKER_OBJECTS_MAX);
	assert_int_equal(tracker_lead(&w.t)->id, MAP_TRACKS_MAX + 1);
}

/* ---- leading -------------------------------------------------------------------------------- */

static void the_nearest_in_the_corridor_leads(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 80, 20, 0.5);
	add(&w, 20, 20, 2.5);
	add(&w, 15, 20, -2.5);
	assert_leads(&w, scans(&w, 10), 0);
	w.car[1].lateral_m = 1.4; /* cuts in, from one moment to the next */
	assert_leads(&w, scans(&w, 5), 1);
	w.car[1].lateral_m = 2.5; /* and out */
	assert_leads(&w, scans(&w, 5), 0);
}

static void the_lead_may_waver_at_the_edge(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	w.noise = 0.1;
	add(&w, 80, 20, 0);
	add(&w, 20, 20, 1.7); /* between the corridor and its margin */
	assert_leads(&w, scans(&w, 20), 0);
	w.car[1].lateral_m = 1.5;
	assert_leads(&w, scans(&w, 20), 1);
	w.car[1].lateral_m = 1.8;
	assert_leads(&w, scans(&w, 20), 1);
	w.car[1].lateral_m = 2.0;
	assert_leads(&w, scans(&w, 20), 0);
	w.car[1].lateral_m = 1.8;
	assert_leads(&w, scans(&w, 20), 0);
	w.car[1].lateral_m = -1.5;
	assert_leads(&w, scans(&w, 20), 1);
	w.car[1].lateral_m = -2.0;
	assert_leads(&w, scans(&w, 20), 0);
}

static void a_curve_bends_the_corridor(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	w.noise = 0;
	add(&w, 40, 20, 1.6 + 0.4); /* 1/400 m to the left: 2 m at 40 m */
	assert_null(scans(&w, 10));

	struct tracker_scan s = {.t_ns = w.ms * MS, .curvature = 1.0 / 400, .n = 1};

	s.det[0] = look(&w, &w.car[0]);
	tracker_scan(&w.t, &s);
	const struct tracker_object *lead = tracker_lead(&w.t);

	assert_non_null(lead);
	assert_true(fabs(tracker_lateral(&w.t, lead)) < 0.01);
}

static void oncoming_traffic_does_not_lead(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 200, -15, 0);
	add(&w, 210, 20, 0);
	assert_leads(&w, scans(&w, 30), 1);
}

/* A speed below that of what stands counts once it is below by the gate's sigmas. */
static void oncoming_is_what_surely_comes(void **state)
{
	struct tracker_object o = {.k.p = {[SCENE_LEAD_SPEED] = {[SCENE_LEAD_SPEED] = 4}}};
	struct road w;

	(void)state;
	open_road(&w);
	const double surely = w.cfg.filter_standing_speed + w.cfg.filter_gate * 2;

	o.k.x[SCENE_LEAD_SPEED] = surely * 1.01;
	assert_false(tracker_oncoming(&w.t, &o));
	o.k.x[SCENE_LEAD_SPEED] = -surely * 0.99;
	assert_false(tracker_oncoming(&w.t, &o));
	o.k.x[SCENE_LEAD_SPEED] = -surely;
	assert_false(tracker_oncoming(&w.t, &o));
	o.k.x[SCENE_LEAD_SPEED] = -surely * 1.01;
	assert_true(tracker_oncoming(&w.t, &o));
}

/* ---- standing ------------------------------------------------------------------------------- */

static void a_lead_that_stops_stays_the_lead(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 120, 10, 0);
	w.car[0].accel_mps2 = -8;
	for (int i = 0; i < 80; i++) {
		const struct tracker_object *lead = scan(&w);

		if (i >= 4) {
			assert_leads(&w, lead, 0);
			assert_int_equal(lead->id, 1);
		}
	}
	/* also while nobody sees it stop */
	open_road(&w);
	add(&w, 60, 10, 0);
	w.car[0].accel_mps2 = -8;
	for (int i = 0; i < 40; i++) {
		w.car[0].hidden = i >= 21 && i <= 24;
		const struct tracker_object *lead = scan(&w);

		assert_true(i < 4 || (lead && lead->id == 1));
	}
}

static void a_lead_that_drives_off_is_believed(void **state)
{
	struct road w;

	(void)state;
	open_road(&w);
	add(&w, 120, 0, 0);
	scans(&w, 20);
	w.car[0].accel_mps2 = 2;
	const struct tracker_object *lead = scans(&w, 20);

	assert_leads(&w, lead, 0);
	assert_int_equal(lead->id, 1);
	assert_true(fabs(lead->k.x[SCENE_LEAD_SPEED] - 1.9) < 0.4);
	assert_true(fabs(lead->k.x[SCENE_LEAD_ACCEL] - 2) < 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_happens_without_an_ego_speed),
		cmocka_unit_test(an_object_counts_after_four_scans),
		cmocka_unit_test(fresh_detections_do_not_count),
		cmocka_unit_test(ghosts_never_lead),
		cmocka_unit_test(what_was_seen_once_is_soon_forgotten),
		cmocka_unit_test(slots_mean_nothing),
		cmocka_unit_test(cars_side_by_side_are_told_apart),
		cmocka_unit_test(a_braking_lead_is_followed),
		cmocka_unit_test(short_gaps_are_bridged),
		cmocka_unit_test(long_gaps_are_not),
		cmocka_unit_test(random_dropouts_do_not_lose_the_lead),
		cmocka_unit_test(a_silent_radar_makes_a_new_start),
		cmocka_unit_test(a_reset_forgets_everything),
		cmocka_unit_test(lateral_motion_is_followed),
		cmocka_unit_test(a_scan_without_time_keeps_the_rate),
		cmocka_unit_test(one_car_seen_twice_is_one_object),
		cmocka_unit_test(objects_that_become_one_are_merged),
		cmocka_unit_test(more_objects_than_fit_are_left_out),
		cmocka_unit_test(the_nearest_in_the_corridor_leads),
		cmocka_unit_test(the_lead_may_waver_at_the_edge),
		cmocka_unit_test(a_curve_bends_the_corridor),
		cmocka_unit_test(oncoming_traffic_does_not_lead),
		cmocka_unit_test(oncoming_is_what_surely_comes),
		cmocka_unit_test(a_lead_that_stops_stays_the_lead),
		cmocka_unit_test(a_lead_that_drives_off_is_believed),
	};

	return cmocka_run_group_tests_name("tracker", tests, NULL, NULL);
}
