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

static int is_stuck(const struct inputs *in, enum inputs_role role)
{
	const struct moves m = moves_of(in, role);

	return m.n && m.steps >= SEEN_MIN && !m.moves && in->last_ns - in->first_ns >= STUCK_NS;
}

/* Not 0: then inputs_check_frozen says so. */
static int is_frozen(const struct inputs *in, enum inputs_role role)
{
	return role == INPUTS_EGO_SPEED && in->ego_mps > 0;
}

void inputs_check_stuck(struct inputs_judge *j)
{
	static const enum inputs_role roles[] = {
		INPUTS_EGO_SPEED, INPUTS_DISTANCE,     INPUTS_REL_SPEED,   INPUTS_LATERAL,
		INPUTS_YAW_RATE,  INPUTS_DRIVER_BRAKE, INPUTS_DRIVER_ACCEL};
	const int seen = moves_of(j->in, INPUTS_DISTANCE).moves > SEEN_MIN;
	char name[NAME_MAX_LEN + 32];

	for (size_t i = 0; i < sizeof(roles) / sizeof(roles[0]); i++) {
		const int target = roles[i] == INPUTS_REL_SPEED || roles[i] == INPUTS_LATERAL;

		if (is_stuck(j->in, roles[i]) && !is_frozen(j->in, roles[i])) {
			inputs_say(j, seen && target ? INPUTS_WRONG : INPUTS_DOUBT,
				   inputs_spec(j->in, roles[i], name, sizeof(name)),
				   "never changes in %.0f s%s",
				   (double)(j->in->last_ns - j->in->first_ns) / CLOCK_NS_PER_S,
				   seen && target ? ", though distances do" : "");
			inputs_change(j,
				      "[signal %s] from = another signal; or drive so that it "
				      "should change",
				      inputs_role_table[roles[i]].name);
		}
	}
}

void inputs_check_frozen(struct inputs_judge *j)
{
	char name[NAME_MAX_LEN];

	for (int i = 0; i < j->in->n_signals; i++) {
		const struct inputs_signal *s = &j->in->signal[i];

		if (s->role == INPUTS_EGO_SPEED && s->still_max_ns > STUCK_NS &&
		    fabs(s->map->gain * s->map->sig->scale) < FINE_MPS) {
			inputs_say(j, INPUTS_WRONG, name_of(j->in, s, name),
				   "stays at exactly %.4g m/s for %.0f s: no car that moves does",
				   s->still_mps, (double)s->still_max_ns / CLOCK_NS_PER_S);
			inputs_change(j, "[signal ego_speed] from = another signal");
		}
	}
}
