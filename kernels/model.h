/* SPDX-License-Identifier: MIT
 * The vehicle model: one sampled scene in, stopping distance and closest approach out.
 * One header for host and device. This file holds the parameters and the f64 RK4 reference rollout of
 * the paper (Sec. III, eq. 1-6), extended by the ego's present acceleration, a brake delay and a moving lead.
 * It knows nothing of batches, draws or statistics.
 */
#ifndef AEBMC_MODEL_H
#define AEBMC_MODEL_H

#include <stdint.h>
#include "detmath.h"

/* Every input of a sample, in the order of struct mc_request and of the draws. The first five are
 * correlated (a filter's errors are); the rest are independent. */
enum model_input {
	MODEL_HEADWAY,    /* gap from ego front to lead rear at t = 0           [m]               */
	MODEL_EGO_SPEED,  /* v0                                                 [m/s], >= 0       */
	MODEL_EGO_ACCEL,  /* a0, net acceleration until the brake acts          [m/s2], signed    */
	MODEL_LEAD_SPEED, /* vl                                                 [m/s], >= 0       */
	MODEL_LEAD_ACCEL, /* al, constant down to standstill                    [m/s2], signed    */
	MODEL_MU,         /* peak friction                                      [1], > 0          */
	MODEL_GRADE,      /* theta, uphill positive                             [rad], |.| <= 0.5 */
	MODEL_MASS,       /* m                                                  [kg], > 0         */
	MODEL_DRAG,       /* C_d                                                [1], >= 0         */
	MODEL_TAU,        /* actuator time constant                             [s], > 0          */
	MODEL_DELAY,      /* from t = 0 to brake onset, before a future's extra [s], >= 0         */
	MODEL_INPUTS
};

enum model_bound {
	MODEL_BOUND_PAPER,    /* eq. 5 solved for a: a >= -mu g / (1 + mu h/L)   */
	MODEL_BOUND_FRICTION, /* a >= -mu g                                      */
};

/* What all samples of a batch share. */
struct model_vehicle {
	float rho_kgpm3;    /* air density, 1.225 */
	float area_m2;      /* frontal area A_f, 2.2 */
	float gravity_mps2; /* 9.81 */
	float cg_height_m;  /* h, 0.5 */
	float wheelbase_m;  /* L, 2.7 */
	uint32_t bound;     /* enum model_bound */
};

/* One thing that may happen next. "Nobody brakes" is extra_delay_s >= horizon. */
struct model_future {
	float accel_cmd_mps2; /* a_cmd <= 0; -6 in the paper */
	float extra_delay_s;  /* >= 0, added to the sample's delay */
};

/* What one rollout yields. All f32 so that CPU and GPU results compare with memcmp. */
struct model_out {
	float stop_m;     /* travelled to standstill, eq. 3; to the horizon if still rolling */
	float need_m;     /* headway that just touches: -min(x_lead - x_ego) over [0,T]      */
	float impact_mps; /* closing speed at first contact; 0 without contact               */
	uint32_t flags;   /* MODEL_* below                                                   */
};
#define MODEL_CONTACT   1u /* headway <= need */
#define MODEL_ROLLING   2u /* ego still moving at the horizon */
#define MODEL_UNDECIDED 4u /* no contact yet, and the gap is still closing at the horizon */

#define MODEL_STEP_S 1e-3 /* the paper's dt, Sec. IV */

/*
 * What happens, for both rollouts. t = 0 is the instant of the scene, d = min(delay + extra delay, T) the onset.
 *   t < d    dv/dt = a0: what the ego does now, net of drag and grade, goes on; it may end in standstill.
 *   t >= d   eq. 4 and 6 with the actuator starting where it is: a(s) = a_cmd + (a_i - a_cmd) e^(-s/tau), s = t - d,
 *            a_i = max(a0, -min(|a_cmd|, bound)); a0 = 0 and d = 0 is the paper's start. An ego that does more than
 *            the command (or friction) already gets the command at onset, no credit for more.
 *   lead     vl + al t down to standstill; al < 0 never makes it reverse.
 * The ego stays where it has stopped: creep and roll-back are not modelled.
 */

