/* SPDX-License-Identifier: MIT
 * The live daemon's real-time start with a GPU, but for the bus: both backends opened and sized, all memory locked with
 * the CUDA context in it, threads raised, batches from a real-time thread, and the CPU behind the GPU with the same bits.
 */
#include <dirent.h>
#include <poll.h>
#include <sched.h>
#include "clock.h"
#include "engine.h"
#include "recorder.h"
#include "rt.h"
#include "scenes.h"
#include "tap.h"

#define BATCHES 2000

struct run {
	struct mc *mc;
	uint32_t samples;
	int done, error;
	int64_t longest_ns;
	uint64_t hash;
};

/* One batch as the pipeline has it: submitted, announced, fetched. */
static int batch(struct run *r, uint64_t id)
{
	struct pollfd fd = {.fd = mc_eventfd(r->mc), .events = POLLIN};
	struct mc_request req = scene_moving(r->samples);
	const int64_t start_ns = clock_now_ns();
	struct mc_result res;
	int got;

	req.id = id;
	got = mc_submit(r->mc, &req);
	while (got == 0 && clock_now_ns() - start_ns < CLOCK_NS_PER_S) {
		poll(&fd, 1, 1000);
		got = mc_poll(r->mc, &res);
	}
	if (got != 1) {
		return got < 0 ? got : -1;
	}
	const int64_t took_ns = clock_now_ns() - start_ns;

	r->longest_ns = took_ns > r->longest_ns ? took_ns : r->longest_ns;
	r->hash = recorder_result_hash(&res);
	return 0;
}

/* Page faults of all SCHED_FIFO threads so far. */
static long faults(void)
{
	DIR *dir = opendir("/proc/self/task");
	const struct dirent *d;
	long sum = 0;

	while (dir && (d = readdir(dir))) {
		char path[300], text[512];
		long minor, major;
		FILE *f;

		snprintf(path, sizeof(path), "/proc/self/task/%s/stat", d->d_name);
		f = sched_getscheduler(atoi(d->d_name)) == SCHED_FIFO ? fopen(path, "re") : NULL;
		if (!f) {
			continue;
		}
		text[fread(text, 1, sizeof(text) - 1, f)] = '\0';
		fclose(f);
		if (sscanf(strrchr(text, ')') + 1, " %*c %*d %*d %*d %*d %*d %*u %ld %*d %ld",
			   &minor, &major) == 2) {
			sum += minor + major;
		}
	}
	if (dir) {
		closedir(dir);
	}
	return sum;
}

static void *real_time(void *arg)
{
	struct run *r = arg;
	struct sched_param sp = {.sched_priority = 80};

	pthread_setschedparam(pthread_self(), SCHED_FIFO, &sp);
	rt_prefault_stack(256 * 1024);
	for (uint64_t id = 2; id < 12; id++) {
		r->error = r->error ? r->error : batch(r, id);
	}
	const long before = faults();

	for (uint64_t id = 12; id < 12 + BATCHES && !r->error; id++) {
		r->error = batch(r, id);
		r->done += !r->error;
	}
	const long during = faults() - before;

	tap_ok(!r->error && r->done == BATCHES,
	       "%d batches of %u samples from a SCHED_FIFO thread, the longest %.3f ms (error %d)",
	       r->done, r->samples, (double)r->longest_ns / 1e6, r->error);
	/* Counting opens a directory: what that costs is this thread's own, at most a few pages. */
	tap_ok(during == 0, "%ld page faults in the real-time and compute threads meanwhile",
	       during);
	return NULL;
}

static void in_a_thread(struct run *r)
{
	pthread_t thread;

	if (tap_ok(!pthread_create(&thread, NULL, real_time, r), "a thread is created after it")) {
		pthread_join(thread, NULL);
	}
}

int main(void)
{
	struct engine e;
	struct config cfg;
	char err[512] = "";

	config_defaults(&cfg);
	cfg.mc_backend = 2; /* cuda */
	if (!tap_ok(!engine_open_live(&cfg, &e, err, sizeof(err)) && e.spare,
		    "the GPU with the CPU behind it (%s)", err)) {
		return tap_end();
	}
	printf("# cuda: %u samples, %.1f us + %.2f ns each; cpu: %u samples, %.1f us + %.2f ns "
	       "each\n",
	       e.size.samples, e.size.cost.overhead_ns / 1e3, e.size.cost.sample_ns,
	       e.spare_size.samples, e.spare_size.cost.overhead_ns / 1e3,
	       e.spare_size.cost.sample_ns);
	tap_ok(!rt_lock_memory(err, sizeof(err)), "all memory is locked, CUDA's too (%s)", err);
	tap_ok(!rt_thread(mc_thread(e.mc), "compute thread", 60, -1, err, sizeof(err)) &&
		       !rt_thread(mc_thread(e.spare), "its spare", 60, -1, err, sizeof(err)),
	       "both compute threads are SCHED_FIFO 60 (%s)", err);

	struct run gpu = {.mc = e.mc, .samples = e.size.samples};
	struct run cpu = {.mc = e.spare, .samples = e.spare_size.samples};

	in_a_thread(&gpu);
	in_a_thread(&cpu);
	gpu.samples = cpu.samples;
	tap_ok(!batch(&gpu, 12 + BATCHES) && gpu.hash == cpu.hash,
	       "the CPU says what the GPU says, bit for bit");
	engine_close(&e);
	return tap_end();
}
