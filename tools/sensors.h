/* SPDX-License-Identifier: MIT
 * The sensors of a made-up drive: from what is true to a radar's and a speedometer's frames through a mapping, with
 * noise, latency, lag and dropouts. Stepped by 1 ms beside the cars. Same seed, same frames, on any machine.
 */
#ifndef AEBMC_SENSORS_H
#define AEBMC_SENSORS_H

#include "drive.h"
#include "encode.h"
#include "noise.h"

#define SENSORS_HISTORY_MS 1024 /* longer than any latency */

/* A nonzero return ends the step. @now: the truth at the frame's stamp, not as the sensors saw it. */
typedef int (*sensors_emit)(void *arg, const struct bus_frame *f, const struct drive_truth *now);

struct sensors_params {
	uint64_t seed;
	double range_sigma_m, rate_sigma_mps, ego_sigma_mps; /* noise of one measurement */
	double latency_s, ego_latency_s;                     /* age of what a frame says, < 1 s */
	double period_s;                                     /* between scans */
	double rate_lag_s; /* first-order lag of the relative speed, 0: none */
	double ego_scale;  /* what the speedometer says of 1 m/s */
	double dropout;    /* probability that a scan misses a target */
	double burst;      /* the same after a scan that missed it, where larger */
	double corridor_m; /* a radar with one slot reports the nearest car within it */
};

struct sensors {
	const struct drive *drive;
	const struct mapping *map;
	struct sensors_params p;
	struct encode encode;
	struct noise noise;
	struct drive_truth history[SENSORS_HISTORY_MS];
	int64_t t_ns;
	int64_t due_ns[MAP_MESSAGES_MAX]; /* of ego messages */
	int64_t scan_due_ns;
	double rate_mps[DRIVE_TARGETS_MAX]; /* as the radar has it, lag included */
	int missed[DRIVE_TARGETS_MAX];
	int slot[DRIVE_TARGETS_MAX]; /* where each target is reported; -1: not yet */
	struct detection det[MAP_TRACKS_MAX];
	int filled[MAP_TRACKS_MAX];
	int n_listed;             /* of det, where the radar sends a list */
	int next_frame, n_frames; /* of the scan being sent */
	sensors_emit emit;
	void *arg;
};

/** sensors_nominal - noise, latency and period that @cfg assumes; no dropout, no lag. */
struct sensors_params sensors_nominal(const struct config *cfg, uint64_t seed);

/** sensors_open - the first frame is stamped DRIVE_START_NS or soon after; @d and @map must outlive it. No allocation. */
void sensors_open(struct sensors *s, const struct drive *d, const struct mapping *map,
		  const struct sensors_params *p);

/**
 * sensors_step - the frames of one millisecond, in order
 * @now: the truth at its beginning
 * Of several targets a radar with one slot reports the nearest within its corridor; one with more slots reports all and
 * moves them between slots. Returns 0, or what @emit returned. No allocation.
 */
int sensors_step(struct sensors *s, const struct drive_truth *now, sensors_emit emit, void *arg);

/** sensors_past - what was true @ago_s before the last step, 0..1 s. */
const struct drive_truth *sensors_past(const struct sensors *s, double ago_s);

#endif
