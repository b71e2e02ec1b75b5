/* SPDX-License-Identifier: MIT
 * rollout: the fast rollout against the oracle's scenes, against the reference on hard random scenes, and at the edges
 * of what a request may hold.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "rollout.h"
#include "scene_kat.h"
#include "verify.h"

#define COUNT 100 /* scenes a group */

static const struct model_vehicle vehicle = {1.225f, 2.2f, 9.81f, 0.5f, 2.7f, MODEL_BOUND_PAPER};

static void near(double got, double want, double by)
{
	if (!(fabs(got - want) <= by)) {
		fail_msg("%.7g is not %.7g +- %g", got, want, by);
	}
}

static struct model_out fast(const struct model_future *fut, float horizon_s, const float *in,
			     uint32_t stride)
{
	const struct rollout_plan p = rollout_plan(&vehicle, fut, horizon_s);

	return rollout_sample(&p, in, stride);
}

static void test_oracle(void **arg)
{
	FILE *f = kat_open("rollout.txt");
	struct scene_kat k;
	int n = 0;

	(void)arg;
	while (scene_kat_next(f, &k)) {
		const struct rollout_plan p = rollout_plan(&k.vehicle, &k.future, k.horizon_s);
		const struct model_out o = rollout_sample(&p, k.in, 1);

		if (!(k.flags & MODEL_ROLLING)) {
			near(o.stop_m, k.stop_m, 2e-4);
		}
		near(o.stop_m, k.stop_m, 1e-3);
		near(o.need_m, k.need_m, 3e-4);
		near(o.impact_mps, k.impact_mps, 5e-3);
		assert_int_equal(o.flags, k.flags);
		n++;
	}
	assert_int_equal(n, SCENES);
}

static struct verify_tally compare(enum verify_kind kind, uint64_t seed, int groups)
{
	static float in[MODEL_INPUTS * COUNT];
	static struct model_out a[COUNT], b[COUNT];
	struct verify_tally t = {0};

	for (int i = 0; i < groups; i++) {
		struct verify_group g = {.count = COUNT, .in = in};
		struct rollout_plan p;

		verify_scenes(kind, seed, (uint64_t)i, &g);
		p = rollout_plan(&g.vehicle, &g.future, g.horizon_s);
		for (uint32_t k = 0; k < COUNT; k++) {
			a[k] = rollout_sample(&p, in + k, COUNT);
			b[k] = model_rollout(&g.vehicle, &g.future, g.horizon_s, MODEL_STEP_S,
					     in + k, COUNT);
		}
		verify_compare(&g, a, b, &t);
	}
	return t;
}

static void test_paper(void **arg)
{
	const struct verify_tally t = compare(VERIFY_PAPER, 7, 10);

	(void)arg;
	assert_int_equal(t.scenes, 10 * COUNT);
	assert_int_equal(t.verdict_mismatches, 0);
	assert_int_equal(t.not_finite, 0);
	assert_true(t.contacts > 25);
	near(t.stop_dev_m, 0.0, 2e-4);
}

static void test_moving(void **arg)
{
	const struct verify_tally t = compare(VERIFY_MOVING, 7, 30);

	(void)arg;
	assert_int_equal(t.verdict_mismatches, 0);
	assert_int_equal(t.not_finite, 0);
	assert_true(t.contacts > 700 && t.grazing > 1250);
	near(t.stop_dev_m, 0.0, 5e-4);
	near(t.need_dev_m, 0.0, 5e-4);
	near(t.impact_dev_mps, 0.0, 0.01);
}

/* The comparison finds what it is for. */
static void test_compare_finds(void **arg)
{
	static float in[MODEL_INPUTS * COUNT];
	struct model_out a[COUNT], b[COUNT];
	struct verify_group g = {.count = COUNT, .in = in};
	struct verify_tally t = {0}, sum = {0};

	(void)arg;
	verify_scenes(VERIFY_PAPER, 1, 0, &g);
	for (uint32_t k = 0; k < COUNT; k++) {
		a[k] = b[k] = fast(&g.future, g.horizon_s, in + k, COUNT);
	}
	a[3].flags ^= MODEL_CONTACT;
	a[4].stop_m += 0.25f;
	a[5].need_m -= 0.5f;
	a[6].stop_m = NAN;
	a[7].flags ^= MODEL_UNDECIDED;
	a[8].need_m = b[8].need_m = in[8] + 1e-4f;
	a[8].flags ^= MODEL_CONTACT;
	a[9].flags = b[9].flags = MODEL_CONTACT;
	a[9].impact_mps = 2.0f;
	b[9].impact_mps = 1.5f;
	verify_compare(&g, a, b, &t);
	assert_int_equal(t.verdict_mismatches, 3);
	assert_int_equal(t.not_finite, 1);
	assert_int_equal(t.in_band, 1);
	near(t.stop_dev_m, 0.25, 1e-5);
	near(t.need_dev_m, 0.5, 1e-5);
	near(t.impact_dev_mps, 0.5, 1e-6);
	verify_add(&sum, &t);
	verify_add(&sum, &t);
	assert_int_equal(sum.scenes, 2 * COUNT);
	assert_int_equal(sum.verdict_mismatches, 6);
	near(sum.stop_dev_m, 0.25, 1e-5);
}

