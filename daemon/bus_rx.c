/* SPDX-License-Identifier: MIT
 * Received CAN messages to frames, events and counters. See bus_rx.h.
 */
#include "bus_rx.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "clock.h"

#define AGE_MAX_NS CLOCK_NS_PER_S
#define BATCH      32

/* Both clocks at one moment, so that a realtime stamp becomes a monotonic time. */
struct now {
	int64_t mono_ns, real_ns;
};

struct slot {
	struct canfd_frame frame;
	struct iovec iov;
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t)) + 64];
	} control;
};

int bus_rx_init(struct bus_rx *rx, const struct bus_id *own, int n_own, int allow_local)
{
	if (n_own > BUS_RX_OWN_MAX) {
		return -ENOSPC;
	}
	memset(rx, 0, sizeof(*rx));
	memcpy(rx->own, own, (size_t)n_own * sizeof(own[0]));
	rx->n_own = n_own;
	rx->allow_local = allow_local;
	return 0;
}

static struct now both_clocks(void)
{
	struct timespec ts;

	clock_gettime(CLOCK_REALTIME, &ts);
	return (struct now){.mono_ns = clock_now_ns(),
			    .real_ns = ts.tv_sec * CLOCK_NS_PER_S + ts.tv_nsec};
}

/* DESIGN: age = realtime now minus the kernel's stamp, believed between 0 and 1 s. */
static int64_t time_of(struct bus_rx *rx, const struct now *now, int64_t stamp_ns)
{
	const int64_t age = now->real_ns - stamp_ns;

	if (stamp_ns && age >= 0 && age <= AGE_MAX_NS) {
		return now->mono_ns - age;
	}
	rx->stats.stamps++;
	rx->once |= BUS_EV_STAMP;
	return now->mono_ns;
}

static int64_t read_control(struct bus_rx *rx, struct msghdr *h, uint8_t iface)
{
	int64_t stamp = 0;

	for (struct cmsghdr *c = CMSG_FIRSTHDR(h); c; c = CMSG_NXTHDR(h, c)) {
		if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_TIMESTAMPNS) {
			struct timespec ts;

			memcpy(&ts, CMSG_DATA(c), sizeof(ts));
			stamp = ts.tv_sec * CLOCK_NS_PER_S + ts.tv_nsec;
		} else if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL) {
			uint32_t total;

			memcpy(&total, CMSG_DATA(c), sizeof(total));
			if (total != rx->dropped[iface]) {
				rx->stats.dropped += total - rx->dropped[iface];
				rx->dropped[iface] = total;
				rx->once |= BUS_EV_OVERFLOW;
			}
		}
	}
	return stamp;
}

void bus_rx_passive(struct bus_rx *rx, uint8_t iface, int passive)
{
	const uint32_t bit = 1u << iface;

	rx->passive = passive ? rx->passive | bit : rx->passive & ~bit;
}

/* Back from error-passive the next state is warning, not active. Other bits say nothing about the state. */
static void controller_state(struct bus_rx *rx, uint8_t iface, int bits)
{
	const int passive = bits & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE);
	const int better =
		bits & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING | CAN_ERR_CRTL_ACTIVE);

	if (passive || better) {
		bus_rx_passive(rx, iface, passive);
	}
	if (passive) {
		rx->once |= BUS_EV_PASSIVE; /* known even if a frame of the same batch ends it */
	}
}

static void error_frame(struct bus_rx *rx, uint8_t iface, const struct canfd_frame *c)
{
	rx->stats.error_frames++;
	if (c->can_id & CAN_ERR_BUSOFF) {
		rx->off |= 1u << iface;
		rx->once |= BUS_EV_OFF; /* known even if a frame of the same batch ends it */
	}
	if (c->can_id & CAN_ERR_RESTARTED) {
		rx->off &= ~(1u << iface);
		bus_rx_passive(rx, iface, 0);
	}
	if (c->can_id & CAN_ERR_CRTL) {
		controller_state(rx, iface, c->data[1]);
	}
}

static int is_own_id(const struct bus_rx *rx, uint8_t iface, uint32_t id)
{
	for (int i = 0; i < rx->n_own; i++) {
		if (rx->own[i].iface == iface && rx->own[i].id == id) {
			return 1;
		}
	}
	return 0;
}

/* Counter and checksum make a frame's content its own for sixteen of them. */
static int is_expected(const struct bus_rx *rx, const struct canfd_frame *c, uint8_t iface)
{
	const struct bus_frame *f = &rx->expected;

	return !rx->expected_ns && f->len && f->iface == iface && f->len == c->len &&
	       f->id == (c->can_id & (CAN_EFF_FLAG | CAN_EFF_MASK)) &&
	       !memcmp(f->data, c->data, f->len);
}

