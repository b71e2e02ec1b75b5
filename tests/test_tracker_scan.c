/* SPDX-License-Identifier: MIT
 * One scan at a time on objects made by hand: the figures that the tracker must reach are worked out here, on paper or by
 * the filter's own functions in the order in which they are due.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "clock.h"
#include "tracker.h"

#define MS      CLOCK_NS_PER_MS
#define EGO_MPS 20.0

struct bench {
	struct config cfg;
	struct tracker t;
	struct tracker_scan s;
};

/* An ego at 20 m/s, at time 0. What was in the memory before does not matter. */
static void open_bench(struct bench *b)
{
	memset(b, 0, sizeof(*b));
	memset(&b->t, 0xA5, sizeof(b->t));
	config_defaults(&b->cfg);
	tracker_open(&b->t, &b->cfg);
	tracker_ego_speed(&b->t, 0, EGO_MPS);
}

static struct detection *see(struct bench *b, double distance_m, double rate_mps, double lateral_m)
{
	struct detection *d = &b->s.det[b->s.n++];

	*d = (struct detection){.distance_m = distance_m,
				.rate_mps = rate_mps,
				.lateral_m = lateral_m,
				.existence = 0.9};
	return d;
}

/* A scan of what was seen since the last one. */
static void end_scan(struct bench *b, int64_t ms)
{
	b->s.t_ns = b->s.seen_ns = ms * MS;
	tracker_scan(&b->t, &b->s);
	b->s.n = 0;
}

static void assert_near(double got, double want, double tolerance)
{
	if (!(fabs(got - want) <= tolerance)) {
		fail_msg("%.17g is not %.17g +- %g", got, want, tolerance);
	}
}

/* ---- the filters ---------------------------------------------------------------------------- */

static void assert_knows_no_lead(const struct kalman *k)
{
	const int lead[] = {SCENE_HEADWAY, SCENE_LEAD_SPEED, SCENE_LEAD_ACCEL};

	for (int n = 0; n < 3; n++) {
		for (int i = 0; i < SCENE_DIM; i++) {
			assert_true(k->p[lead[n]][i] == (i == lead[n]));
		}
		assert_true(k->x[lead[n]] == 0);
	}
}

/* Speed and acceleration alone: two states, one of them measured. */
static void the_ego_is_filtered_alone(void **state)
{
	struct bench b;

	(void)state;
	open_bench(&b);
	tracker_ego_speed(&b.t, 100 * MS, EGO_MPS + 0.3);

	const double dt = 0.1, q = b.cfg.filter_ego_jerk;
	const double r = b.cfg.filter_ego_sigma * b.cfg.filter_ego_sigma;
	const double aa = b.cfg.filter_accel_sigma * b.cfg.filter_accel_sigma;
	const double vv = r + aa * dt * dt + q * dt * dt * dt / 3, va = aa * dt + q * dt * dt / 2;

	assert_near(b.t.ego.x[SCENE_EGO_SPEED], EGO_MPS + 0.3 * vv / (vv + r), 1e-12);
	assert_near(b.t.ego.x[SCENE_EGO_ACCEL], 0.3 * va / (vv + r), 1e-12);
	assert_near(b.t.ego.p[SCENE_EGO_SPEED][SCENE_EGO_SPEED], vv * r / (vv + r), 1e-12);
	assert_near(b.t.ego.p[SCENE_EGO_ACCEL][SCENE_EGO_ACCEL], aa + q * dt - va * va / (vv + r),
		    1e-12);
	assert_knows_no_lead(&b.t.ego);

	const double v = b.t.ego.x[SCENE_EGO_SPEED], a = b.t.ego.x[SCENE_EGO_ACCEL];

	end_scan(&b, 150);
	assert_int_equal(b.t.ego.t_ns, 150 * MS);
	assert_near(b.t.ego.x[SCENE_EGO_SPEED], v + 0.05 * a, 1e-12);
	assert_knows_no_lead(&b.t.ego);
}

