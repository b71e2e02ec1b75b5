/* SPDX-License-Identifier: MIT
 * The fast rollout: the scenes of model.h in f32 without time steps. Actuator lag, friction bound, grade and drag have
 * closed forms; closest approach and first contact are roots found in a few corrections.
 * Host and device, same bits. Each stage is a branch-free function of one lane: a device thread calls them in a row
 * (rollout_sample), the CPU runs each over a block of lanes (lanes.c), where the compiler vectorises it.
 */
#ifndef AEBMC_ROLLOUT_H
#define AEBMC_ROLLOUT_H

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

/** rollout_scene - first stage: what all futures of a lane share. */
HD void rollout_scene(struct rollout *r, const struct rollout_plan *p)
{
	const float load = det_fmaf(r->mu, p->h_over_l, 1.0f);
	const float inv = 1.0f / (r->mass * load * r->tau);
	const float lead_stop = r->al < 0.0f ? r->vl / det_maxf(-r->al, 1e-5f) : ROLLOUT_NEVER_S;

	r->k = p->drag_gain * r->drag * (load * r->tau * inv);
	r->bound = r->mu * p->gravity_mps2 * (r->mass * r->tau * inv);
	r->rate = r->mass * load * inv;
	r->grade = p->gravity_mps2 * det_sinf(r->theta);
	r->lead_stop = det_maxf(r->vl, r->al) > 0.0f ? lead_stop : 0.0f;
	/* stays, unless the lead moves */
	r->near_lo = 0.0f;
	r->near_s = 0.0f;
	r->near_rel = 0.0f;
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

/** rollout_coast - constant acceleration until the brake acts, and the closest approach of that time. */
HD void rollout_coast(struct rollout *r, const struct rollout_plan *p)
{
	const float onset = det_minf(r->delay + p->extra_s, p->horizon_s);
	const float stop = r->a0 < 0.0f ? r->v0 / det_maxf(-r->a0, 1e-5f) : ROLLOUT_NEVER_S;
	const float t1 = det_minf(onset, stop);
	const float v1 = det_maxf(det_fmaf(r->a0, onset, r->v0), 0.0f);
	const float closing = det_maxf(r->v0 - r->vl, 0.0f);
	const float t0 = closing / det_maxf(r->al - r->a0, 1e-5f);

	r->onset = onset;
	r->v1 = stop > onset ? v1 : 0.0f;
	r->x1 = t1 * det_fmaf(0.5f * r->a0, t1, r->v0);
	r->near_0 = t0 < det_minf(onset, r->lead_stop) ? 0.5f * closing * t0 : 0.0f;
}

/** rollout_unbraked - instead of the stages up to rollout_near: the horizon comes before the brake acts. */
HD void rollout_unbraked(struct rollout *r)
{
	r->sk = ROLLOUT_NEVER_S;
	r->end_s = 0.0f;
	r->end_v = r->v1;
	r->stop = r->x1;
	r->near_lo = 0.0f;
	r->near_s = 0.0f;
	r->near_rel = 0.0f;
}

/** rollout_brakes - 0 if no lane of the batch brakes before the horizon. */
HD int rollout_brakes(const struct rollout_plan *p)
{
	return p->extra_s < p->horizon_s;
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

/** rollout_match - the constant-force flow that, with its transient, starts at v1: a quadratic for r0, nearly linear. */
HD void rollout_match(struct rollout *r, const struct rollout_plan *p)
{
	const float fe = p->cmd_mps2 + det_maxf(r->a0, -det_minf(p->cmd_mps2, r->bound));
	const float c1 = p->cmd_mps2 + r->grade;
	const float kt = r->k * r->tau;
	const float ka = kt * c1 * r->tau;
	const float fet = fe * r->tau;
	const float ft = fet * det_fmaf(ka, det_fmaf(16.0f, ka, -4.0f), 1.0f);
	const float g1 = 2.0f * ka;
	const float b = 0.5f * kt * fet * fet;
	const float b0 = b * det_fmaf(-6.5f, ka, 1.0f);
	const float lin = kt * det_fmaf(2.0f, ft, -5.0f * b);
	const float by = (1.0f + lin) * det_fmaf(lin, lin, 1.0f); /* 1 / (1 - lin) */
	const float r1 = (r->v1 + det_fmaf(ft, g1, ft) - b0) * by;

	r->c1 = c1;
	r->fe = fe;
	r->kt = kt;
	r->ft = ft;
	r->g1 = g1;
	r->b0 = b0;
	r->b1 = 5.0f * b;
	r->r0 = det_fmaf(2.0f * ft * kt * kt * by * r1, r1, r1);
	r->d0 = rollout_lag(r, r->r0, 1.0f).x;
}

/** rollout_kink_time - where the friction bound is reached, if it ever is. */
HD void rollout_kink_time(struct rollout *r, const struct rollout_plan *p)
{
	const float over = p->cmd_mps2 - r->bound;
	const float e = det_maxf(over / det_maxf(r->fe, 1e-6f), 1e-10f);
	const float ek =
		over > 0.0f ? det_minf(e, 0.9999999f) : 0.5f; /* below 1: sk > 0 tells P2 from P1 */

	r->ek = ek;
	r->sk = -r->tau * det_logf(ek);
}

/** rollout_kink - speed and distance there, and from where the last phase starts. */
HD void rollout_kink(struct rollout *r, const struct rollout_plan *p)
{
	const struct rollout_flow f = rollout_flow(r->r0, r->c1, r->k, r->sk);
	const struct rollout_flow lag = rollout_lag(r, f.v, r->ek);
	const float v2 = f.v + lag.v;
	const float x2 = f.x + lag.x - r->d0;
	float sk = p->cmd_mps2 > r->bound ? r->sk : ROLLOUT_NEVER_S;

	sk = sk < p->horizon_s - r->onset ? sk : ROLLOUT_NEVER_S;
	sk = v2 > 0.0f ? sk : ROLLOUT_NEVER_S;
	r->sk = sk;
	r->v2 = v2;
	r->x2 = x2;
	r->base_v = sk < ROLLOUT_NEVER_S ? v2 : r->r0;
	r->base_c = sk < ROLLOUT_NEVER_S ? r->bound + r->grade : r->c1;
	r->base_x = sk < ROLLOUT_NEVER_S ? x2 : -r->d0;
	r->base_s = sk < ROLLOUT_NEVER_S ? sk : 0.0f;
}

/**
 * rollout_stop - distance and time to standstill of the last phase: y atanh and atan in closed form
 * The time (Pade, never too short by more than 1e-4 of it) only bounds what follows: at rest the distance stands still.
 * want: lanes whose transient has not died down by then.
 */
HD void rollout_stop(struct rollout *r)
{
	const float c = det_maxf(r->base_c, 1e-4f), v = r->base_v;
	const float q = r->k * v * v;
	const float num = det_fmaf(945.0f * c, c, q * det_fmaf(735.0f, c, 64.0f * q));
	const float den = c * det_fmaf(945.0f * c, c, q * det_fmaf(1050.0f, c, 225.0f * q));
	const float c2 = det_fmaf(2.0f, c, q);
	const float inv = 1.0f / (c2 * den);
	const float y = v * v * den * inv;
	const float ky = r->k * y;
	const float x = det_fmaf(y, rollout_atanh(ky * ky), r->base_x);
	const float s = det_fmaf(v * num, c2 * inv, r->base_s);
	const float end = r->base_c > 1e-4f ? s : ROLLOUT_NEVER_S;
	const float left = r->base_s > 0.0f ? ROLLOUT_NEVER_S : s * r->rate;

	r->end_s = r->v1 > 0.0f ? end : 0.0f;
	r->end_v = 0.0f;
	r->stop = r->v1 > 0.0f ? r->x1 + x : r->x1;
	r->want = (r->v1 > 0.0f ? left : ROLLOUT_NEVER_S) < 14.0f ? 1.0f : 0.0f;
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

/** rollout_short - standstill while the transient lasts: guess from a quadratic that fits the ramp of the brake. */
HD void rollout_short(struct rollout *r)
{
	const float g = det_fmaf(r->k * r->v1, r->v1 * (1.0f / 3.0f), r->c1 - r->fe);
	const float a = det_fmaf(0.8f, g, r->fe);
	const float b = det_fmaf(2.0f * g, r->tau, -0.8f * r->v1);
	const float c = 2.0f * r->v1 * r->tau;
	const float root = det_sqrtf(det_maxf(det_fmaf(b, b, 4.0f * a * c), 0.0f));
	const float num = b > 0.0f ? 2.0f * c : root - b;
	const float den = b > 0.0f ? b + root : 2.0f * a;
	const float guess = num / det_maxf(den, 1e-6f);

	r->at_s = r->end_s * r->rate < 3.0f ? guess : r->end_s;
	r->at_two = 0.0f;
}

/** rollout_short_step - one correction of standstill: exact for a constant force. Lanes with want. */
HD void rollout_short_step(struct rollout *r)
{
	const float by = r->at_v / det_maxf(-r->at_dv, 1e-3f);

	r->at_s = det_maxf(r->at_s + by, 0.0f);
	r->stop = r->want > 0.0f ? det_fmaf(0.5f * r->at_v, by, r->x1 + r->at_x) : r->stop;
	r->end_s = r->want > 0.0f ? r->at_s : r->end_s;
}

/** rollout_late - the horizon as point to look at; want: lanes that may still roll there. */
HD void rollout_late(struct rollout *r, const struct rollout_plan *p)
{
	r->at_s = p->horizon_s - r->onset;
	r->at_two = r->sk < ROLLOUT_NEVER_S ? 1.0f : 0.0f;
	r->want = r->end_s > r->at_s - 0.01f ? 1.0f : 0.0f;
}

/** rollout_roll - speed and distance at the horizon. Lanes with want. */
HD void rollout_roll(struct rollout *r)
{
	const float v = r->at_s > 0.0f ? r->at_v : r->v1;
	const float x = r->at_s > 0.0f ? r->at_x : 0.0f;
	const float rolls = r->v1 > 0.0f ? v : 0.0f;
	const float end_v = r->want > 0.0f ? det_maxf(rolls, 0.0f) : 0.0f;

	r->stop = end_v > 0.0f ? r->x1 + x : r->stop;
	r->end_s = end_v > 0.0f ? r->at_s : det_minf(r->end_s, r->at_s);
	r->end_v = end_v;
}

/**
 * rollout_near - the phase that has the one minimum of the gap that braking can leave behind, and its limits
 * P2 if the ego is still faster than the lead at the kink, or gains on it there because the slope drives it: its
 * acceleration then only falls, so that what has not yet come comes later. Else P1. Once the lead stands there is none.
 */
HD void rollout_near(struct rollout *r)
{
	const float hi = det_maxf(det_minf(r->end_s, r->lead_stop - r->onset), 0.0f);
	const float excess = r->v2 - rollout_lead_v(r, r->onset + r->sk);
	const float brake = det_fmaf(r->k * r->v2, r->v2, r->bound + r->grade);
	const float gains = det_minf(-brake, -brake - r->al);
	const float later = det_maxf(excess, gains) > 0.0f ? r->sk : 0.0f;
	const float lo = later < hi ? later : 0.0f;

	r->at_two = lo > 0.0f ? 1.0f : 0.0f;
	r->near_lo = lo;
	r->near_hi = lo > 0.0f ? hi : det_minf(hi, r->sk);
	r->near_s = lo;
	r->near_rel = 0.0f;
	r->want = r->near_hi > lo ? 1.0f : 0.0f;
}

/**
 * rollout_near_fit - a quadratic for it: (v0 - c s) / (1 + k v0 s) = lead, which leaves out d s^3
 * If its root falls into the first 3 tau, a fit of the ramp of the brake takes its place.
 */
HD void rollout_near_fit(struct rollout *r)
{
	const float lead_0 = rollout_lead_v(r, r->onset + r->near_lo);
	const float v = r->at_two > 0.0f ? r->v2 : r->r0;
	const float force = r->at_two > 0.0f ? r->bound + r->grade : r->c1;
	const float kv = r->k * v;
	const float a = kv * r->al;
	const float b = det_fmaf(kv, lead_0, force + r->al);
	const float c = v - lead_0;
	const float s3 = 3.0f * r->tau;
	const float at3 =
		det_fmaf(s3, det_fmaf(s3, a, b), -c) - r->at_two * 1e6f; /* no ramp in P2 */
	const float w = r->v1 - lead_0;
	const float g = det_fmaf(r->k * r->v1, r->v1, r->c1 - r->fe) + r->al;

	r->near_a = at3 > 0.0f ? det_fmaf(0.8f, g, r->fe) : a;
	r->near_b = at3 > 0.0f ? det_fmaf(2.0f * g, r->tau, -0.8f * w) : b;
	r->near_c = at3 > 0.0f ? 2.0f * w * r->tau : c;
	r->near_d = at3 > 0.0f ? 0.0f : r->k * force * force * (1.0f / 3.0f);
}

/** rollout_near_root - first guess: root of a s^2 + b s - c, then of d s^3 too. No root: the end of the phase. */
HD void rollout_near_root(struct rollout *r)
{
	const float a = r->near_a, b = r->near_b, c = r->near_c;
	const float root = det_sqrtf(det_maxf(det_fmaf(b, b, 4.0f * a * c), 0.01f));
	const float num = b > 0.0f ? 2.0f * c : root - b;
	const float two_a = det_maxf(a, -a) > 1e-9f ? 2.0f * a : 1e-9f;
	const float den = b > 0.0f ? b + root : two_a;
	const float inv = 1.0f / (den * root);
	const float s1 = num * root * inv;
	const float fix = r->near_d * s1 * s1 * s1 * den * inv;
	const float guess = s1 - det_minf(fix, 0.1f * s1);
	/* a <= 0 and b <= 0: the ego never gets slower than the lead */
	const float s = det_maxf(a, b) > 0.0f ? det_maxf(guess, 0.0f) : ROLLOUT_NEVER_S;

	r->at_s = det_minf(s + r->near_lo, r->near_hi);
}

/**
 * rollout_approach - one correction of the closest approach: expansion of the relative motion about at_s. Without a root
 * of the relative speed nearby, go to where it is largest. Lanes with want.
 */
HD void rollout_approach(struct rollout *r)
{
	const float s = r->at_s, t = r->onset + s;
	const float v = rollout_lead_v(r, t) - r->at_v;
	const float dv = r->al - r->at_dv;
	const float ddv = det_fmaf(r->at_fe, r->rate, 2.0f * r->k * r->at_v * r->at_dv);
	const float disc = det_fmaf(dv, dv, -2.0f * v * ddv);
	const float num = disc > 0.0f ? -2.0f * v : -dv;
	const float den = disc > 0.0f ? dv + det_sqrtf(det_maxf(disc, 0.0f)) : ddv;
	const float step = num / (det_maxf(den, -den) > 1e-6f ? den : 1e-6f);
	const float next = det_minf(det_maxf(s + step, r->near_lo), r->near_hi);
	const float h = next - s, h2 = h * h;
	const float rest = r->at_fe * r->rate * r->rate * h2 * h2;
	const float far = h2 < 0.0225f ? 0.0f : 1.0f;
	const float more = rest < 2e-4f ? far : 1.0f;
	const float by =
		more > 0.0f
			? 0.0f
			: h; /* a point of the path bounds the minimum, a poor expansion does not */
	const float rel = rollout_lead_x(r, t) - r->x1 - r->at_x +
			  by * det_fmaf(by, det_fmaf(by, ddv * (1.0f / 6.0f), 0.5f * dv), v);

	r->near_rel = r->want > 0.0f ? rel : r->near_rel;
	r->near_s = r->want > 0.0f ? s + by : r->near_s;
	r->at_s = r->want > 0.0f ? next : s;
	r->want = r->want > 0.0f ? more : 0.0f;
}

/** rollout_end - last stage before impact: need; returns the flags. */
HD uint32_t rollout_end(struct rollout *r, const struct rollout_plan *p)
{
	const float rel = rollout_lead_x(r, r->onset + r->end_s) - r->stop;
	const uint32_t rolling = r->end_v > 0.0f ? MODEL_ROLLING : 0u;
	uint32_t open = r->end_v > rollout_lead_v(r, p->horizon_s) ? MODEL_UNDECIDED : 0u;

	open = r->end_v > 0.0f ? open : 0u;
	r->need = det_maxf(det_maxf(r->near_0, -r->near_rel), -rel);
	return rolling | (r->headway > r->need ? open : MODEL_CONTACT);
}

/**
 * rollout_hit - bracket the first contact of a lane that has one: before onset, in P1 or in P2
 * hit_x, hit_v, hit_c: position, speed and deceleration with which that part begins, for P1 those of its flow.
 */
HD void rollout_hit(struct rollout *r)
{
	const float tk = r->onset + r->sk;
	const float gap_d = r->headway + rollout_lead_x(r, r->onset) - r->x1;
	const float gap_k = r->headway + rollout_lead_x(r, tk) - r->x1 - r->x2;
	const float near =
		r->headway + r->near_rel > 0.0f ? 0.0f : 1.0f; /* contact by near_s at the latest */
	const float near_1 = r->near_lo > 0.0f ? 0.0f : near;
	const float late = r->sk < ROLLOUT_NEVER_S ? gap_k - near_1 * 1e6f
						   : -1.0f; /* > 0: not before the kink */
	const float early = det_minf(gap_d, r->headway - r->near_0);
	const float end = r->onset + (near > 0.0f ? r->near_s : r->end_s);
	const float hi = late > 0.0f ? end : det_minf(end, tk);
	const float lo = late > 0.0f ? tk : r->onset;
	const float x = late > 0.0f ? r->x1 + r->x2 : r->x1 - r->d0;
	const float v = late > 0.0f ? r->v2 : r->r0;
	const float c = late > 0.0f ? r->bound + r->grade : r->c1;

	r->at_two = late > 0.0f ? 1.0f : 0.0f;
	r->hit_lo = early > 0.0f ? lo : 0.0f;
	r->hit_hi = early > 0.0f ? hi : r->onset;
	r->hit_x = early > 0.0f ? x : 0.0f;
	r->hit_v = early > 0.0f ? v : r->v0;
	r->hit_c = early > 0.0f ? det_fmaf(r->k * v, v, c) : -r->a0;
	r->impact = det_maxf(r->v0 - r->vl, 0.0f);
	r->want = r->headway > 0.0f ? 1.0f : 0.0f;
}

/** rollout_hit_guess - first contact under constant deceleration, with a lead that stands if it does so before. */
HD void rollout_hit_guess(struct rollout *r)
{
	const float t = r->hit_lo, left = r->lead_stop - t;
	const float gap = r->headway + rollout_lead_x(r, t) - r->hit_x;
	const float closing = r->hit_v - rollout_lead_v(r, t);
	const float dv = left > 0.0f ? r->hit_c + r->al : r->hit_c;
	/* when the lead stops they are still apart and closing: from there it stands */
	const float then = det_fmaf(left, det_fmaf(left, 0.5f * dv, -closing), gap);
	const float apart = det_minf(det_minf(left, then), det_fmaf(-left, dv, closing));
	const float far = r->headway + rollout_lead_x(r, r->lead_stop) - r->hit_x;
	const float g = apart > 0.0f ? far : gap;
	const float v = apart > 0.0f ? r->hit_v : closing;
	const float c = apart > 0.0f ? r->hit_c : dv;
	const float root = det_sqrtf(det_maxf(det_fmaf(v, v, -2.0f * c * g), 0.0f));

	r->hit_t = det_minf(det_maxf(t + 2.0f * g / det_maxf(v + root, 1e-3f), t), r->hit_hi);
	r->at_s = r->hit_t - r->onset;
}

/** rollout_contact - one correction of the first contact, and the impact speed seen from there. Lanes with want. */
HD void rollout_contact(struct rollout *r)
{
	const float t = r->hit_t;
	const float early = t > r->onset ? 0.0f : 1.0f;
	const float ego_v = early > 0.0f ? det_fmaf(r->a0, t, r->v0) : r->at_v;
	const float ego_x = early > 0.0f ? t * det_fmaf(0.5f * r->a0, t, r->v0) : r->x1 + r->at_x;
	const float ego_dv = early > 0.0f ? r->a0 : r->at_dv;
	const float stands = t < r->lead_stop ? 0.0f : 1.0f;
	const float gap = r->headway + rollout_lead_x(r, t) - ego_x;
	const float closing = ego_v - rollout_lead_v(r, t);
	const float dv = (t < r->lead_stop ? r->al : 0.0f) - ego_dv;
	const float speed = det_sqrtf(det_maxf(det_fmaf(closing, closing, -2.0f * gap * dv), 0.0f));
	const float aim = t + 2.0f * gap / det_maxf(closing + speed, 1e-6f);
	const float lo = gap > 0.0f ? t : r->hit_lo, hi = gap > 0.0f ? r->hit_hi : t;
	const float in = aim < lo ? 0.5f * (lo + hi) : aim;
	const float next = det_minf(in, hi);
	const float by = aim - t, by2 = by * by;
	const float back =
		det_fmaf(r->rate, det_maxf(-by, 0.0f), 1.0f); /* square root of the jerk's growth */
	const float jerk = early > 0.0f ? 0.0f : r->at_fe * r->rate * back * back;
	float more = (jerk * by2 < 4e-3f ? by2 : 1.0f) < 0.01f ? 0.0f : 1.0f;

	more = stands == (aim < r->lead_stop ? 0.0f : 1.0f) ? more : 1.0f;
	more = early == (aim > r->onset ? 0.0f : 1.0f) ? more : 1.0f;
	more = speed > 0.0f ? more : 1.0f; /* the parabola seen from here misses */
	more = (next - t) * (next - t) < 1e-8f ? 0.0f : more;
	r->impact = r->want > 0.0f ? speed : r->impact;
	r->hit_lo = lo;
	r->hit_hi = hi;
	r->hit_t = r->want > 0.0f ? next : t;
	r->at_s = r->hit_t - r->onset;
	r->want = r->want > 0.0f ? more : 0.0f;
}

#define ROLLOUT_APPROACH_MAX 3 /* corrections after which what is found counts */
#define ROLLOUT_SHORT_STEPS  2
#define ROLLOUT_CONTACT_MAX  24

/* From onset to standstill or horizon, and the closest approach on the way. */
HD void rollout_brake(struct rollout *r, const struct rollout_plan *p)
{
	rollout_match(r, p);
	rollout_kink_time(r, p);
	rollout_kink(r, p);
	rollout_stop(r);
	if (r->want > 0.0f) {
		rollout_short(r);
		for (int i = 0; i < ROLLOUT_SHORT_STEPS; i++) {
			rollout_fade(r);
			rollout_at(r);
			rollout_short_step(r);
		}
	}
	rollout_late(r, p);
	if (r->want > 0.0f) {
		rollout_fade(r);
		rollout_at(r);
		rollout_roll(r);
	}
	if (r->lead_stop > 0.0f) {
		rollout_near(r);
		rollout_near_fit(r);
		rollout_near_root(r);
		for (int i = 0; i < ROLLOUT_APPROACH_MAX && r->want > 0.0f; i++) {
			rollout_fade(r);
			rollout_at(r);
			rollout_approach(r);
		}
	}
}

/**
 * rollout_need - all stages of one lane but its impact speed
 * @in: MODEL_INPUTS values, @stride floats apart, within the ranges of enum model_input
 * @r:  stop and need are results; ready for rollout_impact() if the flags say contact
 * Returns the flags. Against model_rollout(): see verify.h. The bits are those of the lane loops. Pure.
 */
HD uint32_t rollout_need(const struct rollout_plan *p, const float *in, uint32_t stride,
			 struct rollout *r)
{
	r->headway = in[MODEL_HEADWAY * stride];
	r->v0 = in[MODEL_EGO_SPEED * stride];
	r->a0 = in[MODEL_EGO_ACCEL * stride];
	r->vl = in[MODEL_LEAD_SPEED * stride];
	r->al = in[MODEL_LEAD_ACCEL * stride];
	r->mu = in[MODEL_MU * stride];
	r->theta = in[MODEL_GRADE * stride];
	r->mass = in[MODEL_MASS * stride];
	r->drag = in[MODEL_DRAG * stride];
	r->tau = in[MODEL_TAU * stride];
	r->delay = in[MODEL_DELAY * stride];
	rollout_scene(r, p);
	rollout_coast(r, p);
	if (rollout_brakes(p)) {
		rollout_brake(r, p);
	} else {
		rollout_unbraked(r);
	}
	return rollout_end(r, p);
}

/** rollout_impact - closing speed at the first contact of a lane that has one. */
HD float rollout_impact(struct rollout *r)
{
	rollout_hit(r);
	rollout_hit_guess(r);
	for (int i = 0; i < ROLLOUT_CONTACT_MAX && r->want > 0.0f; i++) {
		rollout_fade(r);
		rollout_at(r);
		rollout_contact(r);
	}
	return r->impact;
}

/** rollout_sample - one lane to its end, impact speed included. */
HD struct model_out rollout_sample(const struct rollout_plan *p, const float *in, uint32_t stride)
{
	struct rollout r = {0};
	struct model_out out;

	out.flags = rollout_need(p, in, stride, &r);
	out.stop_m = r.stop;
	out.need_m = r.need;
	out.impact_mps = out.flags & MODEL_CONTACT ? rollout_impact(&r) : 0.0f;
	return out;
}

#endif
