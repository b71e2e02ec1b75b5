/* SPDX-License-Identifier: MIT
 * Risk to stage and deceleration request: pure functions on a table of rules, with hysteresis, and a deterministic
 * rule for when there is no fresh risk. Knows no clock, bus or backend: time and risk are arguments.
 */
#ifndef AEBMC_DECISION_H
#define AEBMC_DECISION_H

#include <stdint.h>
#include "config.h"
#include "mc.h"
#include "scene.h"

/* What may happen next; each is one model_future on the same draws. */
enum future {
	FUTURE_DEFER,  /* full braking one decision period later */
	FUTURE_NOW,    /* full braking at once */
	FUTURE_DRIVER, /* the driver brakes after a reaction time */
	FUTURE_NOBODY, /* no one brakes */
	FUTURES
};

enum stage_level { LEVEL_NONE, LEVEL_WARN, LEVEL_PARTIAL, LEVEL_FULL, LEVELS };
extern const char *const level_name[LEVELS]; /* "none", "warn", "partial", "full" */

/* Why the level is what it is; for status, CSV and words. */
enum decision_cause {
	CAUSE_NONE,
	CAUSE_RISK,     /* a rule of the table fired */
	CAUSE_HOLD,     /* kept by hysteresis */
	CAUSE_RELEASED, /* danger over */
	CAUSE_STANDSTILL,
	CAUSE_DRIVER,    /* driver override */
	CAUSE_INHIBITED, /* state does not allow a request */
	CAUSE_NO_EVIDENCE, /* too few samples or scans to judge, or an interval with a threshold in it */
	CAUSE_FALLBACK, /* deterministic rule (DEGRADED) */
	CAUSE_NO_LEAD,  /* nothing is followed in the corridor */
	CAUSE_DEBOUNCE, /* a rule fires, but not often enough in a row yet */
	CAUSES
};
extern const char *const cause_name[CAUSES];

/* What is remembered between evaluations. Zero-initialised at start. */
struct decision_state {
	enum stage_level level;
	int64_t entered_ns;     /* when the present level was entered */
	int64_t warned_ns;      /* when the last warning began; 0 never */
	uint32_t calm;          /* evaluations in a row that would release */
	int64_t calm_ns;        /* when the first of them was */
	uint32_t asked[LEVELS]; /* evaluations in a row that asked for this level or a higher one */
	uint64_t entered[LEVELS]; /* times each level was entered */
};

struct decision {
	enum stage_level level;
	enum decision_cause cause;
	double accel_mps2; /* requested, <= 0; 0 below PARTIAL */
	int changed;       /* level differs from before */
};

/** decision_futures - fill the four futures of a request from the configuration. Pure. */
void decision_futures(const struct config *cfg, struct model_future f[MC_FUTURES_MAX]);

/**
 * decision_step - one evaluation
 * @res: fresh result for @s, or NULL when there is none (then the deterministic rule decides if @fault allows)
 * @s:   the scene the result belongs to
 * @fault: active reasons; INHIBIT and FAULT states force LEVEL_NONE
 * @now_ns: time of the decision
 * @st: state, updated
 * Pure on its arguments.
 */
struct decision decision_step(const struct config *cfg, const struct mc_result *res,
			      const struct scene *s, uint32_t fault, int64_t now_ns,
			      struct decision_state *st);

#endif
