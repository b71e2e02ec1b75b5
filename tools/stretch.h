/* SPDX-License-Identifier: MIT
 * One target's distance over time, cut into stretches of 1 to 2 s: how fast it really changed, beside what the signals
 * said meanwhile. For judging mappings; knows no bus.
 */
#ifndef AEBMC_STRETCH_H
#define AEBMC_STRETCH_H

#include <stddef.h>
#include <stdint.h>

/* What the bus says of one target at one moment; NaN where nothing does. */
struct stretch_sample {
	int64_t t_ns;
	double distance_m, rate_mps, lateral_m;
	double ego_mps, yaw_radps;
};

/* Means over a stretch, but for the slopes, which are least-squares lines. */
struct stretch {
	double slope_mps, slope_se_mps; /* of the distance, and its standard error */
	double lateral_mps;             /* slope of the lateral offset */
	double distance_m, rate_mps, ego_mps, yaw_radps;
};

/* A target being followed. Zeroed at first. */
struct stretch_run {
	int n;
	int64_t first_ns, last_ns;
	double first_m, last_m, first_lateral_m;
	double t, tt, d, dd, td, lateral, t_lateral; /* sums, from the first sample on */
	double distance, rate, ego, yaw;
};

/**
 * stretch_add - one more sample of the target
 * Returns 1 with @done filled if a stretch of at least 1 s and 5 samples ended: by being 2 s long, or because this sample
 * is not of the same target (half a second of silence, or a leap of the distance that no car makes).
 */
int stretch_add(struct stretch_run *r, const struct stretch_sample *s, struct stretch *done);

/** stretch_end - the target is gone. As stretch_add. */
int stretch_end(struct stretch_run *r, struct stretch *done);

/* Many stretches. Zeroed at first. */
struct stretch_list {
	struct stretch *at; /* [n], to be freed */
	uint32_t n, room;
	uint64_t lost; /* beyond STRETCH_LIST_MAX, or no memory */
};

#define STRETCH_LIST_MAX 1000000u

/** stretch_keep - append; what does not fit is counted. Allocates. */
void stretch_keep(struct stretch_list *l, const struct stretch *s);

/* A median with its standard error (from the median absolute deviation, as of normal samples). */
struct stretch_median {
	uint32_t n;
	double value, se;
	double spread; /* 1.4826 times the median absolute deviation */
};

/** stretch_median - of @n values, which it reorders. NaN if @n is 0. */
struct stretch_median stretch_median(double *v, uint32_t n);

/**
 * stretch_ratio - what the relative speed says for each m/s that the distance changes: 1 if it is right
 * Over the stretches whose slope is beyond 0.5 m/s and four of its standard errors.
 * @subtract_ego: of the relative speed less the ego speed, should it be the target's own. Allocates; n is 0 without memory.
 */
struct stretch_median stretch_ratio(const struct stretch_list *l, int subtract_ego);

#endif
