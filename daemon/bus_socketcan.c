/* SPDX-License-Identifier: MIT
 * The live bus: one CAN_RAW socket per interface with exact filters, kernel receive stamps, error frames, drop counter
 * and own echo. What a received message means (filterable without CAN hardware) is in bus_rx.c; this file owns the
 * descriptors. Two threads: recv/send on one, bus_socketcan_service() on another; a new socket passes between them
 * through one atomic word.
 */
#include "bus.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus_rx.h"
#include "clock.h"

#define NO_FD      (-1)
#define WATCH_MAX  2
#define FILTER_MAX 512

enum asked { NOT_ASKED, NOT_PASSIVE, PASSIVE };

struct port {
	int fd;      /* owned by the receiving thread; NO_FD while there is none */
	int offered; /* atomic: a socket the service opened and the receiving thread has not taken yet */
	int retired; /* atomic: a socket the receiving thread gave up, for the service to close */
	int ifindex; /* service only: what the newest socket is bound to; 0 none */
	uint32_t up; /* atomic: link usable */
	int asked;   /* atomic: what the controller said of itself since the last look */
	char name[BUS_NAME_MAX];
	struct can_filter filter[FILTER_MAX];
	int n_filter;
};

struct socketcan {
	struct bus bus;
	int n_ports, n_watch;
	int first; /* port that is read first */
	int watch[WATCH_MAX];
	int ctl; /* for interface queries by the service */
	struct port port[BUS_IFACES_MAX];
	struct bus_rx rx;
};

static struct socketcan *of(struct bus *b)
{
	return (struct socketcan *)b;
}

/* ---- opening a socket (service, or before the threads start) ------------------------------------ */

static int set_options(int fd, const struct port *p)
{
	const int on = 1;
	const can_err_mask_t errors = CAN_ERR_BUSOFF | CAN_ERR_CRTL | CAN_ERR_RESTARTED |
				      CAN_ERR_TX_TIMEOUT | CAN_ERR_ACK;

	if (setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, p->filter,
		       (socklen_t)((size_t)p->n_filter * sizeof(p->filter[0]))) ||
	    setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof(errors)) ||
	    setsockopt(fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &on, sizeof(on)) ||
	    setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof(on)) ||
	    setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)) ||
	    setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on))) {
		return -errno;
	}
	return 0;
}

static int open_socket(const struct port *p, int ifindex)
{
	struct sockaddr_can addr = {.can_family = AF_CAN, .can_ifindex = ifindex};
	const int fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
	int ret;

	if (fd < 0) {
		return -errno;
	}
	ret = set_options(fd, p);
	if (!ret && bind(fd, (struct sockaddr *)&addr, sizeof(addr))) {
		ret = -errno;
	}
	if (ret) {
		close(fd);
		return ret;
	}
	return fd;
}

static int link_up(int ctl, const char *name)
{
	struct ifreq req = {0};

	snprintf(req.ifr_name, sizeof(req.ifr_name), "%s", name);
	return !ioctl(ctl, SIOCGIFFLAGS, &req) && (req.ifr_flags & IFF_UP) &&
	       (req.ifr_flags & IFF_RUNNING);
}

static void close_retired(struct port *p)
{
	const int fd = __atomic_exchange_n(&p->retired, NO_FD, __ATOMIC_ACQ_REL);

	if (fd != NO_FD) {
		close(fd);
	}
}

/* An interface that was deleted and created again has a new index; a socket bound to the old one is deaf for ever. */
static void service_port(struct socketcan *s, struct port *p)
{
	const int ifindex = (int)if_nametoindex(p->name);
	int fd;

	close_retired(p);
	if (ifindex && ifindex != p->ifindex &&
	    __atomic_load_n(&p->offered, __ATOMIC_ACQUIRE) == NO_FD) {
		fd = open_socket(p, ifindex);
		if (fd >= 0) {
			p->ifindex = ifindex;
			__atomic_store_n(&p->offered, fd, __ATOMIC_RELEASE);
		}
	}
	if (!ifindex) {
		p->ifindex = 0;
	}
	__atomic_store_n(&p->up, ifindex && p->ifindex == ifindex && link_up(s->ctl, p->name),
			 __ATOMIC_RELEASE);
}

void bus_socketcan_service(struct bus *b)
{
	struct socketcan *s = of(b);

	for (int i = 0; i < s->n_ports; i++) {
		service_port(s, &s->port[i]);
	}
}

int bus_socketcan_iface(const struct bus *b, int i)
{
	const struct socketcan *s = (const struct socketcan *)b;

	return i >= 0 && i < s->n_ports && __atomic_load_n(&s->port[i].up, __ATOMIC_ACQUIRE);
}

void bus_socketcan_passive(struct bus *b, int i, int passive)
{
	__atomic_store_n(&of(b)->port[i].asked, passive ? PASSIVE : NOT_PASSIVE, __ATOMIC_RELEASE);
}

