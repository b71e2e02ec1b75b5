/* SPDX-License-Identifier: MIT
 * The rule: a table of levels with the conditions to enter them, one condition to release, and what overrides both.
 */
#include "decision.h"
#include <math.h>
#include "clock.h"
#include "fault.h"

const char *const level_name[LEVELS] = {"none", "warn", "partial", "full"};
const char *const cause_name[CAUSES] = {
	[CAUSE_NONE] = "none",
	[CAUSE_RISK] = "risk",
	[CAUSE_HOLD] = "hold",
	[CAUSE_RELEASED] = "released",
	[CAUSE_STANDSTILL] = "standstill",
	[CAUSE_DRIVER] = "driver",
	[CAUSE_INHIBITED] = "inhibited",
	[CAUSE_NO_EVIDENCE] = "no evidence",
	[CAUSE_FALLBACK] = "fallback",
	[CAUSE_NO_LEAD] = "no lead",
	[CAUSE_DEBOUNCE] = "debounce",
};

enum threshold { P_WARN, P_PARTIAL, P_DEFER, P_DRIVER, P_NOBODY, THRESHOLDS };

/* A level is entered when the lower end of each future's risk exceeds its threshold; the highest one wins. */
static const struct rule {
	enum stage_level level;
	int n;
	struct {
		enum future future;
		enum threshold above;
	} when[3];
} rule_table[] = {
	{LEVEL_FULL,
	 3,
	 {{FUTURE_DEFER, P_DEFER}, {FUTURE_DRIVER, P_DRIVER}, {FUTURE_NOBODY, P_NOBODY}}},
	{LEVEL_PARTIAL,
	 3,
	 {{FUTURE_DEFER, P_PARTIAL}, {FUTURE_DRIVER, P_DRIVER}, {FUTURE_NOBODY, P_NOBODY}}},
	{LEVEL_WARN, 2, {{FUTURE_DRIVER, P_WARN}, {FUTURE_NOBODY, P_NOBODY}}},
};

/* What one evaluation says, before memory and limits. */
struct verdict {
	enum stage_level wanted;
	enum decision_cause cause;
	int calm; /* would release */
};

void decision_futures(const struct config *cfg, struct model_future f[MC_FUTURES_MAX])
{
	float full = (float)cfg->brake_accel;

	f[FUTURE_DEFER] = (struct model_future){full, (float)cfg->decision_period};
	f[FUTURE_NOW] = (struct model_future){full, 0};
	f[FUTURE_DRIVER] =
		(struct model_future){(float)cfg->driver_accel, (float)cfg->driver_reaction};
	f[FUTURE_NOBODY] = (struct model_future){0, (float)cfg->mc_horizon};
}

/* The paper's levels (Sec. VI), or one's own. */
static double p_defer(const struct config *cfg)
{
	return cfg->decision_preset ? mc_risk_level[cfg->decision_preset - 1]
				    : cfg->decision_p_defer;
}

static double threshold(const struct config *cfg, enum threshold t)
{
	switch (t) {
	case P_WARN:
		return cfg->decision_p_warn;
	case P_PARTIAL:
		return cfg->decision_partial ? cfg->decision_partial_share * p_defer(cfg)
					     : INFINITY;
	case P_DEFER:
		return p_defer(cfg);
	case P_DRIVER:
		return cfg->decision_p_driver;
	default:
		return cfg->decision_p_nobody;
	}
}

static int fires(const struct config *cfg, const struct rule *r, const struct mc_result *res)
{
	for (int i = 0; i < r->n; i++) {
		if (!(res->risk[r->when[i].future].lo > threshold(cfg, r->when[i].above))) {
			return 0;
		}
	}
	return 1;
}

/* It does not fire, but with more evidence it might: no upper end rules it out. */
static int may_fire(const struct config *cfg, const struct rule *r, const struct mc_result *res)
{
	for (int i = 0; i < r->n; i++) {
		if (res->risk[r->when[i].future].hi <= threshold(cfg, r->when[i].above)) {
			return 0;
		}
	}
	return 1;
}

/* Over when nobody needs to brake any more, or when the driver's braking would do easily again: in dense traffic some
 * risk of doing nothing for ten seconds never goes away. A request is not left to the driver where it has made the car so
 * slow that none would follow: what is left of the speed ends in the lead. */