/* One sample in f64: constants of eq. 4-6 and the motion of the lead. */
struct model_sample {
	double headway, v0, a0, vl, al, lead_stop_s;
	double drag_pm, grade_mps2, bound_mps2, rate_ps; /* k, g sin(theta), eq. 5, 1 / tau */
	double cmd_mps2, start_mps2, onset_s, horizon_s;
};

struct model_state {
	double x, v, a;
};

/* Closest approach and first contact as far as the ego has been followed. */
struct model_watch {
	double rel_min, gap, closing; /* closing: speed at which the gap shrinks */
	double impact;
	int contact;
};

/** model_sample - constants of one sample; @in is MODEL_INPUTS values @stride floats apart. Pure. */
HD struct model_sample model_sample(const struct model_vehicle *veh, const struct model_future *fut,
				    float horizon_s, const float *in, uint32_t stride)
{
	const double h_over_l =
		veh->bound == MODEL_BOUND_PAPER ? (double)veh->cg_height_m / veh->wheelbase_m : 0.0;
	const double mu = in[MODEL_MU * stride];
	const double onset = (double)in[MODEL_DELAY * stride] + fut->extra_delay_s;
	struct model_sample p;

	p.headway = in[MODEL_HEADWAY * stride];
	p.v0 = in[MODEL_EGO_SPEED * stride];
	p.a0 = in[MODEL_EGO_ACCEL * stride];
	p.vl = in[MODEL_LEAD_SPEED * stride];
	p.al = in[MODEL_LEAD_ACCEL * stride];
	p.lead_stop_s = p.al < 0.0 ? p.vl / -p.al : 1e6;
	p.drag_pm = 0.5 * veh->rho_kgpm3 * veh->area_m2 * in[MODEL_DRAG * stride] /
		    in[MODEL_MASS * stride];
	p.grade_mps2 = veh->gravity_mps2 * det_sin(in[MODEL_GRADE * stride]);
	p.bound_mps2 = mu * veh->gravity_mps2 / (1.0 + mu * h_over_l);
	p.rate_ps = 1.0 / in[MODEL_TAU * stride];
	p.cmd_mps2 = fut->accel_cmd_mps2;
	p.start_mps2 = -p.cmd_mps2 < p.bound_mps2 ? p.cmd_mps2 : -p.bound_mps2;
	p.start_mps2 = p.a0 > p.start_mps2 ? p.a0 : p.start_mps2;
	p.horizon_s = horizon_s;
	p.onset_s = onset < p.horizon_s ? onset : p.horizon_s;
	return p;
}

/* Eq. 4 with the bound of eq. 5 on the realised deceleration. */
HD double model_accel(const struct model_sample *p, double v, double a)
{
	return (a > -p->bound_mps2 ? a : -p->bound_mps2) - p->drag_pm * v * v - p->grade_mps2;
}

/* One classical RK4 step of eq. 4 and 6. */
HD struct model_state model_step(const struct model_sample *p, struct model_state s, double h)
{
	const double ka1 = (p->cmd_mps2 - s.a) * p->rate_ps;
	const double kv1 = model_accel(p, s.v, s.a);
	const double a2 = s.a + 0.5 * h * ka1, v2 = s.v + 0.5 * h * kv1;
	const double ka2 = (p->cmd_mps2 - a2) * p->rate_ps;
	const double kv2 = model_accel(p, v2, a2);
	const double a3 = s.a + 0.5 * h * ka2, v3 = s.v + 0.5 * h * kv2;
	const double ka3 = (p->cmd_mps2 - a3) * p->rate_ps;
	const double kv3 = model_accel(p, v3, a3);
	const double a4 = s.a + h * ka3, v4 = s.v + h * kv3;
	const double ka4 = (p->cmd_mps2 - a4) * p->rate_ps;
	const double kv4 = model_accel(p, v4, a4);
	struct model_state n;

	n.x = s.x + h / 6.0 * (s.v + 2.0 * v2 + 2.0 * v3 + v4);
	n.v = s.v + h / 6.0 * (kv1 + 2.0 * kv2 + 2.0 * kv3 + kv4);
	n.a = s.a + h / 6.0 * (ka1 + 2.0 * ka2 + 2.0 * ka3 + ka4);
	return n;
}

