/* SPDX-License-Identifier: MIT
 * The filter against an oracle, against the motion it assumes, and against its own statistics.
 */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../tools/noise.h"
#include "clock.h"
#include "kalman.h"
#include "kat.h"

#define MS CLOCK_NS_PER_MS

/* ---- helpers -------------------------------------------------------------------------------- */

static void assert_near(double got, double want, double tolerance)
{
	if (!(fabs(got - want) <= tolerance)) {
		fail_msg("%.17g is not %.17g +- %g", got, want, tolerance);
	}
}

/* Lower Cholesky factor; 0 if @p is not positive definite. */
static int factor(const double p[SCENE_DIM][SCENE_DIM], double l[SCENE_DIM][SCENE_DIM])
{
	memset(l, 0, sizeof(double[SCENE_DIM][SCENE_DIM]));
	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = 0; j <= i; j++) {
			double s = p[i][j];

			for (int k = 0; k < j; k++) {
				s -= l[i][k] * l[j][k];
			}
			if (i == j && !(s > 0)) {
				return 0;
			}
			l[i][j] = i == j ? sqrt(s) : s / l[j][j];
		}
	}
	return 1;
}

static void assert_sound(const struct kalman *k)
{
	double l[SCENE_DIM][SCENE_DIM];

	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = 0; j < i; j++) {
			assert_memory_equal(&k->p[i][j], &k->p[j][i], sizeof(double));
		}
	}
	assert_true(factor(k->p, l));
}

/* Error squared in sigmas, over all states together. */
static double nees(const struct kalman *k, const double truth[SCENE_DIM])
{
	double l[SCENE_DIM][SCENE_DIM], y[SCENE_DIM], sum = 0;

	assert_true(factor(k->p, l));
	for (int i = 0; i < SCENE_DIM; i++) {
		y[i] = k->x[i] - truth[i];
		for (int j = 0; j < i; j++) {
			y[i] -= l[i][j] * y[j];
		}
		y[i] /= l[i][i];
		sum += y[i] * y[i];
	}
	return sum;
}

/* ---- known answers -------------------------------------------------------------------------- */

static int take_numbers(char *line, char **name, double *number, int max)
{
	char *save;
	int n = 0;

	*name = strtok_r(line, " \n", &save);
	for (char *word; n < max && (word = strtok_r(NULL, " \n", &save));) {
		number[n++] = strtod(word, NULL);
	}
	return n;
}

/* Applies one operation; returns how many arguments it had. */
static int apply(struct kalman *k, const char *name, const double *a)
{
	static const char *const inputs[KALMAN_INPUTS] = {"ego_speed", "distance", "rate"};

	if (!strcmp(name, "open_ego")) {
		kalman_open_ego(k, (int64_t)a[0], a[1], a[2], a[3]);
		return 4;
	}
	if (!strcmp(name, "open_lead")) {
		kalman_open_lead(k, a[0], a[1], a[2], a[3], a[4]);
		return 5;
	}
	if (!strcmp(name, "predict")) {
		kalman_predict(k, (int64_t)a[0], a[1], a[2]);
		return 3;
	}
	for (int in = 0; in < KALMAN_INPUTS; in++) {
		if (!strcmp(name, inputs[in])) {
			kalman_update(k, (enum kalman_input)in, a[0], a[1]);
			return 2;
		}
	}
	assert_string_equal(name, "set_lead_accel");
	kalman_set_lead_accel(k, a[0], a[1]);
	return 2;
}

static void follows_the_oracle(void **state)
{
	FILE *f = kat_open("kalman.txt");
	struct kalman k = {0};
	char line[1024];
	int steps = 0;

	(void)state;
	for (; kat_line(f, line, sizeof(line)); steps++) {
		double number[32];
		char *name;
		const int n = take_numbers(line, &name, number, 32);
		const double *want = number + apply(&k, name, number);

		assert_ptr_equal(want + 20, number + n);
		for (int i = 0; i < SCENE_DIM; i++) {
			assert_near(k.x[i], *want++, 1e-11);
		}
		for (int i = 0; i < SCENE_DIM; i++) {
			for (int j = i; j < SCENE_DIM; j++) {
				assert_near(k.p[i][j], *want++, 1e-12);
			}
		}
		assert_sound(&k);
	}
	assert_in_range(steps, 50, 100);
}

