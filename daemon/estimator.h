/* SPDX-License-Identifier: MIT
 * Frames in, scene out: decoding by role, end of scan, objects followed by association in range and speed, choice of
 * the lead in the ego's corridor, a filter that yields the state with its covariance, plausibility, staleness.
 * Knows the mapping; knows no Monte Carlo, decision or output frame. Allocates at open only. Not thread-safe.
 */
#ifndef AEBMC_ESTIMATOR_H
#define AEBMC_ESTIMATOR_H

#include "bus.h"
#include "config.h"
#include "mapping.h"
#include "scene.h"

struct estimator;

/** estimator_open - @cfg and @map must outlive it. Allocates. 0 or -errno. */
int estimator_open(const struct config *cfg, const struct mapping *map, struct estimator **ret);

/**
 * estimator_frame - take one frame
 * Verifies length, checksum, counter, "not available" and range; what fails is counted and never used.
 * Returns 1 if this frame ended a radar scan, 0 otherwise. No allocation, bounded work.
 */
int estimator_frame(struct estimator *e, const struct bus_frame *f);

/** estimator_deadline - when a pending scan ends by silence [ns], CLOCK_NEVER if none is pending. */
int64_t estimator_deadline(const struct estimator *e);

/** estimator_tick - time passes without a frame. Returns 1 if a scan ended by silence at or before @now_ns. */
int estimator_tick(struct estimator *e, int64_t now_ns);

/** estimator_stale_ns - when the next required input goes stale unless it is heard before [ns]: an instant after @now_ns,
 * CLOCK_NEVER if none is fresh. */
int64_t estimator_stale_ns(const struct estimator *e, int64_t now_ns);

/**
 * estimator_scene - the scene, predicted to @now_ns
 * Call after a scan ended, or any time to learn what is stale. Never fails: what is missing is in s->fault and
 * the valid flags.
 */
void estimator_scene(struct estimator *e, int64_t now_ns, struct scene *s);

/** estimator_rejected - counters by reason, [SCENE_REJECTS]; never reset. */
const uint64_t *estimator_rejected(const struct estimator *e);

/** estimator_distrust - after a clock step or a stall: forget everything; of each message the E2E_START'th good frame is
 * the first one used again. */
void estimator_distrust(struct estimator *e);

void estimator_close(struct estimator *e); /* NULL is fine */

#endif
