/* SPDX-License-Identifier: MIT
 * From the moment a thread submits a request to the moment it has read the result: 16,384 samples x 4 futures behind
 * the mailbox, with a worker that spins and one that sleeps. Prints figures; only a wrong result fails.
 * Usage: latency [COUNT [load]]; with load, a second process keeps the device busy.
 */
#include "mc_ops.h"
#include "tap.h"
#include "scenes.h"
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define N       16384u
#define WARM_UP 500u

static double now_us(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return x < y ? -1 : x > y;
}

static void pin(pthread_t thread, int cpu)
{
	cpu_set_t set;

	CPU_ZERO(&set);
	CPU_SET(cpu, &set);
	pthread_setaffinity_np(thread, sizeof(set), &set);
}

static int once(struct mc *mc, enum mc_worker how, const struct mc_request *req,
		struct mc_result *res)
{
	struct pollfd fd = {.fd = mc_eventfd(mc), .events = POLLIN};
	int got = mc_submit(mc, req) < 0 ? -1 : 0;

	while (!got) {
		if (how == MC_WORKER) {
			poll(&fd, 1, -1);
		}
		got = mc_poll(mc, res);
	}
	return got;
}

static void measure(enum mc_worker how, struct mc_request req, const char *name, uint32_t count)
{
	const struct mc_params p = {.kind = MC_SOBOL, .seed = 1, .n_resident = N, .threads = 1};
	double *us = calloc(count, sizeof(*us));
	struct mc_result first = {0}, res;
	uint32_t wrong = 0;
	struct mc *mc;

	if (!tap_ok(us && mc_open(&mc_cuda_ops, &p, how, &mc) == 0, "%s: open", name)) {
		return;
	}
	pin((pthread_t)mc_thread(mc), 3);
	for (uint32_t i = 0; i < count + WARM_UP; i++) {
		req.id = i + 1;
		const double start = now_us();
		const int got = once(mc, how, &req, &res);
		const double end = now_us();

		first = i ? first : res;
		wrong += got != 1 || res.id != req.id || res.risk[1].hits != first.risk[1].hits;
		us[i < WARM_UP ? 0 : i - WARM_UP] = end - start;
	}
	mc_close(mc);
	qsort(us, count, sizeof(*us), compare);
	tap_ok(wrong == 0, "%s: %u right results", name, count);
	printf("# LATENCY %-34s p50 %7.1f p99 %7.1f p99.9 %7.1f max %8.1f us\n", name,
	       us[count / 2], us[(uint64_t)count * 99 / 100], us[(uint64_t)count * 999 / 1000],
	       us[count - 1]);
	free(us);
}

/* Batches of a million, one after the other, until killed. */
static void load(void)
{
	const struct mc_params p = {
		.kind = MC_SOBOL, .seed = 2, .n_resident = 1u << 20, .threads = 1};
	const struct mc_request req = scene_moving(1u << 20);
	struct mc_backend *b;
	struct mc_result res;

	for (int err = mc_cuda_ops.open(&p, &b); !err;) {
		err = mc_cuda_ops.run(b, &req, NULL, &res);
	}
	_exit(1);
}

int main(int argc, char **argv)
{
	const uint32_t count = argc > 1 ? (uint32_t)atol(argv[1]) : 100000;
	const int loaded = argc > 2 && !strcmp(argv[2], "load");
	const struct mc_request req = scene_moving(N);
	struct mc_request counts = req;
	const pid_t other = loaded ? fork() : 0;

	if (loaded && other == 0) {
		load();
	}
	if (loaded) {
		sleep(4);
	}
	counts.flags = MC_WANT_IMPACT;
	pin(pthread_self(), 2);
	measure(MC_WORKER_SPINS, req, loaded ? "spinning, device loaded" : "spinning", count);
	if (!loaded) {
		measure(MC_WORKER, req, "sleeping", count);
		measure(MC_WORKER_SPINS, counts, "spinning, without histograms", count / 5);
		measure(MC_WORKER, counts, "sleeping, without histograms", count / 5);
	} else {
		kill(other, SIGKILL);
		waitpid(other, NULL, 0);
	}
	return tap_end();
}
