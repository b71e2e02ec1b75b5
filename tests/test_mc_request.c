/* SPDX-License-Identifier: MIT
 * mc_check, mc_request_hash and the paper's preset: every field refused alone, every field in the hash.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <string.h>
#include "mc.h"

#define AT(field) offsetof(struct mc_request, field)

/* A request that uses every field. */
static struct mc_request full(void)
{
	struct mc_request r;

	mc_preset_paper(&r, 100.0f, 1000);
	r.flags = MC_WANT_HIST | MC_WANT_IMPACT | MC_ROLLING_IS_CONTACT;
	r.n_futures = MC_FUTURES_MAX;
	r.n_priors = MC_PRIORS_MAX;
	for (int i = 0; i < MC_FUTURES_MAX; i++) {
		r.future[i] = (struct model_future){-6.0f, 0.1f * (float)i};
	}
	for (int i = 0; i < MC_PRIORS_MAX; i++) {
		r.prior[i] = (struct mc_prior){0.125f, 1.0f, -1.0f, 5.0f, -2.0f};
	}
	return r;
}

static void put_float(struct mc_request *r, size_t at, float x)
{
	memcpy((char *)r + at, &x, sizeof(x));
}

static int check_float(size_t at, float x)
{
	struct mc_request r = full();

	put_float(&r, at, x);
	return mc_check(&r);
}

static int check_word(size_t at, uint32_t x)
{
	struct mc_request r = full();

	memcpy((char *)&r + at, &x, sizeof(x));
	return mc_check(&r);
}

/* Every float of a request: where it is, and the smallest and largest value that is let through. */
#define TOP  1e6f
#define TINY 1e-30f
static const struct {
	size_t at;
	int n;
	float lo, hi;
} field[] = {
	{AT(mean[MODEL_HEADWAY]), 5, -TOP, TOP},
	{AT(mean[MODEL_MU]), 1, TINY, TOP},
	{AT(mean[MODEL_GRADE]), 1, -0.5f, 0.5f},
	{AT(mean[MODEL_MASS]), 1, TINY, TOP},
	{AT(mean[MODEL_DRAG]), 1, -TOP, TOP},
	{AT(mean[MODEL_TAU]), 1, TINY, TOP},
	{AT(mean[MODEL_DELAY]), 1, -TOP, TOP},
	{AT(factor[0]), 1, 0.0f, TOP},
	{AT(factor[1]), 1, -TOP, TOP},
	{AT(factor[2]), 1, 0.0f, TOP},
	{AT(factor[3]), 2, -TOP, TOP},
	{AT(factor[5]), 1, 0.0f, TOP},
	{AT(factor[6]), 3, -TOP, TOP},
	{AT(factor[9]), 1, 0.0f, TOP},
	{AT(factor[10]), 4, -TOP, TOP},
	{AT(factor[14]), 1, 0.0f, TOP},
	{AT(sigma), MODEL_INPUTS - MC_STATE_DIM, 0.0f, TOP},
	{AT(floor), MC_FLOORS, 0.0f, TOP},
	{AT(horizon_s), 1, TINY, 30.0f},
	{AT(centre_m), 1, -TOP, TOP},
	{AT(vehicle.rho_kgpm3), 2, 0.0f, TOP},
	{AT(vehicle.gravity_mps2), 1, TINY, TOP},
	{AT(vehicle.cg_height_m), 1, 0.0f, TOP},
	{AT(vehicle.wheelbase_m), 1, TINY, TOP},
	{AT(future[0].accel_cmd_mps2), 1, -TOP, 0.0f},
	{AT(future[0].extra_delay_s), 1, 0.0f, TOP},
	{AT(future[3].accel_cmd_mps2), 1, -TOP, 0.0f},
	{AT(future[3].extra_delay_s), 1, 0.0f, TOP},
	{AT(prior[0].gain), 4, -TOP, TOP},
	{AT(prior[7].gain), 4, -TOP, TOP},
};

static void test_floats(void **arg)
{
	(void)arg;
	for (size_t i = 0; i < sizeof(field) / sizeof(field[0]); i++) {
		for (int k = 0; k < field[i].n; k++) {
			size_t at = field[i].at + (size_t)k * sizeof(float);
			float below =
				field[i].lo == TINY ? 0.0f : nextafterf(field[i].lo, -INFINITY);

			assert_int_equal(check_float(at, field[i].lo), 0);
			assert_int_equal(check_float(at, field[i].hi), 0);
			assert_int_equal(check_float(at, below), -EINVAL);
			assert_int_equal(check_float(at, nextafterf(field[i].hi, INFINITY)),
					 -EINVAL);
			assert_int_equal(check_float(at, NAN), -EINVAL);
			assert_int_equal(check_float(at, INFINITY), -EINVAL);
			assert_int_equal(check_float(at, -INFINITY), -EINVAL);
		}
	}
}

