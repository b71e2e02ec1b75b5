/* SPDX-License-Identifier: MIT
 * Rooms of the live daemon, opened in order and closed in reverse, and the real-time thread. See live.h.
 */
#include "live_priv.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "clock.h"
#include "engine.h"
#include "rt.h"
#include "service.h"

#define SNAPSHOT_NS (10 * CLOCK_NS_PER_MS)
#define JOIN_NS     (100 * CLOCK_NS_PER_MS)
#define IDS_MAX     (MAP_MESSAGES_MAX + PUBLISH_MSGS)
/* About what a full bus of 500 kbit/s carries. */
#define FRAMES_PER_S 4000

enum policy { RT_OFF, RT_OPTIONAL, RT_REQUIRED };

/* ---- real-time thread ----------------------------------------------------------------------------- */

static void snapshot(struct live *l, uint64_t steps)
{
	struct status s = {.t_ns = clock_now_ns(), .steps = steps};

	s.now = *pipeline_now(l->pipeline);
	s.stats = *pipeline_stats(l->pipeline);
	s.bus = *l->bus->ops->stats(l->bus);
	s.dec = *pipeline_decision(l->pipeline);
	memcpy(s.rejected, pipeline_rejected(l->pipeline), sizeof(s.rejected));
	s.confirmed_ns = l->bus->ops->confirmed_ns(l->bus);
	s.transmit = l->cfg->bus_transmit;
	s.armed = pipeline_armed(l->pipeline);
	ring_put(l->snapshots, &s);
}

static void *real_time(void *arg)
{
	struct live *l = arg;
	int64_t due_ns = 0;
	uint64_t steps = 0;
	int ret = 0;

	rt_prefault_stack(256 * 1024);
	TRACE(l->trace, thread);
	while (!ret && !__atomic_load_n(&l->stop, __ATOMIC_ACQUIRE)) {
		ret = pipeline_step(l->pipeline);
		steps++;
		if (clock_now_ns() >= due_ns) {
			snapshot(l, steps);
			due_ns = clock_now_ns() + SNAPSHOT_NS;
		}
	}
	pipeline_finish(l->pipeline);
	snapshot(l, steps);
	__atomic_store_n(&l->error, ret, __ATOMIC_RELEASE);
	__atomic_store_n(&l->stopped, 1, __ATOMIC_RELEASE);
	return NULL;
}

/* ---- rooms ---------------------------------------------------------------------------------------- */

static int open_signals(struct live *l, char *err, int err_len)
{
	sigset_t set;

	sigemptyset(&set);
	sigaddset(&set, SIGTERM);
	sigaddset(&set, SIGINT);
	sigaddset(&set, SIGHUP);
	pthread_sigmask(SIG_BLOCK, &set, NULL); /* every thread created from here on inherits it */
	l->signal_fd = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
	if (l->signal_fd < 0) {
		snprintf(err, (size_t)err_len, "signalfd: %s", strerror(errno));
		return -errno;
	}
	return 0;
}

static void close_signals(struct live *l)
{
	close(l->signal_fd);
}

/* Its threads, if it has any, are there before ours and take no signals. */
static int open_trace(struct live *l, char *err, int err_len)
{
	return trace_load((enum trace_provider)l->cfg->trace_provider, 1, &l->trace, err, err_len);
}

/* $DIRECTORY/name from the unit's environment, unless the option says otherwise; 0 if there is neither. */
static int unit_path(const char *option, const char *variable, const char *name, char *path,
		     size_t size)
{
	const char *dir = getenv(variable);

	if (option[0]) {
		snprintf(path, size, "%s", option);
	} else if (dir) {
		snprintf(path, size, "%s%s", dir, name);
	}
	return option[0] || dir;
}

static int open_control(struct live *l, char *err, int err_len)
{
	char path[RECORDER_DIR_MAX];

	if (!unit_path(l->cfg->status_socket, "RUNTIME_DIRECTORY", "/status.sock", path,
		       sizeof(path))) {
		return 0;
	}
	return control_open(path, housekeeping_answer, l, &l->control, err, err_len);
}

static void close_control(struct live *l)
{
	control_close(l->control);
}

static int input_ids(const struct live *l, struct bus_id *id)
{
	for (int i = 0; i < l->map->n_messages; i++) {
		id[i] = (struct bus_id){l->map->message[i].iface, l->map->message[i].msg->id};
	}
	return l->map->n_messages;
}

static int own_ids(const struct live *l, struct bus_id *id)
{
	struct publish *pub;
	struct publish_in in = {.state = STATE_INIT};
	struct bus_frame f;

	if (publish_open(l->cfg, &pub)) {
		return 0;
	}
	for (int i = 0; i < PUBLISH_MSGS; i++) {
		publish_pack(pub, (enum publish_msg)i, &in, 0, &f);
		id[i] = (struct bus_id){f.iface, f.id};
	}
	publish_close(pub);
	return PUBLISH_MSGS;
}

