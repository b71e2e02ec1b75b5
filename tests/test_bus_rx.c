/* SPDX-License-Identifier: MIT
 * Received CAN messages: over a real socketpair with kernel stamps, and with injected flags and control messages that
 * only a CAN socket delivers.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clock.h"

#define SHORT_FD  -7 /* takes all but the last byte */
#define FULL_FD   -8 /* takes none */
#define BATCH_MAX 32

/* One injected message: what recvmmsg would have returned. */
static struct {
	int armed, error, flags;
	size_t bytes;
	struct canfd_frame frame;
	int64_t stamp_ns; /* 0: no control message */
	uint32_t drops;   /* 0: no control message */
	int level;        /* of the control messages, SOL_SOCKET unless said otherwise */
	int other_type;   /* 0: none of a type we do not know */
} inject;

static void put_control(struct msghdr *h, int type, const void *data, size_t len)
{
	struct cmsghdr *c = (struct cmsghdr *)((char *)h->msg_control + h->msg_controllen);

	c->cmsg_level = inject.level;
	c->cmsg_type = type;
	c->cmsg_len = CMSG_LEN(len);
	memcpy(CMSG_DATA(c), data, len);
	h->msg_controllen += CMSG_SPACE(len);
}

static int injected_recvmmsg(int fd, struct mmsghdr *m, unsigned n, int flags, struct timespec *t)
{
	const struct timespec ts = {inject.stamp_ns / CLOCK_NS_PER_S,
				    inject.stamp_ns % CLOCK_NS_PER_S};

	if (!inject.armed) {
		return recvmmsg(fd, m, n, flags, t);
	}
	assert_true(n <= BATCH_MAX);
	if (n == 0) {
		return 0;
	}
	assert_int_equal(m->msg_hdr.msg_iovlen, 1);
	if (inject.error) {
		errno = inject.error;
		return -1;
	}
	memcpy(m->msg_hdr.msg_iov->iov_base, &inject.frame, sizeof(inject.frame));
	m->msg_len = (unsigned)inject.bytes;
	m->msg_hdr.msg_flags = inject.flags;
	m->msg_hdr.msg_controllen = 0;
	if (inject.stamp_ns) {
		put_control(&m->msg_hdr, SCM_TIMESTAMPNS, &ts, sizeof(ts));
	}
	if (inject.drops) {
		put_control(&m->msg_hdr, SO_RXQ_OVFL, &inject.drops, sizeof(inject.drops));
	}
	if (inject.other_type) {
		put_control(&m->msg_hdr, inject.other_type, &ts, sizeof(ts));
	}
	return 1;
}

static ssize_t injected_send(int fd, const void *data, size_t size, int flags)
{
	switch (fd) {
	case SHORT_FD:
		return (ssize_t)size - 1;
	case FULL_FD:
		return 0;
	default:
		return send(fd, data, size, flags);
	}
}
#define recvmmsg injected_recvmmsg
#define send     injected_send
#include "../daemon/bus_rx.c"
#undef recvmmsg
#undef send

static const struct bus_id own[] = {{0, 0x2A0}, {1, 0x2A1 | BUS_ID_EFF}};

static int64_t real_ns(void)
{
	struct timespec ts;

	clock_gettime(CLOCK_REALTIME, &ts);
	return ts.tv_sec * CLOCK_NS_PER_S + ts.tv_nsec;
}

