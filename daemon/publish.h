/* SPDX-License-Identifier: MIT
 * Decision, result and state to the frames of our contract (can-dbc/aebmc.dbc), and back (for `aebmc decode`).
 * "No data" is never encoded as "no risk": what is unknown carries the signal's not-available value.
 */
#ifndef AEBMC_PUBLISH_H
#define AEBMC_PUBLISH_H

#include "bus.h"
#include "config.h"
#include "decision.h"
#include "fault.h"
#include "mc.h"
#include "scene.h"

enum publish_msg { PUBLISH_REQUEST, PUBLISH_RISK, PUBLISH_STATUS, PUBLISH_TIMING, PUBLISH_MSGS };

/* Everything a frame may carry; the pipeline keeps it current. */
struct publish_in {
	enum state state;
	uint32_t fault;
	struct decision dec;
	uint64_t eval_id;  /* of the result; 0 = none yet */
	int64_t result_ns; /* time of its scan, for the TTL */
	int have_result;   /* 0: probability and risk figures are "not available" */
	struct mc_result res;
	struct scene scene;
	uint64_t skipped, late, stage_miss, period_miss;
	int64_t mc_ns,
		total_ns; /* last evaluation: backend, and scan end to decision; -1 unknown */
	uint16_t hash;    /* contract and configuration */
	uint32_t samples;
	int on_gpu;
};

struct publish; /* counters of each message */

/** publish_open - ids and interface from @cfg. Allocates. */
int publish_open(const struct config *cfg, struct publish **ret);

/** publish_pack - one frame, protected, at @now_ns. Advances that message's counter. No allocation. */
void publish_pack(struct publish *p, enum publish_msg which, const struct publish_in *in,
		  int64_t now_ns, struct bus_frame *f);

/** publish_words - a frame of ours in plain words, one line, units stated. -ENOMSG if it is not ours, -EBADMSG if its
 * check fails (the line says so). */
int publish_words(const struct publish *p, const struct bus_frame *f, char *line, int size);

void publish_close(struct publish *p); /* NULL is fine */

#endif
