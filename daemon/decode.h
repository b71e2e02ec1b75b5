/* SPDX-License-Identifier: MIT
 * One frame to measurements, by the roles of the mapping. Every check is on unless the mapping waives it; what fails is
 * counted by reason and goes no further. Knows no object, filter or scan.
 */
#ifndef AEBMC_DECODE_H
#define AEBMC_DECODE_H

#include <stdint.h>
#include "bus.h"
#include "e2e.h"
#include "mapping.h"
#include "scene.h"

#define DECODE_NEVER (INT64_MIN / 2) /* before all times, with room for differences */

/* A target in one radar message. */
struct detection {
	double distance_m, rate_mps; /* ego front to target; target minus ego */
	double lateral_m;            /* left positive; 0 where not mapped */
	double existence;            /* 0..1; 1 where not mapped */
	double distance_sigma_m,
		rate_sigma_mps; /* 1 sigma, as the radar says; 0 where it does not */
	uint32_t id;            /* its number in a list; 0 where targets have slots */
	int fresh;              /* just appeared in its slot */
};

/* What one accepted frame says. */
struct decode_frame {
	int message; /* index into the mapping */
	enum map_part part;
	int track;  /* radar slot, -1 for none */
	int target; /* 1: the slot holds a target, in det */
	int count;  /* of a header: objects that follow; -1: it does not say */
	/* Of MAP_QUALITY: id, existence and sigmas alone. */
	struct detection det;
	uint32_t roles;          /* bit MAP_*: value[] is set */
	double value[MAP_ROLES]; /* mean of the role's signals in this message, SI */
};

struct decode_message {
	struct e2e_state e2e;
	int64_t t_ns;  /* last frame that passed its check */
	uint32_t wait; /* good frames still to come before one is used */
	uint32_t
		refused; /* frames in a row that failed their check, or whose target has no place */
};

struct decode {
	const struct mapping *map;
	double existence_min, range_max_m;
	struct decode_message message[MAP_MESSAGES_MAX];
	uint64_t rejected[SCENE_REJECTS];
};

/* What reading a signal gave; all but the first leave no value. */
enum decode_got {
	DECODE_OK,
	DECODE_ABSENT, /* not in this frame of a multiplexed message */
	DECODE_NOT_AVAILABLE,
	DECODE_OUT_OF_RANGE /* of the database, or of its table */
};

/** decode_value - a mapped signal in a frame of @msg, which has its length: the SI value in *@si, untouched without one. Pure. */
enum decode_got decode_value(const struct map_signal *s, const struct dbc_message *msg,
			     const uint8_t *data, double *si);

/** decode_open - @map must outlive it. */
void decode_open(struct decode *d, const struct mapping *map, double range_max_m,
		 double existence_min);

/** decode_distrust - forget all counters; of every message the E2E_START'th good frame is the first one used. */
void decode_distrust(struct decode *d);

/**
 * decode_take - check and decode one frame
 * Returns 1 with @out filled; 0 if it is not mapped, remote, an error frame, refused, or not trusted yet.
 * No allocation, bounded work.
 */
int decode_take(struct decode *d, const struct bus_frame *f, struct decode_frame *out);

#endif
