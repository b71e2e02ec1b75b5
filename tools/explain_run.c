/* SPDX-License-Identifier: MIT
 * One request's samples taken apart: the same draws again, sample by sample.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "draws.h"
#include "engine.h"
#include "explain.h"
#include "mc_ops.h"
#include "recorder.h"
#include "sample.h"
#include "sensitivity.h"

#define SAMPLES_MAX 65536 /* of a larger batch the first ones are looked at */
#define FEW         20 /* so few samples on either side of contact say nothing about their causes */

struct work {
	const struct mc_request *req;
	struct mc_backend *b;
	struct draws *draws;
	struct sample_plan plan;
	const float *z; /* [MC_DIM][stride] */
	uint32_t stride;
	float *x;                      /* [EXPLAIN_INPUTS][n] */
	struct model_out *out;         /* [n_futures][n] */
	double *gap;                   /* [n], left at the closest approach [m] */
	struct sensitivity_pair *pair; /* [n] */
	uint32_t *order;               /* [n], worst first */
};

static int open_work(const struct config *cfg, uint32_t n, struct work *w)
{
	const struct mc_params p = engine_params(cfg, n);
	int error = draws_open(&p, &w->draws);

	error = error ? error : mc_cpu_ops.open(&p, &w->b);
	w->x = calloc((size_t)EXPLAIN_INPUTS * n, sizeof(*w->x));
	w->out = calloc((size_t)w->req->n_futures * n, sizeof(*w->out));
	w->gap = calloc(n, sizeof(*w->gap));
	w->pair = calloc(n, sizeof(*w->pair));
	w->order = calloc(n, sizeof(*w->order));
	return error ? error : w->x && w->out && w->gap && w->pair && w->order ? 0 : -ENOMEM;
}

static void close_work(struct work *w)
{
	if (w->b) {
		mc_cpu_ops.close(w->b);
	}
	draws_close(w->draws);
	free(w->x);
	free(w->out);
	free(w->gap);
	free(w->pair);
	free(w->order);
}

static uint32_t prior_row(const struct work *w, uint32_t i)
{
	return sample_row(w->plan.prior_cum, w->z[(size_t)MC_DIM_PRIOR * w->stride + i]);
}

/* ---- shares ------------------------------------------------------------------------------------ */

/* The request with every row that is not the lead's turned into the lead itself. */
static struct mc_request of_lead(const struct mc_request *req)
{
	struct mc_request r = *req;

	for (uint32_t i = PIPELINE_LEAD_ROWS; i < r.n_priors; i++) {
		r.prior[i] = (struct mc_prior){.weight = r.prior[i].weight, .gain = 1};
	}
	return r;
}

/* Inputs as they are uncertain about the lead; what is met instead of it is an input of its own. */
static void draw_inputs(const struct explain *x, struct work *w)
{
	const struct model_out *out = &w->out[(size_t)x->future * x->n];
	const struct mc_request lead = of_lead(w->req);
	struct sample_plan plan;

	sample_plan(&lead, &plan);
	sample_plan(w->req, &w->plan);
	w->z = draws_table(w->draws, &w->stride);
	for (uint32_t i = 0; i < x->n; i++) {
		const uint32_t row = prior_row(w, i);
		float in[MODEL_INPUTS];

		sample_draw(&plan, w->z + i, w->stride, w->x + i, x->n);
		w->x[(size_t)EXPLAIN_MET * x->n + i] = row < PIPELINE_LEAD_ROWS ? 0 : (float)row;
		sample_draw(&w->plan, w->z + i, w->stride, in, 1);
		w->gap[i] = (double)in[MODEL_HEADWAY] - (double)out[i].need_m;
	}
}

static void moments(const struct explain *x, const struct work *w, struct explain_input *e)
{
	const float *in = w->x + (size_t)e->input * x->n;
	double sum = 0, sum2 = 0, contact = 0;
	uint32_t hits = 0;

	for (uint32_t i = 0; i < x->n; i++) {
		const int hit = w->out[(size_t)x->future * x->n + i].flags & MODEL_CONTACT;

		sum += (double)in[i];
		contact += hit ? (double)in[i] : 0;
		hits += hit != 0;
	}
	e->mean = sum / x->n;
	e->mean_contact = hits ? contact / hits : NAN;
	for (uint32_t i = 0; i < x->n; i++) {
		sum2 += ((double)in[i] - e->mean) * ((double)in[i] - e->mean);
	}
	e->sd = sqrt(sum2 / x->n);
}

/* The request as it would be if this input were known; the others keep their draws. */
static struct mc_request known(const struct mc_request *req, int input)
{
	struct mc_request r = input == EXPLAIN_MET ? of_lead(req) : *req;

	if (input >= MC_STATE_DIM && input < MODEL_INPUTS) {
		r.sigma[input - MC_STATE_DIM] = 0;
	} else if (input < MC_STATE_DIM) {
		memset(&r.factor[input * (input + 1) / 2], 0,
		       (size_t)(input + 1) * sizeof(r.factor[0]));
	}
	for (int i = 0; i < PIPELINE_LEAD_ROWS && input == MODEL_LEAD_ACCEL; i++) {
		r.prior[i].gain = 1;
		r.prior[i].offset_mps2 = 0;
	}
	return r;
}

