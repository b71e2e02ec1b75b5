/* SPDX-License-Identifier: MIT
 * What is seen, as a table; what it means, as lines; both as JSON.
 */
#include "inputs.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include "clock.h"
#include "json.h"

static double age_ms(const struct inputs *in, int64_t t_ns)
{
	return (double)(in->last_ns - t_ns) / CLOCK_NS_PER_MS;
}

/* Mean since the first frame; NaN before the second. */
static double rate_hz(const struct inputs_message *st)
{
	return st->frames > 1 ? (double)(st->frames - 1) * CLOCK_NS_PER_S /
					(double)(st->last_ns - st->first_ns)
			      : NAN;
}

static double period_hz(const struct map_message *m)
{
	return (double)CLOCK_NS_PER_S / (double)m->period_ns;
}

static uint64_t jumps(const struct inputs_message *st)
{
	return st->status[E2E_REPEATED] + st->status[E2E_SOME_LOST] +
	       st->status[E2E_WRONG_SEQUENCE];
}

/* A number in a column of its own, a dash for what is not known. */
static void column(FILE *out, int width, int digits, double v)
{
	if (isfinite(v)) {
		fprintf(out, " %*.*f", width, digits, v);
	} else {
		fprintf(out, " %*s", width, "-");
	}
}

static void message_row(const struct inputs *in, int i, FILE *out)
{
	const struct map_message *m = &in->map->message[i];
	const struct inputs_message *st = &in->message[i];
	const int has_counter = m->counter || m->check == E2E_P2;

	fprintf(out, "%-24.24s %5X %-6s %7" PRIu64, m->msg->name, m->msg->id & BUS_ID_MASK,
		in->iface[m->iface], st->frames);
	column(out, 6, 1, rate_hz(st));
	column(out, 6, 1, period_hz(m));
	column(out, 7, 0, st->frames ? age_ms(in, st->last_ns) : NAN);
	if (m->check == E2E_NONE) {
		fprintf(out, "  %-16s", "not checked");
	} else {
		fprintf(out, "  %-6s %" PRIu64 " bad   ", e2e_kind_name[m->check],
			st->status[E2E_WRONG_CRC]);
	}
	if (has_counter) {
		fprintf(out, "  %" PRIu64 " jumps", jumps(st));
	}
	fputc('\n', out);
}

static void signal_row(const struct inputs *in, const struct inputs_signal *s, FILE *out)
{
	const struct inputs_role_row *r = &inputs_role_table[s->role];
	char spec[2 * DBC_NAME_MAX + 2];

	snprintf(spec, sizeof(spec), "%s.%s", in->map->message[s->message].msg->name,
		 s->map->sig->name);
	fprintf(out, "%-30.30s %-12s", spec, r->name);
	column(out, 9, 3, s->now);
	fprintf(out, " %-5s", r->unit);
	column(out, 7, 0, isnan(s->now) ? NAN : age_ms(in, s->now_ns));
	column(out, 9, 3, s->min);
	fputs(" ..", out);
	column(out, 8, 3, s->max);
	if (s->seen) {
		fprintf(out, "  %3.0f %% n/a", 100 * (double)s->na / (double)s->seen);
	}
	fputc('\n', out);
}

void inputs_table(const struct inputs *in, int lines, FILE *out)
{
	const int rows = in->map->n_messages + in->n_signals;
	int left = lines ? lines - 4 : rows; /* without two heads, the time and what was cut */

	fprintf(out, "%-24s %5s %-6s %7s %6s %6s %7s  %-16s  %s\n", "message", "id", "on", "frames",
		"Hz", "should", "age ms", "checksum", "counter");
	for (int i = 0; i < in->map->n_messages && left > 0; i++, left--) {
		message_row(in, i, out);
	}
	fprintf(out, "%-30s %-12s %9s %-5s %7s %9s\n", "signal", "role", "value", "", "age ms",
		"seen from .. to");
	for (int i = 0; i < in->n_signals && left > 0; i++, left--) {
		signal_row(in, &in->signal[i], out);
	}
	if (lines && rows > lines - 4) {
		fprintf(out, "... %d more rows; a larger window, a log or --json shows all\n",
			rows - (lines > 4 ? lines - 4 : 0));
	}
}

