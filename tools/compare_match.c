/* SPDX-License-Identifier: MIT
 * Warnings and requests of two replays: which are the same, which were gained and lost.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include "compare.h"

#define APART_S 1.0 /* between two beginnings that are still of one danger */

const char *const compare_kind_name[KINDS] = {"warnings", "requests"};

static const enum stage_level least[KINDS] = {LEVEL_WARN, LEVEL_PARTIAL};

/* Fills @span, which has room for all changes. Returns how many. */
static int find_spans(const struct compare_run *r, enum compare_kind kind,
		      struct compare_span *span)
{
	int n = 0, on = 0;

	for (uint32_t i = 0; i < r->head.n_changes; i++) {
		const struct compare_change *c = &r->change[i];
		const int is = c->level >= (int32_t)least[kind];

		if (is && !on) {
			span[n++] = (struct compare_span){c->time_s, r->head.log_s, c->level};
		} else if (is && c->level > span[n - 1].level) {
			span[n - 1].level = c->level;
		} else if (!is && on) {
			span[n - 1].to_s = c->time_s;
		}
		on = is;
	}
	return n;
}

/* How well two go together: the time in which both are on, else how far apart they begin as a negative [s]; -INFINITY: not. */
static double fit_s(const struct compare_span *a, const struct compare_span *b)
{
	const double both = fmin(a->to_s, b->to_s) - fmax(a->from_s, b->from_s);
	const double apart = fabs(a->from_s - b->from_s);

	return both > 0 ? both : both == 0 || apart <= APART_S ? -apart : -INFINITY;
}

/* Which free one of the other side fits @i of @side best; -1: none. */
static int best_for(const struct compare_diff *d, enum compare_side side, int i)
{
	const enum compare_side other = side == SIDE_A ? SIDE_B : SIDE_A;
	double best = -INFINITY;
	int at = -1;

	for (int k = 0; k < d->n[other]; k++) {
		const double fit = fit_s(&d->span[side][i], &d->span[other][k]);

		if (fit > best && (side == SIDE_A ? compare_is_gained(d, k) : d->partner[k] < 0)) {
			best = fit;
			at = k;
		}
	}
	return at;
}

/* Those that are best for each other, until there are none. */
static int pair_some(struct compare_diff *d)
{
	int n = 0;

	for (int i = 0; i < d->n[SIDE_A]; i++) {
		const int k = d->partner[i] < 0 ? best_for(d, SIDE_A, i) : -1;

		if (k >= 0 && best_for(d, SIDE_B, k) == i) {
			d->partner[i] = k;
			n++;
		}
	}
	return n;
}

static void pair(struct compare_diff *d)
{
	int n, pairs = 0;

	for (int i = 0; i < d->n[SIDE_A]; i++) {
		d->partner[i] = -1;
	}
	while ((n = pair_some(d)) > 0) {
		pairs += n;
	}
	d->lost = d->n[SIDE_A] - pairs;
	d->gained = d->n[SIDE_B] - pairs;
}

int compare_match(const struct compare_run *run, enum compare_kind kind, struct compare_diff *d)
{
	*d = (struct compare_diff){0};
	d->partner = calloc(run[SIDE_A].head.n_changes + 1, sizeof(*d->partner));
	for (int side = 0; side < SIDES; side++) {
		d->span[side] = calloc(run[side].head.n_changes + 1, sizeof(*d->span[side]));
	}
	if (!d->partner || !d->span[SIDE_A] || !d->span[SIDE_B]) {
		compare_match_free(d);
		return -ENOMEM;
	}
	for (int side = 0; side < SIDES; side++) {
		d->n[side] = find_spans(&run[side], kind, d->span[side]);
	}
	pair(d);
	return 0;
}

void compare_match_free(struct compare_diff *d)
{
	free(d->partner);
	free(d->span[SIDE_A]);
	free(d->span[SIDE_B]);
	*d = (struct compare_diff){0};
}

int compare_is_gained(const struct compare_diff *d, int i)
{
	for (int k = 0; k < d->n[SIDE_A]; k++) {
		if (d->partner[k] == i) {
			return 0;
		}
	}
	return 1;
}

int compare_differs(const struct compare_log *l)
{
	for (int kind = 0; kind < KINDS; kind++) {
		const struct compare_diff *d = &l->diff[kind];

		for (int i = 0; i < d->n[SIDE_A]; i++) {
			const int k = d->partner[i];

			if (k < 0 || d->span[SIDE_A][i].level != d->span[SIDE_B][k].level) {
				return 1;
			}
		}
		if (d->gained) {
			return 1;
		}
	}
	return 0;
}
