/* SPDX-License-Identifier: MIT
 * model: the reference rollout against the oracle's scenes, its order, and scenes with answers known by hand.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "scene_kat.h"

static const struct model_vehicle vehicle = {1.225f, 2.2f, 9.81f, 0.5f, 2.7f, MODEL_BOUND_PAPER};

/* 30 m/s on a level road, the paper's means; the lead stands 100 m ahead. */
static const float nominal[MODEL_INPUTS] = {
	[MODEL_HEADWAY] = 100.0f, [MODEL_EGO_SPEED] = 30.0f, [MODEL_MU] = 0.8f,
	[MODEL_MASS] = 1500.0f,   [MODEL_DRAG] = 0.3f,       [MODEL_TAU] = 0.15f};

static struct model_out roll(const float in[MODEL_INPUTS], float cmd, float extra, double dt)
{
	const struct model_future fut = {cmd, extra};

	return model_rollout(&vehicle, &fut, 10.0f, dt, in, 1);
}

/* A scene that differs from the nominal one in up to four inputs. */
#define SCENE(name, ...)                                                                \
	float name[MODEL_INPUTS];                                                       \
	do {                                                                            \
		const struct {                                                          \
			int input;                                                      \
			float value;                                                    \
		} set[] = {__VA_ARGS__};                                                \
		memcpy(name, nominal, sizeof(nominal));                                 \
		for (size_t set_i = 0; set_i < sizeof(set) / sizeof(set[0]); set_i++) { \
			name[set[set_i].input] = set[set_i].value;                      \
		}                                                                       \
	} while (0)

static void near(double got, double want, double by)
{
	if (!(fabs(got - want) <= by)) {
		fail_msg("%.7g is not %.7g +- %g", got, want, by);
	}
}

static void test_oracle(void **arg)
{
	FILE *f = kat_open("rollout.txt");
	struct scene_kat k;
	int n = 0, contacts = 0, rolling = 0;

	(void)arg;
	while (scene_kat_next(f, &k)) {
		const struct model_out o =
			model_rollout(&k.vehicle, &k.future, k.horizon_s, MODEL_STEP_S, k.in, 1);

		near(o.stop_m, k.stop_m, 1e-4);
		near(o.need_m, k.need_m, 1e-4);
		near(o.impact_mps, k.impact_mps, 3e-3);
		assert_int_equal(o.flags, k.flags);
		contacts += (k.flags & MODEL_CONTACT) != 0;
		rolling += (k.flags & MODEL_ROLLING) != 0;
		n++;
	}
	assert_int_equal(n, SCENES);
	assert_true(contacts > 50 && contacts < 150 && rolling > 30);
}

/* Without friction kink, fourth order: where dt is coarse, halving it takes the error to a sixteenth. */
static void test_order(void **arg)
{
	SCENE(in, {MODEL_MU, 1.0f});
	const double exact = roll(in, -6.0f, 0.0f, 1e-4).stop_m;

	(void)arg;
	near(roll(in, -6.0f, 0.0f, 1e-3).stop_m, exact, 1e-5);
	near(roll(in, -6.0f, 0.0f, 20e-3).stop_m, exact, 2e-4);
	near(roll(in, -6.0f, 0.0f, 5e-3).stop_m, exact, 2e-5);
}

static void test_nominal(void **arg)
{
	const struct model_out o = roll(nominal, -6.0f, 0.0f, MODEL_STEP_S);

	(void)arg;
	near(o.stop_m, 77.7839599, 1e-5);
	assert_true(o.need_m == o.stop_m);
	assert_int_equal(o.flags, 0);
	assert_true(o.impact_mps == 0.0f);
}

/* Drag-free, so that Newton's parabolas hold. */
static void test_by_hand(void **arg)
{
	/* nobody brakes: contact with a standing lead after 2 s */
	SCENE(coasting, {MODEL_HEADWAY, 60.0f}, {MODEL_DRAG, 0.0f});
	/* already braking at 3 m/s2: stops after 10 s and 150 m */
	SCENE(braking, {MODEL_HEADWAY, 149.0f}, {MODEL_EGO_ACCEL, -3.5f});
	/* same speed, lead brakes at 4: 15 m are used up after 2.74 s, 10.95 m/s */
	SCENE(lead, {MODEL_HEADWAY, 15.0f}, {MODEL_LEAD_SPEED, 30.0f}, {MODEL_LEAD_ACCEL, -4.0f});
	struct model_out o = roll(coasting, -6.0f, 10.0f, MODEL_STEP_S);

	(void)arg;
	near(o.impact_mps, 30.0, 1e-5);
	near(o.stop_m, 300.0, 1e-4);
	near(o.need_m, 300.0, 1e-4);
	assert_int_equal(o.flags, MODEL_CONTACT | MODEL_ROLLING);
	o = roll(braking, 0.0f, 10.0f, MODEL_STEP_S);
	near(o.stop_m, 30.0 * 30.0 / 7.0, 1e-4);
	assert_int_equal(o.flags, 0);
	o = roll(lead, -6.0f, 10.0f, MODEL_STEP_S);
	near(o.impact_mps, sqrt(2.0 * 4.0 * 15.0), 1e-4);
	assert_int_equal(o.flags, MODEL_CONTACT | MODEL_ROLLING);
}