static int open_bus(struct live *l, char *err, int err_len)
{
	const char *iface[BUS_IFACES_MAX];
	struct bus_id input[IDS_MAX], own[PUBLISH_MSGS];
	const struct bus_socketcan_params p = {.ifaces = iface,
					       .n_ifaces = l->map->n_ifaces,
					       .input = input,
					       .n_input = input_ids(l, input),
					       .own = own,
					       .n_own = own_ids(l, own),
					       .allow_local = l->cfg->bus_allow_local};

	for (int i = 0; i < l->map->n_ifaces; i++) {
		iface[i] = l->link[i].name = l->map->iface[i];
	}
	return bus_socketcan_open(&p, &l->bus, err, err_len);
}

static void close_bus(struct live *l)
{
	l->bus->ops->close(l->bus);
}

static int open_recorder(struct live *l, char *err, int err_len)
{
	char dir[RECORDER_DIR_MAX];
	const char *iface[BUS_IFACES_MAX];
	const struct recorder_params p = {.dir = dir,
					  .ifaces = iface,
					  .n_ifaces = l->map->n_ifaces,
					  .before_ns = clock_s_to_ns(l->cfg->recorder_before),
					  .after_ns = clock_s_to_ns(l->cfg->recorder_after),
					  .frames_per_s = FRAMES_PER_S,
					  .requests_per_s =
						  (uint32_t)ceil(1000 / l->cfg->radar_period),
					  .bytes_max = (uint64_t)l->cfg->recorder_size << 20};

	if (!unit_path(l->cfg->recorder_dir, "STATE_DIRECTORY", "", dir, sizeof(dir))) {
		return 0;
	}
	for (int i = 0; i < l->map->n_ifaces; i++) {
		iface[i] = l->map->iface[i];
	}
	return recorder_open(&p, &l->recorder, err, err_len);
}

static void close_recorder(struct live *l)
{
	recorder_close(l->recorder);
}

static int open_events(struct live *l, char *err, int err_len)
{
	const int ret = l->recorder ? pthread_create(&l->writer, NULL, housekeeping_events, l) : 0;

	if (ret) {
		snprintf(err, (size_t)err_len, "cannot create the thread that writes events: %s",
			 strerror(ret));
		return -ret;
	}
	l->writing = l->recorder != NULL;
	return 0;
}

/* After the last frames are out, so that they are in its last event. */
static void close_events(struct live *l)
{
	if (l->writing) {
		__atomic_store_n(&l->finish, 1, __ATOMIC_RELEASE);
		pthread_join(l->writer, NULL);
	}
}

static int open_pipeline(struct live *l, char *err, int err_len)
{
	const struct pipeline_open o = {.cfg = l->cfg,
					.map = l->map,
					.bus = l->bus,
					.quiet = l->cfg->bus_transmit == AEB_STATUS_TRANSMIT_NONE,
					.needs_arm =
						l->cfg->bus_transmit == AEB_STATUS_TRANSMIT_ARMED,
					.recorder = l->recorder,
					.trace = l->trace,
					.clock = clock_now_ns};
	int ret = pipeline_open(&o, &l->pipeline);

	ret = ret ? ret : ring_open(4, sizeof(struct status), &l->snapshots);
	if (ret) {
		pipeline_close(l->pipeline);
		snprintf(err, (size_t)err_len, "cannot open the pipeline: %s", strerror(-ret));
	}
	return ret;
}

static void close_pipeline(struct live *l)
{
	pipeline_close(l->pipeline);
	ring_close(l->snapshots);
}

/* A refusal ends the start, or is remembered where the configuration allows it. */
static int refused(struct live *l, int ret, const char *err)
{
	if (!ret || l->cfg->rt_policy == RT_REQUIRED) {
		return ret;
	}
	pipeline_raise(l->pipeline, FAULT_BIT(RT_REFUSED));
	service_log(SERVICE_WARNING, "RT_REFUSED", err);
	return 0;
}

/* Frames that say INIT go out from here on. */
static int open_thread(struct live *l, char *err, int err_len)
{
	int ret = pthread_create(&l->thread, NULL, real_time, l);

	if (ret) {
		snprintf(err, (size_t)err_len, "cannot create the real-time thread: %s",
			 strerror(ret));
		return -ret;
	}
	l->running = 1;
	return 0;
}

/* A real-time thread that does not end in time is stuck in the kernel: leave it to the exit. */
static void stop_thread(struct live *l)
{
	const struct timespec pause = {.tv_nsec = CLOCK_NS_PER_MS};

	if (!l->running) {
		return;
	}

	__atomic_store_n(&l->stop, 1, __ATOMIC_RELEASE);
	for (int64_t t = 0; t < JOIN_NS && !__atomic_load_n(&l->stopped, __ATOMIC_ACQUIRE);
	     t += CLOCK_NS_PER_MS) {
		nanosleep(&pause, NULL);
	}
	if (!__atomic_load_n(&l->stopped, __ATOMIC_ACQUIRE)) {
		service_log(SERVICE_ERROR, "STUCK",
			    "the real-time thread does not end; leaving without it");
		_exit(1);
	}
	pthread_join(l->thread, NULL);
	l->running = 0;
}

