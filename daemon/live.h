/* SPDX-License-Identifier: MIT
 * The daemon on a real bus. The real-time thread runs the pipeline; the compute thread, behind mc.h, runs batches; the
 * calling thread keeps house until a signal ends it, and one more writes the recorder's events.
 */
#ifndef AEBMC_LIVE_H
#define AEBMC_LIVE_H

#include "config.h"
#include "mapping.h"

/**
 * live_run - open everything in order, run, close in reverse
 * Frames that say INIT go out before any backend is open. Allocates; returns at SIGTERM or SIGINT.
 * @reload: reads the configuration and its mapping again for SIGHUP: 0 or -errno with one line in @err
 * Returns 0, or -errno with one line in @err.
 */
int live_run(const struct config *cfg, const struct mapping *map,
	     int (*reload)(void *arg, struct config *cfg, struct mapping **map, char *err,
			   int err_len),
	     void *arg, char *err, int err_len);

#endif