/* Contact is explained, or, where that is all but certain, the gap that is left to the lead. Returns how many samples. */
static uint32_t fill_pairs(const struct explain *x, struct work *w, int input)
{
	const struct model_out *out = &w->out[(size_t)x->future * x->n];
	uint32_t n = 0;

	for (uint32_t i = 0; i < x->n; i++) {
		const double contact = (out[i].flags & MODEL_CONTACT) != 0;
		const float in = w->x[(size_t)input * x->n + i];

		if (!x->by_gap || prior_row(w, i) < PIPELINE_LEAD_ROWS) {
			w->pair[n++] =
				(struct sensitivity_pair){in, x->by_gap ? w->gap[i] : contact};
		}
	}
	return n;
}

static int explain_input(struct explain *x, struct work *w, int input, struct explain_input *e)
{
	const struct mc_request r = known(w->req, input);
	struct mc_result res;

	*e = (struct explain_input){.input = input, .mean = NAN, .sd = NAN, .mean_contact = NAN};
	if (input != EXPLAIN_MET) {
		moments(x, w, e);
	}
	e->share = sensitivity_share(w->pair, fill_pairs(x, w, input));
	const int error = mc_cpu_ops.run(w->b, &r, NULL, &res);

	e->p_known = error ? NAN : res.risk[x->future].p;
	return error;
}

static int by_share(const void *a, const void *b)
{
	const double x = ((const struct explain_input *)a)->share;
	const double y = ((const struct explain_input *)b)->share;

	return (x < y) - (x > y);
}

/* ---- the worst samples -------------------------------------------------------------------------- */

struct rank {
	const struct model_out *out;
	const double *gap;
};

/* Fastest impact first; of those without contact the one that comes nearest. */
static int by_harm(const void *a, const void *b, void *arg)
{
	const struct rank *r = arg;
	const uint32_t i = *(const uint32_t *)a, k = *(const uint32_t *)b;
	const float x = r->out[i].impact_mps, y = r->out[k].impact_mps;
	const double gap = r->gap[i], other = r->gap[k];

	if (x < y || x > y) {
		return x < y ? 1 : -1;
	}
	return gap < other || gap > other ? (gap > other) - (gap < other) : (i > k) - (i < k);
}

/* The sample's inputs as means that are known exactly. */
static void alone(const struct mc_request *req, struct explain_sample *s)
{
	s->req = *req;
	s->req.n = 1;
	s->req.n_priors = 0;
	memcpy(s->req.mean, s->in, sizeof(s->in));
	memset(s->req.factor, 0, sizeof(s->req.factor));
	memset(s->req.sigma, 0, sizeof(s->req.sigma));
}

/* -ERANGE: an input is beyond what the model is good for (the grade of a wide prior). */
static int fill_worst(const struct explain *x, const struct work *w, uint32_t i,
		      struct explain_sample *s)
{
	const struct model_out *out = &w->out[(size_t)x->future * x->n + i];
	struct mc_result res;

	sample_draw(&w->plan, w->z + i, w->stride, s->in, 1);
	s->index = i;
	s->prior = (int)prior_row(w, i);
	s->gap_m = w->gap[i];
	s->impact_mps = (double)out->impact_mps;
	alone(w->req, s);
	if (mc_check(&s->req)) {
		return -ERANGE;
	}
	const int error = mc_cpu_ops.run(w->b, &s->req, NULL, &res);

	s->result_hash = error ? 0 : recorder_result_hash(&res);
	return error;
}

static int find_worst(struct explain *x, const struct work *w, int n_worst)
{
	struct rank r = {&w->out[(size_t)x->future * x->n], w->gap};
	int error = 0;

	for (uint32_t i = 0; i < x->n; i++) {
		w->order[i] = i;
	}
	qsort_r(w->order, x->n, sizeof(w->order[0]), by_harm, &r);
	for (uint32_t i = 0; !error && x->n_worst < n_worst && i < x->n; i++) {
		error = fill_worst(x, w, w->order[i], &x->worst[x->n_worst]);
		x->n_worst += !error;
		error = error == -ERANGE ? 0 : error;
	}
	return error;
}

/* ---- all ---------------------------------------------------------------------------------------- */

static int run(struct explain *x, struct work *w, int n_worst)
{
	struct mc_request req = *w->req;
	struct mc_result res;
	int error;

	req.n = x->n;
	w->req = &req;
	error = mc_cpu_ops.run(w->b, &req, NULL, &res);
	error = error ? error : mc_cpu_ops.samples(w->b, &req, MC_FAST, 0, x->n, w->out);
	if (error) {
		return error;
	}
	x->risk = res.risk[x->future];
	x->by_gap = x->risk.hits < FEW || x->risk.hits + FEW > x->n;
	draw_inputs(x, w);
	for (int i = 0; i < EXPLAIN_INPUTS && !error; i++) {
		error = explain_input(x, w, i, &x->input[i]);
	}
	qsort(x->input, EXPLAIN_INPUTS, sizeof(x->input[0]), by_share);
	return error ? error : find_worst(x, w, n_worst);
}

int explain_run(const struct config *cfg, int n_worst, struct explain *x)
{
	struct work w = {.req = &x->cycle.req};

	x->n = x->cycle.req.n < SAMPLES_MAX ? x->cycle.req.n : SAMPLES_MAX;
	int error = open_work(cfg, x->n, &w);

	error = error ? error : run(x, &w, n_worst);
	close_work(&w);
	return error;
}