static void reset(struct bus_rx *rx, int allow_local)
{
	assert_int_equal(bus_rx_init(rx, own, 2, allow_local), 0);
	memset(&inject, 0, sizeof(inject));
	inject.armed = 1;
	inject.bytes = CAN_MTU;
	inject.level = SOL_SOCKET;
	inject.frame =
		(struct canfd_frame){.can_id = 0x123, .len = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
	inject.stamp_ns = real_ns();
}

static int read_one(struct bus_rx *rx, struct bus_frame *f)
{
	return bus_rx_read(rx, -1, 0, f, 4);
}

static void test_socketpair_carries_frames_and_stamps(void **state)
{
	struct bus_rx rx;
	struct bus_frame f[4], out = {.id = 0x321, .len = 3, .data = {9, 8, 7}};
	int fd[2];
	const int on = 1;

	(void)state;
	reset(&rx, 1);
	inject.armed = 0;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, fd), 0);
	if (setsockopt(fd[1], SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on))) {
		assert_int_equal(errno, ENOPROTOOPT);
		print_message("# needs native: user-mode emulation has no receive stamps\n");
		close(fd[0]);
		close(fd[1]);
		skip();
	}
	assert_int_equal(bus_rx_read(&rx, fd[1], 2, f, 4), 0); /* nothing there: no error */
	const int64_t before = clock_now_ns();
	assert_int_equal(bus_rx_write(fd[0], &out), 0);
	out = (struct bus_frame){
		.id = 0x18DAF110 | BUS_ID_EFF, .len = 64, .flags = BUS_FD | BUS_BRS};
	memset(out.data, 0xA5, 64);
	assert_int_equal(bus_rx_write(fd[0], &out), 0);
	assert_int_equal(bus_rx_read(&rx, fd[1], 2, f, 4), 2);
	assert_int_equal(f[0].id, 0x321);
	assert_int_equal(f[0].len, 3);
	assert_int_equal(f[0].iface, 2);
	assert_memory_equal(f[0].data, ((uint8_t[]){9, 8, 7}), 3);
	assert_in_range(f[0].t_ns, before, clock_now_ns());
	assert_int_equal(f[1].id, 0x18DAF110 | BUS_ID_EFF);
	assert_int_equal(f[1].flags & (BUS_FD | BUS_BRS | BUS_RTR), BUS_FD | BUS_BRS);
	assert_memory_equal(f[1].data, out.data, 64);
	assert_int_equal(rx.stats.received, 2);
	assert_int_equal(bus_rx_events(&rx), 0);
	close(fd[0]);
	assert_int_equal(bus_rx_write(fd[1], &out), -EPIPE);
	close(fd[1]);
	assert_int_equal(bus_rx_write(fd[1], &out), -EBADF);
}

static void test_age_is_realtime_minus_stamp(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.stamp_ns = real_ns() - 400 * CLOCK_NS_PER_MS;
	assert_int_equal(read_one(&rx, &f), 1);
	const int64_t age = clock_now_ns() - f.t_ns;
	assert_in_range(age, 400 * CLOCK_NS_PER_MS, 900 * CLOCK_NS_PER_MS);
	assert_int_equal(rx.stats.stamps, 0);
}

static void test_incredible_stamps_fall_back_to_receipt(void **state)
{
	const int64_t offset_ns[] = {-1500 * CLOCK_NS_PER_MS, 10 * CLOCK_NS_PER_S};
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	for (int i = 0; i < 2; i++) {
		reset(&rx, 0);
		inject.stamp_ns += offset_ns[i];
		const int64_t before = clock_now_ns();
		assert_int_equal(read_one(&rx, &f), 1);
		assert_in_range(f.t_ns, before, clock_now_ns());
		assert_int_equal(rx.stats.stamps, 1);
		assert_int_equal(bus_rx_events(&rx), BUS_EV_STAMP);
		assert_int_equal(bus_rx_events(&rx), 0);
	}
	reset(&rx, 0);
	inject.stamp_ns = 0;
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(rx.stats.stamps, 1);
}

static void test_an_age_is_believed_from_0_to_1_s(void **state)
{
	static const struct {
		int64_t age_ns, t_ns;
	} row[] = {{0, 5 * CLOCK_NS_PER_S},
		   {1, 5 * CLOCK_NS_PER_S - 1},
		   {CLOCK_NS_PER_S, 4 * CLOCK_NS_PER_S},
		   {CLOCK_NS_PER_S + 1, 5 * CLOCK_NS_PER_S},
		   {-1, 5 * CLOCK_NS_PER_S}};
	const struct now now = {.mono_ns = 5 * CLOCK_NS_PER_S, .real_ns = 70 * CLOCK_NS_PER_S};
	struct bus_rx rx;

	(void)state;
	reset(&rx, 0);
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		assert_true(time_of(&rx, &now, now.real_ns - row[i].age_ns) == row[i].t_ns);
	}
	assert_int_equal(rx.stats.stamps, 2);
}

static void test_own_echo_confirms_and_is_not_input(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.frame.can_id = 0x2A0;
	inject.flags = MSG_DONTROUTE | MSG_CONFIRM;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(rx.stats.confirmed, 1);
	assert_true(rx.confirmed_ns > 0);
	assert_int_equal(bus_rx_events(&rx), 0);
}