/* The ego is at @x with @v at time @t: note the gap; the first that is not positive is the contact, whose speed
 * follows from the quadratic through this point and the last, @h ago. */
HD void model_look(const struct model_sample *p, struct model_watch *w, double t, double h,
		   double x, double v)
{
	const double tc = t < p->lead_stop_s ? t : p->lead_stop_s;
	const double rel = tc * (p->vl + 0.5 * p->al * tc) - x;
	const double gap = p->headway + rel;
	const double closing = v - (t < p->lead_stop_s ? p->vl + p->al * t : 0.0);

	if (!w->contact && gap <= 0.0) {
		const double slope = h > 0.0 ? (closing - w->closing) / h : 0.0;
		const double sq = w->closing * w->closing + 2.0 * w->gap * slope;
		const double at_once = closing > 0.0 ? closing : 0.0;

		w->impact = h > 0.0 ? sqrt(sq > 0.0 ? sq : 0.0) : at_once;
		w->contact = 1;
	}
	w->rel_min = rel < w->rel_min ? rel : w->rel_min;
	w->gap = gap;
	w->closing = closing;
}

/* Before onset: constant acceleration, looked at every @dt, the last step cut at the onset or at standstill. */
HD struct model_state model_coast(const struct model_sample *p, double dt, struct model_watch *w)
{
	const double stop = p->a0 < 0.0 ? p->v0 / -p->a0 : 1e6;
	const double end = stop < p->onset_s ? stop : p->onset_s;
	const struct model_state s = {end * (p->v0 + 0.5 * p->a0 * end),
				      stop <= p->onset_s ? 0.0 : p->v0 + p->a0 * end,
				      p->start_mps2};
	double t = 0.0;

	model_look(p, w, 0.0, 0.0, 0.0, p->v0);
	while (t < end) {
		const double h = t + dt < end ? dt : end - t;

		t = h < dt ? end : t + dt;
		model_look(p, w, t, h, t * (p->v0 + 0.5 * p->a0 * t), p->v0 + p->a0 * t);
	}
	return s;
}

/* From onset to standstill or the horizon. */
HD struct model_state model_brake(const struct model_sample *p, double dt, struct model_state s,
				  struct model_watch *w)
{
	double t = p->onset_s;

	while (s.v > 0.0 && t < p->horizon_s) {
		double h = t + dt < p->horizon_s ? dt : p->horizon_s - t;
		struct model_state n = model_step(p, s, h);

		if (n.v <= 0.0) {
			h *= s.v / (s.v - n.v);
			n.x = s.x + 0.5 * s.v * h;
			n.v = 0.0;
		}
		t = h < dt && n.v > 0.0 ? p->horizon_s : t + h;
		s = n;
		model_look(p, w, t, h, s.x, s.v);
	}
	return s;
}

/**
 * model_rollout - the reference: one sample to standstill or the horizon, in f64
 * @veh, @fut:  what samples share; the command [m/s2, <= 0] and its extra delay [s]
 * @horizon_s:  T_max [s], > 0
 * @dt_s:       fixed step [s], > 0; 0.001 in the paper (Sec. IV). The steps around onset, horizon and v = 0 are cut.
 * @in:         MODEL_INPUTS values, @stride floats apart, within the ranges of enum model_input
 * Classical RK4, no fused operation, gap looked at where steps end. Same bits on host and device. Pure.
 */
HD struct model_out model_rollout(const struct model_vehicle *veh, const struct model_future *fut,
				  float horizon_s, double dt_s, const float *in, uint32_t stride)
{
	const struct model_sample p = model_sample(veh, fut, horizon_s, in, stride);
	struct model_watch w = {0.0, 0.0, 0.0, 0.0, 0};
	const struct model_state s = model_brake(&p, dt_s, model_coast(&p, dt_s, &w), &w);
	struct model_out out;

	out.stop_m = (float)s.x;
	out.need_m = (float)-w.rel_min;
	out.impact_mps = (float)w.impact;
	out.flags = w.contact ? MODEL_CONTACT : 0u;
	out.flags |= s.v > 0.0 ? MODEL_ROLLING : 0u;
	out.flags |= !w.contact && s.v > 0.0 && w.closing > 0.0 ? MODEL_UNDECIDED : 0u;
	return out;
}

#endif
