/* SPDX-License-Identifier: MIT
 * Prediction and measurement for two vehicles in one lane.
 */
#include <string.h>
#include "kalman.h"

static const double observe[KALMAN_INPUTS][SCENE_DIM] = {
	[KALMAN_EGO_SPEED] = {0, 1, 0, 0, 0},
	[KALMAN_DISTANCE] = {1, 0, 0, 0, 0},
	[KALMAN_RATE] = {0, -1, 0, 1, 0},
};

void kalman_open_ego(struct kalman *k, int64_t t_ns, double speed_mps, double speed_sigma,
		     double accel_sigma)
{
	*k = (struct kalman){.t_ns = t_ns};
	kalman_forget_lead(k);
	k->x[SCENE_EGO_SPEED] = speed_mps;
	k->p[SCENE_EGO_SPEED][SCENE_EGO_SPEED] = speed_sigma * speed_sigma;
	k->p[SCENE_EGO_ACCEL][SCENE_EGO_ACCEL] = accel_sigma * accel_sigma;
}

void kalman_forget_lead(struct kalman *k)
{
	const int lead[] = {SCENE_HEADWAY, SCENE_LEAD_SPEED, SCENE_LEAD_ACCEL};

	for (int n = 0; n < 3; n++) {
		for (int i = 0; i < SCENE_DIM; i++) {
			k->p[lead[n]][i] = k->p[i][lead[n]] = 0;
		}
		k->p[lead[n]][lead[n]] = 1;
		k->x[lead[n]] = 0;
	}
}

/* The object's speed is the ego's plus the rate, so the two have the ego's error in common. */
void kalman_open_lead(struct kalman *k, double distance_m, double distance_sigma, double rate_mps,
		      double rate_sigma, double accel_sigma)
{
	kalman_forget_lead(k);
	for (int i = SCENE_EGO_SPEED; i <= SCENE_EGO_ACCEL; i++) {
		k->p[SCENE_LEAD_SPEED][i] = k->p[i][SCENE_LEAD_SPEED] = k->p[SCENE_EGO_SPEED][i];
	}
	k->x[SCENE_HEADWAY] = distance_m;
	k->x[SCENE_LEAD_SPEED] = k->x[SCENE_EGO_SPEED] + rate_mps;
	k->p[SCENE_HEADWAY][SCENE_HEADWAY] = distance_sigma * distance_sigma;
	k->p[SCENE_LEAD_SPEED][SCENE_LEAD_SPEED] =
		k->p[SCENE_EGO_SPEED][SCENE_EGO_SPEED] + rate_sigma * rate_sigma;
	k->p[SCENE_LEAD_ACCEL][SCENE_LEAD_ACCEL] = accel_sigma * accel_sigma;
}

void kalman_set_lead_accel(struct kalman *k, double accel, double sigma)
{
	for (int i = 0; i < SCENE_DIM; i++) {
		k->p[SCENE_LEAD_ACCEL][i] = k->p[i][SCENE_LEAD_ACCEL] = 0;
	}
	k->p[SCENE_LEAD_ACCEL][SCENE_LEAD_ACCEL] = sigma * sigma;
	k->x[SCENE_LEAD_ACCEL] = accel;
}

/* Both vehicles' positions are in the headway: the lead's with +, the ego's with -. */
static void transition(double dt, double f[SCENE_DIM][SCENE_DIM])
{
	memset(f, 0, sizeof(double[SCENE_DIM][SCENE_DIM]));
	for (int i = 0; i < SCENE_DIM; i++) {
		f[i][i] = 1;
	}
	f[SCENE_HEADWAY][SCENE_EGO_SPEED] = -dt;
	f[SCENE_HEADWAY][SCENE_EGO_ACCEL] = -dt * dt / 2;
	f[SCENE_HEADWAY][SCENE_LEAD_SPEED] = dt;
	f[SCENE_HEADWAY][SCENE_LEAD_ACCEL] = dt * dt / 2;
	f[SCENE_EGO_SPEED][SCENE_EGO_ACCEL] = dt;
	f[SCENE_LEAD_SPEED][SCENE_LEAD_ACCEL] = dt;
}

/* White jerk of density @q on position, speed and acceleration of one vehicle, seen through the headway with @sign. */
static void add_jerk(double p[SCENE_DIM][SCENE_DIM], int speed, int accel, double sign, double q,
		     double dt)
{
	const double dt2 = dt * dt, dt3 = dt2 * dt;

	p[SCENE_HEADWAY][SCENE_HEADWAY] += q * dt2 * dt3 / 20;
	p[SCENE_HEADWAY][speed] += sign * q * dt2 * dt2 / 8;
	p[SCENE_HEADWAY][accel] += sign * q * dt3 / 6;
	p[speed][speed] += q * dt3 / 3;
	p[speed][accel] += q * dt2 / 2;
	p[accel][accel] += q * dt;
}

