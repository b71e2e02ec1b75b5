/* SPDX-License-Identifier: MIT
 * Verdicts on messages: do they come, as often as they should, new and intact?
 */
#include "clock.h"
#include "inputs_checks.h"

#define FRAMES_MIN    20 /* below that nothing is said about a message */
#define ABSENT_NS     CLOCK_NS_PER_S
#define SILENCE_NS    (CLOCK_NS_PER_S / 2)
#define PERIOD_WRONG  1.5
#define PERIOD_DOUBT  1.2
#define TWICE_WRONG   0.4
#define TWICE_DOUBT   0.05
#define CRC_WRONG     0.1
#define COUNTER_WRONG 0.5
#define COUNTER_DOUBT 0.01

static const char *name_of(const struct inputs *in, int i)
{
	return in->map->message[i].msg->name;
}

static unsigned id_of(const struct inputs *in, int i)
{
	return in->map->message[i].msg->id & BUS_ID_MASK;
}

static double watched_s(const struct inputs *in)
{
	return (double)(in->last_ns - in->first_ns) / CLOCK_NS_PER_S;
}

/* Enough frames to judge? */
static int enough(const struct inputs *in, int i)
{
	return in->message[i].frames >= FRAMES_MIN;
}

static void say_absent(struct inputs_judge *j, int i)
{
	const struct inputs *in = j->in;
	const struct map_message *m = &in->map->message[i];
	const struct census_id *there = census_elsewhere(&in->census, m->msg->id);
	const struct census_id *near = census_nearest(&in->census, m->iface, m->msg->id);
	const char *iface = in->iface[m->iface];

	if (there) {
		const char *other = in->iface[there->iface];

		inputs_say(j, INPUTS_WRONG, name_of(in, i),
			   "0x%03X does not come on %s, but %llu times on %s", id_of(in, i), iface,
			   (unsigned long long)there->frames, other);
		inputs_change(j, "%s[message %s] interface = %s",
			      there->iface < in->map->n_ifaces ? "" : "add it to bus.interfaces; ",
			      name_of(in, i), other);
	} else if (near && !in->is_live) {
		inputs_say(j, INPUTS_WRONG, name_of(in, i),
			   "0x%03X does not come; nearest on %s is 0x%03X", id_of(in, i), iface,
			   near->id & BUS_ID_MASK);
		inputs_change(j,
			      "the database is of another car or bus, or BO_ %u has another number",
			      m->msg->id);
	} else {
		inputs_say(j, INPUTS_WRONG, name_of(in, i), "nothing comes on %s in %.1f s%s%s",
			   iface, watched_s(in),
			   in->n_ifaces > in->map->n_ifaces ? "; the log also has " : "",
			   in->n_ifaces > in->map->n_ifaces ? in->iface[in->map->n_ifaces] : "");
		inputs_change(j, "bus.interfaces, or the bus: is it up, is the ignition on?");
	}
}

void inputs_check_absent(struct inputs_judge *j)
{
	const struct inputs *in = j->in;

	for (int i = 0; i < in->map->n_messages; i++) {
		const int64_t wait = 5 * in->map->message[i].period_ns;

		if (in->message[i].frames) {
			continue;
		}
		if (in->last_ns - in->first_ns < (wait > ABSENT_NS ? wait : ABSENT_NS)) {
			inputs_say(j, INPUTS_UNTOLD, name_of(in, i), "not seen in %.1f s",
				   watched_s(in));
		} else {
			say_absent(j, i);
		}
	}
}

void inputs_check_length(struct inputs_judge *j)
{
	for (int i = 0; i < j->in->map->n_messages; i++) {
		const struct inputs_message *st = &j->in->message[i];

		if (st->lengths) {
			inputs_say(j,
				   inputs_share(st->lengths, st->frames) > 0.01 ? INPUTS_WRONG
										: INPUTS_DOUBT,
				   name_of(j->in, i),
				   "%llu of %llu frames have %u bytes, the database says %u",
				   (unsigned long long)st->lengths, (unsigned long long)st->frames,
				   st->length, j->in->map->message[i].msg->size);
			inputs_change(
				j, "BO_ in the database, or another message has this identifier");
		}
	}
}

