/* SPDX-License-Identifier: MIT
 * Checks of a CAN bus from what was seen of it for a while. See doctor.def.
 */
#include <math.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "doctor.h"
#include "doctor_file.h"

#define SAMPLE_POINT_TOLERANCE 0.03
#define PASSIVE                128 /* errors from which a controller is error-passive (ISO 11898-1) */
#define WARNING                96

/* ---- looking ----------------------------------------------------------------------------------- */

static int64_t received(const struct doctor *d, const char *name)
{
	char path[128];
	int64_t frames;

	snprintf(path, sizeof(path), "/sys/class/net/%s/statistics/rx_packets", name);
	return doctor_file_number(d->root, path, &frames) ? -1 : frames;
}

/* Netlink knows nothing of made-up trees. */
static void ask_controller(const struct doctor *d, const char *name, struct link_state *l)
{
	*l = (struct link_state){.state = "unknown"};
	if (!d->root[0]) {
		link_read(name, l);
	}
}

static int is_up(const struct doctor *d, const char *name)
{
	char path[128];
	int64_t flags;

	snprintf(path, sizeof(path), "/sys/class/net/%s/flags", name);
	return !doctor_file_number(d->root, path, &flags) && flags & IFF_UP;
}

void doctor_bus_look(const struct doctor *d, struct doctor_bus *b)
{
	const struct timespec wait = {.tv_sec = (time_t)b->window_s};
	char path[128];
	int64_t before;

	snprintf(path, sizeof(path), "/sys/class/net/%s", b->name);
	b->there = doctor_file_there(d->root, path);
	b->up = is_up(d, b->name);
	ask_controller(d, b->name, &b->before);
	before = received(d, b->name);
	if (b->up) {
		nanosleep(&wait, NULL);
	}
	b->frames = before < 0 ? -1 : received(d, b->name) - before;
	ask_controller(d, b->name, &b->after);
}

int doctor_bus_names(const struct doctor *d, char (*name)[BUS_NAME_MAX], int max)
{
	glob_t found;
	const size_t all = doctor_file_glob(d->root, "/sys/class/net/*/type", &found);
	int n = 0;

	for (size_t i = 0; i < all && n < max; i++) {
		char *path = found.gl_pathv[i];
		int64_t type = -1;

		doctor_file_number("", path, &type);
		*strrchr(path, '/') = '\0';
		if (type == ARPHRD_CAN) {
			snprintf(name[n++], BUS_NAME_MAX, "%.*s", BUS_NAME_MAX - 1,
				 strrchr(path, '/') + 1);
		}
	}
	globfree(&found);
	return n;
}

/* ---- judging ----------------------------------------------------------------------------------- */

enum doctor_verdict doctor_bus_up(const struct doctor_bus *b, doctor_text is)
{
	return doctor_say(is, b->up ? DOCTOR_GOOD : DOCTOR_MISSING, "%s",
			  b->up      ? "up"
			  : b->there ? "down"
				     : "there is no such interface");
}

enum doctor_verdict doctor_bus_frames(const struct doctor_bus *b, doctor_text is)
{
	if (!b->up || b->frames < 0 || b->window_s <= 0) {
		return doctor_say(is, DOCTOR_NONE, "not looked at");
	}
	return doctor_say(is, b->frames ? DOCTOR_GOOD : DOCTOR_MISSING, "%lld frames in %g s",
			  (long long)b->frames, b->window_s);
}

static enum doctor_verdict no_controller(doctor_text is)
{
	return doctor_say(is, DOCTOR_NONE, "a virtual interface, or built without libsocketcan");
}

/* Unacknowledged frames count up to error-passive and no further (ISO 11898-1), so rising is no condition there. */
enum doctor_verdict doctor_bus_acknowledged(const struct doctor_bus *b, doctor_text is)
{
	const int rising = b->after.tx_errors > b->before.tx_errors;
	const int bad = b->after.tx_errors >= PASSIVE ||
			(rising && b->after.tx_errors >= WARNING) ||
			!strcmp(b->after.state, "bus-off");

	if (!b->after.known) {
		return no_controller(is);
	}
	return doctor_say(is, bad ? DOCTOR_MISSING : DOCTOR_GOOD, "%s, transmit errors %u to %u",
			  b->after.state, b->before.tx_errors, b->after.tx_errors);
}

/* At a wrong rate every frame is an error: none arrives, and receive errors rise. */
enum doctor_verdict doctor_bus_bit_rate(const struct doctor_bus *b, doctor_text is)
{
	const int deaf = b->frames == 0 && b->after.rx_errors >= WARNING;

	if (!b->after.known) {
		return no_controller(is);
	}
	return doctor_say(
		is, b->after.bitrate == b->bitrate && !deaf ? DOCTOR_GOOD : DOCTOR_MISSING,
		"%u bit/s%s", b->after.bitrate, deaf ? ", but errors instead of frames" : "");
}

enum doctor_verdict doctor_bus_sample_point(const struct doctor_bus *b, doctor_text is)
{
	const double off = fabs(b->after.sample_point - b->sample_point);

	if (!b->after.known) {
		return no_controller(is);
	}
	return doctor_say(is, off <= SAMPLE_POINT_TOLERANCE ? DOCTOR_GOOD : DOCTOR_ADVICE, "%.3f",
			  b->after.sample_point);
}

enum doctor_verdict doctor_bus_restart_ms(const struct doctor_bus *b, doctor_text is)
{
	if (!b->after.known) {
		return no_controller(is);
	}
	return doctor_say(is, b->after.restart_ms ? DOCTOR_GOOD : DOCTOR_MISSING, "%u ms",
			  b->after.restart_ms);
}
