/* SPDX-License-Identifier: MIT
 * pipeline_request: the factor gives the covariance back, what is not a covariance is refused, and every option arrives
 * where the model reads it.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <math.h>
#include <string.h>
#include "pipeline.h"

static struct config cfg;

static int defaults(void **arg)
{
	(void)arg;
	config_defaults(&cfg);
	return 0;
}

static struct scene scene(void)
{
	/* A A' for a lower triangular A: positive definite by construction. */
	static const double a[SCENE_DIM][SCENE_DIM] = {{0.5},
						       {-0.1, 0.2},
						       {0.02, 0.3, 0.7},
						       {0.1, 0.15, -0.05, 0.25},
						       {0.3, -0.2, 0.1, 0.4, 1.5}};
	struct scene s = {.ego_valid = 1, .lead_valid = 1, .x = {40, 25, -0.5, 20, -1}};

	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = 0; j < SCENE_DIM; j++) {
			for (int k = 0; k < SCENE_DIM; k++) {
				s.cov[i][j] += a[i][k] * a[j][k];
			}
		}
	}
	return s;
}

static float factor(const struct mc_request *r, int row, int column)
{
	return column > row ? 0 : r->factor[row * (row + 1) / 2 + column];
}

static void test_factor(void **arg)
{
	struct scene s = scene();
	struct mc_request r;

	(void)arg;
	assert_int_equal(pipeline_request(&cfg, &s, 7, &r), 0);
	assert_int_equal(r.id, 7);
	assert_int_equal(mc_check(&r), 0);
	for (int i = 0; i < SCENE_DIM; i++) {
		assert_true(r.mean[i] == (float)s.x[i]);
		assert_true(factor(&r, i, i) > 0);
		for (int j = 0; j < SCENE_DIM; j++) {
			double sum = 0;

			for (int k = 0; k < SCENE_DIM; k++) {
				sum += (double)factor(&r, i, k) * factor(&r, j, k);
			}
			assert_true(fabs(sum - s.cov[i][j]) < 1e-6);
		}
	}
}

static void test_known_exactly(void **arg)
{
	struct scene s = scene();
	struct mc_request r;

	(void)arg;
	for (int i = 0; i < SCENE_DIM; i++) {
		s.cov[i][SCENE_EGO_ACCEL] = s.cov[SCENE_EGO_ACCEL][i] = 0;
	}
	assert_int_equal(pipeline_request(&cfg, &s, 1, &r), 0);
	assert_int_equal(mc_check(&r), 0);
	for (int k = 0; k <= SCENE_EGO_ACCEL; k++) {
		assert_true(factor(&r, SCENE_EGO_ACCEL, k) == 0);
	}
	memset(s.cov, 0, sizeof(s.cov));
	assert_int_equal(pipeline_request(&cfg, &s, 1, &r), 0);
	for (int i = 0; i < MC_FACTOR_LEN; i++) {
		assert_true(r.factor[i] == 0);
	}
}

static void test_no_covariance(void **arg)
{
	static const struct {
		int row, column;
		double value;
	} bad[] = {
		{0, 0, -1e-9},    {4, 4, -1}, {0, 0, NAN},
		{2, 2, INFINITY}, {1, 0, 1}, /* correlation above 1 */
		{3, 3, 0},                   /* covaries although known exactly */
		{4, 1, INFINITY},
	};
	struct mc_request r = {.id = 99};

	(void)arg;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct scene s = scene();

		s.cov[bad[i].row][bad[i].column] = bad[i].value;
		s.cov[bad[i].column][bad[i].row] = bad[i].value;
		assert_int_equal(pipeline_request(&cfg, &s, 1, &r), -EINVAL);
	}
	assert_int_equal(r.id, 99); /* untouched */
}