/* A flag that turns within 1 ms of the horizon, or on 1 cm/s, is explained by it; 5 ms are not. */
static void test_horizon_excluded(void **arg)
{
	float in[MODEL_INPUTS] = {
		[MODEL_HEADWAY] = 200.0f, [MODEL_EGO_SPEED] = 20.0f, [MODEL_MU] = 0.8f,
		[MODEL_MASS] = 1500.0f,   [MODEL_TAU] = 0.1f,        [MODEL_DRAG] = 0.3f};
	struct verify_group g = {vehicle, {-6.0f, 0.0f}, 0.0f, 1, in};

	(void)arg;
	for (int ms = 0; ms <= 5; ms += 5) {
		struct verify_tally t = {0};
		struct model_out a, b;
		float lo = 2.0f, hi = 5.0f;

		for (int i = 0; i < 40; i++) {
			const float mid = 0.5f * (lo + hi);
			const int rolls = (fast(&g.future, mid, in, 1).flags & MODEL_ROLLING) != 0;

			lo = rolls ? mid : lo;
			hi = rolls ? hi : mid;
		}
		g.horizon_s = lo - 1e-3f * (float)ms;
		a = b = fast(&g.future, g.horizon_s, in, 1);
		a.flags ^= MODEL_ROLLING;
		verify_compare(&g, &a, &b, &t);
		assert_int_equal(t.at_horizon, ms == 0);
		assert_int_equal(t.verdict_mismatches, ms != 0);
	}
}

/* Every corner of the inputs gives finite, ordered results and the reference's verdict. */
static void test_corners(void **arg)
{
	static const float value[MODEL_INPUTS][3] = {[MODEL_HEADWAY] = {0.0f, 30.0f, 300.0f},
						     [MODEL_EGO_SPEED] = {0.0f, 0.3f, 60.0f},
						     [MODEL_EGO_ACCEL] = {-8.0f, 0.0f, 3.0f},
						     [MODEL_LEAD_SPEED] = {0.0f, 15.0f, 60.0f},
						     [MODEL_LEAD_ACCEL] = {-10.0f, 0.0f, 4.0f},
						     [MODEL_MU] = {0.02f, 0.6f, 1.2f},
						     [MODEL_GRADE] = {-0.5f, 0.0f, 0.5f},
						     [MODEL_MASS] = {1000.0f, 1500.0f, 20000.0f},
						     [MODEL_DRAG] = {0.0f, 0.3f, 0.7f},
						     [MODEL_TAU] = {0.02f, 0.15f, 0.4f},
						     [MODEL_DELAY] = {0.0f, 0.7f, 12.0f}};
	static const struct model_future future[] = {
		{0.0f, 0.0f}, {-6.0f, 0.0f}, {-12.0f, 0.5f}, {-6.0f, 30.0f}};
	uint32_t n = 0, mixed = 12345;

	(void)arg;
	for (int i = 0; i < 4000; i++) {
		const struct model_future *f = &future[i % 4];
		float in[MODEL_INPUTS];
		struct model_out o, r;

		for (int k = 0; k < MODEL_INPUTS; k++) {
			mixed = mixed * 1664525u + 1013904223u;
			in[k] = value[k][(mixed >> 16) % 3];
		}
		o = fast(f, 10.0f, in, 1);
		r = model_rollout(&vehicle, f, 10.0f, 5e-3, in, 1);
		assert_true(isfinite(o.stop_m) && isfinite(o.need_m) && isfinite(o.impact_mps));
		assert_true(o.stop_m >= 0.0f && o.need_m >= 0.0f && o.impact_mps >= 0.0f);
		assert_int_equal((o.flags & MODEL_CONTACT) != 0, in[MODEL_HEADWAY] <= o.need_m);
		assert_true(!(o.flags & MODEL_UNDECIDED) ||
			    o.flags == (MODEL_UNDECIDED | MODEL_ROLLING));
		if (fabs((double)in[MODEL_HEADWAY] - r.need_m) > 2e-3) {
			assert_int_equal(o.flags & MODEL_CONTACT, r.flags & MODEL_CONTACT);
			n++;
		}
		near(o.stop_m, r.stop_m, 2e-3 + 1e-5 * r.stop_m);
		near(o.need_m, r.need_m, 2e-3 + 1e-5 * r.need_m);
	}
	assert_true(n > 2300);
}

/* With a standing lead what it takes not to touch is the stopping distance, to the last bit. */
static void test_standing_lead(void **arg)
{
	static float in[MODEL_INPUTS * COUNT];
	struct verify_group g = {.count = COUNT, .in = in};

	(void)arg;
	verify_scenes(VERIFY_PAPER, 3, 0, &g);
	for (uint32_t k = 0; k < COUNT; k++) {
		const struct model_out o = fast(&g.future, g.horizon_s, in + k, COUNT);

		assert_true(o.need_m == o.stop_m);
	}
}

/* A future that brakes only after the horizon is the limit of ones that brake ever later. */
static void test_unbraked(void **arg)
{
	static float in[MODEL_INPUTS * COUNT];
	struct verify_group g = {.count = COUNT, .in = in};

	(void)arg;
	verify_scenes(VERIFY_MOVING, 5, 1, &g);
	for (uint32_t k = 0; k < COUNT; k++) {
		const struct model_future never = {-6.0f, 10.0f}, late = {-6.0f, 9.9999f};
		float at_once[MODEL_INPUTS];
		struct model_out a, b;

		for (int i = 0; i < MODEL_INPUTS; i++) {
			at_once[i] = in[(size_t)i * COUNT + k];
		}
		at_once[MODEL_DELAY] = 0.0f;
		a = fast(&never, 10.0f, at_once, 1);
		b = fast(&late, 10.0f, at_once, 1);
		near(a.stop_m, b.stop_m, 1e-3);
		near(a.need_m, b.need_m, 1e-3);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_oracle),           cmocka_unit_test(test_paper),
		cmocka_unit_test(test_moving),           cmocka_unit_test(test_compare_finds),
		cmocka_unit_test(test_horizon_excluded), cmocka_unit_test(test_corners),
		cmocka_unit_test(test_standing_lead),    cmocka_unit_test(test_unbraked),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
