/* SPDX-License-Identifier: MIT
 * The resident draws: what normal.h yields for the first indices, laid out for the lane loops.
 */
#include "draws.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define ALIGN_BYTES  64
#define ALIGN_FLOATS (ALIGN_BYTES / sizeof(float))
#define RESIDENT_MAX (1u << 24)
#define SLICE_WORDS  16384
#define KEY_GROUP    0xffffffffu /* a Philox group that no draw uses: scrambles come from it */

_Static_assert(MC_DIM % 4 == 0, "draws are made four dimensions at a time");

struct draws {
	struct normal_plan plan;
	float *z; /* [MC_DIM][stride] */
	uint32_t stride, slices;
	uint64_t *sum; /* [slices]: of the table as it was made */
};

/* Joe, Kuo, "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci. Comput. 30 (2008),
 * table new-joe-kuo-6.21201: degree and inner coefficients of the primitive polynomial, first direction numbers. The
 * lower a dimension the better its projections, so the inputs stand in the order of their weight in the risk. */
static const struct {
	uint8_t dim, degree, coeff, m[5];
} sobol[MC_DIM] = {
	{MODEL_EGO_SPEED, 0, 0, {0}}, /* the van der Corput sequence */
	{MODEL_GRADE, 1, 0, {1}},
	{MODEL_MU, 2, 1, {1, 3}},
	{MODEL_LEAD_ACCEL, 3, 1, {1, 3, 1}},
	{MODEL_LEAD_SPEED, 3, 2, {1, 1, 1}},
	{MODEL_HEADWAY, 4, 1, {1, 1, 3, 3}},
	{MC_DIM_PRIOR, 4, 4, {1, 3, 5, 13}},
	{MODEL_DELAY, 5, 2, {1, 1, 5, 5, 17}},
	{MODEL_EGO_ACCEL, 5, 4, {1, 1, 5, 5, 5}},
	{MODEL_TAU, 5, 7, {1, 1, 7, 11, 19}},
	{MODEL_DRAG, 5, 11, {1, 1, 5, 1, 1}},
	{MODEL_MASS, 5, 13, {1, 1, 1, 3, 11}},
};

/* Bratley, Fox, "Algorithm 659", ACM TOMS 14 (1988): the recurrence, on numbers shifted to the top. */
static void plan_directions(uint32_t dir[32], uint32_t degree, uint32_t coeff, const uint8_t *m)
{
	for (uint32_t i = 0; i < 32; i++) {
		if (i < degree || degree == 0) {
			dir[i] = (degree ? m[i] : 1u) << (31 - i);
			continue;
		}
		dir[i] = dir[i - degree] ^ (dir[i - degree] >> degree);
		for (uint32_t k = 1; k < degree; k++) {
			dir[i] ^= (coeff >> (degree - 1 - k) & 1) ? dir[i - k] : 0;
		}
	}
}

/* The cut is where the map itself reaches the limit: bisected over the bit patterns of tail probabilities. */
static struct normal_cut plan_cut(float limit)
{
	uint32_t lo = det_bits(0x1p-33f), hi = det_bits(0.5f);

	if (limit == 0.0f) {
		return (struct normal_cut){0.0f, 1.0f, 2 * NORMAL_MAX_SIGMA};
	}
	while (hi - lo > 1) {
		uint32_t mid = lo + (hi - lo) / 2;
		float p = det_float(mid);

		if (normal_quantile(p, 0.5f - p) > limit) {
			lo = mid;
		} else {
			hi = mid;
		}
	}
	return (struct normal_cut){det_float(hi), 1.0f - 2.0f * det_float(hi), limit};
}

static int draws_check(const struct mc_params *p)
{
	if ((p->kind != MC_SOBOL && p->kind != MC_PHILOX) || p->n_resident < 1 ||
	    p->n_resident > RESIDENT_MAX) {
		return -EINVAL;
	}
	for (int dim = 0; dim < MC_DIM; dim++) {
		if (!(p->truncate[dim] >= 0.0f && p->truncate[dim] <= NORMAL_MAX_SIGMA)) {
			return -EINVAL;
		}
	}
	return 0;
}

int draws_plan(const struct mc_params *p, struct normal_plan *ret)
{
	int err = draws_check(p);

	if (err) {
		return err;
	}
	ret->kind = p->kind;
	ret->key[0] = (uint32_t)p->seed;
	ret->key[1] = (uint32_t)(p->seed >> 32);
	for (uint32_t i = 0; i < MC_DIM; i++) {
		uint32_t dim = sobol[i].dim, word[4] = {dim, 0, KEY_GROUP, 0};

		normal_philox(word, ret->key[0], ret->key[1]);
		ret->owen[dim] = word[0];
		ret->shift[dim] = word[1];
		ret->cut[dim] = plan_cut(p->truncate[dim]);
		plan_directions(ret->dir[dim], sobol[i].degree, sobol[i].coeff, sobol[i].m);
	}
	return 0;
}

/* Any single flipped bit alters the sum: every weight is odd. */
static uint64_t slice_sum(const struct draws *d, uint32_t slice)
{
	const size_t all = (size_t)MC_DIM * d->stride, from = (size_t)slice * SLICE_WORDS;
	const size_t to = from + SLICE_WORDS < all ? from + SLICE_WORDS : all;
	uint64_t sum = 0;

	for (size_t i = from; i < to; i++) {
		sum += (uint64_t)det_bits(d->z[i]) * (2 * i + 1);
	}
	return sum;
}

static int keep_sums(struct draws *d)
{
	d->slices = (MC_DIM * d->stride + SLICE_WORDS - 1) / SLICE_WORDS;
	d->sum = calloc(d->slices, sizeof(*d->sum));
	for (uint32_t i = 0; d->sum && i < d->slices; i++) {
		d->sum[i] = slice_sum(d, i);
	}
	return d->sum ? 0 : -ENOMEM;
}

int draws_intact(const struct draws *d, uint64_t turn)
{
	const uint32_t slice = (uint32_t)(turn % d->slices);

	return slice_sum(d, slice) == d->sum[slice];
}

int draws_open(const struct mc_params *p, struct draws **ret)
{
	struct draws *d = calloc(1, sizeof(*d));
	int err = d ? draws_plan(p, &d->plan) : -ENOMEM;

	if (err) {
		goto out;
	}
	/* One line more than whole lines: rows a power of two apart would share their cache sets. */
	d->stride = (p->n_resident + 2 * ALIGN_FLOATS - 1) / ALIGN_FLOATS * ALIGN_FLOATS;
	d->z = aligned_alloc(ALIGN_BYTES, (size_t)MC_DIM * d->stride * sizeof(*d->z));
	if (!d->z) {
		err = -ENOMEM;
		goto out;
	}
	draws_fill(d, 0, d->stride, d->z, d->stride);
	err = keep_sums(d);
	if (err) {
		goto out;
	}
	*ret = d;
	return 0;
out:
	draws_close(d);
	return err;
}

const float *draws_table(const struct draws *d, uint32_t *stride)
{
	*stride = d->stride;
	return d->z;
}

void draws_fill(const struct draws *d, uint64_t first, uint32_t count, float *z, uint32_t stride)
{
	for (uint32_t i = 0; i < count; i++) {
		for (uint32_t group = 0; group < NORMAL_GROUPS; group++) {
			float four[4];

			normal_four(&d->plan, first + i, group, four);
			for (uint32_t k = 0; k < 4; k++) {
				z[(size_t)(4 * group + k) * stride + i] = four[k];
			}
		}
	}
}

void draws_close(struct draws *d)
{
	if (d) {
		free(d->sum);
		free(d->z);
		free(d);
	}
}
