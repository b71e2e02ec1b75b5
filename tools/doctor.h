/* SPDX-License-Identifier: MIT
 * The checks of aebmc doctor: what is, what should be, and what mends it (doctor.def). Everything is read from files
 * below a root, so that made-up trees decide in tests; controllers are asked over netlink.
 */
#ifndef AEBMC_DOCTOR_H
#define AEBMC_DOCTOR_H

#include <sched.h>
#include <stdint.h>
#include "config.h"
#include "link.h"

#define DOCTOR_TEXT_MAX 256

enum doctor_verdict {
	DOCTOR_GOOD,
	DOCTOR_NONE,    /* does not apply here, or cannot be told */
	DOCTOR_ADVICE,  /* works without, but not as well */
	DOCTOR_MISSING, /* the daemon cannot do its work without */
	DOCTOR_VERDICTS
};

struct doctor {
	const char *root;         /* "" but in tests */
	const struct config *cfg; /* defaults without a file */
	cpu_set_t
		isolated; /* processors set aside for real time; doctor_isolated_read() fills it */
};

/* A bus looked at for a while. */
struct doctor_bus {
	const char *name;
	int there, up;
	double window_s;
	int64_t frames; /* received meanwhile; -1: not known */
	struct link_state before, after;
	uint32_t bitrate;    /* that it should have [bit/s] */
	double sample_point; /* that it should have, 0..1 */
};

struct doctor_row {
	const char *name, *should, *mend; /* in mend, @ is the interface's name */
};

/* What a check writes: a few words on what is. */
typedef char doctor_text[DOCTOR_TEXT_MAX];

#define MACHINE(name, should, mend) DOCTOR_##name,
#define BUS(name, should, mend)
enum {
#include "doctor.def"
	DOCTOR_MACHINE_ROWS
};
#undef MACHINE
#undef BUS
#define MACHINE(name, should, mend)
#define BUS(name, should, mend) DOCTOR_BUS_##name,
enum {
#include "doctor.def"
	DOCTOR_BUS_ROWS
};
#undef MACHINE
#undef BUS

extern const struct doctor_row doctor_machine_row[DOCTOR_MACHINE_ROWS];
extern const struct doctor_row doctor_bus_row[DOCTOR_BUS_ROWS];

/* One function per row. */
#define MACHINE(name, should, mend) \
	enum doctor_verdict doctor_##name(const struct doctor *d, doctor_text is);
#define BUS(name, should, mend) \
	enum doctor_verdict doctor_bus_##name(const struct doctor_bus *b, doctor_text is);
#include "doctor.def"
#undef MACHINE
#undef BUS

/** doctor_say - how a check ends: prints what is into @is and returns @verdict. */
enum doctor_verdict doctor_say(doctor_text is, enum doctor_verdict verdict, const char *fmt, ...)
	__attribute__((format(printf, 3, 4)));

/** doctor_isolated_read - reads @d->isolated, on which other checks rest; empty where none are. */
void doctor_isolated_read(struct doctor *d);

/** doctor_machine, doctor_bus_check - row @i of the tables: fills @is, returns the verdict. Does not wait. */
enum doctor_verdict doctor_machine(const struct doctor *d, int i, doctor_text is);
enum doctor_verdict doctor_bus_check(const struct doctor_bus *b, int i, doctor_text is);

/** doctor_bus_look - watch interface @b->name for @b->window_s seconds and fill the rest but what should be. Waits. */
void doctor_bus_look(const struct doctor *d, struct doctor_bus *b);

/** doctor_bus_names - the CAN interfaces of this machine, at most @max. Returns how many. */
int doctor_bus_names(const struct doctor *d, char (*name)[BUS_NAME_MAX], int max);

#endif
