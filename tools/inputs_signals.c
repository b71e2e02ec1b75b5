/* SPDX-License-Identifier: MIT
 * Verdicts on single signals: are they there, do they move, and as something physical would?
 */
#include <math.h>
#include <stdio.h>
#include "clock.h"
#include "inputs_checks.h"

#define SEEN_MIN     50
#define STUCK_NS     (10 * CLOCK_NS_PER_S)
#define RANGE_WRONG  0.5
#define RANGE_DOUBT  0.01
#define LEAP_SHARE   0.01 /* of full scale, from frame to frame, on average */
#define LEAP_RATIO   8.0  /* to what the other byte order gives */
#define LOW_BITS_MIN 3    /* of the lowest byte must move: else it is one of whole bytes */
#define VARIES_MPS   1.0  /* by which the speed of a car that drives changes */
#define FINE_MPS     0.05 /* a speed of this resolution never stands still while driving */
#define NAME_MAX_LEN (2 * DBC_NAME_MAX + 2)

static const char *name_of(const struct inputs *in, const struct inputs_signal *s,
			   char text[NAME_MAX_LEN])
{
	snprintf(text, NAME_MAX_LEN, "%s.%s", in->map->message[s->message].msg->name,
		 s->map->sig->name);
	return text;
}

void inputs_check_missing(struct inputs_judge *j)
{
	const struct inputs *in = j->in;
	char name[NAME_MAX_LEN];

	for (int i = 0; i < in->n_signals; i++) {
		const struct inputs_signal *s = &in->signal[i];
		const char *role = inputs_role_table[s->role].name;

		if (in->message[s->message].frames - in->message[s->message].lengths < SEEN_MIN) {
			continue;
		}
		if (!s->seen) {
			inputs_say(j, INPUTS_WRONG, name_of(in, s, name),
				   "is multiplexed, and never selected");
			inputs_change(j, "[signal %s] from = another signal", role);
		} else if (s->na == s->seen && s->track < 0) {
			inputs_say(j, s->role == INPUTS_EGO_SPEED ? INPUTS_WRONG : INPUTS_DOUBT,
				   name_of(in, s, name), "always says not available");
			inputs_change(j, "[signal %s] na, or from = another signal", role);
		}
	}
}

void inputs_check_range(struct inputs_judge *j)
{
	const struct inputs *in = j->in;
	char name[NAME_MAX_LEN];

	for (int i = 0; i < in->n_signals; i++) {
		const struct inputs_signal *s = &in->signal[i];
		const double off = inputs_share(s->range, s->seen);

		if (s->seen >= SEEN_MIN && off > RANGE_DOUBT) {
			inputs_say(j, off > RANGE_WRONG ? INPUTS_WRONG : INPUTS_DOUBT,
				   name_of(in, s, name),
				   "%.0f %% of the values lie outside of %g..%g, which the "
				   "database allows",
				   100 * off, s->map->sig->min, s->map->sig->max);
			inputs_change(j, "scale, offset or sign of the signal in the database, or "
					 "its range");
		}
	}
}

/* ---- byte order -------------------------------------------------------------------------------- */

static int is_swap_better(const struct inputs_signal *s, const struct inputs_swap *w)
{
	return s->travel > LEAP_SHARE * (double)s->steps && s->travel > LEAP_RATIO * w->travel &&
	       __builtin_popcountll(s->moved & 0xFF) >= LOW_BITS_MIN;
}

static void judge_swap(struct inputs_judge *j, const struct inputs_signal *s,
		       const struct inputs_swap *w)
{
	char name[NAME_MAX_LEN];

	inputs_say(j, INPUTS_WRONG, name_of(j->in, s, name),
		   "leaps by %.3g %% of its full scale from frame to frame; read with the other "
		   "byte order by "
		   "%.2g %%",
		   100 * s->travel / (double)s->steps, 100 * w->travel / (double)s->steps);
	inputs_change(j, "the database: SG_ %s : %u|%u@%d%c", s->map->sig->name, w->sig.start,
		      w->sig.len, !w->sig.big_endian, w->sig.is_signed ? '-' : '+');
}

void inputs_check_byte_order(struct inputs_judge *j)
{
	for (int i = 0; i < j->in->n_signals; i++) {
		const struct inputs_signal *s = &j->in->signal[i];
		const struct inputs_swap *best = NULL;

		for (int k = 0; k < s->n_swaps && s->steps >= SEEN_MIN; k++) {
			if (is_swap_better(s, &s->swap[k]) &&
			    (!best || s->swap[k].travel < best->travel)) {
				best = &s->swap[k];
			}
		}
		if (best) {
			judge_swap(j, s, best);
		}
	}
}

/* ---- stuck ------------------------------------------------------------------------------------- */

struct moves {
	uint64_t steps, moves;
	int n;
};

static struct moves moves_of(const struct inputs *in, enum inputs_role role)
{
	struct moves m = {0};

	for (int i = 0; i < in->n_signals; i++) {
		if (in->signal[i].role == role) {
			m.steps += in->signal[i].steps;
			m.moves += in->signal[i].moves;
			m.n++;
		}
	}
	return m;
}

