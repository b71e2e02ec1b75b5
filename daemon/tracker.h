/* SPDX-License-Identifier: MIT
 * Objects over scans: which detection belongs to which object, which object is the lead. An object is known by its
 * place and speed, never by its slot in the radar. Knows no frame or mapping; time comes with each measurement.
 */
#ifndef AEBMC_TRACKER_H
#define AEBMC_TRACKER_H

#include <stdint.h>
#include "config.h"
#include "decode.h"
#include "kalman.h"

#define TRACKER_OBJECTS_MAX (2 * MAP_TRACKS_MAX) /* seen now, and coasting */

struct tracker_object {
	struct kalman k;
	double lateral_m, lateral_mps; /* averaged over about confirm_scans scans, left positive */
	double existence;
	int64_t seen_ns; /* reception of its last detection */
	uint32_t id;     /* from 1, never used twice */
	uint32_t hits;   /* scans with a detection that was not fresh */
	uint32_t missed; /* scans in a row without one */
};

struct tracker {
	const struct config *cfg;
	struct kalman ego; /* the ego alone; valid if ego_valid */
	int ego_valid;
	double curvature, curvature_sigma; /* of the ego's path, left positive [1/m] */
	int64_t scan_ns;                   /* measurement time of the last scan */
	double step_s;                     /* from the scan before it to the last one */
	uint32_t last_id, lead_id;         /* id given last; the lead's, 0 for none */
	int n;
	struct tracker_object object[TRACKER_OBJECTS_MAX]; /* oldest first */
	double cost[TRACKER_OBJECTS_MAX][MAP_TRACKS_MAX];
};

/* One radar scan. */
struct tracker_scan {
	int64_t t_ns;     /* when it was measured */
	int64_t seen_ns;  /* when it was received */
	double curvature; /* of the ego's path; 0 where unknown */
	double curvature_sigma;
	int n;
	struct detection det[MAP_TRACKS_MAX];
};

/** tracker_open - @cfg must outlive it. */
void tracker_open(struct tracker *t, const struct config *cfg);

/** tracker_reset - forget the ego and every object. */
void tracker_reset(struct tracker *t);

/** tracker_ego_speed - take one ego speed, measured at @t_ns, into the ego's and every object's filter. */
void tracker_ego_speed(struct tracker *t, int64_t t_ns, double speed_mps);

/**
 * tracker_scan - take one scan: follow, begin, drop objects and choose the lead
 * Does nothing before the first ego speed. No allocation; at most objects x detections x detections steps.
 */
void tracker_scan(struct tracker *t, const struct tracker_scan *s);

/** tracker_lead - the nearest confirmed object in the corridor, or NULL. */
const struct tracker_object *tracker_lead(const struct tracker *t);

/** tracker_confirmed - seen often enough to count? */
int tracker_confirmed(const struct tracker *t, const struct tracker_object *o);

/** tracker_oncoming - does it surely come towards the ego? Then it is no lead. */
int tracker_oncoming(const struct tracker *t, const struct tracker_object *o);

/** tracker_lateral - an object's offset from the ego's path [m], left positive. */
double tracker_lateral(const struct tracker *t, const struct tracker_object *o);

#endif
