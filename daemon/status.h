/* SPDX-License-Identifier: MIT
 * A snapshot of the daemon, written by the real-time thread, read by the housekeeping thread: what the status socket,
 * the service manager and `aebmc top` show. Plain data.
 */
#ifndef AEBMC_STATUS_H
#define AEBMC_STATUS_H

#include <stdio.h>

#include "link.h"
#include "pipeline.h"

struct status {
	int64_t t_ns;   /* when it was taken */
	uint64_t steps; /* of the real-time loop: its sign of life */
	struct publish_in now;
	struct pipeline_stats stats;
	struct bus_stats bus;
	struct decision_state dec;
	uint64_t rejected[SCENE_REJECTS];
	int64_t confirmed_ns; /* when an own frame was last seen back; 0 never */
	int64_t transmit;     /* as bus.transmit */
	int64_t armed;        /* 1: an arm command is in force */
};

/* What the housekeeping thread adds. */
struct status_link {
	const char *name;
	int up;
	struct link_state link;
};

/** status_json - one line of JSON, schema "aebmc.status.1". @hist: [STAGES] */
void status_json(const struct status *s, const struct hist *hist, const struct status_link *links,
		 int n_links, FILE *out);

/** status_words - one short line for the service manager. Returns its length. */
int status_words(const struct status *s, char *line, int size);

#endif