/* ---- receiving thread ---------------------------------------------------------------------------- */

static void take_offered(struct port *p)
{
	int fd;

	if (__atomic_load_n(&p->retired, __ATOMIC_ACQUIRE) != NO_FD) {
		return; /* the last one given up is not closed yet */
	}
	fd = __atomic_exchange_n(&p->offered, NO_FD, __ATOMIC_ACQ_REL);
	if (fd != NO_FD) {
		__atomic_store_n(&p->retired, p->fd, __ATOMIC_RELEASE);
		p->fd = fd;
	}
}

static void mark_down(struct port *p)
{
	__atomic_store_n(&p->up, 0, __ATOMIC_RELEASE);
}

static int fill_poll(struct socketcan *s, struct pollfd *pfd)
{
	int n = 0;

	for (int i = 0; i < s->n_ports; i++) {
		take_offered(&s->port[i]);
		pfd[n++] = (struct pollfd){.fd = s->port[i].fd, .events = POLLIN};
	}
	for (int i = 0; i < s->n_watch; i++) {
		pfd[n++] = (struct pollfd){.fd = s->watch[i], .events = POLLIN};
	}
	return n;
}

/* Reads what is there, at most @max frames. POLLERR is cleared by the read that returns ENETDOWN. */
static int read_port(struct socketcan *s, int i, struct bus_frame *f, int max)
{
	struct port *p = &s->port[i];
	const int n = bus_rx_read(&s->rx, p->fd, (uint8_t)i, f, max);

	if (n == -ENETDOWN || n == -ENODEV || n == -ENXIO) {
		mark_down(p);
		bus_rx_passive(&s->rx, (uint8_t)i, 0); /* it comes up error-active */
		return 0;
	}
	return n < 0 ? 0 : n;
}

/* A watched counter is read here: left alone it would end every later wait at once, for ever. */
static void reset_watched(const struct pollfd *pfd, int n)
{
	uint64_t count;

	for (int i = 0; i < n; i++) {
		if (pfd[i].revents && read(pfd[i].fd, &count, sizeof(count)) < 0) {
			continue; /* somebody else read it: as good */
		}
	}
}

static int socketcan_recv(struct bus *b, struct bus_frame *f, int max, int64_t until_ns,
			  int64_t *now_ns)
{
	struct socketcan *s = of(b);
	struct pollfd pfd[BUS_IFACES_MAX + WATCH_MAX];
	const int n_fds = fill_poll(s, pfd);
	int64_t wait = until_ns - clock_now_ns();
	int n = 0;

	wait = wait < 0 ? 0 : wait > CLOCK_NS_PER_S ? CLOCK_NS_PER_S : wait;
	const struct timespec ts = {.tv_sec = wait / CLOCK_NS_PER_S,
				    .tv_nsec = wait % CLOCK_NS_PER_S};
	const int ready = ppoll(pfd, (nfds_t)n_fds, &ts, NULL);

	if (ready > 0) {
		reset_watched(pfd + s->n_ports, s->n_watch);
	}
	/* Another port first each time: a flood on one must not starve the others. */
	s->first = (s->first + 1) % s->n_ports;
	for (int k = 0; ready > 0 && k < s->n_ports && n < max; k++) {
		const int i = (s->first + k) % s->n_ports;

		if (pfd[i].revents) {
			n += read_port(s, i, f + n, max - n);
		}
	}
	*now_ns = clock_now_ns();
	return n;
}

static int socketcan_send(struct bus *b, const struct bus_frame *f)
{
	struct socketcan *s = of(b);
	struct port *p;
	int ret;

	if (f->iface >= s->n_ports) {
		return -EINVAL;
	}
	p = &s->port[f->iface];
	ret = p->fd == NO_FD ? -ENETDOWN : bus_rx_write(p->fd, f);
	if (ret == -ENETDOWN || ret == -ENXIO || ret == -ENODEV) {
		mark_down(p);
	}
	if (ret) {
		s->rx.stats.tx_refused++;
	} else {
		s->rx.stats.sent++;
	}
	return ret;
}

static const struct bus_stats *socketcan_stats(const struct bus *b)
{
	return &((const struct socketcan *)b)->rx.stats;
}

static int socketcan_watch(struct bus *b, int fd)
{
	struct socketcan *s = of(b);

	if (s->n_watch == WATCH_MAX) {
		return -ENOSPC;
	}
	s->watch[s->n_watch++] = fd;
	return 0;
}

static uint32_t socketcan_events(struct bus *b)
{
	struct socketcan *s = of(b);
	uint32_t down = 0;

	for (int i = 0; i < s->n_ports; i++) {
		const int asked =
			__atomic_exchange_n(&s->port[i].asked, NOT_ASKED, __ATOMIC_ACQ_REL);

		if (asked != NOT_ASKED) {
			bus_rx_passive(&s->rx, (uint8_t)i, asked == PASSIVE);
		}
		down |= bus_socketcan_iface(b, i) ? 0 : BUS_EV_DOWN;
	}
	return bus_rx_events(&s->rx) | down;
}

