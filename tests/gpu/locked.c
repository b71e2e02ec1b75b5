/* SPDX-License-Identifier: MIT
 * The live daemon's real-time start with a GPU, but for the bus: both backends opened and sized, all memory locked with
 * the CUDA context in it, threads raised, batches from a real-time thread, and the CPU behind the GPU with the same bits.
 */
#include <errno.h>
#include <poll.h>
#include <sys/resource.h>
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
	int done, error, raised;
	int64_t longest_ns;
	long faults;
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

/* Of the whole process: the driver's threads too. */
static long faults(void)
{
	struct rusage u;

	getrusage(RUSAGE_SELF, &u);
	return u.ru_minflt + u.ru_majflt;
}

static void *real_time(void *arg)
{
	struct run *r = arg;
	char err[256];

	r->raised = !rt_thread(pthread_self(), "this thread", 80, -1, err, sizeof(err));
	rt_prefault_stack(256 * 1024);
	for (uint64_t id = 2; id < 12; id++) {
		r->error = r->error ? r->error : batch(r, id);
	}
	r->faults = faults();
	for (uint64_t id = 12; id < 12 + BATCHES && !r->error; id++) {
		r->error = batch(r, id);
		r->done += !r->error;
	}
	r->faults = faults() - r->faults;
	return NULL;
}

static void in_a_thread(struct run *r)
{
	pthread_t thread;

	if (!tap_ok(!pthread_create(&thread, NULL, real_time, r), "a thread is created after it")) {
		return;
	}
	pthread_join(thread, NULL);
	tap_ok(!r->error && r->done == BATCHES,
	       "%d batches of %u samples from a thread of policy %s, the longest %.3f ms (error "
	       "%d)",
	       r->done, r->samples, r->raised ? "FIFO" : "OTHER", (double)r->longest_ns / 1e6,
	       r->error);
	tap_ok(r->faults == 0, "%ld page faults in the process meanwhile", r->faults);
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
	int ret = rt_thread(mc_thread(e.mc), "compute thread", 60, -1, err, sizeof(err));

	ret = ret ? ret : rt_thread(mc_thread(e.spare), "its spare", 60, -1, err, sizeof(err));
	tap_ok(!ret || ret == -EPERM, "both compute threads are SCHED_FIFO 60%s",
	       ret ? " # SKIP needs RLIMIT_RTPRIO" : "");

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
