/* SPDX-License-Identifier: MIT
 * How long the real-time thread takes on this machine, over a socketpair in place of a CAN bus:
 *   aebmc generate --drive follow | bench_wakeup CONFIG
 * plays the drive in real time, with batches on a compute thread, and prints p50, p99 and max. A benchmark, not a test.
 */
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus.h"
#include "bus_rx.h"
#include "clock.h"
#include "config.h"
#include "engine.h"
#include "pipeline.h"
#include "rt.h"

#define VALUES_MAX 100000
#define LEAD_ID    0x110 /* can-dbc/vehicles/generic.dbc: one such frame is a scan */

struct values {
	const char *what;
	int n;
	int64_t ns[VALUES_MAX];
};

static struct values late = {.what = "period due -> wake-up"};
static struct values wake = {.what = "wake-up -> request frame sent"};
static struct values scan = {.what = "scan received -> risk frame, with the batch"};

struct pair_bus {
	struct bus bus;
	struct bus_rx rx;
	int fd, watched;
	uint32_t request_id;
	int64_t woken_ns;
	int is_due; /* the last wake-up was the deadline's */
};

struct bench {
	struct config cfg;
	struct mapping *map;
	struct engine engine;
	struct pipeline *pipeline;
	struct pair_bus bus;
	int player_fd;
	int stop; /* atomic */
};

static void add(struct values *v, int64_t ns)
{
	if (v->n < VALUES_MAX) {
		v->ns[v->n++] = ns;
	}
}

static int by_size(const void *a, const void *b)
{
	const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

	return (x > y) - (x < y);
}

static void report(struct values *v)
{
	qsort(v->ns, (size_t)v->n, sizeof(v->ns[0]), by_size);
	if (v->n) {
		printf("%-46s p50 %8.1f us   p99 %8.1f us   max %8.1f us   of %d\n", v->what,
		       (double)v->ns[v->n / 2] / 1e3, (double)v->ns[v->n * 99LL / 100] / 1e3,
		       (double)v->ns[v->n - 1] / 1e3, v->n);
	}
}

/* ---- the bus -------------------------------------------------------------------------------------- */

static int pair_recv(struct bus *bus, struct bus_frame *f, int max, int64_t until_ns,
		     int64_t *now_ns)
{
	struct pair_bus *b = (struct pair_bus *)bus;
	struct pollfd pfd[] = {{.fd = b->fd, .events = POLLIN},
			       {.fd = b->watched, .events = POLLIN}};
	const int64_t wait = until_ns - clock_now_ns();
	const struct timespec ts = {.tv_sec = wait > 0 ? wait / CLOCK_NS_PER_S : 0,
				    .tv_nsec = wait > 0 ? wait % CLOCK_NS_PER_S : 0};
	const int ready = ppoll(pfd, 2, &ts, NULL);
	uint64_t count;
	int n = 0;

	b->woken_ns = *now_ns = clock_now_ns();
	b->is_due = wait > 0 && ready == 0;
	if (b->is_due) {
		add(&late, b->woken_ns - until_ns);
	}
	if (pfd[1].revents && read(b->watched, &count, sizeof(count)) < 0) {
		count = 0; /* somebody else read it: as good */
	}
	if (pfd[0].revents) {
		n = bus_rx_read(&b->rx, b->fd, 0, f, max);
	}
	return n;
}

static int pair_send(struct bus *bus, const struct bus_frame *f)
{
	struct pair_bus *b = (struct pair_bus *)bus;
	const int ret = bus_rx_write(b->fd, f);

	if (b->is_due && f->id == b->request_id) {
		add(&wake, clock_now_ns() - b->woken_ns);
		b->is_due = 0;
	}
	return ret;
}

static int pair_watch(struct bus *bus, int fd)
{
	((struct pair_bus *)bus)->watched = fd;
	return 0;
}

static uint32_t pair_events(struct bus *bus)
{
	return bus_rx_events(&((struct pair_bus *)bus)->rx);
}

static int64_t pair_confirmed_ns(const struct bus *bus)
{
	return ((const struct pair_bus *)bus)->rx.confirmed_ns;
}

static const struct bus_stats *pair_stats(const struct bus *bus)
{
	return &((const struct pair_bus *)bus)->rx.stats;
}

static const struct bus_ops pair_ops = {
	.name = "socketpair",
	.recv = pair_recv,
	.send = pair_send,
	.stats = pair_stats,
	.watch = pair_watch,
	.events = pair_events,
	.confirmed_ns = pair_confirmed_ns,
};

/* ---- the car -------------------------------------------------------------------------------------- */