/* 1 if the message is input to deliver. */
static int is_input(struct bus_rx *rx, const struct canfd_frame *c, int msg_flags, uint8_t iface,
		    int64_t t_ns)
{
	if (msg_flags & MSG_CONFIRM) {
		rx->stats.confirmed++;
		rx->confirmed_ns = t_ns;
		if (is_expected(rx, c, iface)) {
			rx->expected_ns = t_ns;
		}
		return 0;
	}
	if (is_own_id(rx, iface, c->can_id & (CAN_EFF_FLAG | CAN_EFF_MASK))) {
		rx->stats.foreign++;
		rx->once |= BUS_EV_FOREIGN;
		return 0;
	}
	if (msg_flags & MSG_DONTROUTE && !rx->allow_local) {
		rx->stats.local++;
		return 0;
	}
	return 1;
}

static void to_frame(const struct canfd_frame *c, int bytes, int local, struct bus_frame *f)
{
	const int fd = bytes == CANFD_MTU;

	f->id = c->can_id & (CAN_EFF_FLAG | CAN_EFF_MASK);
	f->flags = (uint8_t)((fd ? BUS_FD : 0) | (fd && c->flags & CANFD_BRS ? BUS_BRS : 0) |
			     (fd && c->flags & CANFD_ESI ? BUS_ESI : 0) |
			     (c->can_id & CAN_RTR_FLAG ? BUS_RTR : 0) | (local ? BUS_LOCAL : 0));
	f->len = c->len;
	memcpy(f->data, c->data, c->len);
}

/* One received message; 1 if it became a frame. */
static int message(struct bus_rx *rx, struct slot *s, struct mmsghdr *m, uint8_t iface,
		   const struct now *now, struct bus_frame *f)
{
	const struct canfd_frame *c = &s->frame;
	const int bytes = (int)m->msg_len;
	const int64_t stamp = read_control(rx, &m->msg_hdr, iface);
	int64_t t_ns;

	if ((bytes != CAN_MTU && bytes != CANFD_MTU) ||
	    c->len > (bytes == CANFD_MTU ? CANFD_MAX_DLEN : CAN_MAX_DLEN)) {
		rx->stats.malformed++;
		return 0;
	}
	if (c->can_id & CAN_ERR_FLAG) {
		error_frame(rx, iface, c);
		return 0;
	}
	rx->off &= ~(1u << iface); /* a controller that is off carries nothing */
	t_ns = time_of(rx, now, stamp);
	if (!is_input(rx, c, m->msg_hdr.msg_flags, iface, t_ns)) {
		return 0;
	}
	rx->stats.received++;
	rx->stats.remote_frames += (c->can_id & CAN_RTR_FLAG) != 0;
	f->iface = iface;
	f->t_ns = t_ns;
	to_frame(c, bytes, m->msg_hdr.msg_flags & MSG_DONTROUTE, f);
	return 1;
}

int bus_rx_read(struct bus_rx *rx, int fd, uint8_t iface, struct bus_frame *f, int max)
{
	struct slot slot[BATCH];
	struct mmsghdr msg[BATCH];
	const int want = max < BATCH ? max : BATCH;
	struct now now;
	int n, kept = 0;

	for (int i = 0; i < want; i++) {
		slot[i].iov = (struct iovec){.iov_base = &slot[i].frame,
					     .iov_len = sizeof(slot[i].frame)};
		msg[i].msg_hdr = (struct msghdr){.msg_iov = &slot[i].iov,
						 .msg_iovlen = 1,
						 .msg_control = &slot[i].control,
						 .msg_controllen = sizeof(slot[i].control)};
	}
	rx->taken = 0;
	n = recvmmsg(fd, msg, (unsigned)want, MSG_DONTWAIT, NULL);
	if (n < 0) {
		return errno == EAGAIN || errno == EINTR ? 0 : -errno;
	}
	rx->taken = n;
	now = both_clocks();
	for (int i = 0; i < n; i++) {
		kept += message(rx, &slot[i], &msg[i], iface, &now, f + kept);
	}
	return kept;
}

void bus_rx_expect(struct bus_rx *rx, const struct bus_frame *f)
{
	rx->expected = *f;
	rx->expected_ns = 0;
}

int bus_rx_write(int fd, const struct bus_frame *f)
{
	struct canfd_frame c = {.can_id = f->id | (f->flags & BUS_RTR ? CAN_RTR_FLAG : 0),
				.len = f->len};
	const size_t size = f->flags & BUS_FD ? CANFD_MTU : CAN_MTU;
	ssize_t n;

	c.flags = (uint8_t)(f->flags & BUS_FD && f->flags & BUS_BRS ? CANFD_BRS : 0);
	memcpy(c.data, f->data, f->len);
	n = send(fd, &c, size, MSG_DONTWAIT);
	if (n < 0) {
		return -errno;
	}
	return (size_t)n == size ? 0 : -EIO;
}

uint32_t bus_rx_events(struct bus_rx *rx)
{
	const uint32_t ev =
		rx->once | (rx->off ? BUS_EV_OFF : 0) | (rx->passive ? BUS_EV_PASSIVE : 0);

	rx->once = 0;
	return ev;
}
