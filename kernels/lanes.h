/* SPDX-License-Identifier: MIT
 * Samples by the block: draws -> inputs -> fast rollout of every future -> integer counts, each stage a loop over lanes
 * that the compiler vectorises. lanes.c is compiled once per instruction set; all variants give the same bits.
 */
#ifndef AEBMC_LANES_H
#define AEBMC_LANES_H

#include "rollout.h"
#include "sample.h"
#include "stats.h"

/* Histograms of one thread. */
struct lanes_hist {
	uint32_t stop[MC_HIST_BINS], need[MC_HIST_BINS];
};

/* What to do with a run of samples. Outputs that are NULL are not made. */
struct lanes_job {
	const struct sample_plan *sample; /* NULL: the rows of z are the inputs themselves */
	const float *z;                   /* [MC_DIM or MODEL_INPUTS][stride] */
	uint32_t stride, count;
	uint32_t n_futures;
	struct rollout_plan future[MC_FUTURES_MAX]; /* of one vehicle and horizon */
	uint32_t flags, hist_future;                /* of the request */
	int32_t centre;                             /* stats_centre() */
	float mean_headway_m;
	struct stats_sums *sums; /* added to */
	struct lanes_hist *hist; /* added to; needs sums */
	struct model_out *out;   /* [n_futures][out_stride] */
	uint32_t out_stride;
};

struct lanes_work; /* one thread's blocks */

struct lanes {
	const char *name;
	void (*run)(struct lanes_work *w, const struct lanes_job *job); /* no allocation */
};

/**
 * lanes_pick - a variant that this processor can run
 * @name: "plain", "avx2", "avx512", "neon"; NULL picks the fastest
 * Returns NULL for an unknown name, or one that was not built or that the processor lacks.
 */
const struct lanes *lanes_pick(const char *name);

/** lanes_name - name of variant @i, fastest first; NULL past the last that was built. */
const char *lanes_name(unsigned int i);

/** lanes_work_open - memory for one thread; NULL if there is none. */
struct lanes_work *lanes_work_open(void);

void lanes_work_close(struct lanes_work *w);

#endif
