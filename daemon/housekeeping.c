/* SPDX-License-Identifier: MIT
 * Everything of the live daemon that may block: signals, status socket, log, service manager, watchdog, interfaces,
 * reload; and the thread that writes the recorder's files. The real-time thread never waits for any of it.
 */
#include "live_priv.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/signalfd.h>
#include <time.h>
#include <unistd.h>

#include "clock.h"
#include "config_row.h"
#include "service.h"

#define ROUND_MS 50 /* how often the house is kept */
#define LINKS_NS (200 * CLOCK_NS_PER_MS)

/* ---- log: what changed since the last snapshot ------------------------------------------------------ */

static void log_reasons(uint32_t fault, uint32_t was)
{
	char text[256];

	for (int i = 0; i < FAULTS; i++) {
		const uint32_t bit = 1u << i;

		if ((fault & ~was) & bit) {
			service_log(fault_table[i].state >= STATE_INHIBIT ? SERVICE_WARNING
									  : SERVICE_NOTICE,
				    fault_table[i].name, fault_table[i].doc);
		} else if ((was & ~fault) & bit) {
			snprintf(text, sizeof(text), "cleared: %s", fault_table[i].doc);
			service_log(SERVICE_NOTICE, fault_table[i].name, text);
		}
	}
}

static void log_level(const struct publish_in *now)
{
	const struct scene *s = &now->scene;
	char text[256];

	snprintf(text, sizeof(text),
		 "%s (%s): ego %.1f m/s, lead %.1f m ahead at %.1f m/s; request %.2f m/s2",
		 level_name[now->dec.level], cause_name[now->dec.cause], s->x[SCENE_EGO_SPEED],
		 s->x[SCENE_HEADWAY], s->x[SCENE_LEAD_SPEED], now->dec.accel_mps2);
	service_log(SERVICE_WARNING, "LEVEL", text);
}

/* Nothing else alters the number of samples while the daemon runs. */
static void log_mode(const struct status *s)
{
	char text[96];

	snprintf(text, sizeof(text), "%s, %u samples per evaluation",
		 publish_backend_name[s->now.backend], s->stats.samples);
	service_log(SERVICE_NOTICE, "MODE", text);
}

static void log_changes(struct live *l)
{
	const struct publish_in *now = &l->seen.now;

	if (now->fault != l->logged_fault) {
		log_reasons(now->fault, l->logged_fault);
		l->logged_fault = now->fault;
	}
	if (now->backend != l->logged_backend) {
		log_mode(&l->seen);
		l->logged_backend = now->backend;
	}
	if ((int)now->state != l->logged_state) {
		service_log(SERVICE_NOTICE, "STATE", state_name[now->state]);
		l->logged_state = (int)now->state;
	}
	if ((int)now->dec.level != l->logged_level) {
		log_level(now);
		l->logged_level = (int)now->dec.level;
	}
}

/* ---- status socket ------------------------------------------------------------------------------------ */

static const char *arm(struct live *l, int on)
{
	if (on && !l->seen.now.backend) {
		return "{\"error\":\"not armed: the backend is not open yet\"}";
	}
	if (on && l->seen.now.state == STATE_FAULT) {
		return "{\"error\":\"not armed: the state is FAULT, restart first\"}";
	}
	pipeline_arm(l->pipeline, on);
	service_log(SERVICE_NOTICE, on ? "ARM" : "DISARM", "by command");
	return on ? "{\"ok\":\"armed\"}" : "{\"ok\":\"disarmed\"}";
}

static void answer_status(struct live *l, char *reply, size_t size)
{
	FILE *out = fmemopen(reply, size, "w");

	if (!out) {
		snprintf(reply, size, "{\"error\":\"out of memory\"}");
		return;
	}
	status_json(&l->seen, pipeline_hist(l->pipeline), l->link, l->map->n_ifaces, out);
	fclose(out);
	reply[strcspn(reply, "\n")] = '\0'; /* the socket ends the line */
}

void housekeeping_answer(void *arg, const char *command, char *reply, size_t size)
{
	struct live *l = arg;

	if (strcmp(command, "status") == 0) {
		answer_status(l, reply, size);
	} else if (strcmp(command, "arm") == 0 &&
		   l->cfg->bus_transmit != AEB_STATUS_TRANSMIT_ARMED) {
		snprintf(reply, size, "{\"error\":\"not armed: bus.transmit is not armed\"}");
	} else if (strcmp(command, "arm") == 0 || strcmp(command, "disarm") == 0) {
		snprintf(reply, size, "%s", arm(l, command[0] == 'a'));
	} else if (strcmp(command, "mark") == 0) {
		pipeline_mark(l->pipeline);
		snprintf(reply, size, "%s",
			 l->recorder ? "{\"ok\":\"marked\"}" : "{\"error\":\"no recorder\"}");
	} else {
		snprintf(reply, size, "{\"error\":\"commands are status, arm, disarm, mark\"}");
	}
}

