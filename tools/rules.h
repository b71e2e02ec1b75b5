/* SPDX-License-Identifier: MIT
 * Other ways to decide when to brake fully, behind one interface, for comparison on the same scenes: what does probability
 * buy? They see what the daemon's own decision sees. What is common to all (hold, release, standstill) is done here once.
 */
#ifndef AEBMC_RULES_H
#define AEBMC_RULES_H

#include "config.h"
#include "mc.h"
#include "scene.h"

/* A rule: name, source, and whether it wants full braking for a scene with a lead. */
struct rule {
	const char *name, *doc;
	int (*fires)(const struct config *cfg, const struct scene *s, struct mc *mc,
		     const struct mc_request *req);
};

/* All rules, ended by one without a name. */
extern const struct rule rule_table[];

/** rule_find - by name, or NULL. */
const struct rule *rule_find(const char *name);

/* What is remembered between evaluations; zero at start. */
struct rule_state {
	int braking;
	int64_t entered_ns;
	uint32_t calm;
};

/**
 * rule_step - one evaluation
 * @mc: inline, for rules that sample; @req: the daemon's request for the same scene
 * Enters within the speed range of the configuration, releases after decision.release_evals scenes in which the rule does
 * not fire and decision.hold, or at standstill, as the daemon does. Returns the deceleration asked for [m/s2], 0 or
 * brake.accel.
 */
double rule_step(const struct rule *r, struct rule_state *st, const struct config *cfg,
		 const struct scene *s, struct mc *mc, const struct mc_request *req,
		 int64_t now_ns);

/** rule_distance_* - the distances [m] below which the rules of that name fire. Pure. */
double rule_distance_autoware(double ego_mps, double lead_mps);
double rule_distance_ad_rss(double ego_mps, double lead_mps);

#endif