/* The bound of eq. 5 caps the deceleration; plain friction allows more. */
static void test_bound(void **arg)
{
	const struct model_future hard = {-20.0f, 0.0f};
	struct model_vehicle friction = vehicle;
	SCENE(in, {MODEL_TAU, 0.02f}, {MODEL_DRAG, 0.0f});
	double paper = 0.8 * 9.81 / (1.0 + 0.8 * 0.5 / 2.7);

	(void)arg;
	friction.bound = MODEL_BOUND_FRICTION;
	near(roll(in, -20.0f, 0.0f, MODEL_STEP_S).stop_m, 450.0 / paper, 0.5);
	near(model_rollout(&friction, &hard, 10.0f, MODEL_STEP_S, in, 1).stop_m,
	     450.0 / (0.8 * 9.81), 0.5);
}

static void test_standing(void **arg)
{
	SCENE(stands, {MODEL_EGO_SPEED, 0.0f}, {MODEL_EGO_ACCEL, -1.0f});
	SCENE(downhill, {MODEL_EGO_SPEED, 0.0f}, {MODEL_GRADE, -0.2f});
	SCENE(starts, {MODEL_EGO_SPEED, 0.0f}, {MODEL_EGO_ACCEL, 2.0f}, {MODEL_DELAY, 1.0f},
	      {MODEL_DRAG, 0.0f});
	struct model_out o = roll(stands, -6.0f, 1.0f, MODEL_STEP_S);

	(void)arg;
	assert_true(o.stop_m == 0.0f && o.need_m == 0.0f && o.flags == 0);
	o = roll(downhill, -6.0f, 0.0f, MODEL_STEP_S);
	assert_true(o.stop_m == 0.0f && o.flags == 0);
	o = roll(starts, -6.0f, 0.0f, MODEL_STEP_S);
	assert_true(o.stop_m > 1.0f && o.stop_m < 2.0f && o.flags == 0);
}

/* No headway is contact at once, at the closing speed; a lead that leaves is hit at 0 m/s. */
static void test_no_headway(void **arg)
{
	SCENE(closing, {MODEL_HEADWAY, 0.0f}, {MODEL_LEAD_SPEED, 20.0f});
	SCENE(leaving, {MODEL_HEADWAY, 0.0f}, {MODEL_LEAD_SPEED, 40.0f});
	const struct model_out o = roll(closing, -6.0f, 0.0f, MODEL_STEP_S);
	const struct model_out l = roll(leaving, -6.0f, 0.0f, MODEL_STEP_S);

	(void)arg;
	near(o.impact_mps, 10.0, 1e-6);
	assert_int_equal(o.flags, MODEL_CONTACT);
	assert_true(l.impact_mps == 0.0f && l.need_m == 0.0f);
	assert_int_equal(l.flags, MODEL_CONTACT);
}

/* Rolls at the horizon: undecided where the gap still closes, nothing where it opens. */
static void test_horizon(void **arg)
{
	SCENE(closing, {MODEL_HEADWAY, 900.0f});
	SCENE(opening, {MODEL_HEADWAY, 50.0f}, {MODEL_LEAD_SPEED, 40.0f});

	(void)arg;
	assert_int_equal(roll(closing, -6.0f, 8.0f, MODEL_STEP_S).flags,
			 MODEL_ROLLING | MODEL_UNDECIDED);
	assert_int_equal(roll(opening, -6.0f, 8.0f, MODEL_STEP_S).flags, MODEL_ROLLING);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_oracle),     cmocka_unit_test(test_order),
		cmocka_unit_test(test_nominal),    cmocka_unit_test(test_by_hand),
		cmocka_unit_test(test_bound),      cmocka_unit_test(test_standing),
		cmocka_unit_test(test_no_headway), cmocka_unit_test(test_horizon),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