/* ---- reload ---------------------------------------------------------------------------------------------- */

/* Only decision thresholds and the driver model are read anew at every evaluation; the rest sizes or wires something. */
static int may_change(const struct config_row *r)
{
	/* read by the estimator, or for the backend's size */
	static const char *const wired[] = {"driver.override", "decision.speed_min",
					    "decision.samples_min"};

	for (size_t i = 0; i < sizeof(wired) / sizeof(wired[0]); i++) {
		if (strcmp(r->name, wired[i]) == 0) {
			return 0;
		}
	}
	return strcmp(r->section, "decision") == 0 || strcmp(r->section, "driver") == 0;
}

static int refuse_changes(const struct config *was, const struct config *now, char *err,
			  int err_len)
{
	char a[CONFIG_TEXT_MAX], b[CONFIG_TEXT_MAX];

	for (size_t i = 0; i < config_rows_len; i++) {
		const struct config_row *r = &config_rows[i];

		config_row_print(r, was, a);
		config_row_print(r, now, b);
		if (strcmp(a, b) && !may_change(r)) {
			snprintf(err, (size_t)err_len,
				 "%s: %s to %s takes a restart; nothing was changed", r->name, a,
				 b);
			return -EPERM;
		}
	}
	return 0;
}

/* The estimator and the bus's filters are wired to the mapping they were opened with. */
static int refuse_mapping(const struct live *l, const struct mapping *now, const char *dbc,
			  char *err, int err_len)
{
	if (mapping_hash(l->map, 0) == mapping_hash(now, 0)) {
		return 0;
	}
	snprintf(err, (size_t)err_len,
		 "the mapping ([message], [signal]) or its DBC %s changed, which takes a restart; "
		 "nothing was changed",
		 dbc);
	return -EPERM;
}

static int read_again(const struct live *l, struct config *next, char *err, int err_len)
{
	struct mapping *map;
	int ret = l->reload(l->reload_arg, next, &map, err, err_len);

	if (ret) {
		return ret;
	}
	ret = refuse_changes(l->cfg, next, err, err_len);
	ret = ret ? ret : refuse_mapping(l, map, next->dbc_file, err, err_len);
	config_mapping_free(map);
	return ret;
}

/* The real-time thread takes a new configuration within one period; only then may the next reload fill the other
 * copy. */
static void let_it_take(const struct live *l)
{
	const int64_t wait = 2 * (int64_t)(l->cfg->bus_period * 1e6);
	const struct timespec ts = {.tv_sec = wait / CLOCK_NS_PER_S,
				    .tv_nsec = wait % CLOCK_NS_PER_S};

	nanosleep(&ts, NULL);
}

static void reload(struct live *l)
{
	struct config next;
	char err[1024];

	service_notify("RELOADING=1");
	if (read_again(l, &next, err, sizeof(err))) {
		service_log(SERVICE_ERROR, "RELOAD_REFUSED", err);
	} else {
		l->which = !l->which;
		l->reloaded[l->which] = next;
		pipeline_set_config(l->pipeline, &l->reloaded[l->which]);
		let_it_take(l);
		service_log(SERVICE_NOTICE, "RELOADED", "decision and driver options are in force");
	}
	service_notify("READY=1");
}

/* ---- rounds ------------------------------------------------------------------------------------------------ */

static int take_snapshot(struct live *l)
{
	const uint64_t end = ring_end(l->snapshots);
	struct status s;

	if (!end || ring_get(l->snapshots, end - 1, &s)) {
		return 0;
	}
	l->seen = s;
	return 1;
}

/* A bus that is known to carry nothing: no other node is awake to acknowledge, say, and our frames stay in the queue. To
 * start again would not mend that. */
#define BUS_DEAD \
	(FAULT_BIT(BUS_DOWN) | FAULT_BIT(BUS_OFF) | FAULT_BIT(BUS_PASSIVE) | FAULT_BIT(TX_REFUSED))

/* A sign of life counts only if the real-time loop moved, and our frames came back if the bus carries any. */
static int is_alive(const struct live *l)
{
	const int listening = l->seen.transmit == AEB_STATUS_TRANSMIT_NONE;
	const int dead = (l->seen.now.fault & BUS_DEAD) != 0;

	return l->seen.steps != l->fed_steps &&
	       (listening || dead || l->seen.bus.confirmed != l->fed_confirmed);
}

