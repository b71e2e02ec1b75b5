/* SPDX-License-Identifier: MIT
 * The events as LTTng-UST tracepoints, provider `aebmc`. Read by lttng's own headers again and again with other macros;
 * included by trace_lttng.c alone. One row of stage.def or mc_edge.def, one event.
 */
#undef LTTNG_UST_TRACEPOINT_PROVIDER
#define LTTNG_UST_TRACEPOINT_PROVIDER aebmc

#undef LTTNG_UST_TRACEPOINT_INCLUDE
#define LTTNG_UST_TRACEPOINT_INCLUDE "trace_tp.h"

#if !defined(AEBMC_TRACE_TP_H) || defined(LTTNG_UST_TRACEPOINT_HEADER_MULTI_READ)
#define AEBMC_TRACE_TP_H

#include <lttng/tracepoint.h>
#include <stdint.h>
#include "trace.h"

/* A field a line. */
/* clang-format off */
LTTNG_UST_TRACEPOINT_EVENT_CLASS(aebmc, moment,
	LTTNG_UST_TP_ARGS(uint64_t, cycle, int64_t, t_ns),
	LTTNG_UST_TP_FIELDS(
		lttng_ust_field_integer(uint64_t, cycle, cycle)
		lttng_ust_field_integer(int64_t, t_ns, t_ns)))

#define EDGE(name, doc) \
	LTTNG_UST_TRACEPOINT_EVENT_INSTANCE(aebmc, moment, aebmc, edge_##name, \
		LTTNG_UST_TP_ARGS(uint64_t, cycle, int64_t, t_ns))
#include "stage.def"

#define MC_EDGE(name, doc) \
	LTTNG_UST_TRACEPOINT_EVENT_INSTANCE(aebmc, moment, aebmc, batch_##name, \
		LTTNG_UST_TP_ARGS(uint64_t, cycle, int64_t, t_ns))
#include "mc_edge.def"

LTTNG_UST_TRACEPOINT_EVENT(aebmc, miss,
	LTTNG_UST_TP_ARGS(uint64_t, cycle, const char *, kind, const char *, stage, uint64_t, count, int64_t, late_ns),
	LTTNG_UST_TP_FIELDS(
		lttng_ust_field_integer(uint64_t, cycle, cycle)
		lttng_ust_field_string(kind, kind)
		lttng_ust_field_string(stage, stage)
		lttng_ust_field_integer(uint64_t, count, count)
		lttng_ust_field_integer(int64_t, late_ns, late_ns)))

LTTNG_UST_TRACEPOINT_EVENT(aebmc, fault,
	LTTNG_UST_TP_ARGS(const char *, reason, int, on),
	LTTNG_UST_TP_FIELDS(
		lttng_ust_field_string(reason, reason)
		lttng_ust_field_integer(int, on, on)))

LTTNG_UST_TRACEPOINT_EVENT(aebmc, state,
	LTTNG_UST_TP_ARGS(const char *, from, const char *, to),
	LTTNG_UST_TP_FIELDS(
		lttng_ust_field_string(from, from)
		lttng_ust_field_string(to, to)))

LTTNG_UST_TRACEPOINT_EVENT(aebmc, evaluation,
	LTTNG_UST_TP_ARGS(const struct trace_evaluation *, e),
	LTTNG_UST_TP_FIELDS(
		lttng_ust_field_integer(uint64_t, cycle, e->cycle)
		lttng_ust_field_integer(int64_t, t_ns, e->t_ns)
		lttng_ust_field_integer(uint64_t, samples, e->samples)
		lttng_ust_field_float(double, speed_mps, e->speed_mps)
		lttng_ust_field_float(double, headway_m, e->headway_m)
		lttng_ust_field_float(double, lead_speed_mps, e->lead_speed_mps)
		lttng_ust_field_float(double, safe_m, e->safe_m)
		lttng_ust_field_integer(uint32_t, lead, e->lead)
		lttng_ust_field_float(double, p, e->p)
		lttng_ust_field_float(double, lo, e->lo)
		lttng_ust_field_float(double, hi, e->hi)
		lttng_ust_field_float(double, accel_mps2, e->accel_mps2)
		lttng_ust_field_string(level, e->level)
		lttng_ust_field_string(state, e->state)))

LTTNG_UST_TRACEPOINT_EVENT(aebmc, clock,
	LTTNG_UST_TP_ARGS(const struct trace_clock *, c),
	LTTNG_UST_TP_FIELDS(
		lttng_ust_field_integer(int64_t, mono_ns, c->mono_ns)
		lttng_ust_field_integer(int64_t, real_ns, c->real_ns)
		lttng_ust_field_integer(int64_t, period_ns, c->period_ns)
		lttng_ust_field_integer(int, live, c->live)))

LTTNG_UST_TRACEPOINT_EVENT(aebmc, published,
	LTTNG_UST_TP_ARGS(uint64_t, n, int64_t, due_ns, int64_t, late_ns, int, missed),
	LTTNG_UST_TP_FIELDS(
		lttng_ust_field_integer(uint64_t, n, n)
		lttng_ust_field_integer(int64_t, due_ns, due_ns)
		lttng_ust_field_integer(int64_t, late_ns, late_ns)
		lttng_ust_field_integer(int, missed, missed)))

LTTNG_UST_TRACEPOINT_EVENT(aebmc, deadline_miss,
	LTTNG_UST_TP_ARGS(uint64_t, missed),
	LTTNG_UST_TP_FIELDS(
		lttng_ust_field_integer(uint64_t, missed, missed)))
/* clang-format on */

#endif

#include <lttng/tracepoint-event.h>
