/* SPDX-License-Identifier: MIT
 * What was measured on a GPU and kept. See record.h.
 */
#include "record.h"

/* Rows of record.def are taken one kind at a time. */
#define RECORD_BENCH(gpu, cpu, date, scalar_us)
#define RECORD_STOPS(gpu, date)
#define RECORD_TIME(n, paper_us, fast_us, cpu_us)
#define RECORD_BUDGET(kernel, ms, n)
#define RECORD_STOP(m)

#undef RECORD_TIME
#define RECORD_TIME(n, paper_us, fast_us, cpu_us) n,
static const double samples[] = {
#include "record.def"
};
#undef RECORD_TIME
#define RECORD_TIME(n, paper_us, fast_us, cpu_us) (paper_us) * 1e3,
static const double paper_ns[] = {
#include "record.def"
};
#undef RECORD_TIME
#define RECORD_TIME(n, paper_us, fast_us, cpu_us) (fast_us) * 1e3,
static const double fast_ns[] = {
#include "record.def"
};
#undef RECORD_TIME
#define RECORD_TIME(n, paper_us, fast_us, cpu_us) (cpu_us) * 1e3,
static const double host_ns[] = {
#include "record.def"
};
#undef RECORD_TIME
#define RECORD_TIME(n, paper_us, fast_us, cpu_us)

#undef RECORD_STOP
#define RECORD_STOP(m) (float)(m),
static const float stop_m[] = {
#include "record.def"
};
#undef RECORD_STOP
#define RECORD_STOP(m)

#define SIZES (sizeof(samples) / sizeof(samples[0]))
_Static_assert(SIZES <= FIGURE_SIZES_MAX, "one picture holds them");

/* Where a budget stands among CALIBRATION_MS. */
#define AT_400 0
#define AT_530 1
#define AT_800 2

#undef RECORD_BENCH
#undef RECORD_STOPS
#undef RECORD_BUDGET
#define RECORD_BENCH(gpu_, cpu_, date_, scalar_us) \
	.gpu = gpu_, .cpu = cpu_, .date = date_, .scalar_ns = (scalar_us)*1e3,
#define RECORD_STOPS(gpu, date)      .stops_gpu = gpu, .stops_date = date,
#define RECORD_BUDGET(kernel, ms, n) .kernel##_fits[AT_##ms] = n,
const struct record record = {
	.paper = {SIZES, samples, paper_ns},
	.fast = {SIZES, samples, fast_ns},
	.host = {SIZES, samples, host_ns},
	.stops = sizeof(stop_m) / sizeof(stop_m[0]),
	.stop_m = stop_m,
#include "record.def"
};
