/* SPDX-License-Identifier: MIT
 * Made-up drives: an ego car and others on a road, stepped by 1 ms, seen by a radar with noise, latency and
 * dropouts, and written as the frames of a mapping. What happens is a row of a table. Same seed, same frames, on any machine.
 */
#ifndef AEBMC_DRIVE_H
#define AEBMC_DRIVE_H

#include <stdint.h>
#include "config.h"
#include "mapping.h"

#define DRIVE_TARGETS_MAX 3
#define DRIVE_PHASES_MAX  8
#define DRIVE_STEP_S      0.001

/* From @start_s on the car seeks this acceleration, its jerk limited; it never drives backwards. */
struct drive_phase {
	double start_s, accel_mps2;
	double jerk_mps3; /* 0: 10, a hard pedal; INFINITY: at once */
};

struct drive_path {
	double speed_mps;                           /* at the start */
	struct drive_phase phase[DRIVE_PHASES_MAX]; /* in order; ends at start_s 0 */
};

/* Another car: where it starts, how it drives, and when it changes from one lateral offset to another. */
struct drive_target {
	double gap_m; /* ego front to its rear, at the start */
	struct drive_path path;
	double lateral_m, to_lateral_m; /* left positive */
	double change_s, changed_s;     /* begin and end of the change; both 0: none */
	/* how the radar sees it */
	double existence;      /* what it says of it; 0: 0.99 */
	double seen_m, lost_m; /* reported below the first gap and above the second; 0: always */
	double missed;         /* probability that a scan misses it, beside the radar's own */
	int no_obstacle;       /* 1: can be driven over */
};

struct drive {
	const char *name, *doc;
	double end_s; /* or at contact, if that is sooner */
	struct drive_path ego;
	int n;
	struct drive_target target[DRIVE_TARGETS_MAX];
	double curvature_pm; /* of the road, left positive */
};

/* All drives, ended by a row without a name. */
extern const struct drive drive_table[];

/* The truth at one moment. */
struct drive_car {
	double speed_mps, accel_mps2;
	double gap_m, lateral_m; /* of others: ego front to rear, left positive */
};

struct drive_truth {
	double t_s; /* since the start of the drive */
	struct drive_car ego, target[DRIVE_TARGETS_MAX];
	int driver_brakes; /* the pedal */
};

/** drive_find - by name, or NULL. */
const struct drive *drive_find(const char *name);

/** drive_begin - the truth at the start. Pure. */
struct drive_truth drive_begin(const struct drive *d);

/** drive_accel - the acceleration one millisecond after @accel_mps2 of a car on path @p at time @t_s. Pure. */
double drive_accel(const struct drive_path *p, double t_s, double accel_mps2);

/** drive_step - one millisecond on: every car follows its path. Pure. */
void drive_step(const struct drive *d, struct drive_truth *w);

/** drive_others - the same for all but the ego, which the caller has moved: @ego_before_mps was its speed. Pure. */
void drive_others(const struct drive *d, struct drive_truth *w, double ego_before_mps);

/** drive_contact - index of a car within @corridor_m to either side that the ego has reached, -1 for none. Pure. */
int drive_contact(const struct drive *d, const struct drive_truth *w, double corridor_m);

struct drive_options {
	uint64_t seed;
	double dropout; /* probability that a scan misses a target, 0..1 */
	/* Called for every frame in order of time. @now: the truth at the frame's stamp, not as the radar saw it. A nonzero
	 * return ends the drive. */
	int (*emit)(void *arg, const struct bus_frame *f, const struct drive_truth *now);
	void *arg;
};

/**
 * drive_run - the frames of a drive, from DRIVE_START_NS on
 * @cfg: noise (range_sigma, rate_sigma, ego_sigma), latency and scan period of the sensors
 * @map: frames, periods and protection. Of several targets a radar with one slot reports the nearest within @cfg's
 * corridor; one with more slots reports all and moves them between slots; one with a list reports all by number.
 * Returns 0, or what @emit returned. No allocation.
 */
int drive_run(const struct drive *d, const struct config *cfg, const struct mapping *map,
	      const struct drive_options *o);

#define DRIVE_START_NS 100000000000LL

#endif