/* Only the very frame that was sent, and only its first echo. */
static void test_expected_echo(void **state)
{
	struct bus_rx rx;
	struct bus_frame f, sent = {.id = 0x2A0, .len = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
	int64_t seen_ns;

	(void)state;
	reset(&rx, 0);
	inject.frame.can_id = 0x2A0;
	inject.flags = MSG_DONTROUTE | MSG_CONFIRM;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(rx.expected_ns, 0); /* nothing is expected yet */
	bus_rx_expect(&rx, &sent);
	inject.frame.data[1] = 9;
	assert_int_equal(read_one(&rx, &f), 0);
	inject.frame.data[1] = 2;
	inject.frame.can_id = 0x2A1;
	assert_int_equal(read_one(&rx, &f), 0);
	inject.frame.can_id = 0x2A0;
	inject.frame.len = 7;
	assert_int_equal(read_one(&rx, &f), 0);
	inject.frame.len = 8;
	assert_int_equal(bus_rx_read(&rx, -1, 1, &f, 1), 0);
	inject.flags = MSG_DONTROUTE; /* another socket of this host */
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(rx.expected_ns, 0);
	inject.flags |= MSG_CONFIRM;
	assert_int_equal(read_one(&rx, &f), 0);
	seen_ns = rx.expected_ns;
	assert_true(seen_ns > 0);
	inject.stamp_ns = real_ns();
	assert_int_equal(read_one(&rx, &f), 0);
	assert_true(rx.expected_ns == seen_ns);
	bus_rx_expect(&rx, &sent);
	assert_int_equal(rx.expected_ns, 0);
}

static void test_foreign_sender_on_our_id(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 1);
	inject.frame.can_id = 0x2A0;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(rx.stats.foreign, 1);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_FOREIGN);
	inject.frame.can_id = 0x2A1; /* ours is extended, and on another interface */
	assert_int_equal(read_one(&rx, &f), 1);
	inject.frame.can_id = 0; /* what an empty entry would say */
	assert_int_equal(read_one(&rx, &f), 1);
}

static void test_local_frames_only_where_allowed(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.flags = MSG_DONTROUTE;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(rx.stats.local, 1);
	reset(&rx, 1);
	inject.flags = MSG_DONTROUTE;
	assert_int_equal(read_one(&rx, &f), 1);
	assert_true(f.flags & BUS_LOCAL);
}

static void test_error_frames_become_events(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.frame.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_OFF);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_OFF); /* lasts */
	inject.frame.can_id = CAN_ERR_FLAG | CAN_ERR_RESTARTED;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(bus_rx_events(&rx), 0);
	inject.frame.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL;
	inject.frame.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_PASSIVE);
	assert_int_equal(rx.stats.error_frames, 3);
	inject.frame.data[1] = CAN_ERR_CRTL_ACTIVE;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(bus_rx_events(&rx), 0);
	inject.frame.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
	inject.frame.can_id =
		CAN_ERR_FLAG | CAN_ERR_PROT; /* where those bits mean something else */
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(bus_rx_events(&rx), 0);
	inject.frame.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL;
	inject.frame.data[1] = CAN_ERR_CRTL_RX_OVERFLOW; /* not about the controller's state */
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(bus_rx_events(&rx), 0);
}

static void test_bus_off_belongs_to_its_interface(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.frame.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
	assert_int_equal(bus_rx_read(&rx, -1, 1, &f, 1), 0);
	inject.frame.can_id = CAN_ERR_FLAG | CAN_ERR_RESTARTED;
	assert_int_equal(bus_rx_read(&rx, -1, 0, &f, 1), 0);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_OFF);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_OFF); /* another one restarted */
	assert_int_equal(bus_rx_read(&rx, -1, 1, &f, 1), 0);
	assert_int_equal(bus_rx_events(&rx), 0);
	inject.frame.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
	assert_int_equal(bus_rx_read(&rx, -1, 1, &f, 1), 0);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_OFF);
	inject.frame.can_id = 0x123;
	assert_int_equal(bus_rx_read(&rx, -1, 1, &f, 1), 1);
	assert_int_equal(bus_rx_events(&rx), 0); /* it carries frames again */
	inject.frame.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
	assert_int_equal(bus_rx_read(&rx, -1, 1, &f, 1), 0);
	inject.frame.can_id = 0x123;
	assert_int_equal(bus_rx_read(&rx, -1, 1, &f, 1), 1);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_OFF); /* known although it is over */
	assert_int_equal(bus_rx_events(&rx), 0);
}

static void receive_error(struct bus_rx *rx, uint8_t iface, uint32_t id, int controller)
{
	struct bus_frame f;

	inject.frame.can_id = CAN_ERR_FLAG | id;
	inject.frame.data[1] = (uint8_t)controller;
	assert_int_equal(bus_rx_read(rx, -1, iface, &f, 1), 0);
}