static int is_over(const struct config *cfg, const struct mc_result *res, const struct scene *s,
		   enum stage_level level)
{
	const int slow = s->x[SCENE_EGO_SPEED] < cfg->decision_release_speed;

	return res->risk[FUTURE_NOBODY].hi < cfg->decision_p_release ||
	       (res->risk[FUTURE_DRIVER].hi < cfg->decision_p_release &&
		!(slow && level >= LEVEL_PARTIAL));
}

static struct verdict by_risk(const struct config *cfg, const struct mc_result *res,
			      const struct scene *s, enum stage_level level)
{
	struct verdict v = {LEVEL_NONE, CAUSE_NONE, is_over(cfg, res, s, level)};

	for (size_t i = 0; i < sizeof(rule_table) / sizeof(rule_table[0]); i++) {
		if (fires(cfg, &rule_table[i], res)) {
			v.wanted = rule_table[i].level;
			v.cause = CAUSE_RISK;
			break;
		}
		if (may_fire(cfg, &rule_table[i], res)) {
			v.cause = CAUSE_NO_EVIDENCE;
		}
	}
	return v;
}

static double closing_mps(const struct scene *s)
{
	return s->lead_valid ? s->x[SCENE_EGO_SPEED] - s->x[SCENE_LEAD_SPEED] : 0;
}

/* More deceleration than the driver's is needed to match the lead's speed before the gap is gone. */
static int beyond_driver(const struct config *cfg, const struct scene *s)
{
	double closing = closing_mps(s);
	double room_m = s->x[SCENE_HEADWAY] - closing * cfg->brake_delay;
	double spare_mps2 = -cfg->driver_accel + fmin(s->x[SCENE_LEAD_ACCEL], 0);

	return closing > 0 &&
	       (room_m <= 0 || spare_mps2 <= 0 || closing * closing > 2 * room_m * spare_mps2);
}

/* Without fresh risk: time to collision, where the driver's braking would no longer do. */
static struct verdict by_ttc(const struct config *cfg, const struct scene *s)
{
	double ttc_s = s->x[SCENE_HEADWAY] / fmax(closing_mps(s), 1e-3);
	enum stage_level wanted = LEVEL_NONE;

	if (beyond_driver(cfg, s)) {
		wanted = ttc_s < cfg->decision_fallback_ttc                          ? LEVEL_FULL
			 : ttc_s < cfg->decision_fallback_ttc + cfg->driver_reaction ? LEVEL_WARN
										     : LEVEL_NONE;
	}
	return (struct verdict){wanted, CAUSE_FALLBACK, wanted == LEVEL_NONE};
}

/* Losing sight is calm in the sense of release (which waits for longer then), never proof of safety. */
static struct verdict judge(const struct config *cfg, const struct mc_result *res,
			    const struct scene *s, uint32_t fault, enum stage_level level)
{
	if (!s->lead_valid) {
		return (struct verdict){LEVEL_NONE, CAUSE_NO_LEAD, 1};
	}
	if (s->lead_scans >= cfg->radar_confirm_scans) {
		if (res && res->n >= (uint64_t)cfg->decision_samples_min) {
			return by_risk(cfg, res, s, level);
		}
		if (fault_state(fault) == STATE_DEGRADED) {
			return by_ttc(cfg, s);
		}
	}
	return (struct verdict){LEVEL_NONE, CAUSE_NO_EVIDENCE, 1};
}

/* What ends everything at once, or CAUSE_NONE. */
static enum decision_cause stopped(const struct config *cfg, const struct scene *s, uint32_t fault)
{
	if (fault_state(fault) > STATE_DEGRADED || !s->ego_valid) {
		return CAUSE_INHIBITED;
	}
	return s->x[SCENE_EGO_SPEED] < cfg->decision_standstill ? CAUSE_STANDSTILL : CAUSE_NONE;
}

static int out_of_range(const struct config *cfg, const struct scene *s)
{
	double speed = s->x[SCENE_EGO_SPEED];

	return speed < cfg->decision_speed_min || speed > cfg->decision_speed_max;
}

