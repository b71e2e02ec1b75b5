/* SPDX-License-Identifier: MIT
 * Closed loops over SocketCAN.
 */
#include "scenario_live.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "cli.h"
#include "clock.h"
#include "scenario_loop.h"

#define FRAMES  32
#define PAUSE_S 2 /* longer than any input stays fresh */

static int send_frame(void *arg, const struct bus_frame *f, const struct drive_truth *now)
{
	struct bus *bus = arg;

	(void)now;
	bus->ops->send(bus, f); /* a lost frame is a lost frame */
	return 0;
}

/* What comes until the millisecond is over. */
static int listen_until(struct bus *bus, struct scenario_loop *l, int64_t until_ns)
{
	struct bus_frame f[FRAMES];
	int64_t now_ns = 0;

	while (now_ns < until_ns) {
		const int n = bus->ops->recv(bus, f, FRAMES, until_ns, &now_ns);

		if (n < 0 && n != -EINTR) {
			return n;
		}
		for (int i = 0; i < n; i++) {
			scenario_loop_hear(l, &f[i], l->sensors.t_ns);
		}
	}
	return 0;
}

static void show(struct progress *line, const struct scenario_plan *p, int run, double t_s)
{
	const struct scenario *s = &p->row[run / p->cars];
	const int total = p->rows * p->cars;
	char words[SCENARIO_NAME_MAX + 48];

	if (line->on) {
		snprintf(words, sizeof(words), "%d of %d runs, %s", run, total, s->name);
		progress_update(line, (run + t_s / s->drive.end_s) / total, words);
	}
}

int scenario_live_run(struct bus *bus, const struct scenario_plan *p, int row, int car,
		      struct progress *line, struct scenario_result *r)
{
	const struct scenario *s = &p->row[row];
	const struct scenario_draw d = scenario_draw(p->cfg, s, p->seed, car);
	struct scenario_loop *l = malloc(sizeof(*l));
	const int64_t start_ns = clock_now_ns();
	int ret = l ? 0 : -ENOMEM;

	if (l) {
		scenario_loop_open(l, &p->told[row], p->map, s, &d);
	}
	while (!ret && !cli_interrupted()) {
		show(line, p, row * p->cars + car - p->first_car, l->now.t_s);
		ret = scenario_loop_step(l, send_frame, bus);
		ret = ret ? ret : listen_until(bus, l, start_ns + l->sensors.t_ns - DRIVE_START_NS);
	}
	if (ret == -ENODATA) {
		*r = l->result;
		ret = 0;
	}
	free(l);
	return ret;
}

static int open_bus(const struct scenario_plan *p, struct bus **ret)
{
	const struct bus_id request = {(uint8_t)config_out_interface(p->cfg),
				       (uint32_t)p->cfg->bus_request_id};
	const char *iface[BUS_IFACES_MAX];
	const struct bus_socketcan_params params = {
		.ifaces = iface,
		.n_ifaces = p->map->n_ifaces,
		.input = &request,
		.n_input = 1,
		.allow_local = 1, /* the daemon may run on this host, on vcan */
	};
	char err[256];

	for (int i = 0; i < p->map->n_ifaces; i++) {
		iface[i] = p->map->iface[i];
	}
	const int error = bus_socketcan_open(&params, ret, err, sizeof(err));

	if (error) {
		return cli_error(error == -EAFNOSUPPORT ? CLI_SKIPPED : CLI_FAILED, p->name, "%s",
				 err);
	}
	for (int i = 0; i < p->map->n_ifaces; i++) {
		if (!bus_socketcan_iface(*ret, i)) {
			return cli_error(CLI_FAILED, p->name,
					 "%s is not there or down: ip link set %s up", iface[i],
					 iface[i]);
		}
	}
	return 0;
}

int scenario_live(const struct scenario_plan *p, struct scenario_result *result)
{
	struct bus *bus = NULL;
	struct progress line = progress_start(p->name);
	int code = open_bus(p, &bus);

	for (int i = 0; !code && i < p->rows * p->cars && !cli_interrupted(); i++) {
		const int error = scenario_live_run(bus, p, i / p->cars, p->first_car + i % p->cars,
						    &line, &result[i]);

		p->latest_s[i / p->cars] = scenario_latest(p->cfg, &p->row[i / p->cars]);
		code = error ? cli_error(CLI_FAILED, p->name, "%s: %s", p->row[i / p->cars].name,
					 strerror(-error))
			     : 0;
		sleep(PAUSE_S);
	}
	progress_clear(&line);
	if (bus) {
		bus->ops->close(bus);
	}
	return code || !cli_interrupted() ? code : cli_error(CLI_FAILED, p->name, "interrupted");
}