static void expect_ego(const struct bench *b, struct kalman *k, int64_t ms, double mps)
{
	kalman_predict(k, ms * MS, b->cfg.filter_ego_jerk, b->cfg.filter_lead_jerk);
	kalman_update(k, KALMAN_EGO_SPEED, mps, b->cfg.filter_ego_sigma);
}

/* An object takes each ego speed and each detection at its time, with the noise that the radar says or else the usual one. */
static void an_object_takes_all_that_is_measured(void **state)
{
	struct bench b;
	struct kalman k;

	(void)state;
	open_bench(&b);
	b.cfg.filter_lead_jerk = 3; /* not the ego's */
	k = b.t.ego;
	struct detection *first = see(&b, 40, -2, 0);

	first->distance_sigma_m = 0.5;
	first->rate_sigma_mps = 0.3;
	tracker_ego_speed(&b.t, 20 * MS, 20.1);
	end_scan(&b, 50);
	expect_ego(&b, &k, 20, 20.1);
	kalman_predict(&k, 50 * MS, b.cfg.filter_ego_jerk, b.cfg.filter_lead_jerk);
	kalman_open_lead(&k, 40, 0.5, -2, 0.3, b.cfg.filter_accel_sigma);
	assert_memory_equal(&b.t.object[0].k, &k, sizeof(k));

	for (int i = 0; i < 2; i++) {
		struct detection *d = see(&b, 39.8, -2.2, 0);

		d->distance_sigma_m = i ? 0 : 0.4;
		d->rate_sigma_mps = i ? 0 : 0.2;
		tracker_ego_speed(&b.t, (70 + 50 * i) * MS, 20.2);
		end_scan(&b, 100 + 50 * i);
		expect_ego(&b, &k, 70 + 50 * i, 20.2);
		kalman_predict(&k, (100 + 50 * i) * MS, b.cfg.filter_ego_jerk,
			       b.cfg.filter_lead_jerk);
		kalman_update(&k, KALMAN_DISTANCE, 39.8, i ? b.cfg.radar_range_sigma : 0.4);
		kalman_update(&k, KALMAN_RATE, -2.2, i ? b.cfg.radar_rate_sigma : 0.2);
		assert_memory_equal(&b.t.object[0].k, &k, sizeof(k));
	}
	assert_int_equal(b.t.n, 1);
}

/* Confirmed by 4 scans: a gain of 2 / (4 + 1) on the place, of 0.4^2 / (2 - 0.4) = 0.1 on the rate. */
static void a_sideward_step_is_followed_by_its_gains(void **state)
{
	struct bench b;

	(void)state;
	open_bench(&b);
	see(&b, 30, 0, 0.25);
	end_scan(&b, 50);
	see(&b, 30, 0, 0.75);
	end_scan(&b, 100);
	assert_near(b.t.object[0].lateral_m, 0.25 + 0.4 * 0.5, 1e-12);
	assert_near(b.t.object[0].lateral_mps, 0.1 * 0.5 / 0.05, 1e-12);
	/* on its way to 0.5 m, where nothing is left to correct */
	see(&b, 30, 0, 0.5);
	end_scan(&b, 150);
	assert_near(b.t.object[0].lateral_m, 0.5, 1e-12);
	assert_near(b.t.object[0].lateral_mps, 1, 1e-12);
}

static void the_latest_word_on_existence_counts(void **state)
{
	struct bench b;

	(void)state;
	open_bench(&b);
	see(&b, 30, 0, 0)->existence = 0.9;
	end_scan(&b, 50);
	see(&b, 30, 0, 0)->existence = 0.7;
	end_scan(&b, 100);
	assert_true(b.t.object[0].existence == 0.7);
}

/* ---- association ---------------------------------------------------------------------------- */

/* A confirmed object at the ego's speed whose distance and rate are uncertain by 1 m2 and 4 m2/s2, noise included, and
 * have a covariance of 1.2 m2/s. */
