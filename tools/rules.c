/* SPDX-License-Identifier: MIT
 * Other ways to decide when to brake fully.
 */
#include "rules.h"
#include <math.h>
#include <string.h>
#include "clock.h"

#define TTC_S 1.4 /* chosen here: between early braking and false alarms in overtaking */

/* Autoware, autoware_autonomous_emergency_braking README, "Collision check with target obstacles using RSS distance":
 * t_response, a_ego_min, a_obj_min, longitudinal_offset_margin, as the comparison was asked for. */
#define AUTOWARE_RESPONSE_S 1.0
#define AUTOWARE_EGO_MPS2   3.0
#define AUTOWARE_OBJ_MPS2   1.0
#define AUTOWARE_MARGIN_M   1.0

/* Shalev-Shwartz, Shammah, Shashua: On a Formal Model of Safe and Scalable Self-driving Cars, Lemma 2, with the parameters
 * that ad-rss-lib gives as an example (doc/ad_rss/Appendix-ParameterDiscussion). */
#define AD_RSS_RESPONSE_S 1.0
#define AD_RSS_ACCEL_MPS2 3.5
#define AD_RSS_MIN_MPS2   4.0
#define AD_RSS_MAX_MPS2   8.0

static double closing(const struct scene *s)
{
	return s->x[SCENE_EGO_SPEED] - s->x[SCENE_LEAD_SPEED];
}

static int ttc_fires(const struct config *cfg, const struct scene *s, struct mc *mc,
		     const struct mc_request *req)
{
	(void)cfg, (void)mc, (void)req;
	return s->x[SCENE_HEADWAY] < TTC_S * closing(s);
}

/* Where a car is after @t_s that keeps its speed for @response_s and brakes at @brake_mps2 then, to standstill. */
static double position(double speed_mps, double response_s, double brake_mps2, double t_s)
{
	const double braked = fmin(fmax(t_s - response_s, 0), speed_mps / brake_mps2);

	return speed_mps * fmin(t_s, response_s) + (speed_mps - brake_mps2 / 2 * braked) * braked;
}

/* The README's distance compares stopping distances. An object that brakes more gently than the ego is nearest before
 * they stand, when their speeds are equal: the largest excess over time is what closest approach needs. */
double rule_distance_autoware(double ego_mps, double lead_mps)
{
	const double end_s = AUTOWARE_RESPONSE_S + ego_mps / AUTOWARE_EGO_MPS2;
	const double equal_s = (ego_mps + AUTOWARE_EGO_MPS2 * AUTOWARE_RESPONSE_S - lead_mps) /
			       (AUTOWARE_EGO_MPS2 - AUTOWARE_OBJ_MPS2);
	const double at[] = {AUTOWARE_RESPONSE_S, end_s, fmin(fmax(equal_s, 0), end_s)};
	double most = 0;

	for (size_t i = 0; i < sizeof(at) / sizeof(at[0]); i++) {
		most = fmax(most, position(ego_mps, AUTOWARE_RESPONSE_S, AUTOWARE_EGO_MPS2, at[i]) -
					  position(lead_mps, 0, AUTOWARE_OBJ_MPS2, at[i]));
	}
	return most + AUTOWARE_MARGIN_M;
}

static int autoware_fires(const struct config *cfg, const struct scene *s, struct mc *mc,
			  const struct mc_request *req)
{
	(void)cfg, (void)mc, (void)req;
	return s->x[SCENE_HEADWAY] <
	       rule_distance_autoware(s->x[SCENE_EGO_SPEED], s->x[SCENE_LEAD_SPEED]);
}

double rule_distance_ad_rss(double ego_mps, double lead_mps)
{
	const double t = AD_RSS_RESPONSE_S, after = ego_mps + t * AD_RSS_ACCEL_MPS2;
	const double d = ego_mps * t + AD_RSS_ACCEL_MPS2 / 2 * t * t +
			 after * after / (2 * AD_RSS_MIN_MPS2) -
			 lead_mps * lead_mps / (2 * AD_RSS_MAX_MPS2);

	return fmax(d, 0);
}

static int ad_rss_fires(const struct config *cfg, const struct scene *s, struct mc *mc,
			const struct mc_request *req)
{
	(void)cfg, (void)mc, (void)req;
	return s->x[SCENE_HEADWAY] <
	       rule_distance_ad_rss(s->x[SCENE_EGO_SPEED], s->x[SCENE_LEAD_SPEED]);
}

/* A lead that stands where it is now, known as well as its distance is. */
static struct mc_request standing_lead(const struct mc_request *req)
{
	struct mc_request r = *req;

	r.mean[MODEL_LEAD_SPEED] = r.mean[MODEL_LEAD_ACCEL] = 0;
	r.n_priors = 0;
	for (int i = 6; i < MC_FACTOR_LEN;
	     i++) { /* the rows of the lead's speed and acceleration */
		r.factor[i] = 0;
	}
	r.n_futures = 1;
	r.hist_future = 0;
	r.future[0].extra_delay_s = 0;
	return r;
}

static int paper_fires(const struct config *cfg, const struct scene *s, struct mc *mc,
		       const struct mc_request *req)
{
	const struct mc_request r = standing_lead(req);
	struct mc_result res;

	(void)s;
	return !mc_submit(mc, &r) && mc_poll(mc, &res) == 1 &&
	       res.risk[0].lo > cfg->decision_p_defer;
}

const struct rule rule_table[] = {
	{"ttc", "time to collision below 1.4 s", ttc_fires},
	{"autoware",
	 "Autoware's RSS distance, closest approach: response 1.0 s, ego -3, object -1 m/s2, "
	 "margin "
	 "1 m",
	 autoware_fires},
	{"ad-rss", "safe longitudinal distance of RSS with ad-rss-lib's example parameters",
	 ad_rss_fires},
	{"paper", "the paper alone: P(D_stop > H0) of a lead that stands exceeds decision.p_defer",
	 paper_fires},
	{0},
};

const struct rule *rule_find(const char *name)
{
	for (const struct rule *r = rule_table; r->name; r++) {
		if (!strcmp(r->name, name)) {
			return r;
		}
	}
	return NULL;
}

double rule_step(const struct rule *r, struct rule_state *st, const struct config *cfg,
		 const struct scene *s, struct mc *mc, const struct mc_request *req, int64_t now_ns)
{
	const double speed = s->x[SCENE_EGO_SPEED];
	const int in_range = speed >= cfg->decision_speed_min && speed <= cfg->decision_speed_max;
	const int fires = s->lead_valid && s->lead_scans >= cfg->radar_confirm_scans &&
			  r->fires(cfg, s, mc, req);

	st->calm = fires ? 0 : st->calm + 1;
	if (!st->braking && fires && in_range) {
		*st = (struct rule_state){1, now_ns, 0};
	} else if (speed < cfg->decision_standstill ||
		   (st->calm >= cfg->decision_release_evals &&
		    now_ns - st->entered_ns >= clock_s_to_ns(cfg->decision_hold))) {
		st->braking = 0;
	}
	return st->braking ? cfg->brake_accel : 0;
}
