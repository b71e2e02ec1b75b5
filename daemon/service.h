/* SPDX-License-Identifier: MIT
 * The service manager and the journal. With libsystemd (service_systemd.c), or standard error alone (service_none.c).
 * Housekeeping thread only: all of it may block.
 */
#ifndef AEBMC_SERVICE_H
#define AEBMC_SERVICE_H

#include <stdint.h>

enum service_level {
	SERVICE_ERROR = 3,
	SERVICE_WARNING = 4,
	SERVICE_NOTICE = 5,
	SERVICE_INFO = 6
}; /* syslog's */

/** service_notify - tell the manager: "READY=1", "STATUS=...", "WATCHDOG=1", "RELOADING=1", "STOPPING=1". Returns 1 if it
 * was told, 0 if there is no manager, -errno. */
int service_notify(const char *state);

/** service_watchdog_ns - within which time the manager wants a sign of life; 0: it does not. */
int64_t service_watchdog_ns(void);

/**
 * service_log - one line of the log
 * @reason: short code ("EGO_STALE", "ARMED"): the journal field AEBMC_REASON
 * @text: what happened, with units
 */
void service_log(enum service_level level, const char *reason, const char *text);

#endif
