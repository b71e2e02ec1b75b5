/* SPDX-License-Identifier: MIT
 * With libsocketcan: state and counters of a controller. See link.h.
 */
#include "link.h"

#include <libsocketcan.h>
#include <stdio.h>
#include <unistd.h>

static const char *const state_text[] = {
	[CAN_STATE_ERROR_ACTIVE] = "error-active",
	[CAN_STATE_ERROR_WARNING] = "error-warning",
	[CAN_STATE_ERROR_PASSIVE] = "error-passive",
	[CAN_STATE_BUS_OFF] = "bus-off",
	[CAN_STATE_STOPPED] = "stopped",
	[CAN_STATE_SLEEPING] = "sleeping",
};

/* A virtual interface has no controller, and libsocketcan would complain of it on standard error at every call. */
static int has_controller(const char *name)
{
	char path[64];

	snprintf(path, sizeof(path), "/sys/class/net/%s/device", name);
	return access(path, F_OK) == 0;
}

void link_read(const char *name, struct link_state *l)
{
	struct can_berr_counter errors = {0};
	struct can_bittiming timing = {0};
	int state;

	*l = (struct link_state){.state = "unknown"};
	if (!has_controller(name) || can_get_state(name, &state) || state < 0 ||
	    state > CAN_STATE_SLEEPING || can_get_bittiming(name, &timing)) {
		return;
	}
	l->known = 1;
	l->state = state_text[state];
	l->bitrate = timing.bitrate;
	l->sample_point = timing.sample_point / 1000.0;
	can_get_restart_ms(name, &l->restart_ms);
	l->counted = !can_get_berr_counter(name, &errors);
	if (l->counted) {
		l->tx_errors = errors.txerr;
		l->rx_errors = errors.rxerr;
	}
}
