/* SPDX-License-Identifier: MIT
 * Monte Carlo batches: the public face of kernels/.
 * A request is a scene with its uncertainty; a result is integer counts and what follows from them.
 * Both are plain data without pointers. Knows no CAN, configuration, clock or log.
 */
#ifndef AEBMC_MC_H
#define AEBMC_MC_H

#include <stdint.h>
#include "model.h"

#define MC_STATE_DIM     5            /* MODEL_HEADWAY..MODEL_LEAD_ACCEL share a factor       */
#define MC_FACTOR_LEN    15           /* rows of its lower triangle: (0,0) (1,0) (1,1) (2,0).. */
#define MC_DIM_PRIOR     MODEL_INPUTS /* draw dimension that picks a row of the prior          */
#define MC_DIM           (MODEL_INPUTS + 1) /* draw dimensions per sample                            */
#define MC_FUTURES_MAX   4
#define MC_PRIORS_MAX    8
#define MC_HORIZON_MAX_S 30.0f
#define MC_RISKS         3    /* safe headways are given at 5, 1 and 0.1 %             */
#define MC_HIST_BINS     8192 /* of 0.125 m; last bin = overflow                       */

/* Sampled values below a floor are lifted to it, and the sample is counted in mc_result.floored. */
enum mc_floor { MC_FLOOR_HEADWAY, MC_FLOOR_MU, MC_FLOOR_MASS, MC_FLOOR_DELAY, MC_FLOORS };

/* What may be true of the lead, each sample picking one row: what it does next (al becomes gain * al + offset), and where
 * what the ego meets first really is (added to headway and vl): another object, or so far ahead that it is never met. */
struct mc_prior {
	float weight;      /* >= 0; the weights of a request sum to 1 (+-1e-3) */
	float gain;        /* [1] */
	float offset_mps2; /* [m/s2] */
	float headway_m;   /* [m], added */
	float speed_mps;   /* [m/s], added; below 0 the sum is lifted to standstill */
};

/* flags of a request */
#define MC_WANT_HIST   1u /* fill stop and need histograms and the figures derived from them */
#define MC_WANT_IMPACT 2u /* impact speed of colliding samples */
#define MC_ROLLING_IS_CONTACT \
	4u /* the paper's verdict: still rolling at the horizon counts as contact */

struct mc_request {
	uint64_t
		id; /* >= 1; a cut ends all requests up to its id, so no later one may have such an id */
	uint32_t n; /* samples, >= 1; beyond the resident draws they are generated on the fly */
	uint32_t flags;
	uint32_t n_futures; /* 1..MC_FUTURES_MAX */
	uint32_t n_priors;  /* 0 (hold al) .. MC_PRIORS_MAX */
	float mean[MODEL_INPUTS];
	float factor[MC_FACTOR_LEN]; /* lower triangle of the 5 correlated inputs, SI units */
	float sigma[MODEL_INPUTS - MC_STATE_DIM]; /* of MODEL_MU..MODEL_DELAY, >= 0 */
	float floor[MC_FLOORS];
	float horizon_s;      /* T_max, 10 in the paper; (0, 30] */
	float centre_m;       /* integer centre of the sums; any finite value near the mean */
	uint32_t hist_future; /* which future the histograms describe */
	struct model_vehicle vehicle;
	struct model_future future[MC_FUTURES_MAX];
	struct mc_prior prior[MC_PRIORS_MAX];
};

/* A proportion with its two-sided 95 % Wilson interval. Samples that are undecided count as contact only in hi.
 * With no hits p is 0, lo is 0 and hi is 3/n: print "below 3/N", never 0 (p_is_bound).
 * Without any sample (cut at once) p is NaN and the interval 0..1. */
struct mc_risk {
	uint64_t hits;
	uint64_t undecided;
	double p, lo, hi; /* 0..1 */
	double impact_mps; /* mean closing speed of the colliding samples; NaN if none or not wanted */
	uint32_t p_is_bound; /* 1: no hit, quote hi as an upper bound */
};

/* flags of a result */
#define MC_RES_CUT 1u /* a deadline cut the batch: n < the request's n */

struct mc_result {
	uint64_t id;       /* the request's */
	uint64_t req_hash; /* mc_request_hash() of what the backend computed */
	uint64_t n;        /* samples evaluated */
	uint64_t floored;  /* of them, with an input lifted to a floor */
	uint32_t flags;
	uint32_t n_futures;
	struct mc_risk risk[MC_FUTURES_MAX];
	/* with MC_WANT_HIST, of future hist_future; NaN otherwise */
	double stop_mean_m, stop_sd_m; /* over samples that stopped or reached the horizon */
	double headway_m[MC_RISKS];    /* mean headway at which the risk is 5, 1, 0.1 % */
};