void inputs_verdicts(const struct inputs_judge *j, FILE *out)
{
	for (int i = 0; i < j->n; i++) {
		const struct inputs_verdict *v = &j->verdict[i];

		fprintf(out, "%-8s %s", inputs_level_name[v->level], v->what);
		fprintf(out, *v->also ? " (and so: %s)\n" : "\n", v->also);
		if (*v->change) {
			fprintf(out, "%-8s change: %s\n", "", v->change);
		}
	}
	if (j->lost) {
		fprintf(out, "and %d verdicts more\n", j->lost);
	}
}

/* ---- JSON -------------------------------------------------------------------------------------- */

static void json_message(struct json *j, const struct inputs *in, int i)
{
	const struct map_message *m = &in->map->message[i];
	const struct inputs_message *st = &in->message[i];

	json_open(j, NULL, '{');
	json_str(j, "name", m->msg->name);
	json_uint(j, "id", m->msg->id & BUS_ID_MASK);
	json_str(j, "interface", in->iface[m->iface]);
	json_uint(j, "frames", st->frames);
	json_num(j, "rate_hz", rate_hz(st));
	json_num(j, "should_hz", period_hz(m));
	json_num(j, "age_ms", st->frames ? age_ms(in, st->last_ns) : NAN);
	json_str(j, "check", e2e_kind_name[m->check]);
	json_uint(j, "wrong_checksum", st->status[E2E_WRONG_CRC]);
	json_uint(j, "wrong_length", st->lengths);
	json_bool(j, "has_counter", m->counter || m->check == E2E_P2);
	json_uint(j, "counter_repeated", st->status[E2E_REPEATED]);
	json_uint(j, "counter_skipped", st->status[E2E_SOME_LOST] + st->status[E2E_WRONG_SEQUENCE]);
	json_close(j, '}');
}

static void json_signal(struct json *j, const struct inputs *in, const struct inputs_signal *s)
{
	json_open(j, NULL, '{');
	json_str(j, "message", in->map->message[s->message].msg->name);
	json_str(j, "signal", s->map->sig->name);
	json_str(j, "role", inputs_role_table[s->role].name);
	json_str(j, "unit", inputs_role_table[s->role].unit);
	json_num(j, "value", s->now);
	json_num(j, "age_ms", isnan(s->now) ? NAN : age_ms(in, s->now_ns));
	json_num(j, "min", s->min);
	json_num(j, "max", s->max);
	json_uint(j, "seen", s->seen);
	json_uint(j, "not_available", s->na);
	json_uint(j, "out_of_range", s->range);
	json_uint(j, "changes", s->moves);
	json_close(j, '}');
}

static void json_verdict(struct json *j, const struct inputs_verdict *v)
{
	json_open(j, NULL, '{');
	json_str(j, "check", v->check);
	json_str(j, "level", inputs_level_name[v->level]);
	json_str(j, "what", v->what);
	json_str(j, "also", v->also);
	json_uint(j, "count", (uint64_t)v->n);
	json_str(j, "change", v->change);
	json_close(j, '}');
}

void inputs_json(const struct inputs *in, const struct inputs_judge *v, const char *source,
		 int interrupted, FILE *out)
{
	struct json j = json_start(out);

	json_head(&j, "inputs");
	json_str(&j, "source", source);
	json_num(&j, "seconds", (double)(in->last_ns - in->first_ns) / CLOCK_NS_PER_S);
	json_uint(&j, "frames", in->frames);
	json_bool(&j, "interrupted", interrupted);
	json_open(&j, "messages", '[');
	for (int i = 0; i < in->map->n_messages; i++) {
		json_message(&j, in, i);
	}
	json_close(&j, ']');
	json_open(&j, "signals", '[');
	for (int i = 0; i < in->n_signals; i++) {
		json_signal(&j, in, &in->signal[i]);
	}
	json_close(&j, ']');
	json_open(&j, "verdicts", '[');
	for (int i = 0; i < v->n; i++) {
		json_verdict(&j, &v->verdict[i]);
	}
	json_close(&j, ']');
	json_bool(&j, "wrong", v->n > 0 && v->verdict[0].level == INPUTS_WRONG);
	json_close(&j, '}');
}
