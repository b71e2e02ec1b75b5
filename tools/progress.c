/* SPDX-License-Identifier: MIT
 * A progress line for a person: on standard error, only where that is a terminal, only for work over 2 s.
 */
#include "progress.h"
#include <stdio.h>
#include <unistd.h>
#include "clock.h"

#define QUIET_NS  (2 * CLOCK_NS_PER_S)
#define REDRAW_NS (CLOCK_NS_PER_S / 5)

struct progress progress_start(const char *what)
{
	return (struct progress){what, isatty(STDERR_FILENO), 0, clock_now_ns(), 0};
}

static void draw(double share, double elapsed_s)
{
	if (share > 0) {
		int left_s = (int)(elapsed_s * (1 - share) / share + 0.5);

		fprintf(stderr, " %3.0f %%, %d:%02d left", share * 100, left_s / 60, left_s % 60);
	} else {
		fprintf(stderr, " %.0f s", elapsed_s);
	}
}

void progress_update(struct progress *p, double share, const char *words)
{
	int64_t now_ns = p->on ? clock_now_ns() : 0;

	if (!p->on || now_ns - p->start_ns < QUIET_NS || now_ns - p->last_ns < REDRAW_NS) {
		return;
	}
	fprintf(stderr, "\r\033[K%s", p->what);
	draw(share, (double)(now_ns - p->start_ns) / CLOCK_NS_PER_S);
	fprintf(stderr, "%s%s", *words ? ", " : "", words);
	fflush(stderr);
	p->last_ns = now_ns;
	p->shown = 1;
}

void progress_clear(struct progress *p)
{
	if (p->shown) {
		fputs("\r\033[K", stderr);
		fflush(stderr);
		p->shown = 0;
	}
}
