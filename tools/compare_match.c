/* SPDX-License-Identifier: MIT
 * Warnings and requests of two replays: which are the same, which were gained and lost.
 */
#include <errno.h>
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

static int belong(const struct compare_span *a, const struct compare_span *b)
{
	const double apart = a->from_s - b->from_s;

	return (a->from_s <= b->to_s && b->from_s <= a->to_s) ||
	       (apart <= APART_S && apart >= -APART_S);
}

static void pair(struct compare_diff *d)
{
	int next = 0;

	for (int i = 0; i < d->n[SIDE_A]; i++) {
		d->partner[i] = -1;
		for (int k = next; k < d->n[SIDE_B] && d->partner[i] < 0; k++) {
			if (belong(&d->span[SIDE_A][i], &d->span[SIDE_B][k])) {
				d->partner[i] = k;
				next = k + 1;
			}
		}
		d->lost += d->partner[i] < 0;
	}
	d->gained = d->n[SIDE_B] - (d->n[SIDE_A] - d->lost);
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
