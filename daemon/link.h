/* SPDX-License-Identifier: MIT
 * What a CAN controller says of itself over netlink: state, error counters, bit rate, sample point, restart policy.
 * With libsocketcan (link_socketcan.c), or nothing known (link_none.c). Housekeeping thread: every call blocks.
 */
#ifndef AEBMC_LINK_H
#define AEBMC_LINK_H

#include <stdint.h>

struct link_state {
	int known; /* 0: no netlink, no such interface, or no controller (vcan) */
	const char *
		state; /* "error-active", "error-warning", "error-passive", "bus-off", "stopped", "sleeping" */
	int counted; /* 0: the driver counts no errors, the two below are nothing */
	uint16_t tx_errors, rx_errors;
	uint32_t bitrate;    /* [bit/s] */
	double sample_point; /* 0..1 */
	uint32_t restart_ms; /* 0: a bus-off lasts for ever */
};

/** link_read - ask the kernel about interface @name. Never fails: what is not known is 0 and known is 0. */
void link_read(const char *name, struct link_state *l);

#endif
