/* SPDX-License-Identifier: MIT
 * Radar frames to scans: which frames belong together, when a scan is complete, and which of its objects are kept. Slots
 * that are all sent in every scan, slots or a list of objects after a header (mapping.h). Knows no filter or object over
 * time.
 */
#ifndef AEBMC_SCAN_H
#define AEBMC_SCAN_H

#include <stdint.h>
#include "decode.h"

struct scan {
	const struct mapping *map;
	double existence_min;
	int open;                  /* a scan is being received */
	int64_t first_ns, last_ns; /* reception of its first and last frame */
	uint64_t seen;             /* slots */
	int count;                 /* objects announced, -1: not known */
	int objects, qualities;    /* frames of them so far */
	uint32_t incomplete;       /* scans in a row that brought fewer than announced */
	int n;                     /* targets */
	struct detection det[MAP_TRACKS_MAX];
};

/** scan_open - nothing received yet; @map must outlive it. */
void scan_open(struct scan *s, const struct mapping *map, double existence_min);

/** scan_breaks - 1 if the frame is of the next scan, so that the open one has ended without its last frame. Pure. */
int scan_breaks(const struct scan *s, const struct decode_frame *d);

/**
 * scan_add - take one radar frame (part is not MAP_NO_PART), received at @t_ns
 * Of more than MAP_TRACKS_MAX objects the nearest are kept. Returns 1 if it was the scan's last. No allocation.
 */
int scan_add(struct scan *s, const struct decode_frame *d, int64_t t_ns);

/** scan_end - close it: targets that are too unlikely are dropped, what was announced and did not come is noted. */
void scan_end(struct scan *s);

/** scan_forget - the open scan is nothing. */
void scan_forget(struct scan *s);

#endif
