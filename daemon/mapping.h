/* SPDX-License-Identifier: MIT
 * Which signals of which messages are the car's speed, the radar's targets, the driver's pedals: data, not code.
 * Filled from the configuration and a DBC (config.c), read by the estimator. Read-only once loaded.
 */
#ifndef AEBMC_MAPPING_H
#define AEBMC_MAPPING_H

#include <stdint.h>
#include "bus.h"
#include "dbc.h"
#include "e2e.h"

#define MAP_MESSAGES_MAX 64
#define MAP_TRACKS_MAX   64
#define MAP_SPEEDS_MAX   4

/* One signal, with its way to SI units and the raw value that means "no value". */
struct map_signal {
	const struct dbc_signal *sig; /* NULL: this role is not mapped */
	double gain,
		offset; /* SI = gain * physical + offset (unit conversion, sign, sensor position) */
	int has_na;
	uint64_t na_raw; /* raw value (as unsigned bits) that says "not available" */
};

struct map_message {
	const struct dbc_message *msg;
	uint8_t iface;                    /* index into the configured interfaces */
	enum e2e_kind check;              /* protection to verify */
	const struct dbc_signal *counter; /* rolling counter outside the check, or NULL */
	int64_t period_ns; /* nominal cycle; staleness is judged in multiples of it */
	int16_t track;     /* index of the radar target it carries, -1 if it carries none */
	int8_t ego;        /* 1: carries an ego or driver signal */
};

/* Roles outside the radar: index into mapping.ego_msg / the signals below. */
enum map_role { MAP_EGO_SPEED, MAP_YAW_RATE, MAP_DRIVER_BRAKE, MAP_DRIVER_ACCEL, MAP_ROLES };

struct map_role_signals {
	int n; /* signals averaged (four wheel speeds, say); 0 = not mapped */
	int16_t message[MAP_SPEEDS_MAX]; /* index into mapping.message */
	struct map_signal signal[MAP_SPEEDS_MAX];
};

struct map_track {
	int16_t message;             /* index into mapping.message */
	struct map_signal distance;  /* [m], required; ego front to target */
	struct map_signal rel_speed; /* [m/s], target minus ego: negative when closing; required */
	struct map_signal lateral;   /* [m], left positive; optional */
	struct map_signal valid;     /* nonzero: target present; optional */
	struct map_signal fresh;     /* nonzero: target just appeared in this slot; optional */
	struct map_signal existence; /* probability 0..1; optional */
};

enum map_scan_end { MAP_SCAN_ALL_SEEN, MAP_SCAN_GAP };

struct mapping {
	struct dbc *dbc;
	char iface[BUS_IFACES_MAX][BUS_NAME_MAX];
	int n_ifaces;
	int n_messages, n_tracks;
	struct map_message message[MAP_MESSAGES_MAX];
	struct map_role_signals role[MAP_ROLES];
	struct map_track track[MAP_TRACKS_MAX];
	int64_t scan_gap_ns; /* silence that ends a scan when not all of its messages were seen */
};

/** mapping_find - message index for a frame, or -1. O(log n), no allocation. */
int mapping_find(const struct mapping *m, uint8_t iface, uint32_t id);

#endif
