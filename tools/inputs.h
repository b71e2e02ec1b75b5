/* SPDX-License-Identifier: MIT
 * Are the inputs read right? What was seen of every mapped message and signal (inputs_watch.c), what that says about the
 * mapping (inputs_judge.c, inputs_motion.c: one function per row of inputs.def), and how it is shown (inputs_show.c).
 */
#ifndef AEBMC_INPUTS_H
#define AEBMC_INPUTS_H

#include <stdint.h>
#include <stdio.h>
#include "bus.h"
#include "census.h"
#include "config.h"
#include "mapping.h"
#include "stretch.h"

#define INPUTS_SIGNALS_MAX (MAP_ROLES * MAP_SPEEDS_MAX + 8 * MAP_TRACKS_MAX + 4)
#define INPUTS_RUNS_MAX    256 /* targets followed at once: slots, or numbers in a list */
#define INPUTS_SWAPS       2
#define INPUTS_OTHERS_MAX  16
#define INPUTS_TEXT_MAX    400

enum inputs_role {
	INPUTS_EGO_SPEED,
	INPUTS_YAW_RATE,
	INPUTS_DRIVER_BRAKE,
	INPUTS_DRIVER_ACCEL,
	INPUTS_DISTANCE,
	INPUTS_REL_SPEED,
	INPUTS_LATERAL,
	INPUTS_VALID,
	INPUTS_FRESH,
	INPUTS_EXISTENCE,
	INPUTS_DISTANCE_SIGMA,
	INPUTS_RATE_SIGMA,
	INPUTS_OBJECT_COUNT,
	INPUTS_SCAN_START,
	INPUTS_OBJECT_ID,
	INPUTS_QUALITY_ID,
	INPUTS_ROLES
};

struct inputs_role_row {
	const char *name, *unit; /* as in [signal NAME]; of the SI value */
};
extern const struct inputs_role_row inputs_role_table[INPUTS_ROLES];

/* The signal as it would be with the other byte order. */
struct inputs_swap {
	struct dbc_signal sig;
	double travel;
};

struct inputs_signal {
	const struct map_signal *map;
	int message, track; /* track -1: of the car */
	enum inputs_role role;
	uint64_t seen;         /* frames that have it */
	uint64_t na, range;    /* of these: not available, outside of the database's range */
	uint64_t full;         /* largest raw value */
	uint64_t steps, moves; /* pairs of frames of one sender; those in which it differs */
	uint64_t moved;        /* bits that differed */
	double travel;         /* sum of all steps, in full scales */
	struct inputs_swap swap[INPUTS_SWAPS];
	int n_swaps;
	double now, min, max;     /* SI; NaN before the first value */
	int64_t now_ns, still_ns; /* of the value, and since when it is the same and not 0 */
	int64_t still_max_ns;     /* the longest such time, and its value */
	double still_mps;
};

struct inputs_message {
	uint64_t frames;
	int64_t first_ns, last_ns, silence_ns; /* longest time without a frame */
	uint64_t lengths;                      /* frames of another length than the database's */
	uint8_t length;                        /* that length */
	uint64_t status[E2E_STATUSES];
	uint64_t passes[E2E_KINDS]; /* frames that pass each check, counters aside */
	uint64_t twins; /* same content as the frame before, within a quarter of the period */
	struct e2e_state e2e;
	uint8_t before[BUS_DATA_MAX];
};

/* A signal that is not mapped but should be a speed of the car too, beside the mapped one. */
struct inputs_other {
	const struct dbc_message *msg;
	const struct dbc_signal *sig;
	double gain;
	uint64_t n;
	double x, y, xx, yy, xy; /* sums; x: ego speed, y: this one [m/s] */
};

