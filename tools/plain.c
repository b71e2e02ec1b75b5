/* SPDX-License-Identifier: MIT
 * The rollout as anybody would write it down: a plain C loop of RK4 steps over the paper's equations.
 */
#include "plain.h"
#include <math.h>

struct car {
	double cmd_mps2, bound_mps2, rate_per_s, drag_per_m, slope_mps2;
};

static struct car car_of(const struct model_vehicle *v, double cmd_mps2, const float *in,
			 uint32_t stride)
{
	double mu = (double)in[MODEL_MU * stride], g = (double)v->gravity_mps2;
	double h_l = (double)v->cg_height_m / (double)v->wheelbase_m;
	double area = (double)v->rho_kgpm3 * (double)v->area_m2;

	return (struct car){
		.cmd_mps2 = cmd_mps2,
		.bound_mps2 = v->bound == MODEL_BOUND_PAPER ? -mu * g / (1 + mu * h_l) : -mu * g,
		.rate_per_s = 1 / (double)in[MODEL_TAU * stride],
		.drag_per_m = 0.5 * area * (double)in[MODEL_DRAG * stride] /
			      (double)in[MODEL_MASS * stride],
		.slope_mps2 = g * sin((double)in[MODEL_GRADE * stride]),
	};
}

/* eq. 4 with eq. 5, and eq. 6 */
static inline double dv(const struct car *c, double v, double a)
{
	return (a > c->bound_mps2 ? a : c->bound_mps2) - c->drag_per_m * v * v - c->slope_mps2;
}

static inline double da(const struct car *c, double a)
{
	return (c->cmd_mps2 - a) * c->rate_per_s;
}

struct motion {
	double x_m, v_mps, a_mps2;
};

static inline struct motion step(const struct car *c, struct motion s, double dt)
{
	double v1 = s.v_mps, a1 = s.a_mps2, k1 = dv(c, v1, a1), j1 = da(c, a1);
	double v2 = s.v_mps + dt / 2 * k1, a2 = s.a_mps2 + dt / 2 * j1;
	double k2 = dv(c, v2, a2), j2 = da(c, a2);
	double v3 = s.v_mps + dt / 2 * k2, a3 = s.a_mps2 + dt / 2 * j2;
	double k3 = dv(c, v3, a3), j3 = da(c, a3);
	double v4 = s.v_mps + dt * k3, a4 = s.a_mps2 + dt * j3;
	double k4 = dv(c, v4, a4), j4 = da(c, a4);

	s.x_m += dt / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
	s.v_mps += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
	s.a_mps2 += dt / 6 * (j1 + 2 * j2 + 2 * j3 + j4);
	return s;
}

/* Where the lead is and how fast, @t after the start. */
static inline struct motion lead_at(const float *in, uint32_t stride, double stop_s, double t)
{
	double v = (double)in[MODEL_LEAD_SPEED * stride], a = (double)in[MODEL_LEAD_ACCEL * stride];
	double moving_s = t < stop_s ? t : stop_s;

	return (struct motion){moving_s * (v + 0.5 * a * moving_s), t < stop_s ? v + a * t : 0, a};
}

static double lead_stop_s(const float *in, uint32_t stride)
{
	double a = (double)in[MODEL_LEAD_ACCEL * stride];

	return a < 0 ? (double)in[MODEL_LEAD_SPEED * stride] / -a : 1e6;
}

/* The last step is cut where v crosses 0. */
static double stop_in_step(struct motion last, struct motion s, double dt)
{
	double share = s.v_mps > 0 ? 1 : last.v_mps / (last.v_mps - s.v_mps);

	return s.v_mps > 0 ? s.x_m : last.x_m + 0.5 * last.v_mps * share * dt;
}

void plain_rollout(const struct model_vehicle *veh, float accel_cmd_mps2, double horizon_s,
		   const float *in, uint32_t stride, double dt_s, struct model_out *out)
{
	const struct car c = car_of(veh, (double)accel_cmd_mps2, in, stride);
	const double headway_m = (double)in[MODEL_HEADWAY * stride];
	const double stop_s = lead_stop_s(in, stride);
	const int steps = (int)(horizon_s / dt_s + 0.5);
	struct motion s = {0, (double)in[MODEL_EGO_SPEED * stride], 0};
	double nearest_m = 0, impact_mps = 0;

	for (int i = 1; i <= steps && s.v_mps > 0; i++) {
		const struct motion last = s, lead = lead_at(in, stride, stop_s, i * dt_s);

		s = step(&c, s, dt_s);
		s.x_m = stop_in_step(last, s, dt_s);
		double rel_m = lead.x_m - s.x_m;

		if (headway_m + nearest_m > 0 && headway_m + rel_m <= 0) {
			impact_mps = s.v_mps - lead.v_mps;
		}
		nearest_m = rel_m < nearest_m ? rel_m : nearest_m;
	}
	out->stop_m = (float)s.x_m;
	out->need_m = (float)-nearest_m;
	out->impact_mps = (float)impact_mps;
	out->flags = (headway_m + nearest_m <= 0 ? MODEL_CONTACT : 0) |
		     (s.v_mps > 0 ? MODEL_ROLLING : 0);
}
