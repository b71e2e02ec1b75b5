/* SPDX-License-Identifier: MIT
 * Without libsystemd: no manager to tell, the log goes to standard error. See service.h.
 */
#include "service.h"

#include <stdio.h>

int service_notify(const char *state)
{
	(void)state;
	return 0;
}

int64_t service_watchdog_ns(void)
{
	return 0;
}

void service_log(enum service_level level, const char *reason, const char *text)
{
	fprintf(stderr, "<%d>%s: %s\n", (int)level, reason, text);
}