static void test_counts(void **arg)
{
	struct mc_request r = full();

	(void)arg;
	assert_int_equal(mc_check(&r), 0);
	assert_int_equal(check_word(AT(n), 0), -EINVAL);
	assert_int_equal(check_word(AT(n), 1), 0);
	assert_int_equal(check_word(AT(n), UINT32_MAX), 0);
	assert_int_equal(check_word(AT(flags), 0), 0);
	assert_int_equal(check_word(AT(flags), 8), -EINVAL);
	assert_int_equal(check_word(AT(n_futures), 0), -EINVAL);
	assert_int_equal(check_word(AT(n_futures), 5), -EINVAL);
	assert_int_equal(check_word(AT(n_priors), 9), -EINVAL);
	assert_int_equal(check_word(AT(n_priors), 0), 0);
	assert_int_equal(check_word(AT(hist_future), 3), 0);
	assert_int_equal(check_word(AT(hist_future), 4), -EINVAL);
	assert_int_equal(check_word(AT(vehicle.bound), 1), 0);
	assert_int_equal(check_word(AT(vehicle.bound), 2), -EINVAL);
}

static void test_weights(void **arg)
{
	static const struct {
		float w[4];
		int want;
	} row[] = {
		{{1.0f, 0.0f, 0.0f, 0.0f}, 0},
		{{0.2505f, 0.25f, 0.25f, 0.25f}, 0},
		{{0.2495f, 0.25f, 0.25f, 0.25f}, 0},
		{{0.252f, 0.25f, 0.25f, 0.25f}, -EINVAL},
		{{0.248f, 0.25f, 0.25f, 0.25f}, -EINVAL},
		{{1.5f, -0.5f, 0.0f, 0.0f}, -EINVAL},
		{{NAN, 0.5f, 0.5f, 0.0f}, -EINVAL},
		{{INFINITY, 0.0f, 0.0f, 0.0f}, -EINVAL},
		{{0.0f, 0.0f, 0.0f, 0.0f}, -EINVAL},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct mc_request r = full();

		for (int k = 0; k < MC_PRIORS_MAX; k++) {
			r.prior[k].weight = k < 4 ? row[i].w[k] : 0.0f;
		}
		assert_int_equal(mc_check(&r), row[i].want);
	}
}

/* What is not used is not looked at. */
static void test_unused(void **arg)
{
	struct mc_request r = full(), s;

	(void)arg;
	r.n_futures = r.n_priors = 1;
	r.prior[0].weight = 1.0f;
	s = r;
	s.future[1].accel_cmd_mps2 = NAN;
	s.prior[1].weight = NAN;
	assert_int_equal(mc_check(&s), 0);
	assert_true(mc_request_hash(&s) == mc_request_hash(&r));
}

static void test_hash(void **arg)
{
	const struct mc_request r = full();
	const uint64_t h = mc_request_hash(&r);

	(void)arg;
	for (size_t at = 0; at < sizeof(r); at += 4) {
		struct mc_request s = r;
		uint32_t word;

		memcpy(&word, (char *)&s + at, sizeof(word));
		word ^= 1;
		memcpy((char *)&s + at, &word, sizeof(word));
		if (at < AT(n)) { /* the id */
			assert_true(mc_request_hash(&s) == h);
		} else if (at < AT(prior) + sizeof(s.prior)) {
			assert_true(mc_request_hash(&s) != h);
		}
	}
	assert_int_equal(h, 0x670936f63af3e10bu);
}

static void test_preset(void **arg)
{
	struct mc_request r;

	(void)arg;
	memset(&r, 0xff, sizeof(r));
	mc_preset_paper(&r, 111.9f, 12000);
	assert_int_equal(mc_check(&r), 0);
	assert_int_equal(r.n, 12000);
	assert_int_equal(r.n_futures, 1);
	assert_int_equal(r.n_priors, 0);
	assert_true(r.id >= 1);
	assert_true(r.flags & MC_WANT_HIST);
	assert_true(r.flags & MC_ROLLING_IS_CONTACT);
	assert_true(r.mean[MODEL_HEADWAY] == 111.9f);
	assert_true(r.mean[MODEL_LEAD_SPEED] == 0.0f);
	assert_true(r.mean[MODEL_LEAD_ACCEL] == 0.0f);
	assert_true(r.mean[MODEL_DELAY] == 0.0f);
	assert_true(r.factor[2] == 2.0f);
	assert_true(r.future[0].accel_cmd_mps2 == -6.0f);
	assert_true(r.future[0].extra_delay_s == 0.0f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_floats),  cmocka_unit_test(test_counts),
		cmocka_unit_test(test_weights), cmocka_unit_test(test_unused),
		cmocka_unit_test(test_hash),    cmocka_unit_test(test_preset),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