/* ---- motion --------------------------------------------------------------------------------- */

static struct kalman some_scene(void)
{
	struct kalman k;

	kalman_open_ego(&k, 1000 * MS, 20, 0.05, 2);
	k.x[SCENE_EGO_ACCEL] = -1;
	kalman_open_lead(&k, 30, 0.25, -2, 0.1, 2);
	k.x[SCENE_LEAD_ACCEL] = -3;
	return k;
}

static void prediction_moves_both_vehicles(void **state)
{
	struct kalman k = some_scene();

	(void)state;
	kalman_predict(&k, 1500 * MS, 5, 5);
	assert_near(k.x[SCENE_HEADWAY], 30 - 2 * 0.5 - 2 * 0.125, 1e-12);
	assert_near(k.x[SCENE_EGO_SPEED], 19.5, 1e-12);
	assert_near(k.x[SCENE_LEAD_SPEED], 16.5, 1e-12);
	assert_near(k.x[SCENE_EGO_ACCEL], -1, 0);
	assert_near(k.x[SCENE_LEAD_ACCEL], -3, 0);
	assert_int_equal(k.t_ns, 1500 * MS);
}

static void a_braking_lead_stops(void **state)
{
	struct kalman k = some_scene();

	(void)state;
	k.x[SCENE_LEAD_SPEED] = 1;
	k.x[SCENE_LEAD_ACCEL] = -4;
	kalman_predict(&k, 1400 * MS, 5, 5); /* 0.125 m in 0.25 s */
	assert_near(k.x[SCENE_HEADWAY], 30 + 0.125 - (20 * 0.4 - 0.08), 1e-12);
	assert_near(k.x[SCENE_LEAD_SPEED], 0, 0);
	assert_near(k.x[SCENE_LEAD_ACCEL], 0, 0);
	assert_sound(&k);
	kalman_predict(&k, 1600 * MS, 5, 5);
	assert_near(k.x[SCENE_LEAD_SPEED], 0, 0);
	k.x[SCENE_LEAD_ACCEL] = -4; /* what stands does not begin to move backwards */
	const double gap = k.x[SCENE_HEADWAY], ego = k.x[SCENE_EGO_SPEED];

	kalman_predict(&k, 1650 * MS, 5, 5);
	assert_near(k.x[SCENE_LEAD_SPEED], 0, 0);
	assert_near(k.x[SCENE_LEAD_ACCEL], 0, 0);
	assert_near(k.x[SCENE_HEADWAY], gap - ego * 0.05 - k.x[SCENE_EGO_ACCEL] * 0.05 * 0.05 / 2,
		    1e-12);
	/* oncoming traffic that brakes the other way */
	k.x[SCENE_LEAD_SPEED] = -5;
	k.x[SCENE_LEAD_ACCEL] = -1;
	kalman_predict(&k, 1750 * MS, 5, 5);
	assert_near(k.x[SCENE_LEAD_SPEED], -5.1, 1e-12);
}

static void the_past_changes_nothing(void **state)
{
	struct kalman k = some_scene();
	const struct kalman before = k;

	(void)state;
	kalman_predict(&k, 1000 * MS, 5, 5);
	kalman_predict(&k, 0, 5, 5);
	assert_memory_equal(&k, &before, sizeof(k));
}

static void two_steps_are_one(void **state)
{
	struct kalman once = some_scene(), twice = once;

	(void)state;
	kalman_predict(&once, 1400 * MS, 5, 2);
	kalman_predict(&twice, 1123 * MS, 5, 2);
	kalman_predict(&twice, 1400 * MS, 5, 2);
	for (int i = 0; i < SCENE_DIM; i++) {
		assert_near(twice.x[i], once.x[i], 1e-12);
		for (int j = 0; j < SCENE_DIM; j++) {
			assert_near(twice.p[i][j], once.p[i][j], 1e-12);
		}
	}
}

