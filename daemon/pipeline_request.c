/* SPDX-License-Identifier: MIT
 * From a scene and the configuration to the request of one batch.
 */
#include "pipeline.h"
#include <errno.h>
#include <math.h>

_Static_assert((int)SCENE_DIM == MC_STATE_DIM && (int)SCENE_LEAD_ACCEL == (int)MODEL_LEAD_ACCEL,
	       "a scene's state is the correlated part of a request");

#define NOTHING_M   1000 /* so far ahead, and so fast, that it is neither met nor approached */
#define NOTHING_MPS 200

_Static_assert(PIPELINE_LEAD_ROWS + (int)SCENE_OTHERS == MC_PRIORS_MAX, "a row for each");

const char *const pipeline_prior_words[MC_PRIORS_MAX] = {
	"the lead keeps its acceleration",
	"the lead's acceleration decays",
	"the lead brakes harder",
	"the lead eases off",
	[PIPELINE_LEAD_ROWS + SCENE_NEARER] = "a nearer object is met",
	[PIPELINE_LEAD_ROWS + SCENE_BEHIND] = "the object behind the lead is met",
	[PIPELINE_LEAD_ROWS + SCENE_HIDDEN] = "what the lead hides is met",
	[PIPELINE_LEAD_ROWS + SCENE_NOTHING] = "nothing is met",
};

/* Column @k of the Cholesky factor. A variance of 0 is a figure known exactly: it may covary with nothing. */
static int cholesky_column(const double cov[SCENE_DIM][SCENE_DIM], double l[SCENE_DIM][SCENE_DIM],
			   int k)
{
	for (int i = k; i < SCENE_DIM; i++) {
		double rest = cov[i][k];

		for (int j = 0; j < k; j++) {
			rest -= l[i][j] * l[k][j];
		}
		if (i == k) {
			if (!(rest >= 0 && rest < INFINITY)) {
				return -EINVAL;
			}
			l[k][k] = sqrt(rest);
		} else if (l[k][k] > 0) {
			l[i][k] = rest / l[k][k];
		} else if (rest != 0) {
			return -EINVAL;
		}
	}
	return 0;
}

static int factorise(const double cov[SCENE_DIM][SCENE_DIM], float factor[MC_FACTOR_LEN])
{
	double l[SCENE_DIM][SCENE_DIM] = {{0}};
	int n = 0;

	for (int k = 0; k < SCENE_DIM; k++) {
		if (cholesky_column(cov, l, k)) {
			return -EINVAL;
		}
	}
	for (int i = 0; i < SCENE_DIM; i++) {
		for (int k = 0; k <= i; k++) {
			factor[n++] = (float)l[i][k];
		}
	}
	return 0;
}

static void independent(const struct config *c, struct mc_request *r)
{
	const struct {
		enum model_input input;
		double mean, sigma;
	} row[] = {
		{MODEL_MU, c->road_mu, c->road_mu_sigma},
		{MODEL_GRADE, c->road_grade, c->road_grade_sigma},
		{MODEL_MASS, c->vehicle_mass, c->vehicle_mass_sigma},
		{MODEL_DRAG, c->vehicle_drag, c->vehicle_drag_sigma},
		{MODEL_TAU, c->brake_tau, c->brake_tau_sigma},
		{MODEL_DELAY, c->brake_delay, c->brake_delay_sigma},
	};

	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		r->mean[row[i].input] = (float)row[i].mean;
		r->sigma[row[i].input - MC_STATE_DIM] = (float)row[i].sigma;
	}
	r->floor[MC_FLOOR_MU] = (float)c->road_mu_floor;
	r->floor[MC_FLOOR_MASS] = (float)c->vehicle_mass_floor;
}

