/* SPDX-License-Identifier: MIT
 * Events for a tracer: what the callers include. Knows no tracer: a provider is a shared object beside the program,
 * loaded only when asked for (trace.provider). With none built in (WITH_LTTNG=no and no CUDA), TRACE() is nothing.
 */
#ifndef AEBMC_TRACE_H
#define AEBMC_TRACE_H

#include "mc.h"
#include "stage.h"

enum trace_provider { TRACE_NONE, TRACE_LTTNG, TRACE_NVTX };

/* One evaluation's figures, for the timeline of the risk. */
struct trace_evaluation {
	uint64_t cycle, samples;
	int64_t t_ns;
	double speed_mps, headway_m, lead_speed_mps; /* of ego; to the lead; of the lead */
	double safe_m;                               /* headway at which the risk is 1 % */
	uint32_t lead;                               /* changes with the lead */
	double p, lo, hi;                            /* of FUTURE_DEFER */
	double accel_mps2;                           /* requested */
	const char *level, *state;
};

/* Both clocks at one moment, and what was counted until then. */
struct trace_clock {
	int64_t mono_ns, real_ns, period_ns;
	int live; /* 0: a log's time, in which a computation takes none */
};

/* A provider. Each function may be called from a real-time thread that has called thread(): no lock, no system call,
 * no allocation. Strings are copied. */
struct trace_ops {
	void (*thread)(void); /* once in every real-time thread, before arming; may allocate */
	void (*edge)(uint64_t cycle, enum edge e, int64_t t_ns);
	void (*batch)(uint64_t cycle, enum mc_edge e, int64_t t_ns);
	void (*miss)(uint64_t cycle, const char *kind, const char *stage, uint64_t count,
		     int64_t late_ns);
	void (*fault)(const char *reason, int on);
	void (*state)(const char *from, const char *to);
	void (*evaluation)(const struct trace_evaluation *e);
	void (*clock)(const struct trace_clock *c);
	void (*published)(uint64_t n, int64_t due_ns, int64_t late_ns, int missed);
	/* Of the housekeeping thread: a tracer's trigger may hang on it, which costs a system call. */
	void (*deadline_miss)(uint64_t missed);
};

#define TRACE_OPS_SYMBOL "aebmc_trace_ops" /* what a provider exports */

#ifdef TRACE_PROVIDERS
#define TRACE_BUILT 1
#else
#define TRACE_BUILT 0 /* its arguments are still checked; nothing of it is compiled */
#endif
#define TRACE(ops, event, ...)                     \
	do {                                       \
		if (TRACE_BUILT && (ops)) {        \
			(ops)->event(__VA_ARGS__); \
		}                                  \
	} while (0)

/**
 * trace_load - load a provider: trace-NAME.so in the program's own folder or in ../lib/aebmc beside it
 * @live: 1: the tracer's start is not waited for; 0: for up to 3 s, so that a short run is recorded from its first event
 * *@ret stays NULL for TRACE_NONE. It stays loaded until the process ends. Before any thread is created: sets the
 * environment. Allocates, blocks. 0 or -errno, @err says why in one line.
 */
int trace_load(enum trace_provider which, int live, const struct trace_ops **ret, char *err,
	       int err_len);

/** trace_watch - the watch that hands a backend's sub-stages to @ops, stamped on CLOCK_MONOTONIC. */
struct mc_watch trace_watch(const struct trace_ops *ops);

/* When to tell the tracer's trigger of missed deadlines: zero-initialised. */
struct trace_alarm {
	uint64_t told;  /* misses until the last call */
	int64_t due_ns; /* 0: nothing is due */
	int64_t next_ns;
};

/**
 * trace_alarm - 1 if deadline_miss() is to be fired now
 * One second after the first of several misses, so that what came after is recorded too, and at most once in ten.
 * @missed: all misses until now. Pure on *@a.
 */
int trace_alarm(struct trace_alarm *a, uint64_t missed, int64_t now_ns);

#endif