static void feed_watchdog(struct live *l, int64_t now_ns)
{
	const int64_t interval = service_watchdog_ns();

	if (interval && now_ns - l->fed_ns > interval / 4 && is_alive(l)) {
		service_notify("WATCHDOG=1");
		l->fed_ns = now_ns;
		l->fed_steps = l->seen.steps;
		l->fed_confirmed = l->seen.bus.confirmed;
	}
}

static void look_after_links(struct live *l)
{
	char line[256] = "STATUS=";

	bus_socketcan_service(l->bus);
	for (int i = 0; i < l->map->n_ifaces; i++) {
		struct status_link *k = &l->link[i];

		k->up = bus_socketcan_iface(l->bus, i);
		link_read(k->name, &k->link);
		if (k->link.known) {
			bus_socketcan_passive(l->bus, i, !strcmp(k->link.state, "error-passive"));
		}
	}
	status_words(&l->seen, line + strlen(line), (int)(sizeof(line) - strlen(line)));
	service_notify(line);
}

/* ---- events: a thread of its own, because a disk may take longer than the watchdog waits ---------------- */

static int write_event(struct live *l, int finish)
{
	const int64_t now_ns = clock_now_ns();
	struct timespec real;
	char path[RECORDER_PATH_MAX], words[256], text[RECORDER_PATH_MAX + 320];
	int ret, missing;

	clock_gettime(CLOCK_REALTIME, &real);
	ret = recorder_service(l->recorder, now_ns,
			       real.tv_sec * CLOCK_NS_PER_S + real.tv_nsec - now_ns, finish, path);
	if (!ret) {
		return 0;
	}
	missing = recorder_words(l->recorder, words, sizeof(words));
	if (ret > 0) {
		snprintf(text, sizeof(text), "%s: %s", path, words);
	} else {
		snprintf(text, sizeof(text), "an event could not be written (%s): %s", words,
			 strerror(-ret));
	}
	service_log(ret < 0   ? SERVICE_ERROR
		    : missing ? SERVICE_WARNING
			      : SERVICE_NOTICE,
		    "EVENT", text);
	return ret;
}

void *housekeeping_events(void *arg)
{
	const struct timespec pause = {.tv_nsec = ROUND_MS * CLOCK_NS_PER_MS};
	struct live *l = arg;
	int finish;

	do {
		finish = __atomic_load_n(&l->finish, __ATOMIC_ACQUIRE);
		while (write_event(l, finish)) {
		}
		nanosleep(&pause, NULL);
	} while (!finish);
	return NULL;
}

/* A tracer's trigger that hangs on this writes to a pipe: not in a real-time thread. */
static void tell_tracer(struct live *l, int64_t now_ns)
{
	const struct pipeline_stats *s = &l->seen.stats;
	const uint64_t missed = s->stage_miss + s->late + s->period_miss + s->skipped;

	if (trace_alarm(&l->alarm, missed, now_ns)) {
		TRACE(l->trace, deadline_miss, missed);
	}
}

/* Configuration valid, memory locked, backend warm: all of it is done before the first round. */
static void tell_ready(struct live *l)
{
	if (!l->ready) {
		l->ready = 1;
		service_notify("READY=1");
	}
}

/* Returns 1 when a signal asks for the end. */
static int take_signals(struct live *l)
{
	struct signalfd_siginfo si;

	while (read(l->signal_fd, &si, sizeof(si)) == (ssize_t)sizeof(si)) {
		if (si.ssi_signo != SIGHUP) {
			return 1;
		}
		reload(l);
	}
	return 0;
}

int housekeeping_run(struct live *l, char *err, int err_len)
{
	struct pollfd pfd[] = {
		{.fd = l->signal_fd, .events = POLLIN},
		{.fd = l->control ? control_fd(l->control) : -1, .events = POLLIN},
	};
	int64_t links_ns = 0;
	int ret = 0;

	while (!take_signals(l)) {
		const int64_t now_ns = clock_now_ns();

		if (take_snapshot(l)) {
			log_changes(l);
			tell_ready(l);
		}
		if (now_ns >= links_ns) {
			look_after_links(l);
			pipeline_check_config(l->pipeline);
			links_ns = now_ns + LINKS_NS;
		}
		feed_watchdog(l, now_ns);
		tell_tracer(l, now_ns);
		if (l->control) {
			control_serve(l->control);
		}
		if (__atomic_load_n(&l->stopped, __ATOMIC_ACQUIRE)) {
			ret = __atomic_load_n(&l->error, __ATOMIC_ACQUIRE);
			snprintf(err, (size_t)err_len, "the bus failed: %s", strerror(-ret));
			break;
		}
		poll(pfd, 2, ROUND_MS);
	}
	service_notify("STOPPING=1");
	return ret;
}
