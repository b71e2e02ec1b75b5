/* SPDX-License-Identifier: MIT
 * What the ego meets first: each effect alone against its formula, each switched off, and that the parts make 1.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>
#include "clock.h"
#include "perception.h"

#define EGO_MPS 20.0

static struct config cfg;
static struct tracker t;

static int empty_road(void **state)
{
	(void)state;
	config_defaults(&cfg);
	cfg.perception_curve_sigma = 0;
	tracker_open(&t, &cfg);
	return 0;
}

/* An object seen often, sure to exist. */
static struct tracker_object *add(double gap_m, double speed_mps, double lateral_m)
{
	struct tracker_object *o = &t.object[t.n++];

	*o = (struct tracker_object){
		.lateral_m = lateral_m, .existence = 1, .hits = 100, .id = (uint32_t)t.n};
	o->k.x[SCENE_HEADWAY] = gap_m;
	o->k.x[SCENE_EGO_SPEED] = EGO_MPS;
	o->k.x[SCENE_LEAD_SPEED] = speed_mps;
	o->k.p[SCENE_LEAD_SPEED][SCENE_LEAD_SPEED] = 0.01;
	return o;
}

static double lead_p(const struct perception *w)
{
	double p = 1;

	for (int i = 0; i < SCENE_OTHERS; i++) {
		assert_true(w->p[i] >= 0 && w->p[i] <= 1);
		p -= w->p[i];
	}
	return p;
}

static void near(double got, double want)
{
	if (!(fabs(got - want) < 1e-12)) {
		fail_msg("%.17g is not %.17g", got, want);
	}
}

/* ---- inside the corridor ---------------------------------------------------------------------- */

static double gauss(double x)
{
	return 0.5 * erfc(-x / sqrt(2));
}

static void inside_is_the_normal_distribution(void **state)
{
	(void)state;
	for (int i = -60; i <= 60; i++) {
		const double at = 0.1 * i;
		struct tracker_object *o = add(30, EGO_MPS, at);
		const double want = gauss((1.6 - at) / 0.3) - gauss((-1.6 - at) / 0.3);

		assert_true(fabs(perception_inside(&t, o) - want) < 3e-4);
		t.n = 0;
	}
	cfg.perception_lateral_sigma = 0; /* known exactly: inside or not */
	assert_true(perception_inside(&t, add(30, EGO_MPS, 1.6)) == 1);
	assert_true(perception_inside(&t, add(30, EGO_MPS, 1.61)) == 0);
	assert_true(perception_inside(&t, add(30, EGO_MPS, -1.61)) == 0);
	cfg.perception_lateral_sigma = 5e-7;
	assert_true(perception_inside(&t, add(30, EGO_MPS, 1.6)) == 1);
	cfg.perception_lateral_sigma = 1e-6; /* from here on on the edge is half inside */
	assert_true(fabs(perception_inside(&t, add(30, EGO_MPS, 1.6)) - 0.5) < 1e-6);
}

static void lateral_motion_is_followed_until_contact(void **state)
{
	static const struct {
		double gap_m, speed_mps, lookahead_s, want_m; /* from 3 m, moving in at 2 m/s */
	} row[] = {
		{30, 20, 0.5, 2}, {30, 25, 0.5, 2}, {30, 20, 0, 3}, {30, 10, 1, 1}, {2, 10, 1, 2.6},
		{0, 10, 1, 3},    {-1, 10, 1, 3},   {10, 10, 1, 1}, {10, 10, 2, 1},
	};

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct tracker_object *moving = add(row[i].gap_m, row[i].speed_mps, 3);
		struct tracker_object *there = add(30, EGO_MPS, row[i].want_m);

		cfg.perception_lookahead = row[i].lookahead_s;
		moving->lateral_mps = -2;
		near(perception_inside(&t, moving), perception_inside(&t, there));
		t.n = 0;
	}
}

static void a_curve_bends_the_corridor(void **state)
{
	struct tracker_object *o = add(50, EGO_MPS, 2.5);

	(void)state;
	assert_true(perception_inside(&t, o) < 0.01);
	t.curvature = 0.002; /* 2.5 m to the left at 50 m */
	cfg.perception_lookahead = 1;
	assert_true(perception_inside(&t, o) > 0.99);
	/* one that comes nearer along the bent path stays on it */
	o->k.x[SCENE_LEAD_SPEED] = 10;
	o->lateral_mps = 0.002 * 50 * -10;
	assert_true(perception_inside(&t, o) > 0.99);
	/* the less the curvature is known, the less so far away */
	o->lateral_mps = 0;
	o->k.x[SCENE_LEAD_SPEED] = EGO_MPS;
	t.curvature_sigma = 0.001;
	const double sigma = sqrt(0.3 * 0.3 + 1.25 * 1.25);

	assert_true(fabs(perception_inside(&t, o) - (2 * gauss(1.6 / sigma) - 1)) < 3e-4);
}