int inputs_stuck(const struct inputs *in, enum inputs_role role)
{
	const struct moves m = moves_of(in, role);

	return m.n && m.steps >= SEEN_MIN && !m.moves && in->last_ns - in->first_ns >= STUCK_NS;
}

/* A speed that is exactly the same for too long for a car that drives; one of 0 may be. */
static int is_frozen(const struct inputs_signal *s)
{
	return s->role == INPUTS_EGO_SPEED && s->still_max_ns > STUCK_NS &&
	       fabs(s->map->gain * s->map->sig->scale) < FINE_MPS;
}

/* Does the car drive, so that targets should live? */
static int is_driving(const struct inputs *in)
{
	for (int i = 0; i < in->n_signals; i++) {
		const struct inputs_signal *s = &in->signal[i];

		if (s->role == INPUTS_EGO_SPEED && (s->max - s->min > VARIES_MPS || is_frozen(s))) {
			return in->last_ns - in->first_ns >= STUCK_NS;
		}
	}
	return 0;
}

/* Is that distance of a target in every frame, and does nothing beside it in its message ever change either? */
static int is_still(const struct inputs *in, const struct inputs_signal *distance)
{
	if (distance->role != INPUTS_DISTANCE || distance->steps < SEEN_MIN ||
	    !(distance->min <= in->cfg->radar_range_max)) {
		return 0;
	}
	for (int i = 0; i < in->n_signals; i++) {
		const struct inputs_signal *s = &in->signal[i];

		if (s->track == distance->track && s->message == distance->message &&
		    (s->moves || (s->role == INPUTS_VALID && !(fabs(s->min) > 0)))) {
			return 0;
		}
	}
	return 1;
}

int inputs_still(const struct inputs *in)
{
	int n = 0;

	for (int i = 0; i < in->n_signals && is_driving(in); i++) {
		n += is_still(in, &in->signal[i]);
	}
	return n;
}

void inputs_check_still(struct inputs_judge *j)
{
	const struct inputs *in = j->in;
	char name[DBC_NAME_MAX + 16];

	for (int i = 0; i < in->n_signals && is_driving(in); i++) {
		const struct inputs_signal *s = &in->signal[i];
		const struct dbc_message *msg = in->map->message[s->message].msg;

		if (is_still(in, s)) {
			snprintf(name, sizeof(name), "%s (0x%03X)", msg->name,
				 msg->id & BUS_ID_MASK);
			inputs_say(j, INPUTS_WRONG, name,
				   "its target stays at exactly %.4g m for %.0f s, though the "
				   "car drives: no radar that lives says so",
				   s->min, (double)(in->last_ns - in->first_ns) / CLOCK_NS_PER_S);
			inputs_change(j, "the radar or a gateway that repeats an old frame; or "
					 "[signal distance] from = another message");
		}
	}
}

/* Is it said elsewhere? Of a speed that is not 0 by inputs_check_frozen, of targets by inputs_check_still. */
static int is_told(const struct inputs *in, enum inputs_role role, int is_target)
{
	return role == INPUTS_EGO_SPEED ? in->ego_mps > 0 : is_target && inputs_still(in);
}

void inputs_check_stuck(struct inputs_judge *j)
{
	static const struct {
		enum inputs_role role;
		int is_target;
	} rows[] = {{INPUTS_EGO_SPEED, 0},   {INPUTS_DISTANCE, 1}, {INPUTS_REL_SPEED, 1},
		    {INPUTS_LATERAL, 1},     {INPUTS_YAW_RATE, 0}, {INPUTS_DRIVER_BRAKE, 0},
		    {INPUTS_DRIVER_ACCEL, 0}};
	const int seen = moves_of(j->in, INPUTS_DISTANCE).moves > SEEN_MIN;
	char name[NAME_MAX_LEN + 32];

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		const int wrong = rows[i].is_target && seen;

		if (inputs_stuck(j->in, rows[i].role) &&
		    (wrong || !is_told(j->in, rows[i].role, rows[i].is_target))) {
			inputs_say(j, wrong ? INPUTS_WRONG : INPUTS_DOUBT,
				   inputs_spec(j->in, rows[i].role, name, sizeof(name)),
				   "never changes in %.0f s%s",
				   (double)(j->in->last_ns - j->in->first_ns) / CLOCK_NS_PER_S,
				   wrong ? ", though distances do" : "");
			inputs_change(j,
				      "[signal %s] from = another signal; or drive so that it "
				      "should change",
				      inputs_role_table[rows[i].role].name);
		}
	}
}

void inputs_check_frozen(struct inputs_judge *j)
{
	char name[NAME_MAX_LEN];

	for (int i = 0; i < j->in->n_signals; i++) {
		const struct inputs_signal *s = &j->in->signal[i];

		if (is_frozen(s)) {
			inputs_say(j, INPUTS_WRONG, name_of(j->in, s, name),
				   "stays at exactly %.4g m/s for %.0f s: no car that moves does",
				   s->still_mps, (double)s->still_max_ns / CLOCK_NS_PER_S);
			inputs_change(j, "[signal ego_speed] from = another signal");
		}
	}
}
