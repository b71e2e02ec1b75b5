/* SPDX-License-Identifier: MIT
 * A queue of ego speeds and their plausibility.
 */
#include "speeds.h"
#include "decode.h"

void speeds_reset(struct speeds *q)
{
	*q = (struct speeds){.last.t_ns = DECODE_NEVER, .heard_ns = DECODE_NEVER};
}

int speeds_judge(struct speeds *q, const struct speed *s, double accel_max, double noise)
{
	const double limit = accel_max * (double)(s->t_ns - q->last.t_ns) * 1e-9 + noise;
	const double step = s->mps - q->last.mps;

	q->heard_ns = s->t_ns;
	q->jumps = step > limit || step < -limit ? q->jumps + 1 : 0;
	return q->jumps;
}

static struct speed take_oldest(struct speeds *q)
{
	const struct speed s = q->queue[q->head];

	q->head = (q->head + 1) % SPEEDS_MAX;
	q->n--;
	return s;
}

int speeds_push(struct speeds *q, const struct speed *s, struct speed *out)
{
	const int full = q->n == SPEEDS_MAX;

	if (full) {
		*out = take_oldest(q);
	}
	q->queue[(q->head + q->n++) % SPEEDS_MAX] = *s;
	q->last = *s;
	q->heard_ns = s->t_ns;
	return full;
}

int speeds_pop(struct speeds *q, int64_t t_ns, struct speed *out)
{
	if (q->n == 0 || q->queue[q->head].t_ns > t_ns) {
		return 0;
	}
	*out = take_oldest(q);
	return 1;
}

const struct speed *speeds_at(const struct speeds *q, int i)
{
	return &q->queue[(q->head + i) % SPEEDS_MAX];
}
