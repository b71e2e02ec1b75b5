/* SPDX-License-Identifier: MIT
 * From a DBC, and a log if there is one, to a mapping: message families and what was seen of every signal (mapper_log.c),
 * names (mapper_words.c), candidates for each role with reasons (mapper_rank.c), the configuration (mapper_write.c).
 */
#ifndef AEBMC_MAPPER_H
#define AEBMC_MAPPER_H

#include <stdint.h>
#include <stdio.h>
#include "census.h"
#include "dbc.h"
#include "e2e.h"
#include "mapping.h"
#include "stretch.h"
#include "unit.h"

#define MAPPER_PAIRS_MAX      64
#define MAPPER_CANDIDATES_MAX 12 /* kept for each role, the best */
#define MAPPER_WHY_MAX        320
#define MAPPER_SPEC_MAX       1200
#define MAPPER_RUNS           256
#define MAPPER_GAPS           1000 /* ms */
#define MAPPER_SCORE_MIN      4.0  /* a candidate below is a guess */
#define MAPPER_LEAD_MIN       1.5  /* over the second, to be clear */

enum mapper_role {
#define MAPPER_ROLE(name, unit, whose, required, doc) MAPPER_##name,
#include "mapper.def"
	MAPPER_ROLES
};

enum mapper_whose { MAPPER_CAR, MAPPER_TARGET, MAPPER_HEADER };
enum mapper_where { MAPPER_SIGNAL, MAPPER_MESSAGE };

struct mapper_role_row {
	const char *name; /* first, for text_nearest */
	enum unit_kind unit;
	enum mapper_whose whose;
	int required;
	const char *doc;
};
extern const struct mapper_role_row mapper_role_table[MAPPER_ROLES];

/* Messages alike but for a number in their name, or one message. */
struct mapper_family {
	int n;
	const struct dbc_message *member[MAP_TRACKS_MAX];
	char name[DBC_NAME_MAX + 16]; /* as a mapping names it: TRACK_{0..15} */
};

struct mapper_message {
	uint64_t frames;
	uint64_t passes[E2E_KINDS]; /* that pass each check, counters aside */
	int64_t first_ns, last_ns;
	uint32_t signals; /* index of its first in mapper.stats */
	uint8_t before[DBC_DATA_MAX];
};

/* Of one signal. */
struct mapper_stats {
	uint64_t n, steps, moves, ups,
		full;          /* frames; pairs of them; different; one up; all bits one */
	double min, max, leap; /* physical; largest step */
};

/* A distance and what may be its rate. */
struct mapper_pair {
	int family;
	const struct dbc_signal *distance, *rate, *id; /* id: NULL, or the object's number */
	double distance_gain, rate_gain;
	struct stretch_list list;
	struct stretch_run run[MAPPER_RUNS];
	int64_t last_ns;               /* of the family's last frame, 0: none */
	uint32_t gap[MAPPER_GAPS + 1]; /* times from frame to frame, by ms; the last: longer ones */
};

struct mapper {
	const struct dbc *dbc;
	int n_families, n_pairs, n_ifaces;
	struct mapper_family *family;   /* [n_families] */
	struct mapper_message *message; /* [dbc->n_messages] */
	struct mapper_stats *stats;
	struct mapper_pair *pair; /* [n_pairs] */
	struct census census;
	char iface[BUS_IFACES_MAX][BUS_NAME_MAX];
	uint64_t frames; /* 0: no log */
};

struct mapper_candidate {
	int family;
	int n; /* signals: several are averaged */
	const struct dbc_signal *sig[MAP_SPEEDS_MAX];
	double score;
	const char *unit; /* to be written; NULL: the database's will do */
	int negate;
	int odd; /* it behaves as no such signal should: not to be taken unasked */
	char why[MAPPER_WHY_MAX];
};

struct mapper_choice {
	int n; /* candidates, best first */
	struct mapper_candidate at[MAPPER_CANDIDATES_MAX];
	int taken;                        /* -1: none */
	const struct dbc_signal *strange; /* named best of those whose unit is not known; NULL */
	int strange_family;
	double strange_points;
};

/** mapper_open - @dbc must outlive it. Allocates. 0 or -ENOMEM. */
int mapper_open(const struct dbc *dbc, struct mapper **ret);

/** mapper_frame - see one frame. Allocates now and then. */
void mapper_frame(struct mapper *m, const struct bus_frame *f);

void mapper_close(struct mapper *m); /* NULL is fine */

/** mapper_words - points that a name earns for a role. Pure. */
double mapper_words(enum mapper_role role, enum mapper_where where, const char *name);

/** mapper_is_counter - 1 if a signal is called a frame counter. Pure. */
int mapper_is_counter(const char *name);

/** mapper_unit - the unit of @kind that @name stands for, as unit_gain knows it; NULL for none. @name "" is none. Pure. */
const char *mapper_unit(enum unit_kind kind, const char *name);

/** mapper_rank - candidates for a role; @family: of the distance that was taken, -1 for roles of no target. */
void mapper_rank(const struct mapper *m, enum mapper_role role, int family,
		 const struct mapper_candidate *distance, struct mapper_choice *c);

/** mapper_is_clear - 1 if the first candidate is good, not odd, and far better than the second. */
int mapper_is_clear(const struct mapper_choice *c);

/** mapper_spec - the candidate as [signal] from names it. Returns @text. */
const char *mapper_spec(const struct mapper *m, const struct mapper_candidate *c,
			char text[MAPPER_SPEC_MAX]);

/** mapper_at - of a message: what was seen of it, and of its signal. */
const struct mapper_message *mapper_at(const struct mapper *m, const struct dbc_message *msg);
const struct mapper_stats *mapper_stats(const struct mapper *m, const struct dbc_message *msg,
					const struct dbc_signal *sig);

/**
 * mapper_gaps - the silence within and between a radar's scans [ms], where a scan is a frame of each of its messages
 * @within: all but 2 % of a scan's gaps are at most that long; @between: all but 2 % of those between scans at least.
 * Returns 0, or -ENODATA if @family has one message, or too few frames were seen.
 */
int mapper_gaps(const struct mapper *m, int family, int *within, int *between);

/**
 * mapper_odd_counters - a line for each message taken whose counter is one by its name, but does not count in the log
 * Such a counter is not mapped: the daemon would drop the frames that repeat.
 */
void mapper_odd_counters(const struct mapper *m, const struct mapper_choice choice[MAPPER_ROLES],
			 FILE *out);

/** mapper_write - the configuration. @dbc_path as it is to be found from the file. */
void mapper_write(const struct mapper *m, const struct mapper_choice choice[MAPPER_ROLES],
		  const char *dbc_path, const char *iface, FILE *out);

#endif
