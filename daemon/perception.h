/* SPDX-License-Identifier: MIT
 * What the ego will meet first, with what probability: the lead, another object that the radar follows, one that the lead
 * hides, or nothing. From existence, confirmation and lateral motion of the objects; each effect is an option
 * (perception.*). Pure; knows no frame and no Monte Carlo.
 */
#ifndef AEBMC_PERCEPTION_H
#define AEBMC_PERCEPTION_H

#include "tracker.h"

struct perception {
	const struct tracker_object *object[SCENE_OTHERS]; /* SCENE_NEARER, SCENE_BEHIND; or NULL */
	double p[SCENE_OTHERS];                            /* the lead has what they leave of 1 */
};

/**
 * perception_inside - probability that an object will be in the ego's corridor [0..1]
 * Its lateral offset from the ego's path is followed for perception.lookahead or until it is reached, if that is sooner;
 * it is normal about that with perception.lateral_sigma and, growing with distance squared, the path's curvature.
 * Same bits on every machine.
 */
double perception_inside(const struct tracker *t, const struct tracker_object *o);

/**
 * perception_weigh - who is met first
 * @lead: the lead
 * Objects count as independent, each there with its own probability; the nearest that is there is met. Of those nearer
 * than the lead, and of those behind it, only the most probable one counts.
 */
struct perception perception_weigh(const struct tracker *t, const struct tracker_object *lead);

#endif