/* ---- who is met ------------------------------------------------------------------------------- */

static void a_sure_lead_alone_is_met(void **state)
{
	struct perception w = perception_weigh(&t, add(30, 18, 0));

	(void)state;
	assert_true(lead_p(&w) > 0.9999);
	assert_null(w.object[SCENE_NEARER]);
	assert_null(w.object[SCENE_BEHIND]);
	t.n = 0;
	cfg.perception_cutout = 0;
	w = perception_weigh(&t, add(30, 18, 0));
	assert_true(lead_p(&w) == 1);
}

static void a_ghost_may_be_nothing(void **state)
{
	struct tracker_object *lead = add(30, 0, 0);

	(void)state;
	cfg.perception_cutout = 0;
	lead->existence = 0.4;
	struct perception w = perception_weigh(&t, lead);

	near(lead_p(&w), 0.4);
	near(w.p[SCENE_NOTHING], 0.6);
	assert_true(w.p[SCENE_HIDDEN] == 0); /* a ghost hides nothing */
	cfg.perception_existence = 0.5;
	w = perception_weigh(&t, lead);
	near(lead_p(&w), 0.2);
	cfg.perception_ghosts = 0;
	w = perception_weigh(&t, lead);
	assert_true(lead_p(&w) == 1);
}

static void behind_a_ghost_is_the_next_object(void **state)
{
	struct tracker_object *lead = add(30, 0, 0), *next = add(50, 20, 0);

	(void)state;
	cfg.perception_cutout = 0;
	add(70, 20, 3); /* beside the road ahead */
	lead->existence = 0.4;
	next->existence = 0.5;
	struct perception w = perception_weigh(&t, lead);

	assert_ptr_equal(w.object[SCENE_BEHIND], next);
	assert_null(w.object[SCENE_NEARER]);
	assert_true(fabs(w.p[SCENE_BEHIND] - 0.6 * 0.5) < 1e-6);
	assert_true(fabs(w.p[SCENE_NOTHING] - 0.6 * 0.5) < 1e-6);
	near(lead_p(&w), 0.4);
}

static void who_cuts_in_is_met_before_the_lead(void **state)
{
	struct tracker_object *lead = add(40, 20, 0), *other = add(15, 17, 2.6);

	(void)state;
	cfg.perception_cutout = 0;
	add(20, 17, -4);
	struct perception w = perception_weigh(&t, lead);

	assert_true(w.p[SCENE_NEARER] < 1e-3); /* beside, staying there */
	other->lateral_mps = -2.4;
	w = perception_weigh(&t, lead);
	assert_ptr_equal(w.object[SCENE_NEARER], other);
	near(w.p[SCENE_NEARER], perception_inside(&t, other));
	assert_true(w.p[SCENE_NEARER] > 0.7);
	near(lead_p(&w), 1 - w.p[SCENE_NEARER]);
	cfg.perception_cutin = 0; /* then only where it is counts */
	w = perception_weigh(&t, lead);
	assert_true(lead_p(&w) == 1);
	other->lateral_m = -1.6;
	w = perception_weigh(&t, lead);
	assert_true(w.p[SCENE_NEARER] == 1);
}

static void what_is_not_confirmed_counts_in_part(void **state)
{
	struct tracker_object *lead = add(40, 20, 0), *new = add(15, 17, 0);

	(void)state;
	cfg.perception_cutout = 0;
	cfg.perception_cutin = 0;
	new->hits = 2; /* of 4 */
	struct perception w = perception_weigh(&t, lead);

	near(w.p[SCENE_NEARER], 0.25);
	new->hits = 4;
	w = perception_weigh(&t, lead);
	near(w.p[SCENE_NEARER], 1);
	new->hits = 3;
	cfg.perception_missed = 0;
	w = perception_weigh(&t, lead);
	assert_null(w.object[SCENE_NEARER]);
	cfg.perception_missed = 1;
	new->k.x[SCENE_LEAD_SPEED] = -15; /* oncoming traffic is not met */
	w = perception_weigh(&t, lead);
	assert_null(w.object[SCENE_NEARER]);
}