static void log_size(const char *backend, const struct engine_size *s)
{
	char text[160];

	if (s->samples) {
		snprintf(text, sizeof(text),
			 "%s: %u samples per evaluation; a batch takes %.3f ms + %.1f ns a sample",
			 backend, s->samples, s->cost.overhead_ns / 1e6, s->cost.sample_ns);
		service_log(SERVICE_NOTICE, "SAMPLES", text);
	}
}

/* Before the thread is a real-time one: meeting the tracer allocates. */
static void watch(struct live *l, struct mc *mc)
{
	if (l->trace && mc && mc_watch(mc, &l->watch)) {
		service_log(SERVICE_WARNING, "TRACE", "the compute thread does not answer");
	}
}

static int open_mc(struct live *l, char *err, int err_len)
{
	const struct engine *e = &l->engine;
	const int ret = engine_open_live(l->cfg, &l->engine, err, err_len);

	if (ret) {
		return ret;
	}
	if (err[0]) {
		service_log(SERVICE_WARNING, l->engine.faults ? "GPU" : "CALIBRATION", err);
	}
	l->watch = trace_watch(l->trace);
	watch(l, e->mc);
	watch(l, e->spare);
	log_size(publish_backend_name[e->which], &e->size);
	log_size("cpu, standing by", &e->spare_size);
	pipeline_raise(l->pipeline, e->faults);
	pipeline_set_spare(l->pipeline, e->spare, e->spare_size.samples);
	pipeline_set_mc(l->pipeline, e->mc, e->which, e->size.samples);
	return 0;
}

static void close_mc(struct live *l)
{
	engine_close(&l->engine);
}

static int rt_compute(struct live *l, const struct mc *mc, char *err, int err_len)
{
	return mc ? rt_thread(mc_thread(mc), "compute thread", (int)l->cfg->rt_compute_priority,
			      (int)l->cfg->rt_compute_cpu, err, err_len)
		  : 0;
}

/* After everything is allocated. */
static int open_real_time(struct live *l, char *err, int err_len)
{
	const struct config *c = l->cfg;
	int ret;

	l->latency_fd = -1;
	if (c->rt_policy == RT_OFF) {
		return 0;
	}
	ret = refused(l, rt_lock_memory(err, err_len), err);
	ret = ret ? ret : refused(l, rt_compute(l, l->engine.mc, err, err_len), err);
	ret = ret ? ret : refused(l, rt_compute(l, l->engine.spare, err, err_len), err);
	ret = ret ? ret
		  : refused(l,
			    rt_thread(l->thread, "real-time thread", (int)c->rt_priority,
				      (int)c->rt_cpu, err, err_len),
			    err);
	if (!ret) {
		l->latency_fd = rt_latency_open(err, err_len);
		ret = refused(l, l->latency_fd < 0 ? l->latency_fd : 0, err);
	}
	return ret;
}

static void close_real_time(struct live *l)
{
	if (l->latency_fd >= 0) {
		close(l->latency_fd);
	}
}

/* Each needs those above it; NULL: nothing to do. */
static const struct room {
	int (*open)(struct live *l, char *err, int err_len);
	void (*close)(struct live *l);
} rooms[] = {
	{open_signals, close_signals},
	{open_trace, NULL},
	{open_control, close_control},
	{open_bus, close_bus},
	{open_recorder, close_recorder},
	{open_events, close_events},
	{open_pipeline, close_pipeline},
	{open_thread, stop_thread},
	{open_mc, close_mc},
	{open_real_time, close_real_time},
	{NULL, stop_thread}, /* ends before what it uses */
};

#define ROOMS (int)(sizeof(rooms) / sizeof(rooms[0]))

int live_run(const struct config *cfg, const struct mapping *map,
	     int (*reload)(void *arg, struct config *cfg, struct mapping **map, char *err,
			   int err_len),
	     void *arg, char *err, int err_len)
{
	struct live *l = calloc(1, sizeof(*l));
	int n = 0, ret = l ? 0 : -ENOMEM;

	if (!l) {
		snprintf(err, (size_t)err_len, "out of memory");
		return ret;
	}
	l->cfg = cfg;
	l->map = map;
	l->reload = reload;
	l->reload_arg = arg;
	for (; n < ROOMS && !ret; n++) {
		ret = rooms[n].open ? rooms[n].open(l, err, err_len) : 0;
	}
	if (ret) {
		n--; /* the room that failed has closed itself */
	} else {
		ret = housekeeping_run(l, err, err_len);
	}
	while (n-- > 0) {
		if (rooms[n].close) {
			rooms[n].close(l);
		}
	}
	free(l);
	return ret;
}