static int64_t socketcan_confirmed_ns(const struct bus *b)
{
	return ((const struct socketcan *)b)->rx.confirmed_ns;
}

static void socketcan_expect(struct bus *b, const struct bus_frame *f)
{
	bus_rx_expect(&of(b)->rx, f);
}

static int64_t socketcan_expected_ns(const struct bus *b)
{
	return ((const struct socketcan *)b)->rx.expected_ns;
}

/* Bounded: 2048 messages are more than the queue of a default socket holds. */
static void socketcan_drain(struct bus *b)
{
	struct socketcan *s = of(b);
	struct bus_frame scrap[32];

	for (int i = 0; i < s->n_ports; i++) {
		int round = 0;

		do {
			s->rx.taken = 0;
			if (s->port[i].fd != NO_FD) {
				read_port(s, i, scrap, 32);
			}
		} while (s->rx.taken > 0 && ++round < 64);
	}
}

static void close_port(struct port *p)
{
	const int fds[] = {p->fd, p->offered, p->retired};

	for (unsigned i = 0; i < sizeof(fds) / sizeof(fds[0]); i++) {
		if (fds[i] != NO_FD) {
			close(fds[i]);
		}
	}
}

static void socketcan_close(struct bus *b)
{
	struct socketcan *s = of(b);

	if (!s) {
		return;
	}
	for (int i = 0; i < s->n_ports; i++) {
		close_port(&s->port[i]);
	}
	if (s->ctl != NO_FD) {
		close(s->ctl);
	}
	free(s);
}

static const struct bus_ops socketcan_ops = {
	.name = "socketcan",
	.recv = socketcan_recv,
	.send = socketcan_send,
	.stats = socketcan_stats,
	.watch = socketcan_watch,
	.events = socketcan_events,
	.confirmed_ns = socketcan_confirmed_ns,
	.expect = socketcan_expect,
	.expected_ns = socketcan_expected_ns,
	.drain = socketcan_drain,
	.close = socketcan_close,
};

/* ---- open ------------------------------------------------------------------------------------------ */

/* Exact filters (both format bits in the mask) use the kernel's constant-time lists. */
static int add_filters(struct socketcan *s, const struct bus_id *id, int n)
{
	for (int i = 0; i < n; i++) {
		struct port *p;

		if (id[i].iface >= s->n_ports) {
			return -EINVAL;
		}
		p = &s->port[id[i].iface];
		if (p->n_filter == FILTER_MAX) {
			return -ENOSPC;
		}
		p->filter[p->n_filter++] = (struct can_filter){
			.can_id = id[i].id,
			.can_mask = CAN_EFF_FLAG | CAN_RTR_FLAG |
				    (id[i].id & BUS_ID_EFF ? CAN_EFF_MASK : CAN_SFF_MASK),
		};
	}
	return 0;
}

static int prepare(struct socketcan *s, const struct bus_socketcan_params *p)
{
	int ret;

	for (int i = 0; i < p->n_ifaces; i++) {
		struct port *port = &s->port[s->n_ports++];

		port->fd = port->offered = port->retired = NO_FD;
		snprintf(port->name, sizeof(port->name), "%s", p->ifaces[i]);
	}
	ret = add_filters(s, p->input, p->n_input);
	return ret ? ret : add_filters(s, p->own, p->n_own);
}

int bus_socketcan_open(const struct bus_socketcan_params *p, struct bus **ret, char *err,
		       int err_len)
{
	struct socketcan *s;
	int status;

	if (p->n_ifaces < 1 || p->n_ifaces > BUS_IFACES_MAX) {
		snprintf(err, (size_t)err_len, "%d interfaces: 1 to %d are possible", p->n_ifaces,
			 BUS_IFACES_MAX);
		return -EINVAL;
	}
	s = calloc(1, sizeof(*s));
	if (!s) {
		snprintf(err, (size_t)err_len, "out of memory");
		return -ENOMEM;
	}
	s->bus.ops = &socketcan_ops;
	s->ctl = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
	if (s->ctl < 0) {
		status = -errno;
		snprintf(err, (size_t)err_len,
			 "no CAN in this kernel (%s): modprobe can_raw, and vcan for a virtual bus",
			 strerror(-status));
		free(s);
		return status;
	}
	status = prepare(s, p);
	if (!status) {
		status = bus_rx_init(&s->rx, p->own, p->n_own, p->allow_local);
	}
	if (status) {
		snprintf(err, (size_t)err_len,
			 "too many identifiers for one interface (at most %d)", FILTER_MAX);
		socketcan_close(&s->bus);
		return status;
	}
	bus_socketcan_service(&s->bus);
	*ret = &s->bus;
	return 0;
}