static void test_error_passive_lasts_until_its_controller_says_otherwise(void **state)
{
	static const int passive[] = {CAN_ERR_CRTL_RX_PASSIVE, CAN_ERR_CRTL_TX_PASSIVE};
	static const struct {
		uint32_t id;
		int controller;
		uint32_t events;
	} row[] = {
		{CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE, 0},
		{CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING, 0},
		{CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING, 0},
		{CAN_ERR_RESTARTED, 0, 0},
		{CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_PASSIVE, BUS_EV_PASSIVE},
		{CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW, BUS_EV_PASSIVE},
		{CAN_ERR_CRTL, CAN_ERR_CRTL_TX_OVERFLOW, BUS_EV_PASSIVE},
		{CAN_ERR_PROT, CAN_ERR_CRTL_ACTIVE, BUS_EV_PASSIVE}, /* other bits there */
	};
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	for (size_t i = 0; i < 2 * sizeof(row) / sizeof(row[0]); i++) {
		reset(&rx, 0);
		receive_error(&rx, 1, CAN_ERR_CRTL, passive[i % 2]);
		assert_int_equal(bus_rx_events(&rx), BUS_EV_PASSIVE);
		inject.frame.can_id = 0x123; /* it may carry frames all the same */
		assert_int_equal(bus_rx_read(&rx, -1, 1, &f, 1), 1);
		receive_error(&rx, 0, CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE); /* another one */
		assert_int_equal(bus_rx_events(&rx), BUS_EV_PASSIVE);
		receive_error(&rx, 1, row[i / 2].id, row[i / 2].controller);
		assert_int_equal(bus_rx_events(&rx), row[i / 2].events);
	}
	reset(&rx, 0);
	receive_error(&rx, 1, CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
	receive_error(&rx, 1, CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_PASSIVE); /* known although it is over */
	assert_int_equal(bus_rx_events(&rx), 0);
}

/* Where its driver sends no error frame. */
static void test_controller_that_was_asked_says_error_passive(void **state)
{
	struct bus_rx rx;

	(void)state;
	reset(&rx, 0);
	bus_rx_passive(&rx, 1, 0);
	assert_int_equal(bus_rx_events(&rx), 0);
	bus_rx_passive(&rx, 1, 1);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_PASSIVE);
	bus_rx_passive(&rx, 0, 1);
	bus_rx_passive(&rx, 1, 0);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_PASSIVE);
	bus_rx_passive(&rx, 0, 0);
	assert_int_equal(bus_rx_events(&rx), 0);
}

static void test_taken_counts_what_was_not_delivered_too(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.flags = MSG_DONTROUTE;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(rx.taken, 1);
	inject.error = EAGAIN;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(rx.taken, 0);
}

static void test_kernel_drops_are_counted_per_interface(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.drops = 7;
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(rx.stats.dropped, 7);
	assert_int_equal(bus_rx_events(&rx), BUS_EV_OVERFLOW);
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(rx.stats.dropped, 7);
	assert_int_equal(bus_rx_events(&rx), 0);
	assert_int_equal(bus_rx_read(&rx, -1, 3, &f, 1),
			 1); /* another interface counts for itself */
	assert_int_equal(rx.stats.dropped, 14);
	inject.drops = 9;
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(rx.stats.dropped, 16);
}

static void test_malformed_messages(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.bytes = 5;
	assert_int_equal(read_one(&rx, &f), 0);
	inject.bytes = CAN_MTU;
	inject.frame.len = 9;
	assert_int_equal(read_one(&rx, &f), 0);
	inject.bytes = CANFD_MTU;
	inject.frame.len = 65;
	assert_int_equal(read_one(&rx, &f), 0);
	assert_int_equal(rx.stats.malformed, 3);
	assert_int_equal(rx.stats.received, 0);
}

static void test_remote_frames_keep_their_flag(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(rx.stats.remote_frames, 0);
	inject.frame.can_id |= CAN_RTR_FLAG;
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(f.id, 0x123);
	assert_true(f.flags & BUS_RTR);
	assert_int_equal(rx.stats.remote_frames, 1);
}

static void test_fd_frames_keep_their_flags(void **state)
{
	static const struct {
		uint8_t can, bus;
	} row[] = {{0, BUS_FD},
		   {CANFD_BRS, BUS_FD | BUS_BRS},
		   {CANFD_ESI, BUS_FD | BUS_ESI},
		   {CANFD_BRS | CANFD_ESI, BUS_FD | BUS_BRS | BUS_ESI}};
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		reset(&rx, 0);
		inject.bytes = CANFD_MTU;
		inject.frame.flags = row[i].can;
		assert_int_equal(read_one(&rx, &f), 1);
		assert_int_equal(f.flags, row[i].bus);
	}
	reset(&rx, 0);
	inject.frame.flags = CANFD_BRS; /* a classic frame has none */
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(f.flags, 0);
}