/* The lower triangle from the upper one. */
static void mirror(double p[SCENE_DIM][SCENE_DIM])
{
	for (int i = 1; i < SCENE_DIM; i++) {
		for (int j = 0; j < i; j++) {
			p[i][j] = p[j][i];
		}
	}
}

/* out = f m, or f m f' with the second factor transposed */
static void multiply(double a[SCENE_DIM][SCENE_DIM], double b[SCENE_DIM][SCENE_DIM], int transpose,
		     double out[SCENE_DIM][SCENE_DIM])
{
	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = 0; j < SCENE_DIM; j++) {
			double sum = 0;

			for (int k = 0; k < SCENE_DIM; k++) {
				sum += a[i][k] * (transpose ? b[j][k] : b[k][j]);
			}
			out[i][j] = sum;
		}
	}
}

/* A lead that brakes to standstill within @dt stands from there on; @before is where it was. */
static void stop_lead(double x[SCENE_DIM], const double before[SCENE_DIM], double dt)
{
	const double v = before[SCENE_LEAD_SPEED], a = before[SCENE_LEAD_ACCEL];

	if (v < 0 || x[SCENE_LEAD_SPEED] >= 0) {
		return;
	}
	x[SCENE_HEADWAY] += v * v / (-2 * a) - (v * dt + a * dt * dt / 2);
	x[SCENE_LEAD_SPEED] = 0;
	x[SCENE_LEAD_ACCEL] = 0;
}

void kalman_predict(struct kalman *k, int64_t t_ns, double q_ego, double q_lead)
{
	double f[SCENE_DIM][SCENE_DIM], fp[SCENE_DIM][SCENE_DIM], x[SCENE_DIM] = {0};
	const double dt = (double)(t_ns - k->t_ns) * 1e-9;

	if (t_ns <= k->t_ns) {
		return;
	}
	transition(dt, f);
	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = 0; j < SCENE_DIM; j++) {
			x[i] += f[i][j] * k->x[j];
		}
	}
	stop_lead(x, k->x, dt);
	memcpy(k->x, x, sizeof(x));
	multiply(f, k->p, 0, fp);
	multiply(fp, f, 1, k->p);
	add_jerk(k->p, SCENE_EGO_SPEED, SCENE_EGO_ACCEL, -1, q_ego, dt);
	add_jerk(k->p, SCENE_LEAD_SPEED, SCENE_LEAD_ACCEL, 1, q_lead, dt);
	mirror(k->p);
	k->t_ns = t_ns;
}

static void times(const double p[SCENE_DIM][SCENE_DIM], const double h[SCENE_DIM],
		  double out[SCENE_DIM])
{
	for (int i = 0; i < SCENE_DIM; i++) {
		out[i] = 0;
		for (int j = 0; j < SCENE_DIM; j++) {
			out[i] += p[i][j] * h[j];
		}
	}
}

double kalman_innovation(const struct kalman *k, enum kalman_input in, double z, double sigma,
			 double *variance)
{
	const double *h = observe[in];
	double ph[SCENE_DIM], expected = 0, s = sigma * sigma;

	times(k->p, h, ph);
	for (int i = 0; i < SCENE_DIM; i++) {
		expected += h[i] * k->x[i];
		s += h[i] * ph[i];
	}
	*variance = s;
	return z - expected;
}

/* Joseph's form (I - K h')P(I - K h')' + K r K', factor by factor: rounding cannot make it indefinite. */
void kalman_update(struct kalman *k, enum kalman_input in, double z, double sigma)
{
	const double *h = observe[in];
	double ph[SCENE_DIM], g[SCENE_DIM], a[SCENE_DIM][SCENE_DIM], ap[SCENE_DIM][SCENE_DIM], s;
	const double nu = kalman_innovation(k, in, z, sigma, &s);

	times(k->p, h, ph);
	for (int i = 0; i < SCENE_DIM; i++) {
		g[i] = ph[i] / s;
		k->x[i] += g[i] * nu;
		for (int j = 0; j < SCENE_DIM; j++) {
			a[i][j] = (i == j) - g[i] * h[j];
		}
	}
	multiply(a, k->p, 0, ap);
	multiply(ap, a, 1, k->p);
	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = i; j < SCENE_DIM; j++) {
			k->p[i][j] += g[i] * sigma * sigma * g[j];
		}
	}
	mirror(k->p);
}
