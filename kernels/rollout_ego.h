/* SPDX-License-Identifier: MIT
 * Fast rollout, the ego's motion: until the brake acts, onto the friction bound, to standstill or the horizon.
 * Stages in the order in which rollout.h calls them.
 */
#ifndef AEBMC_ROLLOUT_EGO_H
#define AEBMC_ROLLOUT_EGO_H

#include "rollout_lane.h"

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
	const float left = r->base_s > 0.0f ? ROLLOUT_NEVER_S : end * r->rate;

	r->end_s = r->v1 > 0.0f ? end : 0.0f;
	r->end_v = 0.0f;
	r->stop = r->v1 > 0.0f ? r->x1 + x : r->x1;
	r->want = (r->v1 > 0.0f ? left : ROLLOUT_NEVER_S) < 14.0f ? 1.0f : 0.0f;
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

#endif