static void test_exact_yet_correlated(void **arg)
{
	struct mc_request r;
	struct scene s = {.x = {40, 25, 0, 20, 0}};

	(void)arg;
	s.cov[1][0] = s.cov[0][1] = 1e-3;
	assert_int_equal(pipeline_request(&cfg, &s, 1, &r), -EINVAL);
}

static void test_options_arrive(void **arg)
{
	static const char *const set[] = {
		"mc.samples=512",          "mc.horizon=8",
		"vehicle.mass=1600",       "vehicle.mass_sigma=90",
		"vehicle.mass_floor=400",  "vehicle.drag=0.4",
		"vehicle.drag_sigma=0.06", "vehicle.area=2.5",
		"vehicle.rho=1.2",         "vehicle.gravity=9.8",
		"vehicle.cg_height=0.6",   "vehicle.wheelbase=2.8",
		"vehicle.bound=friction",  "road.mu=0.7",
		"road.mu_sigma=0.11",      "road.mu_floor=0.06",
		"road.grade=0.01",         "road.grade_sigma=0.04",
		"brake.accel=-9.5",        "brake.tau=0.2",
		"brake.tau_sigma=0.01",    "brake.delay=0.12",
		"brake.delay_sigma=0.02",
	};
	struct scene s = scene();
	struct mc_request r;
	char err[200];

	(void)arg;
	for (size_t i = 0; i < sizeof(set) / sizeof(set[0]); i++) {
		assert_int_equal(config_set(&cfg, set[i], err, sizeof(err)), 0);
	}
	assert_int_equal(pipeline_request(&cfg, &s, 1, &r), 0);
	assert_int_equal(mc_check(&r), 0);
	const float *m = r.mean, *sd = r.sigma - MC_STATE_DIM;

	assert_int_equal(r.n, 512);
	assert_int_equal(r.n_futures, FUTURES);
	assert_true(r.horizon_s == 8 && r.future[FUTURE_NOBODY].extra_delay_s >= 8);
	assert_true(r.future[FUTURE_NOW].accel_cmd_mps2 == -9.5f);
	assert_true(m[MODEL_MASS] == 1600 && sd[MODEL_MASS] == 90);
	assert_true(r.floor[MC_FLOOR_MASS] == 400);
	assert_true(m[MODEL_DRAG] == 0.4f && sd[MODEL_DRAG] == 0.06f);
	assert_true(m[MODEL_MU] == 0.7f && sd[MODEL_MU] == 0.11f);
	assert_true(r.floor[MC_FLOOR_MU] == 0.06f);
	assert_true(m[MODEL_GRADE] == 0.01f && sd[MODEL_GRADE] == 0.04f);
	assert_true(m[MODEL_TAU] == 0.2f && sd[MODEL_TAU] == 0.01f);
	assert_true(m[MODEL_DELAY] == 0.12f && sd[MODEL_DELAY] == 0.02f);
	assert_true(r.floor[MC_FLOOR_DELAY] == 0 && r.floor[MC_FLOOR_HEADWAY] == 0);
	assert_true(r.vehicle.area_m2 == 2.5f && r.vehicle.rho_kgpm3 == 1.2f);
	assert_true(r.vehicle.gravity_mps2 == 9.8f && r.vehicle.cg_height_m == 0.6f);
	assert_true(r.vehicle.wheelbase_m == 2.8f);
	assert_int_equal(r.vehicle.bound, MODEL_BOUND_FRICTION);
	assert_true(r.centre_m == floorf(25 * 0.32f + 625 / 19.0f));
}

