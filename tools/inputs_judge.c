/* SPDX-License-Identifier: MIT
 * Verdicts: how they are collected, by which checks.
 */
#include "inputs.h"
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include "inputs_checks.h"

const char *const inputs_level_name[INPUTS_LEVELS] = {"WRONG", "doubt", "unknown", "good"};

/* ---- saying ------------------------------------------------------------------------------------ */

static struct inputs_verdict *last(struct inputs_judge *j)
{
	return j->n ? &j->verdict[j->n - 1] : NULL;
}

static void join(struct inputs_verdict *v, const char *subject)
{
	const size_t used = strlen(v->also);

	v->n++;
	snprintf(v->also + used, sizeof(v->also) - used, "%s%s", used ? ", " : "", subject);
}

void inputs_say(struct inputs_judge *j, enum inputs_level level, const char *subject,
		const char *fmt, ...)
{
	struct inputs_verdict *v = last(j);
	va_list ap;
	int n;

	if (v && v->check == j->check && v->level == level) {
		join(v, subject);
		return;
	}
	if (j->n == INPUTS_VERDICTS_MAX) {
		j->lost++;
		return;
	}
	v = &j->verdict[j->n++];
	*v = (struct inputs_verdict){.check = j->check, .level = level, .n = 1};
	n = snprintf(v->what, sizeof(v->what), "%s: ", subject);
	va_start(ap, fmt);
	vsnprintf(v->what + n, sizeof(v->what) - (size_t)n, fmt, ap);
	va_end(ap);
}

void inputs_change(struct inputs_judge *j, const char *fmt, ...)
{
	struct inputs_verdict *v = last(j);
	va_list ap;

	if (v && v->n == 1) {
		va_start(ap, fmt);
		vsnprintf(v->change, sizeof(v->change), fmt, ap);
		va_end(ap);
	}
}

static int by_level(const void *a, const void *b)
{
	const struct inputs_verdict *x = a, *y = b;

	return (int)x->level - (int)y->level;
}

void inputs_judge(struct inputs_judge *j, const struct inputs *in)
{
	static const struct {
		const char *name;
		void (*run)(struct inputs_judge *j);
	} checks[] = {
#define INPUTS_CHECK(name, doc) {#name, inputs_check_##name},
#include "inputs.def"
#undef INPUTS_CHECK
	};

	j->in = in;
	j->n = j->lost = 0;
	for (size_t i = 0; i < sizeof(checks) / sizeof(checks[0]); i++) {
		j->check = checks[i].name;
		checks[i].run(j);
	}
	qsort(j->verdict, (size_t)j->n, sizeof(j->verdict[0]), by_level);
}

int inputs_mapped(const struct inputs *in, enum inputs_role role)
{
	for (int i = 0; i < in->n_signals; i++) {
		if (in->signal[i].role == role) {
			return 1;
		}
	}
	return 0;
}

const char *inputs_spec(const struct inputs *in, enum inputs_role role, char *text, size_t size)
{
	int n = 0;

	text[0] = '\0';
	for (int i = 0; i < in->n_signals; i++) {
		const struct inputs_signal *s = &in->signal[i];

		if (s->role == role && n++ == 0) {
			snprintf(text, size, "%s.%s", in->map->message[s->message].msg->name,
				 s->map->sig->name);
		}
	}
	if (n > 1) {
		const size_t used = strlen(text);

		snprintf(text + used, size - used, " and %d more", n - 1);
	}
	return text;
}
