/* SPDX-License-Identifier: MIT
 * A bus around a bus that remembers when the first and the last frame came.
 */
#include "stamped.h"

static int stamped_recv(struct bus *b, struct bus_frame *f, int max, int64_t until_ns,
			int64_t *now_ns)
{
	struct stamped *s = (struct stamped *)b; /* the first member */
	int n = s->inner->ops->recv(s->inner, f, max, until_ns, now_ns);

	if (n > 0) {
		s->first_ns = s->first_ns ? s->first_ns : f[0].t_ns;
		s->last_ns = f[n - 1].t_ns;
	}
	return n;
}

static int stamped_send(struct bus *b, const struct bus_frame *f)
{
	struct stamped *s = (struct stamped *)b;

	return s->inner->ops->send(s->inner, f);
}

static const struct bus_stats *stamped_stats(const struct bus *b)
{
	const struct stamped *s = (const struct stamped *)b;

	return s->inner->ops->stats(s->inner);
}

static void stamped_close(struct bus *b)
{
	(void)b;
}

static const struct bus_ops stamped_ops = {
	.name = "log",
	.recv = stamped_recv,
	.send = stamped_send,
	.stats = stamped_stats,
	.close = stamped_close,
};

void stamped_init(struct stamped *s, struct bus *inner)
{
	*s = (struct stamped){.bus = {&stamped_ops}, .inner = inner};
}