static void test_priors_are_normalised(void **arg)
{
	struct scene s = scene();
	struct mc_request r;

	(void)arg;
	cfg.lead_hold_weight = 1;
	cfg.lead_decay_weight = 0.5;
	cfg.lead_harder_weight = 0.5;
	cfg.lead_ease_weight = 0;
	assert_int_equal(pipeline_request(&cfg, &s, 1, &r), 0);
	assert_int_equal(mc_check(&r), 0);
	assert_int_equal(r.n_priors, 8);
	assert_true(r.prior[0].weight == 0.5f && r.prior[0].gain == 1 &&
		    r.prior[0].offset_mps2 == 0);
	assert_true(r.prior[1].weight == 0.25f && r.prior[1].gain == 0.5f);
	assert_true(r.prior[2].weight == 0.25f && r.prior[2].gain == 1 &&
		    r.prior[2].offset_mps2 == -2);
	assert_true(r.prior[3].weight == 0 && r.prior[3].gain == 0);
	cfg.lead_hold_weight = cfg.lead_decay_weight = cfg.lead_harder_weight = 0;
	assert_int_equal(pipeline_request(&cfg, &s, 1, &r), 0);
	assert_true(r.prior[0].weight == 1); /* no weight at all: hold */
	assert_int_equal(mc_check(&r), 0);
}

static void assert_row(const struct mc_prior *p, struct mc_prior want)
{
	assert_true(fabsf(p->weight - want.weight) < 1e-7f);
	assert_true(p->gain == want.gain && p->offset_mps2 == want.offset_mps2);
	assert_true(p->headway_m == want.headway_m && p->speed_mps == want.speed_mps);
}

/* What is met instead of the lead has a row each, and takes its weight from the lead's. */
static void test_other_objects(void **arg)
{
	struct scene s = scene(); /* 40 m ahead, 25 behind 20 m/s, -1 m/s2 */
	struct mc_request r;

	(void)arg;
	s.other[SCENE_NEARER] = (struct scene_object){0.1, 22, 18, 0.5};
	s.other[SCENE_BEHIND] = (struct scene_object){0.2, 70, 0, 0};
	s.other[SCENE_HIDDEN] = (struct scene_object){0.05, 50, 0, 0};
	s.other[SCENE_NOTHING] = (struct scene_object){.p = 0.15};
	assert_int_equal(pipeline_request(&cfg, &s, 1, &r), 0);
	assert_int_equal(mc_check(&r), 0);
	assert_true(fabs(scene_lead_p(&s) - 0.5) < 1e-12);
	assert_row(&r.prior[0], (struct mc_prior){0.275f, 1, 0, 0, 0});
	assert_row(&r.prior[1], (struct mc_prior){0.15f, 0.5f, 0, 0, 0});
	assert_row(&r.prior[2], (struct mc_prior){0.025f, 1, -2, 0, 0});
	assert_row(&r.prior[3], (struct mc_prior){0.05f, 0, 0, 0, 0});
	assert_row(&r.prior[4], (struct mc_prior){0.1f, 1, 1.5f, -18, -2});
	assert_row(&r.prior[5], (struct mc_prior){0.2f, 1, 1, 30, -20});
	assert_row(&r.prior[6], (struct mc_prior){0.05f, 0, 0, 10, -20});
	assert_true(fabsf(r.prior[7].weight - 0.15f) < 1e-7f && r.prior[7].gain == 0);
	/* never met: farther than an ego at 100 m/s gets in any horizon, for it is the faster */
	assert_true(r.prior[7].headway_m >= 1000 && r.prior[7].speed_mps > 100);
	s.other[SCENE_NOTHING].p = 0.65 + 1e-15; /* rounding leaves nothing below 0 */
	assert_int_equal(pipeline_request(&cfg, &s, 1, &r), 0);
	assert_int_equal(mc_check(&r), 0);
	assert_true(scene_lead_p(&s) >= 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(test_factor, defaults),
		cmocka_unit_test_setup(test_known_exactly, defaults),
		cmocka_unit_test_setup(test_no_covariance, defaults),
		cmocka_unit_test_setup(test_exact_yet_correlated, defaults),
		cmocka_unit_test_setup(test_options_arrive, defaults),
		cmocka_unit_test_setup(test_priors_are_normalised, defaults),
		cmocka_unit_test_setup(test_other_objects, defaults),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