static void put(struct bench *b, double distance_m)
{
	struct tracker_object *o = &b->t.object[b->t.n++];
	static const double p[SCENE_DIM][SCENE_DIM] = {{0.64, -0.3, 0, 0.9, 0},
						       {-0.3, 0.96, 0, 0.2, 0},
						       {0, 0, 1, 0, 0},
						       {0.9, 0.2, 0, 2, 0},
						       {0, 0, 0, 0, 1}};

	b->cfg.radar_range_sigma = 0.6;
	b->cfg.radar_rate_sigma = 1.2;
	*o = (struct tracker_object){.id = ++b->t.last_id, .hits = 4};
	o->k.x[SCENE_HEADWAY] = distance_m;
	o->k.x[SCENE_EGO_SPEED] = o->k.x[SCENE_LEAD_SPEED] = EGO_MPS;
	memcpy(o->k.p, p, sizeof(p));
}

/* 1 if a detection so far from where the object should be is taken for it; 0 if it is another. */
static int is_taken(double ahead_m, double faster_mps, double aside_m)
{
	struct bench b;

	open_bench(&b);
	put(&b, 30);
	see(&b, 30 + ahead_m, faster_mps, aside_m);
	end_scan(&b, 0);
	assert_int_equal(b.t.n, 1 + b.t.object[0].missed);
	return b.t.n == 1;
}

/* With t sigmas of each, (t^2 -+ 2 * 0.6 t^2 + t^2) / (1 - 0.6^2) is below 4^2 where t is below 3.578 if both have the
 * same sign, for then they go together, and below 1.789 if not; one alone is by 4 * 0.8. */
static void the_gate_is_an_ellipse(void **state)
{
	(void)state;
	for (int sign = -1; sign <= 1; sign += 2) {
		assert_true(is_taken(sign * 3.57, sign * 3.57 * 2, 0));
		assert_false(is_taken(sign * 3.59, sign * 3.59 * 2, 0));
		assert_true(is_taken(sign * 1.78, sign * -1.78 * 2, 0));
		assert_false(is_taken(sign * 1.80, sign * -1.80 * 2, 0));
		assert_true(is_taken(sign * 3.19, 0, 0));
		assert_false(is_taken(sign * 3.21, 0, 0));
		assert_true(is_taken(0, sign * 3.19 * 2, 0));
		assert_false(is_taken(0, sign * 3.21 * 2, 0));
	}
}

/* Half the corridor aside is another lane, wherever it is; together with a distance it is sooner. */
static void the_gate_reaches_half_a_corridor_aside(void **state)
{
	(void)state;
	for (int sign = -1; sign <= 1; sign += 2) {
		assert_true(is_taken(0, 0, sign * 1.59));
		assert_false(is_taken(0, 0, sign * 1.6));
		/* sqrt(16 - (2 / 0.8)^2) = 3.122 of 4 are left */
		assert_true(is_taken(2, 0, sign * 1.24));
		assert_false(is_taken(2, 0, sign * 1.26));
	}
}

/* Who is near enough to be either goes to the nearer one, whichever is older, and to that alone. */
static void a_detection_is_of_one_object(void **state)
{
	(void)state;
	for (int nearer = 0; nearer < 2; nearer++) {
		struct bench b;

		open_bench(&b);
		put(&b, 30);
		put(&b, 34);
		see(&b, nearer ? 32.2 : 31.8, 0, 0);
		end_scan(&b, 0);
		assert_int_equal(b.t.n, 2);
		for (int i = 0; i < 2; i++) {
			assert_int_equal(b.t.object[i].hits, i == nearer ? 5 : 4);
			assert_int_equal(b.t.object[i].missed, i == nearer ? 0 : 1);
		}
	}
}

/* The nearer of two is the object; the other one begins another, which is the same vehicle, seen twice. */
static void an_object_has_one_detection(void **state)
{
	(void)state;
	for (int nearer = 0; nearer < 2; nearer++) {
		struct bench b, alone;

		open_bench(&b);
		put(&b, 30);
		see(&b, nearer ? 31.2 : 31, 0, 0);
		see(&b, nearer ? 31 : 31.2, 0, 0);
		end_scan(&b, 0);
		open_bench(&alone);
		put(&alone, 30);
		see(&alone, 31, 0, 0);
		end_scan(&alone, 0);
		assert_int_equal(b.t.n, 1);
		assert_int_equal(b.t.object[0].hits, 5);
		assert_int_equal(b.t.last_id, 2);
		assert_memory_equal(&b.t.object[0], &alone.t.object[0], sizeof(b.t.object[0]));
	}
}

