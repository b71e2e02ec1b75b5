/* SPDX-License-Identifier: MIT
 * One lane of the fast rollout: its fields, what a batch shares, and the closed forms that the stages have in common.
 * Good for drag k <= 1e-3 /m, grades of up to 0.5 rad, tau of 0.02 to 0.4 s.
 */
#ifndef AEBMC_ROLLOUT_LANE_H
#define AEBMC_ROLLOUT_LANE_H

#include "model.h"

#define ROLLOUT_NEVER_S 1e6f /* an event that does not come; far beyond any horizon */

/* What all lanes of a batch share, made once by rollout_plan(). */
struct rollout_plan {
	float drag_gain; /* rho A_f / 2 */
	float gravity_mps2;
	float h_over_l; /* 0 where the bound is plain friction */
	float horizon_s;
	float cmd_mps2; /* F = |a_cmd| */
	float extra_s;
};

/*
 * One lane. Times s count from brake onset, t from the scene. Braking has up to two phases: P1 from onset under
 * F + G - (F + a_i) e^(-s/tau), and P2 from the kink, where the friction bound is reached, under P + G.
 */
/* The inputs, in the order of enum model_input. */
#define ROLLOUT_INPUTS(X) \
	X(headway) X(v0) X(a0) X(vl) X(al) X(mu) X(theta) X(mass) X(drag) X(tau) X(delay)
/* Scene, shared by all futures: k of v' = ... - k v^2 [1/m], G = g sin(theta), P of eq. 5 [m/s2], 1 / tau, and when the
 * lead stands. */
#define ROLLOUT_SCENE(X) X(k) X(grade) X(bound) X(rate) X(lead_stop)
/* Before onset: where and how fast the ego is then, and -min(x_lead - x_ego) if that lies inside. */
#define ROLLOUT_COAST(X) X(onset) X(v1) X(x1) X(near_0)
/* P1 as flow under the constant force c1 from speed r0; constants of its transient, fe = F + a_i its amplitude. */
#define ROLLOUT_MATCH(X) X(c1) X(r0) X(fe) X(kt) X(ft) X(g1) X(b0) X(b1) X(d0)
/* Kink, and the phase that lasts to the end. */
#define ROLLOUT_KINK(X) X(ek) X(sk) X(v2) X(x2) X(base_v) X(base_c) X(base_x) X(base_s)
/* Standstill or horizon. */
#define ROLLOUT_STOP(X) X(end_s) X(stop) X(end_v)
/* A point of the braking phase: when, in P2 or not, e^(-s/tau); distance since onset, speed, its derivative, fe e. */
#define ROLLOUT_AT(X) X(at_s) X(at_two) X(at_e) X(at_x) X(at_v) X(at_dv) X(at_fe)
/* Closest approach while braking: quadratic for a first guess, limits, what was found when. */
#define ROLLOUT_NEAR(X) \
	X(near_a) X(near_b) X(near_c) X(near_d) X(near_lo) X(near_hi) X(near_s) X(near_rel) X(need)
/* First contact, and 1 or 0 for a lane that a correction still works on. */
#define ROLLOUT_HIT(X) X(hit_t) X(hit_lo) X(hit_hi) X(hit_x) X(hit_v) X(hit_c) X(impact) X(want)

#define ROLLOUT_FIELDS(X) \
	ROLLOUT_INPUTS(X) \
	ROLLOUT_SCENE(X)  \
	ROLLOUT_COAST(X)  \
	ROLLOUT_MATCH(X)  \
	ROLLOUT_KINK(X)   \
	ROLLOUT_STOP(X)   \
	ROLLOUT_AT(X)     \
	ROLLOUT_NEAR(X)   \
	ROLLOUT_HIT(X)

/* What the stages from rollout_hit on read. */
#define ROLLOUT_KEPT(X)  \
	ROLLOUT_SCENE(X) \
	ROLLOUT_COAST(X) \
	ROLLOUT_MATCH(X) \
	X(headway)       \
	X(v0) X(a0) X(vl) X(al) X(tau) X(sk) X(v2) X(x2) X(end_s) X(near_lo) X(near_s) X(near_rel)

struct rollout {
#define ROLLOUT_MEMBER(name) float name;
	ROLLOUT_FIELDS(ROLLOUT_MEMBER)
#undef ROLLOUT_MEMBER
};

/** rollout_plan - constants of a batch for one future; ranges as in model.h. Pure. */
HD struct rollout_plan rollout_plan(const struct model_vehicle *veh, const struct model_future *fut,
				    float horizon_s)
{
	struct rollout_plan p;

	p.drag_gain = 0.5f * veh->rho_kgpm3 * veh->area_m2;
	p.gravity_mps2 = veh->gravity_mps2;
	p.h_over_l = veh->bound == MODEL_BOUND_PAPER ? veh->cg_height_m / veh->wheelbase_m : 0.0f;
	p.horizon_s = horizon_s;
	p.cmd_mps2 = -fut->accel_cmd_mps2;
	p.extra_s = fut->extra_delay_s;
	return p;
}