/* Only the two kinds of SOL_SOCKET are ours; a stamp under another level is none. */
static void test_other_control_messages_are_ignored(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.other_type = SCM_CREDENTIALS;
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(rx.stats.stamps, 0);
	inject.level = SOL_CAN_BASE;
	inject.drops = 3;
	assert_int_equal(read_one(&rx, &f), 1);
	assert_int_equal(rx.stats.stamps, 1);
	assert_int_equal(rx.stats.dropped, 0);
}

static void test_writes_carry_flags_or_fail(void **state)
{
	static const uint8_t flags[] = {BUS_RTR, BUS_BRS, BUS_FD, BUS_FD | BUS_BRS};
	struct bus_frame f = {.id = 0x123, .len = 2};
	struct canfd_frame c;
	int fd[2];

	(void)state;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, fd), 0);
	for (size_t i = 0; i < sizeof(flags); i++) {
		f.flags = flags[i];
		assert_int_equal(bus_rx_write(fd[0], &f), 0);
		assert_int_equal(recv(fd[1], &c, sizeof(c), 0),
				 flags[i] & BUS_FD ? CANFD_MTU : CAN_MTU);
		assert_int_equal(c.can_id, 0x123 | (flags[i] & BUS_RTR ? CAN_RTR_FLAG : 0));
		assert_int_equal(c.flags, flags[i] == (BUS_FD | BUS_BRS) ? CANFD_BRS : 0);
	}
	close(fd[0]);
	close(fd[1]);
	assert_int_equal(bus_rx_write(SHORT_FD, &f), -EIO);
	errno = 0;
	assert_int_equal(bus_rx_write(FULL_FD, &f), -EIO);
}

static void test_read_errors_pass_through(void **state)
{
	struct bus_rx rx;
	struct bus_frame f;

	(void)state;
	reset(&rx, 0);
	inject.error = ENETDOWN;
	assert_int_equal(read_one(&rx, &f), -ENETDOWN);
	inject.error = EINTR;
	assert_int_equal(read_one(&rx, &f), 0);
}

static void test_at_most_a_batch_is_asked_for(void **state)
{
	struct bus_frame f[2 * BATCH_MAX];
	struct bus_rx rx;

	(void)state;
	reset(&rx, 0);
	assert_int_equal(bus_rx_read(&rx, -1, 0, f, 2 * BATCH_MAX), 1);
	errno = EIO; /* nothing asked for is no error, whatever was wrong before */
	assert_int_equal(bus_rx_read(&rx, -1, 0, f, 0), 0);
	assert_int_equal(rx.taken, 0);
}

static void test_too_many_own_ids(void **state)
{
	struct bus_id many[BUS_RX_OWN_MAX + 1] = {{0, 0}};
	struct bus_rx rx;

	(void)state;
	assert_int_equal(bus_rx_init(&rx, many, BUS_RX_OWN_MAX, 0), 0);
	assert_int_equal(bus_rx_init(&rx, many, BUS_RX_OWN_MAX + 1, 0), -ENOSPC);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_socketpair_carries_frames_and_stamps),
		cmocka_unit_test(test_age_is_realtime_minus_stamp),
		cmocka_unit_test(test_incredible_stamps_fall_back_to_receipt),
		cmocka_unit_test(test_an_age_is_believed_from_0_to_1_s),
		cmocka_unit_test(test_own_echo_confirms_and_is_not_input),
		cmocka_unit_test(test_expected_echo),
		cmocka_unit_test(test_foreign_sender_on_our_id),
		cmocka_unit_test(test_local_frames_only_where_allowed),
		cmocka_unit_test(test_error_frames_become_events),
		cmocka_unit_test(test_bus_off_belongs_to_its_interface),
		cmocka_unit_test(test_error_passive_lasts_until_its_controller_says_otherwise),
		cmocka_unit_test(test_controller_that_was_asked_says_error_passive),
		cmocka_unit_test(test_taken_counts_what_was_not_delivered_too),
		cmocka_unit_test(test_kernel_drops_are_counted_per_interface),
		cmocka_unit_test(test_malformed_messages),
		cmocka_unit_test(test_remote_frames_keep_their_flag),
		cmocka_unit_test(test_fd_frames_keep_their_flags),
		cmocka_unit_test(test_other_control_messages_are_ignored),
		cmocka_unit_test(test_writes_carry_flags_or_fail),
		cmocka_unit_test(test_read_errors_pass_through),
		cmocka_unit_test(test_at_most_a_batch_is_asked_for),
		cmocka_unit_test(test_too_many_own_ids),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
