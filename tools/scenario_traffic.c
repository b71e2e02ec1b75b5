/* SPDX-License-Identifier: MIT
 * Cars that cut in, cars that leave and uncover one that stands, and targets that are none: what no regulation's test has.
 */
#include <stdio.h>
#include "scenario.h"

#define KMH(v)    ((v) / 3.6)
#define LANE_M    3.5
#define CHANGE_S  5.0 /* a change of lanes begins */
#define CHANGED_S 7.0
#define HALFWAY_S 5.95 /* then the car is at the corridor's edge, 1.6 m from its middle */
#define END_S     20.0

/* The lead leaves and uncovers a car that stands: until then it hid it. */
#define CUT_OUT(v, headway_s, ttc_s)                                                          \
	{                                                                                     \
		.end_s = END_S, .ego = {KMH(v)}, .n = 2, .target = {                          \
			{.gap_m = KMH(v) * (headway_s),                                       \
			 .path.speed_mps = KMH(v),                                            \
			 .to_lateral_m = LANE_M,                                              \
			 .change_s = CHANGE_S,                                                \
			 .changed_s = CHANGED_S},                                             \
			{.gap_m = KMH(v) * ((ttc_s) + HALFWAY_S), .seen_m = KMH(v) * (ttc_s)} \
		}                                                                             \
	}

/* A slower car comes in from the left, @ttc_s ahead when it is in the corridor, and brakes then. */
#define CUT_IN(v, other, ttc_s, accel)                                   \
	{                                                                \
		.end_s = END_S, .ego = {KMH(v)}, .n = 1, .target = {     \
			{.gap_m = KMH((v) - (other)) * ((ttc_s) + 6.05), \
			 .path = {KMH(other), {{CHANGED_S, accel}}},     \
			 .lateral_m = LANE_M,                            \
			 .change_s = CHANGE_S,                           \
			 .changed_s = CHANGED_S}                         \
		}                                                        \
	}

/* Nearer than the lead something appears that the radar follows for three scans alone. */
#define GHOST(v, gap)                                               \
	{                                                           \
		.gap_m = (gap)-2 + KMH(v) * 5, .seen_m = (gap)-2,   \
		.lost_m = (gap)-2 - KMH(v) * 0.14, .no_obstacle = 1 \
	}

static const struct scenario traffic[] = {
	{.name = "cut-out-50-2s", .drive = CUT_OUT(50, 1.2, 2)},
	{.name = "cut-out-70-2s", .in_short = 1, .drive = CUT_OUT(70, 1.2, 2)},
	{.name = "cut-out-70-3s", .drive = CUT_OUT(70, 1.2, 3)},
	{.name = "cut-out-90-3s", .drive = CUT_OUT(90, 1.2, 3)},
	{.name = "cut-in-50-20-1.5s", .in_short = 1, .drive = CUT_IN(50, 20, 1.5, 0)},
	{.name = "cut-in-80-50-1.5s", .drive = CUT_IN(80, 50, 1.5, 0)},
	{.name = "cut-in-100-60-2s", .drive = CUT_IN(100, 60, 2, 0)},
	{.name = "cut-in-80-60-2s-brakes", .drive = CUT_IN(80, 60, 2, -4)},
	{.name = "ghost-follow-80-20m",
	 .in_short = 1,
	 .goal = GOAL_NO_REQUEST,
	 .drive = {.end_s = 12,
		   .ego = {KMH(80)},
		   .n = 2,
		   .target = {{.gap_m = 20, .path.speed_mps = KMH(80)}, GHOST(80, 20)}}},
	{.name = "ghost-brake-80-20m-0.5g",
	 .in_short = 1,
	 .onset_s = 4.9,
	 .drive = {.end_s = END_S,
		   .ego = {KMH(80)},
		   .n = 2,
		   .target = {{.gap_m = 20, .path = {KMH(80), {{4.9, -0.5 * 9.81}}}},
			      GHOST(80, 20)}}},
};

int scenario_traffic(struct scenario *row, int max)
{
	const int n = (int)(sizeof(traffic) / sizeof(traffic[0]));

	for (int i = 0; i < n && i < max; i++) {
		row[i] = traffic[i];
	}
	return n;
}
