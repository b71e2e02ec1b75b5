/* SPDX-License-Identifier: MIT
 * Radar frames to scans.
 */
#include "scan.h"

#define COUNT_UNKNOWN (-1)

void scan_open(struct scan *s, const struct mapping *map, double existence_min)
{
	*s = (struct scan){.map = map, .existence_min = existence_min, .count = COUNT_UNKNOWN};
}

static int is_list(const struct scan *s)
{
	return s->map->list.id.sig != NULL;
}

/* Index of the target of this number, or -1. */
static int find(const struct scan *s, uint32_t id)
{
	for (int i = 0; i < s->n; i++) {
		if (s->det[i].id == id) {
			return i;
		}
	}
	return -1;
}

int scan_breaks(const struct scan *s, const struct decode_frame *d)
{
	if (!s->open || d->part == MAP_QUALITY) {
		return 0;
	}
	if (d->part == MAP_HEADER) {
		return 1;
	}
	return is_list(s) ? find(s, d->det.id) >= 0 : (int)(s->seen >> d->track & 1);
}

/* Where a further target goes: at the end, or in place of the farthest if it is nearer. NULL: it is farther than all. */
static struct detection *place(struct scan *s, const struct detection *det)
{
	struct detection *far = &s->det[0];

	if (s->n < MAP_TRACKS_MAX) {
		return &s->det[s->n++];
	}
	for (int i = 1; i < s->n; i++) {
		far = s->det[i].distance_m > far->distance_m ? &s->det[i] : far;
	}
	return det->distance_m < far->distance_m ? far : NULL;
}

static void add_target(struct scan *s, const struct decode_frame *d)
{
	struct detection *to = d->target ? place(s, &d->det) : NULL;

	s->objects++;
	s->seen |= 1ull << d->track;
	if (to) {
		*to = d->det;
	}
}

static void add_quality(struct scan *s, const struct detection *q)
{
	const int i = find(s, q->id);

	s->qualities++;
	if (i >= 0) {
		struct detection *to = &s->det[i];

		to->existence = q->existence;
		to->distance_sigma_m = q->distance_sigma_m;
		to->rate_sigma_mps = q->rate_sigma_mps;
	}
}

/* Every slot, or everything that was announced. */
static int is_complete(const struct scan *s)
{
	const int n = s->map->n_tracks;

	if (!is_list(s) && s->seen == (n == 64 ? ~0ull : (1ull << n) - 1)) {
		return 1;
	}
	return s->count != COUNT_UNKNOWN && s->objects >= s->count &&
	       (s->map->list.quality < 0 || s->qualities >= s->count);
}

static void begin(struct scan *s, int64_t t_ns)
{
	s->open = 1;
	s->first_ns = t_ns;
	s->seen = 0;
	s->count = COUNT_UNKNOWN;
	s->objects = s->qualities = s->n = 0;
}

int scan_add(struct scan *s, const struct decode_frame *d, int64_t t_ns)
{
	if (!s->open) {
		begin(s, t_ns);
	}
	s->last_ns = t_ns;
	if (d->part == MAP_HEADER) {
		s->count = d->count;
	} else if (d->part == MAP_QUALITY) {
		add_quality(s, &d->det);
	} else {
		add_target(s, d);
	}
	return is_complete(s);
}

void scan_end(struct scan *s)
{
	const int announces = s->map->list.count.sig != NULL;
	int kept = 0;

	for (int i = 0; i < s->n; i++) {
		if (s->det[i].existence >= s->existence_min) {
			s->det[kept++] = s->det[i];
		}
	}
	s->n = kept;
	s->incomplete = announces && !is_complete(s) ? s->incomplete + 1 : 0;
	s->open = 0;
}

void scan_forget(struct scan *s)
{
	s->open = 0;
}