struct inputs {
	const struct config *cfg;
	const struct mapping *map;
	char iface[BUS_IFACES_MAX][BUS_NAME_MAX]; /* the mapping's, then others that a log has */
	int n_ifaces;
	int is_live; /* then only the mapped identifiers are seen */
	int64_t first_ns, last_ns;
	uint64_t frames;
	struct census census;
	struct inputs_message message[MAP_MESSAGES_MAX];
	struct inputs_signal signal[INPUTS_SIGNALS_MAX];
	int n_signals;
	struct inputs_other other[INPUTS_OTHERS_MAX];
	int n_others;
	struct stretch_run run[INPUTS_RUNS_MAX];
	uint8_t run_before[INPUTS_RUNS_MAX][BUS_DATA_MAX];
	uint8_t run_seen[INPUTS_RUNS_MAX];
	struct stretch_list stretches;
	uint64_t targets; /* distances of targets */
	uint64_t full, beyond,
		behind;          /* of these: at full scale; beyond radar.range_max; below 0 */
	double far_m;            /* farthest target */
	uint64_t invalid_there;  /* frames that say invalid, with a distance */
	uint64_t valid, invalid; /* frames that say so */
	uint64_t valid_moves,
		invalid_moves;        /* of these: the distance differs from the frame before */
	double ego_mps, yaw_radps;    /* latest; NaN */
	double accel_mps2;            /* largest change of ego speed over half a second */
	uint64_t turns, bends, skids; /* yaw rates at speed; in a bend; beyond what tyres hold */
	double side_mps2;             /* largest yaw rate times speed */
	int64_t ref_ns;               /* of ref_mps, for accel_mps2 */
	double ref_mps;
	uint64_t pulls, hard_pulls; /* half seconds judged; those beyond what tyres do */
};

/** inputs_open - @cfg and @map must outlive it. Allocates. 0 or -ENOMEM. */
int inputs_open(const struct config *cfg, const struct mapping *map, struct inputs **ret);

/** inputs_by_chance - 1 if so few frames pass that check as pass any: it is the wrong one. Pure. */
int inputs_by_chance(const struct inputs_message *st, enum e2e_kind check);

/** inputs_frame - take one frame. An interface beyond the mapping's is only counted. Allocates now and then. */
void inputs_frame(struct inputs *in, const struct bus_frame *f);

void inputs_close(struct inputs *in); /* NULL is fine */

/* ---- verdicts ---------------------------------------------------------------------------------- */

enum inputs_level {
	INPUTS_WRONG,  /* what the configuration says is not so */
	INPUTS_DOUBT,  /* may be so; worth a look */
	INPUTS_UNTOLD, /* not enough data to tell */
	INPUTS_GOOD,
	INPUTS_LEVELS
};
extern const char *const inputs_level_name[INPUTS_LEVELS];

struct inputs_verdict {
	const char *check;
	enum inputs_level level;
	char what[INPUTS_TEXT_MAX];   /* with the evidence */
	char also[INPUTS_TEXT_MAX];   /* others of which the same is true; "" */
	char change[INPUTS_TEXT_MAX]; /* what to change in the configuration; "" */
	int n;                        /* of how many it is true */
};

#define INPUTS_VERDICTS_MAX 256

struct inputs_judge {
	const struct inputs *in;
	const char *check;
	int n, lost; /* verdicts; beyond INPUTS_VERDICTS_MAX */
	struct inputs_verdict verdict[INPUTS_VERDICTS_MAX];
};

/** inputs_judge - every check of inputs.def; verdicts come out by level. @in's open stretches stay open. */
void inputs_judge(struct inputs_judge *j, const struct inputs *in);

/**
 * inputs_say - for the checks: a verdict on @subject
 * The same check at the same level joins the verdict before it. inputs_change: what to change, for the one said last.
 */
void inputs_say(struct inputs_judge *j, enum inputs_level level, const char *subject,
		const char *fmt, ...) __attribute__((format(printf, 4, 5)));
void inputs_change(struct inputs_judge *j, const char *fmt, ...)
	__attribute__((format(printf, 2, 3)));

/** inputs_mapped - 1 if a signal plays that role. */
int inputs_mapped(const struct inputs *in, enum inputs_role role);

/** inputs_spec - "MESSAGE.SIGNAL" of a role's first signal; of a target's "MESSAGE.SIGNAL and N more". Returns @text. */
const char *inputs_spec(const struct inputs *in, enum inputs_role role, char *text, size_t size);

/* ---- words ------------------------------------------------------------------------------------- */

/** inputs_table - messages and signals, at most @lines of them (0: all). */
void inputs_table(const struct inputs *in, int lines, FILE *out);

/** inputs_verdicts - one or two lines each. */
void inputs_verdicts(const struct inputs_judge *j, FILE *out);

/** inputs_json - everything, as one object, schema aebmc.inputs.1. */
void inputs_json(const struct inputs *in, const struct inputs_judge *j, const char *source,
		 int interrupted, FILE *out);

#endif
