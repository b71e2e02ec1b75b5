/* SPDX-License-Identifier: MIT
 * What the compute thread says of a batch on the GPU: taken, then launched, answered and verified once for each chunk, then
 * done. Prints how long each part takes.
 */
#include "mc_ops.h"
#include "scenes.h"
#include "tap.h"
#include <poll.h>
#include <time.h>

#define EDGES_MAX 256
#define BATCHES   2000

static struct seen {
	int hellos, n;
	struct {
		enum mc_edge edge;
		uint64_t id;
		double us;
	} at[EDGES_MAX];
} seen;

static double now_us(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static void on_hello(const void *arg)
{
	(void)arg;
	seen.hellos++;
}

static void on_edge(const void *arg, enum mc_edge e, uint64_t id)
{
	(void)arg;
	if (seen.n < EDGES_MAX) {
		seen.at[seen.n].edge = e;
		seen.at[seen.n].id = id;
		seen.at[seen.n++].us = now_us();
	}
}

/* TAKEN (LAUNCHED ANSWERED VERIFIED){@chunks} DONE, all of request @id, in the order of time */
static int in_order(uint64_t id, int chunks)
{
	int good = seen.n == 2 + 3 * chunks && seen.at[0].edge == MC_EDGE_TAKEN &&
		   seen.at[seen.n - 1].edge == MC_EDGE_DONE;

	for (int i = 1; good && i < seen.n - 1; i++) {
		good = seen.at[i].edge == MC_EDGE_LAUNCHED + (unsigned int)((i - 1) % 3);
	}
	for (int i = 0; good && i < seen.n; i++) {
		good = seen.at[i].id == id && (!i || seen.at[i].us >= seen.at[i - 1].us);
	}
	return good;
}

static int run(struct mc *mc, const struct mc_request *req)
{
	struct pollfd fd = {.fd = mc_eventfd(mc), .events = POLLIN};
	struct mc_result res;
	int got = mc_submit(mc, req) < 0 ? -1 : 0;

	seen.n = 0;
	while (!got) {
		poll(&fd, 1, -1);
		got = mc_poll(mc, &res);
	}
	while (mc_busy(mc)) {
		poll(NULL, 0, 1); /* DONE follows the result */
	}
	poll(NULL, 0, 1);
	return got;
}

int main(void)
{
	static const struct mc_watch watch = {on_hello, on_edge, NULL};
	const struct mc_params p = {.kind = MC_SOBOL, .seed = 1, .n_resident = 16384, .threads = 1};
	struct mc_request req = scene_moving(16384);
	double launch = 0, gpu = 0, verify = 0, rest = 0;
	struct mc *mc = NULL;
	int good = 1;

	if (!tap_ok(mc_open(&mc_cuda_ops, &p, MC_WORKER, &mc) == 0, "open")) {
		return tap_end();
	}
	tap_ok(mc_watch(mc, &watch) == 0 && seen.hellos == 1 && seen.n == 0, "watched");
	for (uint64_t id = 1; id <= BATCHES; id++) {
		req.id = id;
		good &= run(mc, &req) == 1 && in_order(id, 1);
		launch += seen.at[1].us - seen.at[0].us;
		gpu += seen.at[2].us - seen.at[1].us;
		verify += seen.at[3].us - seen.at[2].us;
		rest += seen.at[4].us - seen.at[3].us;
	}
	tap_ok(good, "%d batches of one chunk, every edge once and in order", BATCHES);
	printf("# SUBSTAGES mean us: launch %.1f, GPU %.1f, verify %.1f, statistics %.1f\n",
	       launch / BATCHES, gpu / BATCHES, verify / BATCHES, rest / BATCHES);
	req = scene_moving(40000);
	req.id = BATCHES + 1;
	good = run(mc, &req) == 1 && seen.n > 5 && (seen.n - 2) % 3 == 0 &&
	       in_order(req.id, (seen.n - 2) / 3);
	tap_ok(good, "a batch beyond the resident draws: %d chunks", (seen.n - 2) / 3);
	mc_close(mc);
	return tap_end();
}
