/* SPDX-License-Identifier: MIT
 * Which signals of which messages are the car's speed, the radar's targets, the driver's pedals: data, not code.
 * Filled from the configuration file's [message] and [signal] sections and a DBC, read by the estimator. Read-only
 * once loaded.
 */
#ifndef AEBMC_MAPPING_H
#define AEBMC_MAPPING_H

#include <stdint.h>
#include <stdio.h>
#include "bus.h"
#include "dbc.h"
#include "e2e.h"

#define MAP_MESSAGES_MAX 64
#define MAP_TRACKS_MAX   64
#define MAP_SPEEDS_MAX   4
#define MAP_TABLES_MAX   8
#define MAP_TABLE_MAX    64 /* entries of one */

/* What the raw values 0, 1, ... of a signal stand for, where no scale says it. */
struct map_table {
	uint32_t n;
	double value[MAP_TABLE_MAX]; /* in the signal's unit */
};

/* One signal, with its way to SI units and the raw value that means "no value". */
struct map_signal {
	const struct dbc_signal *sig;  /* NULL: this role is not mapped */
	const struct map_table *table; /* physical value by raw value, or NULL */
	double gain,
		offset; /* SI = gain * physical + offset (unit conversion, sign, sensor position) */
	int16_t message; /* index into mapping.message */
	int has_na;
	uint64_t na_raw; /* raw value (as unsigned bits) that says "not available" */
};

/* What a message is to the radar's scan. */
enum map_part {
	MAP_NO_PART,
	MAP_HEADER, /* begins a scan; says how many objects follow, or nothing about it */
	MAP_TARGET, /* a target: of a slot of its own, or of a list, named by its number */
	MAP_QUALITY /* more about the target of a list that has the same number */
};

struct map_message {
	const struct dbc_message *msg;
	uint8_t iface;                    /* index into the configured interfaces */
	enum e2e_kind check;              /* protection to verify */
	const struct dbc_signal *counter; /* rolling counter outside the check, or NULL */
	int64_t period_ns; /* nominal cycle; staleness is judged in multiples of it */
	int16_t track;     /* index of the radar target it carries, -1 if it carries none */
	uint8_t part;      /* enum map_part */
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
	struct map_signal distance;  /* [m], from the front bumper (front_offset is in); required */
	struct map_signal rel_speed; /* [m/s], target minus ego: negative when closing; required */
	struct map_signal lateral;   /* [m], left positive; optional */
	struct map_signal valid;     /* nonzero: target present; optional */
	struct map_signal fresh;     /* nonzero: target just appeared in this slot; optional */
	struct map_signal existence; /* probability 0..1; optional */
	struct map_signal distance_sigma, rate_sigma; /* [m], [m/s], 1 sigma; optional */
};

/*
 * A radar that does not send every slot in every scan: a header begins each scan and shows that the radar lives, so that
 * what is not sent is not there. Where objects have a number, one message carries all of them, one frame each, described by
 * track[0]; existence and sigmas may come in a second message, named by the same number. No header: header is -1, and
 * every slot is sent in every scan.
 */
struct map_list {
	int16_t header, quality; /* index into mapping.message, -1: none */
	struct map_signal
		count; /* frames of objects that follow; no sig: the header does not say */
	struct map_signal start;      /* a header that does not say; no sig: not mapped */
	struct map_signal id;         /* the object's number in its message; no sig: slots */
	struct map_signal quality_id; /* and in the quality message */
};

struct config;
struct ini;

struct mapping {
	struct dbc *dbc;
	struct ini *source; /* the file it was read from, for mapping_print */
	char iface[BUS_IFACES_MAX][BUS_NAME_MAX];
	int n_ifaces;
	int n_messages, n_tracks;
	struct map_message message[MAP_MESSAGES_MAX];
	struct map_role_signals role[MAP_ROLES];
	struct map_track track[MAP_TRACKS_MAX];
	struct map_list list;
	int n_tables;
	struct map_table table[MAP_TABLES_MAX];
	uint8_t by_id[MAP_MESSAGES_MAX]; /* indices of messages, ordered by interface and id */
	int64_t scan_gap_ns; /* silence that ends a scan when not all of its messages were seen */
};

/** mapping_section - 1 if a section of that name belongs to the mapping: "message NAME", "signal ROLE". */
int mapping_section(const char *section);

/**
 * mapping_load - from sections and a DBC to roles
 * @ini: read file with overrides; owned by the mapping on success
 * @cfg: checked options; dbc_file becomes an absolute path
 * Reports to ini->err, one line. Allocates; blocks on the file system. Returns 0 or -errno (-EINVAL for content).
 */
int mapping_load(struct ini *ini, struct config *cfg, struct mapping **ret);

/** mapping_find - message index for a frame, or -1. O(log n), no allocation. */
int mapping_find(const struct mapping *m, uint8_t iface, uint32_t id);

/** mapping_hash - @h continued by the DBC's content and what is taken from it; the same on any machine. */
uint64_t mapping_hash(const struct mapping *m, uint64_t h);

/** mapping_print - the sections it was read from, in the file's order. */
void mapping_print(const struct mapping *m, FILE *out);

/** mapping_print_options - what such sections may say, as scdoc text. */
void mapping_print_options(FILE *out);

/** mapping_free - and what it owns; NULL is fine. */
void mapping_free(struct mapping *m);

#endif
