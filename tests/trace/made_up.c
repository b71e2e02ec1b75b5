/* SPDX-License-Identifier: MIT
 * A drive that never took place, for a tracer: a thousand evaluations whose times are drawn, one batch of 600 ms with the
 * scans skipped meanwhile, one stall of 29 periods. Fires what the daemon would fire, counts into histograms as it does, and
 * prints its status, which a report of the trace must agree with. usage: made-up-trace [SECONDS to stay afterwards]
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "clock.h"
#include "decision.h"
#include "status.h"
#include "trace.h"

#define CYCLES     1000
#define SCAN_NS    (50 * CLOCK_NS_PER_MS)
#define PERIOD_NS  (20 * CLOCK_NS_PER_MS)
#define LONG_CYCLE 400 /* its batch takes 600 ms */
#define STALL      700 /* at this scan 29 periods are missed */
#define US         1000.0

struct world {
	const struct trace_ops *ops;
	uint64_t random, published;
	int64_t start_ns, due_ns;
	struct hist hist[STAGES];
	struct status status;
};

/* 0..1; the same drive every time */
static double draw(struct world *w)
{
	w->random = w->random * 6364136223846793005ULL + 1442695040888963407ULL;
	return (double)(w->random >> 40) / (1 << 24);
}

static void miss(struct world *w, uint64_t id, enum miss kind, const char *stage, uint64_t n,
		 int64_t late_ns)
{
	uint64_t *const count[MISSES] = {&w->status.stats.stage_miss, &w->status.stats.late,
					 &w->status.stats.period_miss, &w->status.stats.skipped};

	*count[kind] += n;
	TRACE(w->ops, miss, id, miss_name[kind], stage, n, late_ns);
}

static void close_stages(struct world *w, uint64_t id, const int64_t t_ns[EDGES], enum edge e)
{
	for (int s = 0; s < STAGES; s++) {
		const struct stage_row *r = &stage_table[s];
		const int64_t ns = r->to == e ? stage_ns((enum stage)s, t_ns) : -1;

		if (ns < 0) {
			continue;
		}
		hist_add(&w->hist[s], ns);
		if (r->budget_ns && ns > r->budget_ns) {
			w->status.stats.stage_misses[s]++;
			miss(w, id, MISS_STAGE, r->name, 1, ns - r->budget_ns);
		}
	}
}

static void batch(const struct world *w, uint64_t id, int64_t from_ns, int64_t to_ns)
{
	const int64_t took_ns = to_ns - from_ns;
	const int64_t t_ns[MC_EDGES] = {[MC_EDGE_TAKEN] = from_ns + took_ns / 10,
					[MC_EDGE_LAUNCHED] = from_ns + took_ns / 5,
					[MC_EDGE_ANSWERED] = from_ns + took_ns * 7 / 10,
					[MC_EDGE_VERIFIED] = from_ns + took_ns * 8 / 10,
					[MC_EDGE_DONE] = from_ns + took_ns * 9 / 10};

	for (int e = 0; e < MC_EDGES; e++) {
		TRACE(w->ops, batch, id, (enum mc_edge)e, t_ns[e]);
	}
}

/* The car nears its lead, which then leaves it behind; the risk follows. */
static void evaluation(const struct world *w, uint64_t id, int64_t t_ns)
{
	const double whole_s = CYCLES * (double)SCAN_NS / CLOCK_NS_PER_S;
	const double s = (double)(t_ns - w->start_ns) / CLOCK_NS_PER_S / whole_s;
	const double near = exp(-40 * (s - 0.75) * (s - 0.75));
	const double p = 1e-4 + 0.9 * near * near,
		     headway_mps = 70 * near * 80 * (s - 0.75) / whole_s;
	const struct trace_evaluation e = {.cycle = id,
					   .samples = 16384,
					   .t_ns = t_ns,
					   .speed_mps = 30 - 8 * near,
					   .headway_m = 90 - 70 * near,
					   .lead_speed_mps = 30 - 8 * near + headway_mps,
					   .safe_m = 40 + 10 * near,
					   .lead = 1,
					   .p = p,
					   .lo = p * 0.9,
					   .hi = fmin(p * 1.1, 1),
					   .accel_mps2 = p > 0.5 ? -6 : 0,
					   .level = level_name[p > 0.5    ? LEVEL_FULL
							       : p > 0.05 ? LEVEL_WARN
									  : LEVEL_NONE],
					   .state =
						   state_name[p > 0.5 ? STATE_BRAKE : STATE_ARMED]};

	TRACE(w->ops, evaluation, &e);
}