/* What the lead does next, with the probability that it is what the ego meets. */
static void lead_rows(const struct config *c, double p, struct mc_prior row[PIPELINE_LEAD_ROWS])
{
	const struct {
		double weight, gain, offset;
	} next[PIPELINE_LEAD_ROWS] = {
		{c->lead_hold_weight, 1, 0},
		{c->lead_decay_weight, c->lead_decay_gain, 0},
		{c->lead_harder_weight, 1, c->lead_harder_accel},
		{c->lead_ease_weight, 0, 0},
	};
	double sum = 0;

	for (int i = 0; i < PIPELINE_LEAD_ROWS; i++) {
		sum += next[i].weight;
	}
	for (int i = 0; i < PIPELINE_LEAD_ROWS; i++) {
		const double share = sum > 0 ? next[i].weight / sum : i == 0;

		row[i] = (struct mc_prior){.weight = (float)(p * share),
					   .gain = (float)next[i].gain,
					   .offset_mps2 = (float)next[i].offset};
	}
}

/* Another object: as uncertain as the lead, elsewhere. */
static struct mc_prior object_row(const struct scene *s, const struct scene_object *o)
{
	return (struct mc_prior){
		.weight = (float)o->p,
		.gain = 1,
		.offset_mps2 = (float)(o->accel_mps2 - s->x[SCENE_LEAD_ACCEL]),
		.headway_m = (float)(o->headway_m - s->x[SCENE_HEADWAY]),
		.speed_mps = (float)(o->speed_mps - s->x[SCENE_LEAD_SPEED]),
	};
}

/* One row for each thing that the ego may meet, the lead's first. */
static void priors(const struct config *c, const struct scene *s, struct mc_request *r)
{
	const struct scene_object *o = s->other;
	struct mc_prior *row = &r->prior[PIPELINE_LEAD_ROWS];

	lead_rows(c, scene_lead_p(s), r->prior);
	row[SCENE_NEARER] = object_row(s, &o[SCENE_NEARER]);
	row[SCENE_BEHIND] = object_row(s, &o[SCENE_BEHIND]);
	row[SCENE_HIDDEN] = object_row(s, &o[SCENE_HIDDEN]);
	row[SCENE_HIDDEN].gain = row[SCENE_HIDDEN].offset_mps2 = 0;
	row[SCENE_NOTHING] = (struct mc_prior){.weight = (float)o[SCENE_NOTHING].p,
					       .headway_m = NOTHING_M,
					       .speed_mps = NOTHING_MPS};
	r->n_priors = PIPELINE_LEAD_ROWS + SCENE_OTHERS;
}

static struct model_vehicle vehicle(const struct config *c)
{
	return (struct model_vehicle){
		.rho_kgpm3 = (float)c->vehicle_rho,
		.area_m2 = (float)c->vehicle_area,
		.gravity_mps2 = (float)c->vehicle_gravity,
		.cg_height_m = (float)c->vehicle_cg_height,
		.wheelbase_m = (float)c->vehicle_wheelbase,
		.bound = (uint32_t)c->vehicle_bound,
	};
}

/* About where the car stops: only so that the sums stay small. */
static float centre_m(const struct config *c, const struct scene *s)
{
	double speed = s->x[SCENE_EGO_SPEED];

	return (float)floor(speed * (c->brake_delay + c->brake_tau) -
			    speed * speed / (2 * c->brake_accel));
}

/* Histograms cost less than a tenth of a batch, so that every evaluation can publish the safe headway. */
int pipeline_request(const struct config *cfg, const struct scene *s, uint64_t id,
		     struct mc_request *req)
{
	struct mc_request r = {
		.id = id,
		.n = (uint32_t)cfg->mc_samples,
		.flags = MC_WANT_HIST | MC_WANT_IMPACT,
		.n_futures = FUTURES,
		.horizon_s = (float)cfg->mc_horizon,
		.centre_m = centre_m(cfg, s),
		.hist_future = FUTURE_DEFER,
		.vehicle = vehicle(cfg),
	};

	if (factorise(s->cov, r.factor)) {
		return -EINVAL;
	}
	for (int i = 0; i < SCENE_DIM; i++) {
		r.mean[i] = (float)s->x[i];
	}
	independent(cfg, &r);
	priors(cfg, s, &r);
	decision_futures(cfg, r.future);
	*req = r;
	return 0;
}