extern const double mc_risk_level[MC_RISKS]; /* 0.05, 0.01, 0.001 */

/* Who runs the requests: the caller inside mc_submit (replay, tools), or one compute thread that sleeps or spins (on a
 * core of its own) until the next one comes. */
enum mc_worker { MC_INLINE, MC_WORKER, MC_WORKER_SPINS };

/* How to open a backend. */
enum mc_draws_kind { MC_SOBOL, MC_PHILOX };
struct mc_params {
	enum mc_draws_kind kind;
	uint64_t seed;
	uint32_t n_resident;    /* draws kept in memory; 1..2^24 */
	uint32_t threads;       /* CPU backend: 1 = the calling thread alone */
	float truncate[MC_DIM]; /* two-sided, in sigma; 0 = none (6.3 sigma by construction) */
	const char *variant;    /* lane variant by name; NULL = best this processor has */
};

/* What the thread that runs batches passes, in order (mc_edge.def). */
enum mc_edge {
#define MC_EDGE(name, doc) MC_EDGE_##name,
#include "mc_edge.def"
	MC_EDGES
};
extern const char *const mc_edge_name[MC_EDGES]; /* "TAKEN", ... */

/* Who is told of it, in that thread. Must not block or allocate. */
struct mc_watch {
	void (*hello)(const void *arg); /* once, before any edge; may allocate */
	void (*edge)(const void *arg, enum mc_edge e, uint64_t id);
	const void *arg;
};

struct mc;
struct mc_ops;

/**
 * mc_check - is this a request that can be run?
 * Returns 0, or -EINVAL for NaN, infinity or a figure beyond +-1e6, a negative sigma or floor or diagonal of the
 * factor, mean mass or mean friction or tau <= 0, an unknown flag, and whatever lies outside the range written beside
 * it: horizon, counts, weights, grade, futures, vehicle. Means of speeds, headway, C_d and delay may be negative: a
 * filter's may, and samples are lifted. The id is not looked at. Pure; every backend calls it first.
 */
int mc_check(const struct mc_request *req);

/**
 * mc_request_hash - 64-bit hash of a request's content, the same on any machine
 * FNV-1a over its words in little-endian order, without the id and without unused futures and priors. Pure.
 */
uint64_t mc_request_hash(const struct mc_request *req);

/**
 * mc_preset_paper - the request of the paper (Sec. IV): standing lead, braking from t = 0, one future of -6 m/s2.
 * @headway_m: mean headway [m]     @n: samples
 */
void mc_preset_paper(struct mc_request *req, float headway_m, uint32_t n);

/**
 * mc_open - open a backend behind a mailbox
 * @ops:    the backend                     @p: how to open it
 * @worker: enum mc_worker
 * @ret:    the handle; untouched on failure
 * Allocates; blocks while draws are made. Returns 0 or -errno of the backend. One thread uses a handle at a time; the
 * compute thread takes no signals.
 */
int mc_open(const struct mc_ops *ops, const struct mc_params *p, int worker, struct mc **ret);

/**
 * mc_submit - hand over a request; the newest wins
 * Never blocks on the worker, never allocates. Returns 0; 1 if an unstarted request was replaced; -EINVAL as mc_check()
 * or for id 0, which no cut could name.
 * With an inline handle the batch has run when it returns.
 */
int mc_submit(struct mc *mc, const struct mc_request *req);

/**
 * mc_poll - fetch the newest finished result
 * Returns 1 with @res filled, 0 if none since the last call, -errno if the backend failed (the request's id is in
 * res->id). Never blocks, never allocates.
 */
int mc_poll(struct mc *mc, struct mc_result *res);

/** mc_busy - 1 while a request is submitted and its result not yet finished. Never blocks. */
int mc_busy(const struct mc *mc);

/** mc_cut - ask the backend to end request @id (and any earlier one) at its next chunk. Never blocks. */
void mc_cut(struct mc *mc, uint64_t id);

/**
 * mc_watch - from now on @w is told; once for a handle, before its first request
 * Waits up to 200 ms until the compute thread has said hello. Returns 0 or -ETIMEDOUT.
 */
int mc_watch(struct mc *mc, const struct mc_watch *w);

/** mc_eventfd - becomes readable when a result is finished; -1 for an inline handle. */
int mc_eventfd(const struct mc *mc);

/** mc_thread - the compute thread (for scheduling policy), or 0 for an inline handle. */
unsigned long mc_thread(const struct mc *mc);

/**
 * mc_close - stop the worker and free; NULL is fine
 * A worker that does not answer within 200 ms is abandoned: since it may still write to them, the handle, the backend
 * and the descriptors are then left alone for the rest of the process.
 */
void mc_close(struct mc *mc);

#endif
