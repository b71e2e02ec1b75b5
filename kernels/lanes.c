/* SPDX-License-Identifier: MIT
 * Blocks of lanes, compiled once per variant: what only some lanes need runs for a block or group that has one, and a
 * select in the stage leaves the others as they were. So neighbours never change a lane's bits.
 */
#include "lane_loops.h"

#define LANES_NAME2(v)   lanes_##v
#define LANES_NAME1(v)   LANES_NAME2(v)
#define LANES_STRING2(v) #v
#define LANES_STRING1(v) LANES_STRING2(v)

/* What the first correction leaves to do is done where some lane of a group needs it. */
static void correct(struct lanes_block *b, const struct rollout_plan *p, int max,
		    void (*step)(struct lanes_block *restrict, const struct rollout_plan *restrict,
				 int))
{
	for (int first = 0; first < LANES; first += GROUP) {
		for (int i = 1; i < max && group_wanted(b->want + first); i++) {
			group_fade(b, p, first);
			group_at(b, p, first);
			step(b, p, first);
		}
	}
}

static void impact(struct lanes_block *b, const struct rollout_plan *p)
{
	lane_hit_guess(b, p, 0);
	lane_fade(b, p, 0);
	lane_at(b, p, 0);
	lane_contact(b, p, 0);
	correct(b, p, ROLLOUT_CONTACT_MAX, group_contact);
}

/* None of this depends on the future a lane comes from. */
static void pool_flush(struct lanes_work *w, const struct lanes_job *job)
{
	lane_hit(&w->pool, &job->future[0], 0);
	impact(&w->pool, &job->future[0]);
	for (uint32_t i = 0; i < w->pooled; i++) {
		const uint32_t f = w->pool_future[i];
		const float mps = w->pool.impact[i];

		if (job->sums) {
			job->sums->impact_units[f] += (uint32_t)tally_units(mps);
		}
		if (job->out) {
			job->out[(size_t)f * job->out_stride + w->pool_index[i]].impact_mps = mps;
		}
	}
	w->pooled = 0;
}

/* Few lanes of a block collide: collect them, until a block is full. */
static void pool_add(struct lanes_work *w, const struct lanes_job *job, uint32_t n, uint32_t future,
		     uint32_t first)
{
	const struct lanes_block *b = &w->block;

	for (uint32_t i = 0; i < n; i++) {
		const uint32_t at = w->pooled;

		if (!(w->flags[i] & MODEL_CONTACT)) {
			continue;
		}
#define POOL(name) w->pool.name[at] = b->name[i];
		ROLLOUT_KEPT(POOL)
#undef POOL
		w->pool_future[at] = future;
		w->pool_index[at] = first + i;
		if (++w->pooled == LANES) {
			pool_flush(w, job);
		}
	}
}

/* Most lanes of a block collide: the block itself. */
static void impact_all(struct lanes_work *w, const struct lanes_job *job, uint32_t n,
		       uint32_t future, uint32_t first)
{
	struct lanes_block *b = &w->block;

	lane_hit(b, &job->future[future], 0);
	lane_mask(b->want, w->flags);
	impact(b, &job->future[future]);
	if (job->sums) {
		job->sums->impact_units[future] += lane_impact(b->impact, w->flags, n);
	}
	for (uint32_t i = 0; job->out && i < n; i++) {
		if (w->flags[i] & MODEL_CONTACT) {
			job->out[(size_t)future * job->out_stride + first + i].impact_mps =
				b->impact[i];
		}
	}
}

static void add_impact(struct lanes_work *w, const struct lanes_job *job, uint32_t n,
		       uint32_t future, uint32_t first)
{
	const uint32_t hits = lane_count(w->flags, n, MODEL_CONTACT);

	if (hits > LANES / 2) {
		impact_all(w, job, n, future, first);
	} else if (hits > 0) {
		pool_add(w, job, n, future, first);
	}
}

static void count(struct lanes_work *w, const struct lanes_job *job, uint32_t n, uint32_t future)
{
	const uint32_t rolling = job->flags & MC_ROLLING_IS_CONTACT ? MODEL_ROLLING : 0;
	const uint32_t open = job->flags & MC_ROLLING_IS_CONTACT ? 0 : MODEL_UNDECIDED;

	job->sums->hits[future] += lane_count(w->flags, n, MODEL_CONTACT | rolling);
	job->sums->undecided[future] += lane_count(w->flags, n, open);
	if (!job->hist || future != job->hist_future) {
		return;
	}
	lane_moments(w->block.stop, n, job->centre, job->sums);
	lane_bins(w, job->mean_headway_m, job->flags);
	for (uint32_t i = 0; i < n; i++) {
		job->hist->stop[w->stop_bin[i]]++;
		job->hist->need[w->need_bin[i]]++;
	}
}

