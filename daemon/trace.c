/* SPDX-License-Identifier: MIT
 * Loads a provider of trace events. See trace.h.
 */
#include "trace.h"
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"
#include "program.h"

#define AFTER_NS (1 * CLOCK_NS_PER_S)
#define AGAIN_NS (10 * CLOCK_NS_PER_S)

static const char *const provider_name[] = {
	[TRACE_NONE] = "none", [TRACE_LTTNG] = "lttng", [TRACE_NVTX] = "nvtx"};

/* Where the build leaves it, and where it is installed. */
static const char *const place[] = {"", "../lib/aebmc/"};
#define PLACES (sizeof(place) / sizeof(place[0]))

/* A tracer's start may take 3 s by default, and it may be told to block when its buffers are full. */
static int prepare_environment(int live)
{
	return (live && setenv("LTTNG_UST_REGISTER_TIMEOUT", "0", 1)) ||
			       unsetenv("LTTNG_UST_ALLOW_BLOCKING")
		       ? -errno
		       : 0;
}

int trace_load(enum trace_provider which, int live, const struct trace_ops **ret, char *err,
	       int err_len)
{
	char name[32], path[PATH_MAX];
	const char *why;
	void *so;
	int status;

	*ret = NULL;
	if (which == TRACE_NONE) {
		return 0;
	}
	status = prepare_environment(live);
	snprintf(name, sizeof(name), "trace-%s.so", provider_name[which]);
	status = status ? status : program_file(place, PLACES, name, path);
	if (status && status != -ENOENT) {
		snprintf(err, (size_t)err_len, "trace.provider: %s", strerror(-status));
		return status;
	}
	so = status ? NULL : dlopen(path, RTLD_NOW | RTLD_LOCAL);
	*ret = so ? dlsym(so, TRACE_OPS_SYMBOL) : NULL;
	if (!*ret) {
		why = dlerror();
		snprintf(err, (size_t)err_len, "trace.provider: cannot load %s: %s", name,
			 why ? why : "it was not built (see WITH_LTTNG)");
		return -ENOENT;
	}
	return 0;
}

/* ---- sub-stages of a backend --------------------------------------------------------------------- */

static void on_hello(const void *arg)
{
	const struct trace_ops *ops = arg;

	TRACE(ops, thread);
}

static void on_edge(const void *arg, enum mc_edge e, uint64_t id)
{
	const struct trace_ops *ops = arg;

	(void)e;
	(void)id;
	TRACE(ops, batch, id, e, clock_now_ns());
}

struct mc_watch trace_watch(const struct trace_ops *ops)
{
	return (struct mc_watch){.hello = on_hello, .edge = on_edge, .arg = ops};
}

/* ---- alarm ----------------------------------------------------------------------------------------- */

int trace_alarm(struct trace_alarm *a, uint64_t missed, int64_t now_ns)
{
	if (missed != a->told && !a->due_ns) {
		a->due_ns = now_ns + AFTER_NS > a->next_ns ? now_ns + AFTER_NS : a->next_ns;
	}
	a->told = missed;
	if (!a->due_ns || now_ns < a->due_ns) {
		return 0;
	}
	a->due_ns = 0;
	a->next_ns = now_ns + AGAIN_NS;
	return 1;
}
