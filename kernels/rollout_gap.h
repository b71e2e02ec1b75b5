/* SPDX-License-Identifier: MIT
 * Fast rollout, the gap: closest approach, verdict, first contact and its speed.
 * Stages in the order in which rollout.h calls them.
 */
#ifndef AEBMC_ROLLOUT_GAP_H
#define AEBMC_ROLLOUT_GAP_H

#include "rollout_lane.h"

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
	/* a lead that brakes harder than the ego ever does is never the faster one again */
	r->want = det_maxf(det_fmaf(kv, v, force), 0.0f) + r->al > 0.0f ? r->want : 0.0f;
}

/** rollout_near_root - first guess: root of a s^2 + b s - c, then of d s^3 too; or where that comes nearest to 0. */
HD void rollout_near_root(struct rollout *r)
{
	const float a = r->near_a, b = r->near_b, c = r->near_c;
	const float disc = det_fmaf(b, b, 4.0f * a * c);
	const float root = det_sqrtf(det_maxf(disc, 0.01f));
	const float two_a = det_maxf(a, -a) > 1e-9f ? 2.0f * a : 1e-9f;
	const float num_b = b > 0.0f ? 2.0f * c : root - b;
	const float den_b = b > 0.0f ? b + root : two_a;
	const float num = disc > 0.0f ? num_b : -b;
	const float den = disc > 0.0f ? den_b : two_a;
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
	/* below zero: the lead's speed was not reached before, and will not be */
	const float past = det_maxf(det_maxf(disc, v), dv);
	const float top = past < 0.0f ? 0.0f : -dv;
	const float num = disc > 0.0f ? -2.0f * v : top;
	const float den = disc > 0.0f ? dv + det_sqrtf(det_maxf(disc, 0.0f)) : ddv;
	const float step = num / (det_maxf(den, -den) > 1e-6f ? den : 1e-6f);
	const float next = det_minf(det_maxf(s + step, r->near_lo), r->near_hi);
	const float h = next - s, h2 = h * h;
	const float pull = det_maxf(r->at_dv, -r->at_dv), drag = 2.0f * r->k * r->at_v * r->at_v;
	const float third =
		det_fmaf(r->at_fe * r->rate, r->rate, 2.0f * r->k * pull * (pull + drag));
	/* 1/24 of it is left out: 0.02 mm; a point of the path bounds the minimum, a poor expansion does not */
	const float more = third * h2 * h2 < 5e-4f ? 0.0f : 1.0f;
	const float by = more > 0.0f ? 0.0f : h;
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

#endif