static void cycle(struct world *w, uint64_t id)
{
	const double took_us[EDGES] = {
		[EDGE_SCAN] = 20000 + 40000 * draw(w),
		[EDGE_SCENE] = 100 + 80 * draw(w),
		[EDGE_SUBMIT] = 10 + 8 * draw(w),
		[EDGE_RESULT] = id == LONG_CYCLE ? 600000 : 800 * exp(3.5 * draw(w) * draw(w)),
		[EDGE_DECIDE] = 3 + 5 * draw(w),
		[EDGE_SEND] = 18000 * draw(w),
		[EDGE_CONFIRM] = 150 + 100 * draw(w),
	};
	int64_t t_ns[EDGES] = {0}, at_ns = w->start_ns + (int64_t)id * SCAN_NS;

	for (int e = 0; e < EDGES; e++) {
		at_ns += (int64_t)(took_us[e] * US);
		t_ns[e] = at_ns;
		if (e == EDGE_RESULT) {
			batch(w, id, t_ns[EDGE_SUBMIT], at_ns);
		}
		TRACE(w->ops, edge, id, (enum edge)e, at_ns);
		close_stages(w, id, t_ns, (enum edge)e);
		if (id == LONG_CYCLE && e == EDGE_RESULT) {
			miss(w, id, MISS_LATE, "", 1, 0);
			return; /* older than it may be used: decided without it */
		}
		if (e == EDGE_DECIDE) {
			evaluation(w, id, at_ns);
		}
	}
}

static void both_clocks(const struct world *w, int64_t mono_ns)
{
	struct timespec ts;

	clock_gettime(CLOCK_REALTIME, &ts);
	const struct trace_clock c = {
		mono_ns, mono_ns + ts.tv_sec * CLOCK_NS_PER_S + ts.tv_nsec - clock_now_ns(),
		PERIOD_NS, 1};

	TRACE(w->ops, clock, &c);
}

/* All request frames due before @until_ns. */
static void publish(struct world *w, int64_t until_ns)
{
	for (; w->due_ns < until_ns; w->due_ns += PERIOD_NS) {
		if (w->published % 50 == 0) {
			both_clocks(w, w->due_ns);
		}
		TRACE(w->ops, published, ++w->published, w->due_ns, 0, 0);
	}
}

int main(int argc, char **argv)
{
	static struct world w;
	char err[512] = "";

	if (trace_load(TRACE_LTTNG, 0, &w.ops, err, sizeof(err))) {
		fprintf(stderr, "%s\n", err);
		return 1;
	}
	TRACE(w.ops, thread);
	w.start_ns = w.due_ns = clock_now_ns();
	for (uint64_t id = 1; id <= CYCLES; id++) {
		const uint64_t after_long = id - LONG_CYCLE;

		publish(&w, w.start_ns + (int64_t)id * SCAN_NS);
		if (id > LONG_CYCLE && after_long <= 11) {
			miss(&w, LONG_CYCLE, MISS_SKIPPED, "", 1, 0);
			continue;
		}
		if (id == STALL) {
			miss(&w, id, MISS_PERIOD, "", 29, 29 * PERIOD_NS);
			w.due_ns += 29 * PERIOD_NS;
		}
		cycle(&w, id);
	}
	TRACE(w.ops, state, "ARMED", "INHIBIT");
	TRACE(w.ops, fault, "CLOCK_STEP", 1);
	TRACE(w.ops, deadline_miss, w.status.stats.stage_miss);
	status_json(&w.status, w.hist, NULL, 0, stdout);
	fflush(stdout);
	sleep(argc > 1 ? (unsigned)atoi(argv[1]) : 0);
	return 0;
}