static void a_lead_that_leaves_may_reveal_what_it_hid(void **state)
{
	struct tracker_object *lead = add(30, 18, 1.2);

	(void)state;
	lead->lateral_mps = 1.5;
	const double stays = perception_inside(&t, lead);
	struct perception w = perception_weigh(&t, lead);

	assert_true(stays > 0.05 && stays < 0.3);
	near(lead_p(&w), stays);
	near(w.p[SCENE_HIDDEN], 0.01 * (1 - stays));
	near(w.p[SCENE_NOTHING], 0.99 * (1 - stays));
	cfg.perception_hidden = 0;
	w = perception_weigh(&t, lead);
	assert_true(w.p[SCENE_HIDDEN] == 0);
	/* what is seen behind is no longer hidden */
	cfg.perception_hidden = 1;
	struct tracker_object *next = add(60, 0, 0);

	next->existence = 0.9;
	w = perception_weigh(&t, lead);
	near(w.p[SCENE_BEHIND], (1 - stays) * 0.9 * perception_inside(&t, next));
	assert_true(fabs(w.p[SCENE_HIDDEN] - (1 - stays) * 0.1) < 1e-6);
	assert_true(w.p[SCENE_NOTHING] < 1e-12 && w.p[SCENE_NOTHING] >= 0);
	cfg.perception_cutout = 0;
	w = perception_weigh(&t, lead);
	assert_true(lead_p(&w) == 1);
}

/* The order of age is not that of place. */
static void every_effect_takes_its_share_of_what_the_others_leave(void **state)
{
	struct tracker_object *nearer = add(15, 17, 1.3), *lead = add(30, 18, 1.2);
	struct tracker_object *next = add(60, 0, 0);

	(void)state;
	add(10, 20, 0); /* given up */
	t.n--;
	lead->lateral_mps = 0.5;
	nearer->existence = 0.8;
	lead->existence = 0.5;
	next->existence = 0.6;
	cfg.perception_hidden = 0.25;
	const struct perception w = perception_weigh(&t, lead);
	const double n = 0.8 * perception_inside(&t, nearer), stays = perception_inside(&t, lead);
	const double b = 0.6 * perception_inside(&t, next);
	const double hidden = (1 - n) * 0.5 * (1 - stays) * (1 - b) * 0.25;

	assert_true(n > 0.5 && n < 0.79 && stays > 0.2 && stays < 0.8);
	assert_ptr_equal(w.object[SCENE_NEARER], nearer);
	assert_ptr_equal(w.object[SCENE_BEHIND], next);
	near(w.p[SCENE_NEARER], n);
	near(w.p[SCENE_BEHIND], (1 - n) * (1 - 0.5 * stays) * b);
	near(w.p[SCENE_HIDDEN], hidden);
	near(w.p[SCENE_NOTHING], (1 - n) * (1 - 0.5 * stays) * (1 - b) - hidden);
	near(lead_p(&w), (1 - n) * 0.5 * stays);
}

/* An object beside the lead, as far away, is not before it. */
static void as_far_as_the_lead_is_not_nearer(void **state)
{
	struct tracker_object *lead = add(30, 18, 1), *beside = add(30, 18, -1);
	const struct perception w = perception_weigh(&t, lead);

	(void)state;
	assert_null(w.object[SCENE_NEARER]);
	assert_ptr_equal(w.object[SCENE_BEHIND], beside);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(inside_is_the_normal_distribution, empty_road),
		cmocka_unit_test_setup(lateral_motion_is_followed_until_contact, empty_road),
		cmocka_unit_test_setup(a_curve_bends_the_corridor, empty_road),
		cmocka_unit_test_setup(a_sure_lead_alone_is_met, empty_road),
		cmocka_unit_test_setup(a_ghost_may_be_nothing, empty_road),
		cmocka_unit_test_setup(behind_a_ghost_is_the_next_object, empty_road),
		cmocka_unit_test_setup(who_cuts_in_is_met_before_the_lead, empty_road),
		cmocka_unit_test_setup(what_is_not_confirmed_counts_in_part, empty_road),
		cmocka_unit_test_setup(a_lead_that_leaves_may_reveal_what_it_hid, empty_road),
		cmocka_unit_test_setup(every_effect_takes_its_share_of_what_the_others_leave,
				       empty_road),
		cmocka_unit_test_setup(as_far_as_the_lead_is_not_nearer, empty_road),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
