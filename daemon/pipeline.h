/* SPDX-License-Identifier: MIT
 * The cycle: frame -> estimator -> scene -> budget -> request -> backend -> result -> decision -> frames.
 * The only file that sees all rooms. One struct cycle per evaluation, never allocated.
 */
#ifndef AEBMC_PIPELINE_H
#define AEBMC_PIPELINE_H

#include "bus.h"
#include "config.h"
#include "decision.h"
#include "fault.h"
#include "hist.h"
#include "mapping.h"
#include "mc.h"
#include "publish.h"
#include "scene.h"
#include "stage.h"
#include "trace.h"

struct cycle {
	uint64_t id;
	int64_t t_ns[EDGES]; /* when each edge was passed; 0 = not yet */
	struct scene scene;
	struct mc_request req;
	struct mc_result res;
	struct decision dec;
	struct bus_frame out[PUBLISH_MSGS];
};

/* Counters since start. */
struct pipeline_stats {
	uint64_t frames;               /* frames received on the configured interfaces */
	uint64_t scans;                /* radar scans ended */
	uint64_t evaluations;          /* results decided upon */
	uint64_t skipped;              /* scans not evaluated: the worker was busy */
	uint64_t stage_miss;           /* stages over their budget (stage.def) */
	uint64_t stage_misses[STAGES]; /* the same by stage */
	uint64_t late;                 /* results cut by the deadline, or older than their TTL */
	uint64_t period_miss;          /* request frames absent or more than 25 % late */
	uint64_t sent;                 /* frames handed to the bus */
	double risk_max;               /* largest P(defer) of any evaluation */
	uint32_t samples; /* per evaluation, on the backend in use; 0 before there is one */
};

struct recorder;

struct pipeline_open {
	const struct config *cfg;
	const struct mapping *map;
	struct bus *bus;
	struct mc *mc; /* runs mc.samples; NULL: none yet, pipeline_set_mc() brings it */
	enum publish_backend backend; /* what mc runs on, for STATUS */
	int quiet;                    /* 1: send nothing (transmit = none on a live bus) */
	int needs_arm; /* 1: "no request" until pipeline_arm() (transmit = armed on a live bus) */
	struct recorder *recorder; /* keeps frames and evaluations; NULL for none */
	/* Stamps within a step, clock_now_ns() when live. NULL on a log: all time is the bus's, so that the same log
	 * gives the same frames; times of computation are then "not available". */
	int64_t (*clock)(void);
	const struct trace_ops *trace; /* NULL: nobody is told */
	/* Called after every evaluation (a batch was run and decided upon); NULL for none. For CSV, traces, the recorder;
	 * must not block when live. t_ns[EDGE_SEND] is 0 where the next periodic request frame will carry it. */
	void (*on_cycle)(void *arg, const struct cycle *c, enum state state);
	/* Called when level or state changed, whatever the cause; NULL for none. @now: what the frames say from here on. */
	void (*on_change)(void *arg, int64_t t_ns, const struct publish_in *now);
	void *arg; /* of both */
};

struct pipeline;

/** pipeline_open - takes no ownership; everything @o points to must outlive it. Allocates. 0 or -errno. */
int pipeline_open(const struct pipeline_open *o, struct pipeline **ret);

/**
 * pipeline_step - wait for the next event (frames, a result, a period) and deal with it
 * Returns 0, -ENODATA at the end of a log, -errno of the bus. No allocation; bounded work; blocks at most until the
 * next period.
 */
int pipeline_step(struct pipeline *p);

/** pipeline_request - the request a scene leads to (means, factor, futures, priors). Pure. 0, or -EINVAL when the
 * covariance is not positive definite (rows that are all zero are allowed: known exactly). */
int pipeline_request(const struct config *cfg, const struct scene *s, uint64_t id,
		     struct mc_request *req);

/* What each row of such a request's prior says, in words. The first ones are of the lead, the others of what else is met. */
#define PIPELINE_LEAD_ROWS 4
extern const char *const pipeline_prior_words[MC_PRIORS_MAX];

/* The next eight may be called from another thread than pipeline_step's; they do not block. */

/** pipeline_set_mc - the backend is open: from the next step on scans are evaluated (until then the state is INIT), with
 * @samples each. */
void pipeline_set_mc(struct pipeline *p, struct mc *mc, enum publish_backend backend,
		     uint32_t samples);

/** pipeline_set_spare - the CPU backend, open beforehand: takes over for good, with @samples, when the GPU fails or does
 * not answer. Call before pipeline_set_mc(). */
void pipeline_set_spare(struct pipeline *p, struct mc *spare, uint32_t samples);

/** pipeline_set_config - use @cfg for decisions from the next step on. Options that size or wire anything are read at
 * open alone; both configurations must outlive the pipeline. */
void pipeline_set_config(struct pipeline *p, const struct config *cfg);

/** pipeline_check_config - are configuration, mapping and contract still those whose hash the frames carry? Memory that
 * changed under them is FAULT. By the thread that calls pipeline_set_config(), now and then. */
void pipeline_check_config(struct pipeline *p);

/** pipeline_arm - 1: requests may go out (bus.transmit = armed); 0: they are sent as "no request". A FAULT disarms. */
void pipeline_arm(struct pipeline *p, int on);

/** pipeline_armed - is an arm command in force? */
int pipeline_armed(const struct pipeline *p);

/** pipeline_raise - reasons found outside the pipeline (a refused real-time setting); they stay. */
void pipeline_raise(struct pipeline *p, uint32_t fault);

/** pipeline_mark - have the recorder keep what is around now. */
void pipeline_mark(struct pipeline *p);

/** pipeline_finish - the last frames: no request, INHIBIT. Called by pipeline_step's thread. */
void pipeline_finish(struct pipeline *p);

/** pipeline_now - what the frames say at present. Called by pipeline_step's thread. */
const struct publish_in *pipeline_now(const struct pipeline *p);

const struct pipeline_stats *pipeline_stats(const struct pipeline *p);
const struct hist *pipeline_hist(const struct pipeline *p); /* [STAGES]; any thread may read it */
const struct decision_state *pipeline_decision(const struct pipeline *p);
const uint64_t *pipeline_rejected(const struct pipeline *p); /* [SCENE_REJECTS] */

void pipeline_close(struct pipeline *p); /* NULL is fine */

#endif