static void put(struct lanes_work *w, const struct lanes_job *job, uint32_t n, uint32_t future,
		uint32_t first)
{
	struct model_out *out = job->out + (size_t)future * job->out_stride + first;

	for (uint32_t i = 0; i < n; i++) {
		out[i].stop_m = w->block.stop[i];
		out[i].need_m = w->block.need[i];
		out[i].impact_mps = 0.0f;
		out[i].flags = w->flags[i];
	}
}

static void brake(struct lanes_block *b, const struct rollout_plan *p)
{
	lane_match(b, p, 0);
	lane_kink_time(b, p, 0);
	lane_kink(b, p, 0);
	lane_stop(b, p, 0);
	if (lane_wanted(b->want)) {
		lane_short(b, p, 0);
		for (int i = 0; i < ROLLOUT_SHORT_STEPS; i++) {
			lane_fade(b, p, 0);
			lane_at(b, p, 0);
			lane_short_step(b, p, 0);
		}
	}
	lane_late(b, p, 0);
	if (lane_wanted(b->want)) {
		lane_fade(b, p, 0);
		lane_at(b, p, 0);
		lane_roll(b, p, 0);
	}
}

static void approach(struct lanes_block *b, const struct rollout_plan *p)
{
	lane_near(b, p, 0);
	lane_near_fit(b, p, 0);
	lane_near_root(b, p, 0);
	lane_fade(b, p, 0);
	lane_at(b, p, 0);
	lane_approach(b, p, 0);
	correct(b, p, ROLLOUT_APPROACH_MAX, group_approach);
}

static void roll(struct lanes_work *w, const struct rollout_plan *p)
{
	struct lanes_block *b = &w->block;

	lane_coast(b, p, 0);
	if (rollout_brakes(p)) {
		brake(b, p);
		if (lane_wanted(b->lead_stop)) {
			approach(b, p);
		}
	} else {
		lane_unbraked(b, p, 0);
	}
	lane_end(b, p, w->flags);
}

/* The draws of a block; an incomplete one is filled up with copies of its first sample. */
static const float *draws(struct lanes_work *w, const struct lanes_job *job, uint32_t first,
			  uint32_t n, uint32_t *stride)
{
	const uint32_t rows = job->sample ? MC_DIM : MODEL_INPUTS;

	*stride = job->stride;
	if (n == LANES) {
		return job->z + first;
	}
	for (uint32_t d = 0; d < rows; d++) {
		for (uint32_t i = 0; i < LANES; i++) {
			w->tail[d][i] = job->z[(size_t)d * job->stride + first + (i < n ? i : 0)];
		}
	}
	*stride = LANES;
	return w->tail[0];
}

static void future(struct lanes_work *w, const struct lanes_job *job, uint32_t first, uint32_t n,
		   uint32_t f)
{
	roll(w, &job->future[f]);
	if (job->sums) {
		count(w, job, n, f);
	}
	if (job->out) {
		put(w, job, n, f, first);
	}
	if (job->flags & MC_WANT_IMPACT) {
		add_impact(w, job, n, f, first);
	}
}

static void block(struct lanes_work *w, const struct lanes_job *job, uint32_t first, uint32_t n)
{
	uint32_t stride;
	const float *z = draws(w, job, first, n, &stride);

	if (job->sample) {
		lane_draw(job->sample, z, stride, w->block.headway, w->lifted);
	} else {
		for (int d = 0; d < MODEL_INPUTS; d++) {
			memcpy(w->block.headway + d * LANES, z + (size_t)d * stride,
			       LANES * sizeof(*z));
		}
	}
	if (job->sums) {
		job->sums->n += n;
		job->sums->floored += lane_count(w->lifted, n, 1);
	}
	lane_scene(&w->block, &job->future[0], 0);
	for (uint32_t f = 0; f < job->n_futures; f++) {
		future(w, job, first, n, f);
	}
}

static void run(struct lanes_work *w, const struct lanes_job *job)
{
	for (uint32_t first = 0; first < job->count; first += LANES) {
		const uint32_t left = job->count - first;

		block(w, job, first, left < LANES ? left : LANES);
	}
	if (w->pooled) {
		pool_flush(w, job);
	}
}

extern const struct lanes LANES_NAME1(LANE_VARIANT);
const struct lanes LANES_NAME1(LANE_VARIANT) = {LANES_STRING1(LANE_VARIANT), run};