static void innovation_is_what_an_update_expects(void **state)
{
	struct kalman k = some_scene();
	double s;

	(void)state;
	assert_near(kalman_innovation(&k, KALMAN_DISTANCE, 31, 0.25, &s), 1, 1e-12);
	assert_near(s, 0.0625 + 0.0625, 1e-12);
	/* the ego's error is in both speeds and cancels in the rate */
	assert_near(kalman_innovation(&k, KALMAN_RATE, -1.5, 0.1, &s), 0.5, 1e-12);
	assert_near(s, 0.01 + 0.01, 1e-12);
	assert_near(kalman_innovation(&k, KALMAN_EGO_SPEED, 20, 0.05, &s), 0, 1e-12);
	assert_near(s, 0.0025 + 0.0025, 1e-12);
}

static void a_forgotten_lead_leaves_the_ego(void **state)
{
	struct kalman k = some_scene();
	const double var = k.p[SCENE_EGO_SPEED][SCENE_EGO_SPEED];

	(void)state;
	kalman_forget_lead(&k);
	assert_near(k.x[SCENE_EGO_SPEED], 20, 0);
	assert_near(k.p[SCENE_EGO_SPEED][SCENE_EGO_SPEED], var, 0);
	assert_near(k.p[SCENE_LEAD_SPEED][SCENE_EGO_SPEED], 0, 0);
	assert_near(k.x[SCENE_LEAD_SPEED], 0, 0);
	assert_sound(&k);
}

static void a_set_acceleration_moves_nothing_else(void **state)
{
	struct kalman k = some_scene();

	(void)state;
	kalman_predict(&k, 1500 * MS, 5, 5);
	const struct kalman before = k;

	kalman_set_lead_accel(&k, 0, 0.1);
	for (int i = 0; i < SCENE_LEAD_ACCEL; i++) {
		assert_near(k.x[i], before.x[i], 0);
		assert_near(k.p[i][i], before.p[i][i], 0);
	}
	assert_near(k.p[SCENE_LEAD_ACCEL][SCENE_LEAD_ACCEL], 0.01, 1e-15);
	assert_sound(&k);
}

/* ---- statistics ----------------------------------------------------------------------------- */

static void stays_sound_for_200000_steps(void **state)
{
	struct noise r = {.seed = 7};
	struct kalman k = some_scene();

	(void)state;
	for (int i = 0; i < 200000; i++) {
		const enum kalman_input in = (enum kalman_input)(noise_uniform(&r) * KALMAN_INPUTS);
		const double sigma = 0.001 + 5 * noise_uniform(&r) * noise_uniform(&r);
		double s;

		kalman_predict(&k, k.t_ns + (int64_t)(noise_uniform(&r) * 100) * MS, 0.1, 100);
		kalman_update(&k, in,
			      kalman_innovation(&k, in, 0, sigma, &s) * -1 +
				      sigma * noise_normal(&r),
			      sigma);
		if (i % 1000 == 0) {
			assert_sound(&k);
			k.t_ns = 0;
		}
	}
	assert_sound(&k);
}

#define RUNS 400
#define Q    5.0

/* The motion that the filter assumes: white jerk on both vehicles, stepped by 1 ms. */
struct world {
	struct noise r;
	double x[SCENE_DIM];
};

static void step_world(struct world *w)
{
	const double dt = 0.001, jerk = sqrt(Q * dt);

	w->x[SCENE_HEADWAY] += (w->x[SCENE_LEAD_SPEED] - w->x[SCENE_EGO_SPEED]) * dt +
			       (w->x[SCENE_LEAD_ACCEL] - w->x[SCENE_EGO_ACCEL]) * dt * dt / 2;
	w->x[SCENE_EGO_SPEED] += w->x[SCENE_EGO_ACCEL] * dt;
	w->x[SCENE_LEAD_SPEED] += w->x[SCENE_LEAD_ACCEL] * dt;
	w->x[SCENE_EGO_ACCEL] += jerk * noise_normal(&w->r);
	w->x[SCENE_LEAD_ACCEL] += jerk * noise_normal(&w->r);
}

