/* SPDX-License-Identifier: MIT
 * With libsystemd: notifications, watchdog, structured journal fields. See service.h.
 */
#include "service.h"

#include <stdio.h>
#include <stdlib.h>
#include <systemd/sd-daemon.h>
#include <systemd/sd-journal.h>

int service_notify(const char *state)
{
	return sd_notify(0, state);
}

int64_t service_watchdog_ns(void)
{
	uint64_t us = 0;

	return sd_watchdog_enabled(0, &us) > 0 ? (int64_t)us * 1000 : 0;
}

/* Started by hand there is no journal behind standard error: say it there. */
void service_log(enum service_level level, const char *reason, const char *text)
{
	if (!getenv("JOURNAL_STREAM") ||
	    sd_journal_send("MESSAGE=%s: %s", reason, text, "PRIORITY=%i", (int)level,
			    "AEBMC_REASON=%s", reason, NULL) < 0) {
		fprintf(stderr, "<%d>%s: %s\n", (int)level, reason, text);
	}
}