/* Where the lead is at t, and how fast. */
HD float rollout_lead_x(const struct rollout *r, float t)
{
	const float tc = det_minf(t, r->lead_stop);

	return tc * det_fmaf(0.5f * r->al, tc, r->vl);
}

HD float rollout_lead_v(const struct rollout *r, float t)
{
	return t < r->lead_stop ? det_fmaf(r->al, t, r->vl) : 0.0f;
}

/* Speed and distance after s under v' = -(c + k v^2) from v0: Pade form of tan, any sign of c and k >= 0. */
struct rollout_flow {
	float v, x;
};

/* atanh(sqrt(h)) / sqrt(h) for h <= 0.36, that is k x <= 0.69; relative error 3e-8. */
HD float rollout_atanh(float h)
{
	float a = 0.272370297f;

	a = det_fmaf(a, h, -0.0289347014f);
	a = det_fmaf(a, h, 0.143361569f);
	a = det_fmaf(a, h, 0.138658612f);
	a = det_fmaf(a, h, 0.200245813f);
	a = det_fmaf(a, h, 0.333328602f);
	return det_fmaf(a, h, 1.0f);
}

HD struct rollout_flow rollout_flow(float v0, float c, float k, float s)
{
	const float z = k * c * s * s;
	const float sn = s * det_fmaf(z, det_fmaf(z, 1.0f / 945.0f, -1.0f / 9.0f), 1.0f);
	const float d = det_fmaf(z, det_fmaf(z, 1.0f / 63.0f, -4.0f / 9.0f), 1.0f);
	const float kv = k * v0;
	const float den = det_fmaf(kv, sn, d);
	const float num_y = sn * det_fmaf(v0, d, 0.5f * sn * det_fmaf(kv, v0, -c));
	const float den_y = det_fmaf(d, den, 0.5f * k * sn * sn * det_fmaf(kv, v0, c));
	const float inv = 1.0f / (den * den_y);
	const float y = num_y * den * inv;
	const float ky = k * y;
	struct rollout_flow f;

	f.v = det_fmaf(v0, d, -c * sn) * den_y * inv;
	f.x = y * rollout_atanh(ky * ky);
	return f;
}

/*
 * The actuator's transient on top of the flow R, to second order in e = e^(-s/tau): v = R + e d1(R) + e^2 d2(R), and x
 * alike. Put into eq. 4, each order is a linear equation in R that a polynomial solves; with ep = k tau R,
 * ka = k c tau^2, b = k tau (fe tau)^2 / 2:
 *   d1 = -fe tau (1 + 2 ka + 2 ep + 2 ep^2) / (1 + 4 ka)     in x: fe tau^2 (1 + 2 ep) / (1 + 4 ka)     exact
 *   d2 = b (1 - 6.5 ka + 5 ep)                               in x: -tau d2 / 2                  to first order
 */
HD struct rollout_flow rollout_lag(const struct rollout *r, float v, float e)
{
	const float ep = r->kt * v;
	const float lin = det_fmaf(2.0f, ep, 1.0f);
	const float d1 = r->ft * det_fmaf(2.0f * ep, ep, lin + r->g1);
	const float d2 = e * det_fmaf(r->b1, ep, r->b0);
	struct rollout_flow lag;

	lag.v = e * (d2 - d1);
	lag.x = r->tau * e * det_fmaf(r->ft, lin, -0.5f * d2);
	return lag;
}

/** rollout_fade - e^(-s/tau) of the point at at_s; none in P2. Held at 2^-40, so that its square is no denormal. */
HD void rollout_fade(struct rollout *r)
{
	const float e = det_expf(-det_minf(det_maxf(r->at_s * r->rate, 0.0f), 28.0f));

	r->at_e = r->at_two > 0.0f ? 0.0f : e;
}

/** rollout_at - the ego's motion at at_s. */
HD void rollout_at(struct rollout *r)
{
	const float v0 = r->at_two > 0.0f ? r->v2 : r->r0;
	const float c = r->at_two > 0.0f ? r->bound + r->grade : r->c1;
	const float x0 = r->at_two > 0.0f ? r->x2 : -r->d0;
	const float s0 = r->at_two > 0.0f ? r->sk : 0.0f;
	const struct rollout_flow f = rollout_flow(v0, c, r->k, r->at_s - s0);
	const struct rollout_flow lag = rollout_lag(r, f.v, r->at_e);

	r->at_v = f.v + lag.v;
	r->at_x = f.x + lag.x + x0;
	r->at_fe = r->fe * r->at_e;
	r->at_dv = r->at_fe - det_fmaf(r->k * r->at_v, r->at_v, c);
}

#endif
