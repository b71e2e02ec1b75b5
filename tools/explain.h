/* SPDX-License-Identifier: MIT
 * What drives the risk of one request: for each uncertain input its share, and the samples that end worst. Between
 * explain.c, which computes it, and explain_report.c, which tells.
 */
#ifndef AEBMC_EXPLAIN_H
#define AEBMC_EXPLAIN_H

#include "config.h"
#include "json.h"
#include "pipeline.h"

#define EXPLAIN_MET       MODEL_INPUTS /* which object is met: the lead, another, none */
#define EXPLAIN_INPUTS    (MODEL_INPUTS + 1)
#define EXPLAIN_WORST_MAX 100

/* One uncertain input. The lead's acceleration is the one that is rolled, with what the lead does next. */
struct explain_input {
	int input;           /* enum model_input, EXPLAIN_MET */
	double mean, sd;     /* of its samples [SI]; NaN of EXPLAIN_MET */
	double mean_contact; /* of those that collide; NaN without any, and of EXPLAIN_MET */
	double share;        /* of the variance of contact or gap that it explains, 0..1 */
	double p_known; /* risk if it were exactly its mean; of EXPLAIN_MET: if it were the lead */
};

/* One sample, as it was rolled. */
struct explain_sample {
	uint32_t index;
	float in[MODEL_INPUTS];
	int prior;    /* row */
	double gap_m; /* left at the closest approach; negative: it would have taken so much more */
	double impact_mps;     /* 0 without contact */
	struct mc_request req; /* of this sample alone: every backend gives its result again */
	uint64_t result_hash;
};

struct explain {
	struct cycle cycle; /* the evaluation */
	double time_s;      /* its scan, from the log's first frame */
	int future;         /* enum future */
	uint32_t n;         /* samples looked at */
	struct mc_risk risk;
	int by_gap; /* contact is the same in nearly all samples: the shares are of the gap to the lead */
	struct explain_input input[EXPLAIN_INPUTS]; /* by share, largest first */
	struct explain_sample worst[EXPLAIN_WORST_MAX];
	int n_worst;
};

extern const char *const explain_future_name[FUTURES]; /* "defer", "now", "driver", "nobody" */
extern const char *const explain_input_name[EXPLAIN_INPUTS];

/**
 * explain_run - fill in shares and worst samples of @x->cycle.req
 * @cfg: of the replay: its draws are drawn again
 * @n_worst: how many of the worst, at most EXPLAIN_WORST_MAX
 * Allocates and frees. 0 or -errno.
 */
int explain_run(const struct config *cfg, int n_worst, struct explain *x);

/** explain_words, explain_json - tell it. */
void explain_words(FILE *out, const struct explain *x);
void explain_json(const struct explain *x, uint64_t config_hash);

#endif
