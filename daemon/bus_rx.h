/* SPDX-License-Identifier: MIT
 * What a message received from a CAN socket means: whose frame it is, how old it is, what the controller reports.
 * Works on any descriptor that carries struct can_frame / canfd_frame with control messages, so that a socketpair
 * stands in for a bus in tests. For bus_socketcan.c.
 */
#ifndef AEBMC_BUS_RX_H
#define AEBMC_BUS_RX_H

#include <sys/types.h>

#include "bus.h"

#define BUS_RX_OWN_MAX 16

struct bus_rx {
	struct bus_id own[BUS_RX_OWN_MAX];
	int n_own;
	int allow_local;
	uint32_t once;    /* events reported once */
	uint32_t off;     /* bit per interface: bus-off until it restarts or carries a frame */
	uint32_t passive; /* bit per interface: error-passive until its controller says otherwise */
	int taken;        /* messages that the last read took from the queue, delivered or not */
	int64_t confirmed_ns;      /* when an own frame was last seen back */
	struct bus_frame expected; /* its echo is looked out for */
	int64_t expected_ns;       /* when it was seen; 0: not yet */
	uint32_t dropped
		[BUS_IFACES_MAX]; /* the kernel's drop counter at the last message of each interface */
	struct bus_stats stats;
};

/** bus_rx_init - @own: identifiers we send. 0, or -ENOSPC for more than BUS_RX_OWN_MAX. */
int bus_rx_init(struct bus_rx *rx, const struct bus_id *own, int n_own, int allow_local);

/**
 * bus_rx_read - read at most @max messages and keep the input frames among them
 * Own echo confirms and is not delivered; a foreign frame with one of our identifiers, an error frame and a local frame
 * (unless allowed) are counted and not delivered. A frame's time is now minus the age its kernel stamp tells, on
 * CLOCK_MONOTONIC; an age outside 0..1 s is not believed (the clock stepped, or the frame waited too long): time of
 * receipt, counted, BUS_EV_STAMP.
 * Returns the number of frames delivered, or -errno when the first read failed (-EAGAIN is 0). Does not block if @fd
 * does not. No allocation.
 */
int bus_rx_read(struct bus_rx *rx, int fd, uint8_t iface, struct bus_frame *f, int max);

/** bus_rx_expect - look out for the echo of @f from now on: seen at rx->expected_ns. */
void bus_rx_expect(struct bus_rx *rx, const struct bus_frame *f);

/** bus_rx_write - one frame. 0 or -errno; -EIO if the kernel took less than a frame. */
int bus_rx_write(int fd, const struct bus_frame *f);

/** bus_rx_passive - what the controller of @iface says of itself when asked: 1 error-passive, 0 not. */
void bus_rx_passive(struct bus_rx *rx, uint8_t iface, int passive);

/** bus_rx_events - BUS_EV_* since the last call and lasting ones. */
uint32_t bus_rx_events(struct bus_rx *rx);

#endif
