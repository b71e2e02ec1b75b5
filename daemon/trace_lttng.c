/* SPDX-License-Identifier: MIT
 * The provider for LTTng-UST: built as trace-lttng.so, the only file that sees lttng. See trace.h.
 */
#define LTTNG_UST_COMPAT_API_VERSION 1
#define LTTNG_UST_TRACEPOINT_CREATE_PROBES
#define LTTNG_UST_TRACEPOINT_DEFINE
#include "trace_tp.h"
#include <lttng/ust-thread.h>

/* Without it a thread's first event registers it, with a lock and system calls. */
static void thread(void)
{
	lttng_ust_init_thread();
}

static void edge(uint64_t cycle, enum edge e, int64_t t_ns)
{
	switch (e) {
#define EDGE(name, doc)                                                \
	case EDGE_##name:                                              \
		lttng_ust_tracepoint(aebmc, edge_##name, cycle, t_ns); \
		break;
#include "stage.def"
	default:
		break;
	}
}

static void batch(uint64_t cycle, enum mc_edge e, int64_t t_ns)
{
	switch (e) {
#define MC_EDGE(name, doc)                                              \
	case MC_EDGE_##name:                                            \
		lttng_ust_tracepoint(aebmc, batch_##name, cycle, t_ns); \
		break;
#include "mc_edge.def"
	default:
		break;
	}
}

static void miss(uint64_t cycle, const char *kind, const char *stage, uint64_t count,
		 int64_t late_ns)
{
	lttng_ust_tracepoint(aebmc, miss, cycle, kind, stage, count, late_ns);
}

static void fault(const char *reason, int on)
{
	lttng_ust_tracepoint(aebmc, fault, reason, on);
}

static void state(const char *from, const char *to)
{
	lttng_ust_tracepoint(aebmc, state, from, to);
}

static void evaluation(const struct trace_evaluation *e)
{
	lttng_ust_tracepoint(aebmc, evaluation, e);
}

static void clocks(const struct trace_clock *c)
{
	lttng_ust_tracepoint(aebmc, clock, c);
}

static void published(uint64_t n, int64_t due_ns, int64_t late_ns, int missed)
{
	lttng_ust_tracepoint(aebmc, published, n, due_ns, late_ns, missed);
}

static void deadline_miss(uint64_t missed)
{
	lttng_ust_tracepoint(aebmc, deadline_miss, missed);
}

extern const struct trace_ops aebmc_trace_ops;
const struct trace_ops aebmc_trace_ops = {
	.thread = thread,
	.edge = edge,
	.batch = batch,
	.miss = miss,
	.fault = fault,
	.state = state,
	.evaluation = evaluation,
	.clock = clocks,
	.published = published,
	.deadline_miss = deadline_miss,
};
