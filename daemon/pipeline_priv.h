/* SPDX-License-Identifier: MIT
 * What the pipeline's files share: its state, and what goes out. pipeline.c decides when, pipeline_out.c says what.
 */
#ifndef AEBMC_PIPELINE_PRIV_H
#define AEBMC_PIPELINE_PRIV_H

#include "estimator.h"
#include <string.h>
#include "pipeline.h"
#include "recorder.h"

struct pipeline {
	struct pipeline_open o;
	struct estimator *est;
	struct publish *pub;
	struct mc *mc;
	int64_t period_ns, ttl_ns, budget_ns;
	int watched; /* the bus wakes us for a result */

	int64_t now_ns;
	int started;
	int64_t tick_ns;              /* next periodic request frame */
	int64_t due_ns[PUBLISH_MSGS]; /* next of the slower messages */

	struct fault_set faults;
	uint32_t once;      /* conditions seen since the last update */
	uint32_t lasting;   /* conditions that stand until taken back */
	struct scene scene; /* newest */

	struct cycle cycle; /* the last evaluation, or the one under way */
	/* The last decided one on its way out: its successor may be under way before it is confirmed. */
	struct {
		uint64_t id;
		int64_t t_ns[EDGES];
		int waits; /* for a request frame to carry it */
	} sent;
	struct hist hist[STAGES];
	uint64_t published; /* request frames on the period */
	int64_t clock_due_ns;
	uint64_t last_id;
	int running, waiting;     /* a batch is; a scan is, because a batch was */
	int64_t cut_ns, stuck_ns; /* when to cut the batch; when to give it up */

	/* written by another thread, read here; atomic */
	struct mc *offered_mc, *spare;
	enum publish_backend offered_backend;
	uint32_t offered_samples, spare_samples;
	const struct config *offered_cfg;
	uint16_t hash; /* of offered_cfg, as the frames carry it */
	int arm, mark;
	uint32_t outside; /* reasons found outside the pipeline */

	struct decision_state dec;
	struct publish_in in;
	struct pipeline_stats stats;
};

/** pipeline_take_offers - take over what another thread has put there since the last step. */
void pipeline_take_offers(struct pipeline *p);

/** pipeline_event - have the recorder keep what is around now; nothing without a recorder. */
void pipeline_event(struct pipeline *p, enum recorder_reason why);

/** pipeline_stamp - now, within a step. */
int64_t pipeline_stamp(const struct pipeline *p);

/** pipeline_edge - the present cycle passed @e at @at_ns: stamp it, close and count the stages that end there. */
void pipeline_edge(struct pipeline *p, enum edge e, int64_t at_ns);

/** pipeline_miss - count @count of a kind, have the recorder keep what is around; @stage: its name, or ""; @late_ns: by how much, 0 if that has no meaning. */
void pipeline_miss(struct pipeline *p, enum miss kind, uint64_t cycle, const char *stage,
		   uint64_t count, int64_t late_ns);

/** pipeline_decided, pipeline_sent, pipeline_confirm - the way out: decided now; carried by @f, handed to the bus at
 * @at_ns; seen back, if the bus says so since. */
void pipeline_decided(struct pipeline *p);
void pipeline_sent(struct pipeline *p, const struct bus_frame *f, int64_t at_ns);
void pipeline_confirm(struct pipeline *p);

/** pipeline_stages - what AEB_TIMING says of each stage. A log's time knows no computation: of it, the inputs' age alone. */
void pipeline_stages(struct pipeline *p);

/** pipeline_tell_* - events for the tracer: the cycle's figures; reasons that changed since @was; both clocks, once a
 * second. */
void pipeline_tell_evaluation(const struct pipeline *p);
void pipeline_tell_faults(const struct pipeline *p, uint32_t was);
void pipeline_tell_clock(struct pipeline *p);

/** pipeline_stale_ns - when what is fresh at now_ns goes stale unless more is heard; CLOCK_NEVER if nothing is fresh. */
int64_t pipeline_stale_ns(const struct pipeline *p);

/** pipeline_faults - raise and clear reasons by what is known at now_ns; have the recorder keep what is around a new one. */
void pipeline_faults(struct pipeline *p);

/** pipeline_trusted - 1 if inputs may be judged by: in other states no batch is run and every figure is "not
 * available". */
int pipeline_trusted(const struct pipeline *p);

/** pipeline_state - from faults and decision to what the frames say; 1 if level or state is a new one. */
int pipeline_state(struct pipeline *p, struct decision dec);

/** pipeline_send - one frame; the first AEB_REQUEST after a decision completes its cycle. */
void pipeline_send(struct pipeline *p, enum publish_msg which);

#endif