/* What the daemon sends, until @until_ns; @scan_ns: when the last scan was sent, 0 once it was answered. */
static void listen_until(struct bench *b, int64_t until_ns, int64_t *scan_ns)
{
	for (int64_t wait = until_ns - clock_now_ns(); wait > 0; wait = until_ns - clock_now_ns()) {
		struct pollfd pfd = {.fd = b->player_fd, .events = POLLIN};
		const struct timespec ts = {.tv_sec = wait / CLOCK_NS_PER_S,
					    .tv_nsec = wait % CLOCK_NS_PER_S};
		struct bus_frame f;
		struct bus_rx rx = {.allow_local = 1};

		if (ppoll(&pfd, 1, &ts, NULL) > 0 &&
		    bus_rx_read(&rx, b->player_fd, 0, &f, 1) == 1 &&
		    f.id == b->bus.request_id + PUBLISH_RISK && *scan_ns) {
			add(&scan, clock_now_ns() - *scan_ns);
			*scan_ns = 0;
		}
	}
}

static void play(struct bench *b, FILE *log)
{
	const int64_t start_ns = clock_now_ns();
	int64_t first_ns = -1, scan_ns = 0;
	char line[256], iface[BUS_NAME_MAX];
	struct bus_frame f;

	while (fgets(line, sizeof(line), log)) {
		line[strcspn(line, "\n")] = '\0';
		if (bus_log_parse(line, iface, &f)) {
			continue;
		}
		first_ns = first_ns < 0 ? f.t_ns : first_ns;
		listen_until(b, start_ns + f.t_ns - first_ns, &scan_ns);
		scan_ns = f.id == LEAD_ID ? clock_now_ns() : scan_ns;
		if (bus_rx_write(b->player_fd, &f)) {
			perror("bench_wakeup: the daemon does not read");
			return;
		}
	}
}

/* ---- the daemon ----------------------------------------------------------------------------------- */

static void *real_time(void *arg)
{
	struct bench *b = arg;

	rt_prefault_stack(256 * 1024);
	while (!__atomic_load_n(&b->stop, __ATOMIC_ACQUIRE) && !pipeline_step(b->pipeline)) {
	}
	return NULL;
}

static int open_bench(struct bench *b, const char *config, char *err, int err_len)
{
	static const char *const set[] = {"mc.backend=cpu", "bus.transmit=shadow"};
	struct pipeline_open o = {.cfg = &b->cfg, .bus = &b->bus.bus, .clock = clock_now_ns};
	int fd[2], ret = config_load(config, set, 2, &b->cfg, &b->map, err, err_len);

	ret = ret ? ret : engine_open_live(&b->cfg, &b->engine, err, err_len);
	if (ret) {
		return ret;
	}
	if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fd)) {
		snprintf(err, (size_t)err_len, "socketpair: %s", strerror(errno));
		return -errno;
	}
	b->bus = (struct pair_bus){.bus = {&pair_ops},
				   .fd = fd[0],
				   .watched = -1,
				   .rx = {.allow_local = 1},
				   .request_id = (uint32_t)b->cfg.bus_request_id};
	b->player_fd = fd[1];
	setsockopt(fd[0], SOL_SOCKET, SO_TIMESTAMPNS, &(int){1}, sizeof(int));
	o.map = b->map;
	ret = pipeline_open(&o, &b->pipeline);
	if (!ret) {
		pipeline_set_mc(b->pipeline, b->engine.mc, b->engine.which, b->engine.size.samples);
	}
	return ret;
}

/* As the daemon asks for it; a refusal is told, the figures are then those of ordinary threads. */
static void be_real_time(struct bench *b, pthread_t thread)
{
	char err[256] = "";

	if (rt_lock_memory(err, sizeof(err)) ||
	    rt_thread(thread, "real-time thread", (int)b->cfg.rt_priority, -1, err, sizeof(err)) ||
	    rt_thread(mc_thread(b->engine.mc), "compute thread", (int)b->cfg.rt_compute_priority,
		      -1, err, sizeof(err)) ||
	    rt_thread(pthread_self(), "player", (int)b->cfg.rt_priority + 1, -1, err,
		      sizeof(err))) {
		printf("not real time: %s\n", err);
	}
}

int main(int argc, char **argv)
{
	static struct bench b;
	char err[1024] = "";
	pthread_t thread;

	if (argc != 2) {
		fprintf(stderr, "usage: aebmc generate --drive follow | bench_wakeup CONFIG\n");
		return 2;
	}
	if (open_bench(&b, argv[1], err, sizeof(err)) ||
	    pthread_create(&thread, NULL, real_time, &b)) {
		fprintf(stderr, "bench_wakeup: %s\n", err);
		return 1;
	}
	be_real_time(&b, thread);
	play(&b, stdin);
	__atomic_store_n(&b.stop, 1, __ATOMIC_RELEASE);
	pthread_join(thread, NULL);
	printf("%u samples x 4 futures an evaluation, %llu evaluations, period %g ms\n",
	       b.engine.size.samples, (unsigned long long)pipeline_stats(b.pipeline)->evaluations,
	       b.cfg.bus_period);
	report(&late);
	report(&wake);
	report(&scan);
	pipeline_close(b.pipeline);
	engine_close(&b.engine);
	config_mapping_free(b.map);
	return scan.n ? 0 : 1;
}