/* The highest level allowed. Leaving the speed range ends nothing: braking goes on to standstill. */
static enum stage_level highest(const struct config *cfg, const struct scene *s,
				enum stage_level now)
{
	if (out_of_range(cfg, s)) {
		return now;
	}
	return now < LEVEL_WARN ? LEVEL_WARN : LEVEL_FULL; /* braking only after a warning */
}

/* A lead lost from sight while we brake for it is still there until it had time to be found again. */
static int released(const struct config *cfg, const struct scene *s, int64_t now_ns,
		    const struct decision_state *st)
{
	const int blind = !s->lead_valid && st->level >= LEVEL_PARTIAL;
	const int apart = (!blind && closing_mps(s) <= cfg->decision_release_closing) ||
			  now_ns - st->calm_ns >= clock_s_to_ns(cfg->decision_release_max);

	return st->calm >= cfg->decision_release_evals && apart &&
	       now_ns - st->entered_ns >= clock_s_to_ns(cfg->decision_hold);
}

static enum stage_level lower(enum stage_level a, enum stage_level b)
{
	return a < b ? a : b;
}

/* From verdict, limits and memory to the next level; @v becomes what was decided and why. */
static void settle(const struct config *cfg, const struct scene *s, uint32_t fault, int64_t now_ns,
		   const struct decision_state *st, struct verdict *v)
{
	enum decision_cause stop = stopped(cfg, s, fault);
	enum stage_level asked = v->wanted, cap = highest(cfg, s, st->level);

	if (stop != CAUSE_NONE) {
		*v = (struct verdict){.wanted = LEVEL_NONE, .cause = stop};
	} else if (s->driver_accel == 1 && (asked > LEVEL_WARN || st->level > LEVEL_WARN)) {
		*v = (struct verdict){.wanted = lower(cap, LEVEL_WARN), .cause = CAUSE_DRIVER};
	} else if (lower(asked, cap) >= st->level) {
		v->wanted = lower(asked, cap);
		v->cause = asked > cap && out_of_range(cfg, s) ? CAUSE_INHIBITED : v->cause;
	} else if (released(cfg, s, now_ns, st)) {
		*v = (struct verdict){.wanted = LEVEL_NONE, .cause = CAUSE_RELEASED};
	} else {
		*v = (struct verdict){.wanted = st->level, .cause = CAUSE_HOLD};
	}
}

/* Count the evaluations in a row that are calm, and those that ask for each level. */
static void count(struct decision_state *st, const struct verdict *v, int64_t now_ns)
{
	st->calm_ns = v->calm && st->calm ? st->calm_ns : now_ns;
	st->calm = v->calm ? st->calm + 1 : 0;
	for (int i = 0; i < LEVELS; i++) {
		st->asked[i] = v->wanted >= (enum stage_level)i ? st->asked[i] + 1 : 0;
	}
}

/* The highest level up to the wanted one that was asked for often enough in a row. A level once entered stays wanted. */
static void debounce(const struct config *cfg, const struct decision_state *st, struct verdict *v)
{
	enum stage_level l = v->wanted;

	while (l > st->level && st->asked[l] < (l == LEVEL_WARN ? cfg->decision_warn_evals
								: cfg->decision_brake_evals)) {
		l--;
		v->cause = CAUSE_DEBOUNCE;
	}
	v->wanted = l;
}

static void enter(struct decision_state *st, enum stage_level to, int64_t now_ns)
{
	if (st->level == LEVEL_NONE) {
		st->warned_ns = now_ns;
	}
	st->level = to;
	st->entered_ns = now_ns;
	st->entered[to]++;
}

struct decision decision_step(const struct config *cfg, const struct mc_result *res,
			      const struct scene *s, uint32_t fault, int64_t now_ns,
			      struct decision_state *st)
{
	const double accel[LEVELS] = {0, 0, cfg->brake_accel_partial, cfg->brake_accel};
	struct verdict v = judge(cfg, res, s, fault, st->level);
	struct decision d;

	count(st, &v, now_ns);
	debounce(cfg, st, &v);
	settle(cfg, s, fault, now_ns, st, &v);
	d = (struct decision){v.wanted, v.cause, accel[v.wanted], v.wanted != st->level};
	if (d.changed) {
		enter(st, v.wanted, now_ns);
	}
	return d;
}