static int is_twice(const struct inputs_message *st)
{
	return inputs_share(st->status[E2E_REPEATED], st->frames) > TWICE_WRONG ||
	       inputs_share(st->twins, st->frames) > TWICE_WRONG;
}

/* Frames of a list come as there are objects. */
static int is_regular(const struct inputs *in, int i)
{
	const struct map_message *m = &in->map->message[i];

	return enough(in, i) &&
	       !(in->map->list.header >= 0 && (m->part == MAP_TARGET || m->part == MAP_QUALITY));
}

static void judge_period(struct inputs_judge *j, int i)
{
	const struct inputs_message *st = &j->in->message[i];
	const double should = (double)j->in->map->message[i].period_ns;
	const double is = (double)(st->last_ns - st->first_ns) / (double)(st->frames - 1);
	const double off = is > should ? is / should : should / is;

	if (off > PERIOD_DOUBT) {
		inputs_say(j, off > PERIOD_WRONG ? INPUTS_WRONG : INPUTS_DOUBT, name_of(j->in, i),
			   "a frame every %.4g ms, the mapping says %.4g ms%s", is * 1e-6,
			   should * 1e-6,
			   is > should * (double)j->in->cfg->bus_stale_periods
				   ? ": it would always be stale"
				   : "");
		inputs_change(j, "[message %s] period = %.3g", name_of(j->in, i), is * 1e-6);
	} else {
		inputs_say(j, INPUTS_GOOD, name_of(j->in, i),
			   "a frame every %.4g ms, the mapping says %.4g ms", is * 1e-6,
			   should * 1e-6);
	}
}

void inputs_check_period(struct inputs_judge *j)
{
	for (int i = 0; i < j->in->map->n_messages; i++) {
		if (is_regular(j->in, i) && !is_twice(&j->in->message[i])) {
			judge_period(j, i);
		}
	}
}

void inputs_check_silence(struct inputs_judge *j)
{
	for (int i = 0; i < j->in->map->n_messages; i++) {
		const int64_t silence = j->in->message[i].silence_ns;
		const int64_t limit =
			j->in->cfg->bus_stale_periods * j->in->map->message[i].period_ns;

		if (is_regular(j->in, i) && silence > 2 * limit && silence > SILENCE_NS) {
			inputs_say(j, INPUTS_DOUBT, name_of(j->in, i), "once silent for %.1f s",
				   (double)silence / CLOCK_NS_PER_S);
		}
	}
}

static void judge_twice(struct inputs_judge *j, int i)
{
	const struct inputs_message *st = &j->in->message[i];
	const char *name = name_of(j->in, i);
	const double repeats = inputs_share(st->status[E2E_REPEATED], st->frames);
	const double twins = inputs_share(st->twins, st->frames);

	if (repeats > 0.95) {
		inputs_say(j, INPUTS_WRONG, name, "its counter never changes");
		inputs_change(j, "[message %s] counter = another signal, or none", name);
	} else if (repeats > TWICE_WRONG) {
		inputs_say(j, INPUTS_WRONG, name,
			   "its counter repeats in %.0f %% of the frames: sent twice?",
			   100 * repeats);
		inputs_change(j, "record each bus once, look for a second sender or a gateway");
	} else if (twins > TWICE_WRONG) {
		inputs_say(j, INPUTS_WRONG, name,
			   "%.0f %% of the frames repeat the one just before: sent twice?",
			   100 * twins);
		inputs_change(j, "record each bus once, look for a second sender or a gateway");
	} else if (repeats > TWICE_DOUBT) {
		inputs_say(j, INPUTS_DOUBT, name, "its counter repeats in %.0f %% of the frames",
			   100 * repeats);
	}
}

void inputs_check_twice(struct inputs_judge *j)
{
	for (int i = 0; i < j->in->map->n_messages; i++) {
		if (enough(j->in, i)) {
			judge_twice(j, i);
		}
	}
}

