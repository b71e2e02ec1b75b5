/* SPDX-License-Identifier: MIT
 * What live.c and housekeeping.c share.
 */
#ifndef AEBMC_LIVE_PRIV_H
#define AEBMC_LIVE_PRIV_H

#include <pthread.h>

#include "control.h"
#include "engine.h"
#include "live.h"
#include "recorder.h"
#include "ring.h"
#include "status.h"

struct live {
	const struct config *cfg; /* as started with */
	const struct mapping *map;
	struct config
		reloaded[2]; /* the one in use since the last reload, and the one the next fills */
	int which;
	int (*reload)(void *arg, struct config *cfg, struct mapping **map, char *err, int err_len);
	void *reload_arg;

	struct bus *bus;
	struct engine engine;
	struct recorder *recorder;
	struct control *control;
	struct pipeline *pipeline;
	const struct trace_ops *trace; /* NULL: none */
	struct mc_watch watch;
	struct trace_alarm alarm;
	struct ring *snapshots; /* struct status: written by the real-time thread */
	int latency_fd;

	pthread_t writer;
	int writing; /* the thread that writes events exists */
	int finish;  /* atomic: it should write what it has and end */

	pthread_t thread;
	int running; /* the real-time thread exists */
	int stop;    /* atomic: it should end */
	int stopped; /* atomic: it has ended */
	int error;   /* why it ended by itself, -errno */

	int signal_fd, ready;
	struct status_link link[BUS_IFACES_MAX];
	struct status seen; /* last snapshot read */
	int64_t fed_ns;     /* when the watchdog was last fed */
	uint64_t fed_steps, fed_confirmed;
	uint32_t logged_fault;
	int logged_state, logged_level;
	enum publish_backend logged_backend;
};

/** housekeeping_run - everything that may block, until a signal or an error ends the daemon. 0 or -errno, @err says why. */
int housekeeping_run(struct live *l, char *err, int err_len);

/** housekeeping_events - writes the recorder's events until l->finish, which ends an open one. The body of a thread. */
void *housekeeping_events(void *live);

/** housekeeping_answer - one command of the status socket. For control_open(). */
void housekeeping_answer(void *arg, const char *command, char *reply, size_t size);

#endif
