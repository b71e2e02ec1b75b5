/* SPDX-License-Identifier: MIT
 * Reads the events of an LTTng trace, oldest first. Knows CTF, not what the events mean.
 */
#ifndef AEBMC_CTF_H
#define AEBMC_CTF_H

#include <stdint.h>

#define CTF_FIELDS_MAX 24

/* One member of an event's payload. */
struct ctf_field {
	const char *name;
	const char *text; /* a string's; NULL for a number */
	int64_t i;        /* an integer's, whatever its sign */
	double f;         /* any number's */
};

struct ctf_record {
	const char *name; /* "aebmc:edge_SCAN" */
	int64_t t_ns;     /* of the trace's clock, since its origin */
	int64_t pid;      /* of context vpid; 0: not recorded */
	int n;
	struct ctf_field field[CTF_FIELDS_MAX];
};

/* What the tracer itself says it dropped. */
struct ctf_lost {
	uint64_t events, packets;
};

/** Takes one event; its strings are gone when it returns. A nonzero return ends the reading with that. */
typedef int ctf_event(void *arg, const struct ctf_record *r);

/**
 * ctf_read - hand every event of all traces below @dir to @event
 * @lost: how many were dropped by the tracer (full buffers, an overwritten flight recorder's not counted)
 * Returns 0; -ENOENT if there is no trace below @dir; -ENOTSUP without libbabeltrace2; what @event returned; -EBADMSG
 * if the trace cannot be read; @err says which in one line. Allocates.
 */
int ctf_read(const char *dir, ctf_event *event, void *arg, struct ctf_lost *lost, char *err,
	     int err_len);

#endif