/* A check that all frames pass, though they differ; E2E_NONE if there is none. */
static enum e2e_kind other_check(const struct inputs *in, int i)
{
	const struct inputs_message *st = &in->message[i];

	for (int kind = E2E_NONE + 1; kind < E2E_KINDS; kind++) {
		if (st->passes[kind] == st->frames) {
			return (enum e2e_kind)kind;
		}
	}
	return E2E_NONE;
}

static int has_moved(const struct inputs *in, int i)
{
	for (int k = 0; k < in->n_signals; k++) {
		if (in->signal[k].message == i && in->signal[k].moves > FRAMES_MIN) {
			return 1;
		}
	}
	return 0;
}

static void judge_unchecked(struct inputs_judge *j, int i)
{
	const enum e2e_kind other = other_check(j->in, i);

	if (other != E2E_NONE && has_moved(j->in, i)) {
		inputs_say(j, INPUTS_DOUBT, name_of(j->in, i),
			   "is not checked, but all %llu frames would pass check %s",
			   (unsigned long long)j->in->message[i].frames, e2e_kind_name[other]);
		inputs_change(j, "[message %s] check = %s", name_of(j->in, i),
			      e2e_kind_name[other]);
	}
}

static void judge_crc(struct inputs_judge *j, int i)
{
	const struct inputs_message *st = &j->in->message[i];
	const char *name = name_of(j->in, i), *kind = e2e_kind_name[j->in->map->message[i].check];
	const uint64_t wrong = st->status[E2E_WRONG_CRC];
	const enum e2e_kind other = other_check(j->in, i);

	if (wrong && inputs_by_chance(st, j->in->map->message[i].check)) {
		inputs_say(j, INPUTS_WRONG, name,
			   "its checksum is wrong in %llu of %llu frames, and right as often as by "
			   "chance (check %s)",
			   (unsigned long long)wrong, (unsigned long long)st->frames, kind);
		inputs_change(j, "[message %s] check = %s", name, e2e_kind_name[other]);
	} else if (wrong) {
		inputs_say(j,
			   inputs_share(wrong, st->frames) > CRC_WRONG ? INPUTS_WRONG
								       : INPUTS_DOUBT,
			   name,
			   "its checksum is wrong in %llu of %llu frames (check %s): they are not "
			   "used",
			   (unsigned long long)wrong, (unsigned long long)st->frames, kind);
		inputs_change(j, "a second sender of 0x%03X, or a disturbed bus", id_of(j->in, i));
	} else {
		inputs_say(j, INPUTS_GOOD, name,
			   "its checksum is right in all %llu frames (check %s)",
			   (unsigned long long)st->frames, kind);
	}
}

void inputs_check_crc(struct inputs_judge *j)
{
	for (int i = 0; i < j->in->map->n_messages; i++) {
		if (!enough(j->in, i)) {
			continue;
		}
		if (j->in->map->message[i].check == E2E_NONE) {
			judge_unchecked(j, i);
		} else {
			judge_crc(j, i);
		}
	}
}

void inputs_check_counter(struct inputs_judge *j)
{
	for (int i = 0; i < j->in->map->n_messages; i++) {
		const struct inputs_message *st = &j->in->message[i];
		const double wrong = inputs_share(st->status[E2E_WRONG_SEQUENCE], st->frames);
		const double lost = inputs_share(st->status[E2E_SOME_LOST], st->frames);

		if (!enough(j->in, i) || is_twice(st) || wrong + lost < COUNTER_DOUBT) {
			continue;
		}
		if (wrong > COUNTER_WRONG) {
			inputs_say(j, INPUTS_WRONG, name_of(j->in, i),
				   "its counter does not go up by one in %.0f %% of the frames",
				   100 * wrong);
			inputs_change(j, "[message %s] counter = another signal, or none",
				      name_of(j->in, i));
		} else {
			inputs_say(j, INPUTS_DOUBT, name_of(j->in, i),
				   "its counter skips in %.1f %% of the frames: some are lost",
				   100 * (wrong + lost));
		}
	}
}
