/* SPDX-License-Identifier: MIT
 * A recorded drive with another lead: from a given time on, the targets in the corridor are replaced by one that brakes.
 * The ego's own motion stays as recorded.
 */
#ifndef AEBMC_SPLICE_H
#define AEBMC_SPLICE_H

#include "drive.h"
#include "encode.h"
#include "estimator.h"
#include "noise.h"

#define SPLICE_ACCEL_MPS2 (-0.5 * 9.81)

struct splice {
	const struct config *cfg;
	const struct mapping *map;
	struct estimator *recorded; /* follows the recorded lead, from which ours takes over */
	struct decode decode;
	struct noise noise;
	double at_s;      /* when, from the first frame */
	int64_t first_ns; /* of the first frame */
	int scans;        /* since our lead took over; 0: not yet */
	int64_t t_ns;     /* time of ours and of the ego's speed */
	double gap_m, lead_mps, ego_mps, ego_mps2;
	struct detection det; /* what the radar says of ours in the present scan */
};

/** splice_open - @cfg and @map must outlive it. Allocates. 0 or -errno. */
int splice_open(struct splice *s, const struct config *cfg, const struct mapping *map, double at_s,
		uint64_t seed);

/**
 * splice_frame - take the next recorded frame and change it where needed
 * Ours takes over at the first scan after @at_s with a lead, at its place and speed, and brakes at SPLICE_ACCEL_MPS2.
 * Returns 0; 1 once ours is reached, where the drive ends. No allocation.
 */
int splice_frame(struct splice *s, struct bus_frame *f);

void splice_close(struct splice *s);

#endif
