/* SPDX-License-Identifier: MIT
 * sample: draws to inputs against plain f64 arithmetic, every floor alone, every prior row, bits that may not change.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "draws.h"
#include "sample.h"

#define N 4096u

/* A scene in the middle of everything: no floor is near. */
static struct mc_request scene(void)
{
	struct mc_request r = {
		.mean = {40.0f, 25.0f, -0.5f, 20.0f, -2.0f, 0.8f, 0.02f, 1500.0f, 0.3f, 0.15f,
			 0.3f},
		.factor = {0.5f, -0.2f, 0.7f, 0.1f, 0.05f, 0.3f, 0.4f, 0.2f, -0.1f, 0.6f, 0.02f,
			   0.01f, 0.3f, -0.2f, 0.5f},
		.sigma = {0.05f, 0.01f, 50.0f, 0.02f, 0.01f, 0.02f},
		.floor = {1.0f, 0.05f, 100.0f, 0.01f},
	};

	return r;
}

static struct sample_plan planned(const struct mc_request *req)
{
	struct sample_plan p;

	sample_plan(req, &p);
	return p;
}

static void table(float z[MC_DIM][N])
{
	const struct mc_params p = {.kind = MC_PHILOX, .seed = 1, .n_resident = 1};
	struct draws *d;

	assert_int_equal(draws_open(&p, &d), 0);
	draws_fill(d, 0, N, z[0], N);
	draws_close(d);
}

/* What the inputs are, in f64 and by the textbook: mean + L z, then independent ones. */
static double expected(const struct mc_request *r, const float *z, int input)
{
	const float *row = r->factor + input * (input + 1) / 2;
	double v = (double)r->mean[input];

	if (input >= MC_STATE_DIM) {
		return v + (double)r->sigma[input - MC_STATE_DIM] * (double)z[input * N];
	}
	for (int k = 0; k <= input; k++) {
		v += (double)row[k] * (double)z[k * N];
	}
	return v;
}

static void test_inputs(void **arg)
{
	static float z[MC_DIM][N], in[MODEL_INPUTS][N];
	struct mc_request r = scene();
	struct sample_plan p = planned(&r);

	(void)arg;
	table(z);
	for (uint32_t i = 0; i < N; i++) {
		assert_int_equal(sample_draw(&p, &z[0][i], N, &in[0][i], N), 0);
		for (int k = 0; k < MODEL_INPUTS; k++) {
			double want = expected(&r, &z[0][i], k);

			assert_true(fabs((double)in[k][i] - want) < 3e-7 * (1.0 + fabs(want)));
		}
	}
}

static void test_floors(void **arg)
{
	static const struct {
		int input;
		float mean, floor;
	} row[] = {
		{MODEL_HEADWAY, 0.5f, 1.0f},
		{MODEL_EGO_SPEED, -0.1f, 0.0f},
		{MODEL_LEAD_SPEED, -0.1f, 0.0f},
		{MODEL_MU, 0.01f, 0.05f},
		{MODEL_MASS, 99.0f, 100.0f},
		{MODEL_DRAG, -0.01f, 0.0f},
		{MODEL_TAU, 0.019f, SAMPLE_TAU_FLOOR_S},
		{MODEL_DELAY, 0.009f, 0.01f},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		const float zero[MC_DIM] = {0};
		float in[MODEL_INPUTS];
		struct mc_request r = scene();
		struct sample_plan p;

		r.mean[row[i].input] = row[i].floor;
		p = planned(&r);
		assert_int_equal(sample_draw(&p, zero, 1, in, 1), 0);
		r.mean[row[i].input] = row[i].mean;
		p = planned(&r);
		assert_int_equal(sample_draw(&p, zero, 1, in, 1), 1);
		for (int k = 0; k < MODEL_INPUTS; k++) {
			float want = k == row[i].input ? row[i].floor : r.mean[k];

			assert_true(in[k] == want);
		}
	}
}

/* Negative accelerations and grades are no floor's business. */
static void test_signed(void **arg)
{
	const float zero[MC_DIM] = {0};
	float in[MODEL_INPUTS];
	struct mc_request r = scene();
	struct sample_plan p;

	(void)arg;
	r.mean[MODEL_GRADE] = -0.3f;
	p = planned(&r);
	assert_int_equal(sample_draw(&p, zero, 1, in, 1), 0);
	assert_true(in[MODEL_EGO_ACCEL] == -0.5f);
	assert_true(in[MODEL_LEAD_ACCEL] == -2.0f);
	assert_true(in[MODEL_GRADE] == -0.3f);
}

static float lead_accel(const struct mc_request *r, float u)
{
	float z[MC_DIM] = {0}, in[MODEL_INPUTS];
	struct sample_plan p = planned(r);

	z[MC_DIM_PRIOR] = u;
	sample_draw(&p, z, 1, in, 1);
	return in[MODEL_LEAD_ACCEL];
}