struct sums {
	double nees, nis[KALMAN_INPUTS];
	int n[KALMAN_INPUTS];
};

static void measure(struct kalman *k, struct world *w, enum kalman_input in, double truth,
		    double sigma, struct sums *sum)
{
	const double z = truth + sigma * noise_normal(&w->r);
	double s;
	const double nu = kalman_innovation(k, in, z, sigma, &s);

	sum->nis[in] += nu * nu / s;
	sum->n[in]++;
	kalman_update(k, in, z, sigma);
}

/* Two seconds of a drive: ego speed every 20 ms, radar every 50 ms and out of step. */
static void one_run(uint64_t seed, struct sums *sum)
{
	struct world w = {.r.seed = seed};
	struct kalman k;

	w.x[SCENE_HEADWAY] = 40;
	w.x[SCENE_EGO_SPEED] = 25 + noise_normal(&w.r);
	w.x[SCENE_EGO_ACCEL] = 2 * noise_normal(&w.r);
	w.x[SCENE_LEAD_SPEED] = 25 + noise_normal(&w.r);
	w.x[SCENE_LEAD_ACCEL] = 2 * noise_normal(&w.r);
	kalman_open_ego(&k, 0, w.x[SCENE_EGO_SPEED] + 0.05 * noise_normal(&w.r), 0.05, 2);
	kalman_open_lead(&k, w.x[SCENE_HEADWAY] + 0.25 * noise_normal(&w.r), 0.25,
			 w.x[SCENE_LEAD_SPEED] - w.x[SCENE_EGO_SPEED] + 0.1 * noise_normal(&w.r),
			 0.1, 2);
	for (int ms = 1; ms <= 2000; ms++) {
		const double rate = w.x[SCENE_LEAD_SPEED] - w.x[SCENE_EGO_SPEED];

		if (ms > 1 && ms % 20 == 1) {
			kalman_predict(&k, (ms - 1) * MS, Q, Q);
			measure(&k, &w, KALMAN_EGO_SPEED, w.x[SCENE_EGO_SPEED], 0.05, sum);
		}
		if (ms % 50 == 8) {
			kalman_predict(&k, (ms - 1) * MS, Q, Q);
			measure(&k, &w, KALMAN_DISTANCE, w.x[SCENE_HEADWAY], 0.25, sum);
			measure(&k, &w, KALMAN_RATE, rate, 0.1, sum);
		}
		step_world(&w);
	}
	kalman_predict(&k, 2000 * MS, Q, Q);
	sum->nees += nees(&k, w.x);
}

/* A mean of chi-square values with @dof degrees of freedom each, 99.9 % two-sided, @n of them independent. */
static void assert_chi_square(double mean, double dof, double n)
{
	assert_near(mean, dof, 3.29 * sqrt(2 * dof / n));
}

static void errors_are_as_large_as_it_says(void **state)
{
	struct sums sum = {0};

	(void)state;
	for (uint64_t seed = 1; seed <= RUNS; seed++) {
		one_run(seed, &sum);
	}
	assert_chi_square(sum.nees / RUNS, SCENE_DIM, RUNS);
	for (int in = 0; in < KALMAN_INPUTS; in++) {
		assert_chi_square(sum.nis[in] / sum.n[in], 1, sum.n[in]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(follows_the_oracle),
		cmocka_unit_test(prediction_moves_both_vehicles),
		cmocka_unit_test(a_braking_lead_stops),
		cmocka_unit_test(the_past_changes_nothing),
		cmocka_unit_test(two_steps_are_one),
		cmocka_unit_test(innovation_is_what_an_update_expects),
		cmocka_unit_test(a_forgotten_lead_leaves_the_ego),
		cmocka_unit_test(a_set_acceleration_moves_nothing_else),
		cmocka_unit_test(stays_sound_for_200000_steps),
		cmocka_unit_test(errors_are_as_large_as_it_says),
	};

	return cmocka_run_group_tests_name("kalman", tests, NULL, NULL);
}
