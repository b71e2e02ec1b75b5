/* SPDX-License-Identifier: MIT
 * sensitivity: indices known in closed form, inputs of few values, and what explains nothing.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "../tools/noise.h"
#include "../tools/sensitivity.c"

#define N 20000

static struct sensitivity_pair pair[N];
static double x1[N], x2[N];

static void draw(void)
{
	struct noise r = {.seed = 5};

	for (int i = 0; i < N; i++) {
		x1[i] = noise_normal(&r);
		x2[i] = noise_normal(&r);
	}
}

static double share(const double *x, double (*y)(int i))
{
	for (int i = 0; i < N; i++) {
		pair[i] = (struct sensitivity_pair){(float)x[i], y(i)};
	}
	return sensitivity_share(pair, N);
}

static double linear(int i)
{
	return 3 + 2 * x1[i] - x2[i];
}

static double product(int i)
{
	return x1[i] * x2[i];
}

static double both_high(int i)
{
	return x1[i] > 1 && x2[i] > 0;
}

static double constant(int i)
{
	(void)i;
	return 0.1;
}

static void assert_near(double got, double want, double by)
{
	if (!(fabs(got - want) <= by)) {
		fail_msg("%g is not %g +- %g", got, want, by);
	}
}

/* a^2 / (a^2 + b^2) of a X1 + b X2 */
static void of_a_sum(void **state)
{
	(void)state;
	assert_near(share(x1, linear), 0.8, 0.01);
	assert_near(share(x2, linear), 0.2, 0.015);
}

/* Each explains nothing alone: E[X1 X2 | X1] is 0. */
static void of_a_product(void **state)
{
	(void)state;
	assert_near(share(x1, product), 0, 0.005);
	assert_near(share(x2, product), 0, 0.005);
}

/* P = Q(1)/2; Var(P(Y|X1)) = Q(1)/4 - P^2, Var(P(Y|X2)) = Q(1)^2/2 - P^2 */
static void of_a_verdict(void **state)
{
	const double q = 0.5 * erfc(1 / sqrt(2)), p = q / 2, var = p * (1 - p);

	(void)state;
	assert_near(share(x1, both_high), (q / 4 - p * p) / var, 0.02);
	assert_near(share(x2, both_high), (q * q / 2 - p * p) / var, 0.01);
}

static void of_what_does_not_vary(void **state)
{
	static double zero[N];

	(void)state;
	assert_true(share(zero, linear) == 0);
	assert_true(share(x1, constant) == 0);
	pair[0] = (struct sensitivity_pair){1, 1};
	assert_true(sensitivity_share(pair, 1) == 0);
	pair[1] = (struct sensitivity_pair){2, 2};
	assert_true(sensitivity_share(pair, 2) == 0); /* as many classes as samples */
}

/* Three values, of which the most frequent fills many classes' worth: one class each. */
static void of_an_input_of_few_values(void **state)
{
	(void)state;
	for (int i = 0; i < N; i++) {
		const float x = i % 10 == 0 ? 2 : i % 5 == 1 ? 1 : 0;

		pair[i] = (struct sensitivity_pair){x, (double)x};
	}
	assert_near(sensitivity_share(pair, N), 1, 1e-12);
	for (int i = 1; i < N; i++) {
		assert_true(pair[i].x >= pair[i - 1].x);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(of_a_sum),
		cmocka_unit_test(of_a_product),
		cmocka_unit_test(of_a_verdict),
		cmocka_unit_test(of_what_does_not_vary),
		cmocka_unit_test(of_an_input_of_few_values),
	};

	draw();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