static void test_priors(void **arg)
{
	struct mc_request r = scene();
	const float last = 1.0f - 0x1p-24f;

	(void)arg;
	assert_true(lead_accel(&r, 0.0f) == -2.0f);
	assert_true(lead_accel(&r, last) == -2.0f);
	r.n_priors = 4;
	r.prior[0] = (struct mc_prior){.weight = 0.5f, .gain = 1.0f};
	r.prior[1] = (struct mc_prior){.weight = 0.25f};
	r.prior[2] = (struct mc_prior){.weight = 0.125f, .gain = 0.5f, .offset_mps2 = -1.0f};
	r.prior[3] = (struct mc_prior){.weight = 0.125f, .offset_mps2 = -6.0f};
	assert_true(lead_accel(&r, 0.0f) == -2.0f);
	assert_true(lead_accel(&r, 0.499f) == -2.0f);
	assert_true(lead_accel(&r, 0.5f) == 0.0f);
	assert_true(lead_accel(&r, 0.749f) == 0.0f);
	assert_true(lead_accel(&r, 0.75f) == -2.0f);
	r.prior[2].gain = 2.0f;
	assert_true(lead_accel(&r, 0.75f) == -5.0f);
	assert_true(lead_accel(&r, 0.874f) == -5.0f);
	assert_true(lead_accel(&r, 0.875f) == -6.0f);
	assert_true(lead_accel(&r, last) == -6.0f);
	r.n_priors = 2; /* weights that end short of 1: the last row takes the rest */
	r.prior[1].weight = 0.4995f;
	assert_true(lead_accel(&r, last) == 0.0f);
	r.n_priors = 1;
	r.prior[0] = (struct mc_prior){.weight = 0.9995f, .gain = 3.0f, .offset_mps2 = 0.5f};
	assert_true(lead_accel(&r, last) == -5.5f);
}

/* Each of the rows, at both ends of its share: what it does to headway, speed and acceleration of the lead; the ego's
 * inputs stay. */
static void test_every_row(void **arg)
{
	struct mc_request r = scene();

	(void)arg;
	r.n_priors = MC_PRIORS_MAX;
	for (int i = 0; i < MC_PRIORS_MAX; i++) {
		r.prior[i] = (struct mc_prior){.weight = 0.125f,
					       .gain = (float)i,
					       .offset_mps2 = 1.0f,
					       .headway_m = -3.0f * (float)i,
					       .speed_mps = 2.0f * (float)i};
	}
	const struct sample_plan p = planned(&r);

	for (int i = 0; i < 2 * MC_PRIORS_MAX; i++) {
		const int row = i / 2;
		float z[MC_DIM] = {0}, in[MODEL_INPUTS];

		z[MC_DIM_PRIOR] = 0.125f * (float)(row + i % 2) - (i % 2 ? 0x1p-24f : 0.0f);
		assert_int_equal(sample_draw(&p, z, 1, in, 1), 0);
		for (int k = 0; k < MODEL_INPUTS; k++) {
			const float want = k == MODEL_HEADWAY      ? 40.0f - 3.0f * (float)row
					   : k == MODEL_LEAD_SPEED ? 20.0f + 2.0f * (float)row
					   : k == MODEL_LEAD_ACCEL ? 1.0f - 2.0f * (float)row
								   : r.mean[k];

			assert_true(in[k] == want);
		}
	}
	/* moved below their floors, both are lifted */
	r.n_priors = 1;
	r.prior[0] = (struct mc_prior){.weight = 1.0f, .headway_m = -50.0f, .speed_mps = -30.0f};
	const struct sample_plan q = planned(&r);
	float z[MC_DIM] = {0}, in[MODEL_INPUTS];

	assert_int_equal(sample_draw(&q, z, 1, in, 1), 1);
	assert_true(in[MODEL_HEADWAY] == 1.0f && in[MODEL_LEAD_SPEED] == 0.0f);
}

/* FNV-1a over all inputs, so that a machine or compiler with other bits is noticed. */
static void test_bits(void **arg)
{
	static float z[MC_DIM][N];
	struct mc_request r = scene();
	struct sample_plan p = planned(&r);
	uint64_t h = 0xcbf29ce484222325u;

	(void)arg;
	table(z);
	for (uint32_t i = 0; i < N; i++) {
		float in[MODEL_INPUTS];

		sample_draw(&p, &z[0][i], N, in, 1);
		for (int k = 0; k < MODEL_INPUTS; k++) {
			h = (h ^ det_bits(in[k])) * 0x100000001b3u;
		}
	}
	assert_int_equal(h, 0x5a82a820cf82f135u);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_inputs),    cmocka_unit_test(test_floors),
		cmocka_unit_test(test_signed),    cmocka_unit_test(test_priors),
		cmocka_unit_test(test_every_row), cmocka_unit_test(test_bits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
