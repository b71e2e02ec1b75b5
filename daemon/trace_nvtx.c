/* SPDX-License-Identifier: MIT
 * The provider for Nsight Systems: built as trace-nvtx.so with CUDA's headers. Batches and what the GPU does in them are
 * ranges of the compute thread; the rest are marks. See trace.h.
 */
#include "trace.h"
#include <nvtx3/nvToolsExt.h>
#include <stdio.h>

/* A tool is looked for at the first call: here, not in the first event. */
static void thread(void)
{
	nvtxInitialize(NULL);
}

static void mark(const char *text, uint64_t cycle)
{
	const nvtxEventAttributes_t a = {.version = NVTX_VERSION,
					 .size = NVTX_EVENT_ATTRIB_STRUCT_SIZE,
					 .payloadType = NVTX_PAYLOAD_TYPE_UNSIGNED_INT64,
					 .payload.ullValue = cycle,
					 .messageType = NVTX_MESSAGE_TYPE_ASCII,
					 .message.ascii = text};

	nvtxMarkEx(&a);
}

static void edge(uint64_t cycle, enum edge e, int64_t t_ns)
{
	static const char *const name[EDGES] = {
#define EDGE(name, doc) #name,
#include "stage.def"
	};

	(void)t_ns;
	mark(name[e], cycle);
}

/* Each range ends before the next begins, or encloses it: TAKEN (LAUNCHED ANSWERED VERIFIED)... DONE. */
static void batch(uint64_t cycle, enum mc_edge e, int64_t t_ns)
{
	static const struct {
		int ends;
		const char *begins;
	} row[MC_EDGES] = {
		[MC_EDGE_TAKEN] = {0, "batch"},     [MC_EDGE_LAUNCHED] = {0, "gpu"},
		[MC_EDGE_ANSWERED] = {1, "verify"}, [MC_EDGE_VERIFIED] = {1, NULL},
		[MC_EDGE_DONE] = {1, NULL},
	};

	(void)cycle;
	(void)t_ns;
	if (row[e].ends) {
		nvtxRangePop();
	}
	if (row[e].begins) {
		nvtxRangePushA(row[e].begins);
	}
}

static void miss(uint64_t cycle, const char *kind, const char *stage, uint64_t count,
		 int64_t late_ns)
{
	char text[64];

	(void)count;
	(void)late_ns;
	snprintf(text, sizeof(text), "miss: %s %s", kind, stage);
	mark(text, cycle);
}

static void fault(const char *reason, int on)
{
	mark(reason, (uint64_t)on);
}

static void state(const char *from, const char *to)
{
	(void)from;
	mark(to, 0);
}

static void evaluation(const struct trace_evaluation *e)
{
	mark(e->level, e->cycle);
}

static void clocks(const struct trace_clock *c)
{
	mark("clock", (uint64_t)c->real_ns);
}

static void published(uint64_t n, int64_t due_ns, int64_t late_ns, int missed)
{
	(void)due_ns;
	(void)late_ns;
	(void)missed;
	mark("published", n);
}

static void deadline_miss(uint64_t missed)
{
	mark("deadline_miss", missed);
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
