/* SPDX-License-Identifier: MIT
 * Closed loops over SocketCAN: the car's frames in real time to a daemon, its requests back to the plant.
 */
#ifndef AEBMC_SCENARIO_LIVE_H
#define AEBMC_SCENARIO_LIVE_H

#include "scenario_pool.h"

/**
 * scenario_live - every car of every row, one after the other, each as long as it takes
 * The daemon runs elsewhere, with the same mapping, on the same interfaces; it brakes if it is armed. Between two runs
 * the bus is silent for two seconds.
 * @result: [rows][cars]. Returns 0, or an exit code after one line: CLI_SKIPPED where the kernel has no CAN.
 */
int scenario_live(const struct scenario_plan *p, struct scenario_result *result);

/**
 * scenario_live_run - one run on an open bus, clock_now_ns() being its time
 * @bus: the frames of @p's mapping out, AEB_REQUEST in; @line: shows how far all runs of @p are. Returns 0 or -errno.
 */
int scenario_live_run(struct bus *bus, const struct scenario_plan *p, int row, int car,
		      struct progress *line, struct scenario_result *r);

#endif
