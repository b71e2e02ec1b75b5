/* SPDX-License-Identifier: MIT
 * Decision, result and state to the frames of our contract (can-dbc/aebmc.dbc), and back (for `aebmc decode`).
 * "No data" is never encoded as "no risk": what is unknown carries the signal's not-available value.
 */
#ifndef AEBMC_PUBLISH_H
#define AEBMC_PUBLISH_H

#include "bus.h"
#include "config.h"
#include "contract.h"
#include "decision.h"
#include "fault.h"
#include "mc.h"
#include "scene.h"
#include "stage.h"

/* Our messages, in the order of the contract; identifiers follow each other from bus.request_id. */
enum publish_msg {
	PUBLISH_REQUEST,
	PUBLISH_RISK,
	PUBLISH_MARGIN,
	PUBLISH_STATUS,
	PUBLISH_TIMING,
	PUBLISH_MSGS
};

enum publish_backend {
	PUBLISH_BACKEND_NONE,
	PUBLISH_BACKEND_CPU,
	PUBLISH_BACKEND_GPU,
	PUBLISH_BACKENDS
};
extern const char *const publish_backend_name[PUBLISH_BACKENDS]; /* "none", "cpu", "cuda" */

/* Since start; -1: unknown. */
struct publish_stage {
	uint64_t misses;
	int64_t p99_ns, max_ns;
};

/* Everything a frame may carry; the pipeline keeps it current. */
struct publish_in {
	enum state state;
	uint32_t fault;
	struct decision dec;
	int have_scan;   /* 0: the decision rests on no scan, and the TTL is 0 */
	int64_t scan_ns; /* time of the scan that the decision rests on, for the TTL */
	int have_result; /* 0: probability and risk figures are "not available" */
	struct mc_result res;
	struct scene scene; /* of the decision */
	uint64_t eval_id;   /* last evaluation; 0 = none yet */
	uint64_t skipped, late, stage_miss, period_miss;
	int64_t input_age_ns, mc_ns, decision_ns, total_ns; /* last evaluation; -1 unknown */
	struct publish_stage stage[STAGES];                 /* current when AEB_TIMING is packed */
	uint16_t hash;                                      /* contract and configuration */
	uint32_t
		samples; /* in the last batch; before one, what the backend will run; 0 without a backend */
	enum publish_backend backend;
	int withheld; /* 1: decide, but say "no request": no arm command is in force */
};

struct publish; /* counters of each message */

/** publish_open - ids, interface, TTL and transmit mode from @cfg. Allocates. 0 or -errno. */
int publish_open(const struct config *cfg, struct publish **ret);

/**
 * publish_pack - one frame, protected, at @now_ns. Advances that message's counter. No allocation.
 * P_COLLISION, P_LOW and P_HIGH are those of FUTURE_DEFER: the risk if full braking waits one decision period, which is
 * what the receiver can still change. Without a hit the bound 3/N stands, flagged. Past its TTL a result is not
 * available. What exceeds a signal's range saturates.
 */
void publish_pack(struct publish *p, enum publish_msg which, const struct publish_in *in,
		  int64_t now_ns, struct bus_frame *f);

/** publish_words - a frame of ours, by its identifier on any interface, in plain words, one line, units stated. 0;
 * -ENOMSG if it is not ours, -EBADMSG if its length or checksum is wrong (the line says so). */
int publish_words(const struct publish *p, const struct bus_frame *f, char *line, int size);

void publish_close(struct publish *p); /* NULL is fine */

#endif