/* Not that it matters which, but that it is the same one in every replay. */
static void of_two_as_near_the_first_is_taken(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		struct bench b;

		open_bench(&b);
		put(&b, 30);
		see(&b, 30, 0, i ? 0.5 : -0.5);
		see(&b, 30, 0, i ? -0.5 : 0.5);
		end_scan(&b, 0);
		assert_near(b.t.object[0].lateral_m, i ? 0.2 : -0.2, 1e-12);
	}
}

/* ---- the lead ------------------------------------------------------------------------------- */

static void the_corridor_has_its_edges(void **state)
{
	(void)state;
	for (int sign = -1; sign <= 1; sign += 2) {
		struct bench b;

		open_bench(&b);
		put(&b, 30);
		b.t.object[0].lateral_m = sign * 1.6;
		end_scan(&b, 0);
		assert_ptr_equal(tracker_lead(&b.t), &b.t.object[0]);
		tracker_reset(&b.t);
		assert_int_equal(b.t.lead_id, 0);
		put(&b, 30);
		b.t.object[0].lateral_m = sign * nextafter(1.6, 2);
		tracker_ego_speed(&b.t, 0, EGO_MPS);
		end_scan(&b, 0);
		assert_null(tracker_lead(&b.t));
	}
}

/* 1/400 m to the left: 2 m at 40 m, so that what is straight ahead is 2 m to the right. */
static void the_path_is_the_scans(void **state)
{
	struct bench b;

	(void)state;
	open_bench(&b);
	put(&b, 40);
	b.s.curvature = 1.0 / 400;
	b.s.curvature_sigma = 0.001;
	end_scan(&b, 0);
	assert_near(tracker_lateral(&b.t, &b.t.object[0]), -2, 1e-12);
	assert_true(b.t.curvature_sigma == 0.001);
	assert_null(tracker_lead(&b.t));
}

static void of_two_as_far_the_older_leads(void **state)
{
	struct bench b;

	(void)state;
	open_bench(&b);
	put(&b, 30);
	put(&b, 30);
	b.t.object[0].lateral_m = -0.8;
	b.t.object[1].lateral_m = 0.8;
	end_scan(&b, 0);
	assert_int_equal(b.t.n, 2);
	assert_ptr_equal(tracker_lead(&b.t), &b.t.object[0]);
}

/* Three periods of 50 ms are not yet too long a silence. */
static void silence_counts_from_three_periods_on(void **state)
{
	(void)state;
	for (int more = 0; more < 2; more++) {
		struct bench b;

		open_bench(&b);
		put(&b, 30);
		end_scan(&b, 150 + more);
		assert_int_equal(b.t.n, !more);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_ego_is_filtered_alone),
		cmocka_unit_test(an_object_takes_all_that_is_measured),
		cmocka_unit_test(a_sideward_step_is_followed_by_its_gains),
		cmocka_unit_test(the_latest_word_on_existence_counts),
		cmocka_unit_test(the_gate_is_an_ellipse),
		cmocka_unit_test(the_gate_reaches_half_a_corridor_aside),
		cmocka_unit_test(a_detection_is_of_one_object),
		cmocka_unit_test(an_object_has_one_detection),
		cmocka_unit_test(of_two_as_near_the_first_is_taken),
		cmocka_unit_test(the_corridor_has_its_edges),
		cmocka_unit_test(the_path_is_the_scans),
		cmocka_unit_test(of_two_as_far_the_older_leads),
		cmocka_unit_test(silence_counts_from_three_periods_on),
	};

	return cmocka_run_group_tests_name("tracker_scan", tests, NULL, NULL);
}
