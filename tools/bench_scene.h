/* SPDX-License-Identifier: MIT
 * The scenes that bench times, on every backend the same.
 */
#ifndef AEBMC_BENCH_SCENE_H
#define AEBMC_BENCH_SCENE_H

#include "mc.h"

/** bench_scene_paper - the paper's scene (Sec. IV) with every input that it has drawn: headway and tau too. Pure. */
void bench_scene_paper(struct mc_request *req, uint32_t n);

/**
 * bench_scene_futures - what the daemon submits at the paper's 30 m/s, 20 m behind a lead that brakes at 5 m/s2
 * All eleven inputs are drawn, the five of the state with the correlations that a tracking filter leaves. 0 or -errno.
 */
int bench_scene_futures(struct mc_request *req, uint32_t n);

/** bench_scene_perception - the same, with every other thing that may be met: a nearer object, one behind the lead, one that
 * it hides, none. 0 or -errno. */
int bench_scene_perception(struct mc_request *req, uint32_t n);

/** bench_scene_moving - the same with one future: brake now. 0 or -errno. */
int bench_scene_moving(struct mc_request *req, uint32_t n);

#endif
