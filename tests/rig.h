/* SPDX-License-Identifier: MIT
 * An estimator on a rig: an ego car, a radar with slots and one lead in the first of them, frame by frame. Whoever wants to
 * see inside includes daemon/estimator.c after it.
 */
#ifndef AEBMC_TEST_RIG_H
#define AEBMC_TEST_RIG_H

#include "drives.h"

#define MS CLOCK_NS_PER_MS

struct rig {
	struct config cfg;
	struct mapping *map;
	struct encode encode;
	struct estimator *e;
	int64_t t_ns;
	double speed_mps, gap_m, rate_mps;
	uint32_t roles; /* known to the car */
	double value[MAP_ROLES];
	uint64_t silent; /* slots that send nothing */
	int lead;        /* one is there */
	int deaf;        /* no ego messages */
	int half_deaf;   /* the first of them only */
	int ended;       /* scans ended */
};

static inline void rig_begin(struct rig *b)
{
	*b = (struct rig){.t_ns = 1000 * MS,
			  .speed_mps = 20,
			  .gap_m = 30,
			  .roles = (1u << MAP_ROLES) - 1,
			  .lead = 1};
}

static inline void rig_start(struct rig *b)
{
	encode_open(&b->encode, b->map);
	assert_int_equal(estimator_open(&b->cfg, b->map, &b->e), 0);
}

static inline void rig_open(struct rig *b, const char *car)
{
	rig_begin(b);
	b->map = drives_load(car, &b->cfg);
	rig_start(b);
}

static inline void rig_close(struct rig *b)
{
	estimator_close(b->e);
	config_mapping_free(b->map);
}

static inline int rig_give(struct rig *b, const struct bus_frame *f)
{
	const int ended = estimator_frame(b->e, f);

	b->ended += ended;
	return ended;
}

static inline struct bus_frame rig_ego(struct rig *b, int message)
{
	struct bus_frame f;

	b->value[MAP_EGO_SPEED] = b->speed_mps;
	encode_message(&b->encode, message, b->roles, b->value, NULL, b->t_ns, &f);
	return f;
}

static inline struct bus_frame rig_slot(struct rig *b, int slot)
{
	const struct detection det = {
		.distance_m = b->gap_m, .rate_mps = b->rate_mps, .existence = 0.9};
	struct bus_frame f;

	encode_message(&b->encode, b->map->track[slot].message, 0, b->value,
		       b->lead && slot == 0 ? &det : NULL, b->t_ns, &f);
	return f;
}

/* Time passes, the scan's deadline included. */
static inline void rig_wait(struct rig *b, int ms)
{
	b->t_ns += ms * MS;
	b->ended += estimator_tick(b->e, b->t_ns);
}

static inline void rig_say_ego(struct rig *b)
{
	int said = 0;

	for (int i = 0; i < b->map->n_messages && !b->deaf && !(b->half_deaf && said); i++) {
		if (b->map->message[i].ego) {
			const struct bus_frame f = rig_ego(b, i);

			rig_give(b, &f);
			said++;
		}
	}
}

static inline void rig_say_scan(struct rig *b)
{
	for (int i = 0; i < b->map->n_tracks; i++) {
		if (!(b->silent >> i & 1)) {
			const struct bus_frame f = rig_slot(b, i);

			rig_give(b, &f);
		}
	}
}

/* 50 ms: a scan, and ego messages every 10 ms or so. */
static inline struct scene rig_cycle(struct rig *b)
{
	struct scene s;

	for (int i = 0; i < 5; i++) {
		rig_wait(b, 10);
		if (i % 2 == 0) {
			rig_say_ego(b);
		}
	}
	rig_say_scan(b);
	b->gap_m += b->rate_mps * 0.05;
	estimator_scene(b->e, b->t_ns, &s);
	drives_assert_sound(&s);
	return s;
}

static inline struct scene rig_cycles(struct rig *b, int n)
{
	struct scene s = rig_cycle(b);

	for (int i = 1; i < n; i++) {
		s = rig_cycle(b);
	}
	return s;
}

static inline struct scene rig_look(struct rig *b)
{
	struct scene s;

	estimator_scene(b->e, b->t_ns, &s);
	return s;
}

/* A radar of 16 slots after two whole scans: of the next all came but slot 7, so that it is open. */
static inline void rig_open_in_scan(struct rig *b)
{
	rig_open(b, "toyota-tss-p");
	rig_cycles(b, 4);
	rig_wait(b, 50);
	b->silent = 1 << 7;
	rig_say_scan(b);
}

#endif
