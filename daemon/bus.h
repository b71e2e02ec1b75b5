/* SPDX-License-Identifier: MIT
 * The bus as the pipeline sees it: frames with a time, in and out, behind one table of operations.
 * bus_log.c replays and writes candump logs; bus_socketcan.c talks to the kernel.
 */
#ifndef AEBMC_BUS_H
#define AEBMC_BUS_H

#include <stdint.h>

#define BUS_IFACES_MAX 8
#define BUS_NAME_MAX   16 /* IFNAMSIZ */
#define BUS_DATA_MAX   64
#define BUS_ID_EFF     0x80000000u /* extended id; same bits as SocketCAN */
#define BUS_ID_MASK    0x1FFFFFFFu

#define BUS_FD    1u /* CAN FD frame */
#define BUS_BRS   2u
#define BUS_ESI   4u
#define BUS_RTR   8u  /* remote frame, no data */
#define BUS_ERR   16u /* error frame (log: id bit 0x20000000) */
#define BUS_LOCAL 32u /* sent by this host (MSG_DONTROUTE; candump suffix T) */

struct bus_frame {
	int64_t t_ns;  /* time of reception on the pipeline's clock */
	uint32_t id;   /* 11 or 29 bits, BUS_ID_EFF set for the latter */
	uint8_t iface; /* index into the interface names given at open */
	uint8_t len;   /* data bytes, 0..64 */
	uint8_t flags; /* BUS_* */
	uint8_t data[BUS_DATA_MAX];
};

/* What a bus has seen and refused; never reset. */
struct bus_stats {
	uint64_t received, sent;
	uint64_t malformed;                   /* log lines that are no frame and no comment */
	uint64_t other_iface;                 /* frames on interfaces nobody listed */
	uint64_t error_frames, remote_frames; /* delivered as well, with their flag */
	uint64_t disorder; /* timestamps that ran backwards or leapt (log): clamped */
	/* live only */
	uint64_t dropped; /* lost in the kernel's receive queue (SO_RXQ_OVFL) */
	uint64_t local;   /* sent by this host and refused as input */
	uint64_t foreign; /* one of our identifiers, sent by somebody else */
	uint64_t stamps;  /* receive stamps whose age is not within 0..1 s: time of receipt used */
	uint64_t confirmed;  /* own frames seen back on the bus */
	uint64_t tx_refused; /* frames the kernel did not take */
};

struct bus;
struct bus_ops {
	const char *name; /* "log", "socketcan" */

	/* Waits until a frame arrives or @until_ns passes. Fills at most @max frames, sets *@now_ns (never past @until_ns
	 * on a log). Returns the number of frames, 0 at the deadline, -ENODATA at the end of a log, -errno. Bounded work;
	 * no allocation. */
	int (*recv)(struct bus *b, struct bus_frame *f, int max, int64_t until_ns, int64_t *now_ns);

	/* Sends one frame. 0 or -errno (-ENOBUFS: counted by the caller, never retried here). Never blocks. */
	int (*send)(struct bus *b, const struct bus_frame *f);

	const struct bus_stats *(*stats)(const struct bus *b);

	/* Live only, NULL on a log. */
	int (*watch)(
		struct bus *b,
		int fd); /* a descriptor whose readability ends recv early (a finished batch) */
	uint32_t (*events)(
		struct bus *
			b); /* BUS_EV_* since the last call, and the lasting ones while they last */
	int64_t (*confirmed_ns)(
		const struct bus *b); /* when an own frame was last seen back on the bus; 0 never */
	/* Look out for the echo of @f, which was just sent, instead of that of an earlier one; when it was seen, 0 not
	 * yet. */
	void (*expect)(struct bus *b, const struct bus_frame *f);
	int64_t (*expected_ns)(const struct bus *b);
	void (*drain)(struct bus *b); /* throw away everything queued (after a stall) */

	void (*close)(struct bus *b); /* NULL is fine */
};

struct bus {
	const struct bus_ops *ops;
};

/* Events of a live bus. */
#define BUS_EV_DOWN    1u /* an interface is down or missing (lasting) */
#define BUS_EV_OFF     2u /* a controller is bus-off (lasting, until restarted) */
#define BUS_EV_PASSIVE 4u /* a controller is error-passive (lasting) */
#define BUS_EV_FOREIGN 8u /* somebody else sent one of our identifiers */
#define BUS_EV_STAMP \
	16u /* a receive stamp was not credible: the clock stepped or the queue is old */
#define BUS_EV_OVERFLOW 32u /* frames were lost in the kernel */

struct bus_id {
	uint8_t iface;
	uint32_t id; /* 11 or 29 bits, BUS_ID_EFF set for the latter */
};

struct bus_socketcan_params {
	const char *const *ifaces;
	int n_ifaces;
	const struct bus_id *input; /* identifiers to receive: exact kernel filters */
	int n_input;
	const struct bus_id
		*own; /* identifiers we send: their echo confirms, anybody else's is foreign */
	int n_own;
	int allow_local; /* accept input sent by this host (replay by canplayer onto vcan) */
};

/**
 * bus_socketcan_open - one raw socket per interface
 * A missing or down interface is no error: it is BUS_EV_DOWN until bus_socketcan_service() finds it.
 * recv() and send() belong to one thread; bounded work, no allocation, no blocking but the wait. Returns 0 or -errno
 * (-EAFNOSUPPORT: the kernel has no CAN; @err says how to load it). Allocates.
 */
int bus_socketcan_open(const struct bus_socketcan_params *p, struct bus **ret, char *err,
		       int err_len);

/**
 * bus_socketcan_service - housekeeping thread, every 200 ms: look for interfaces that appeared, were re-created, or came
 * up, and open a new socket for the other thread to pick up. May block. Safe beside recv() and send().
 */
void bus_socketcan_service(struct bus *b);

/** bus_socketcan_passive - what the controller of interface @i says when asked: 1 error-passive, 0 not. Not every driver
 * sends an error frame when it leaves that state (mttcan does not), and none when it was there before us. Any thread. */
void bus_socketcan_passive(struct bus *b, int i, int passive);

/** bus_socketcan_iface - 1 if interface @i is up and its socket usable. Any thread. */
int bus_socketcan_iface(const struct bus *b, int i);

/**
 * bus_log_open - replay a candump log
 * @in:     path, or "-" for standard input
 * @out:    path of the log to write (6 decimals), "-" for standard output, NULL to discard
 * @ifaces: interface names; a frame's index is its position
 * @err:    one line saying what failed and how to mend it
 * Reads R/T suffixes, FD ##, remote #R, error frames, several blanks, 6 or 9 decimals; other lines count as malformed,
 * blank and # lines as comments. Allocates one line buffer; a longer line is counted malformed and skipped.
 * Virtual time: the first recv() gives the first frame whatever its deadline, and its stamp starts the clock. Each
 * later one gives the frames of one stamp. Stamps up to 1 s back are clamped to the last one; further back, or more than
 * 60 s ahead, the recorder's clock was set: time goes on from the last stamp. Both count as disorder.
 * send() blocks while a pipe is full, and fails with -EPIPE once its reader is gone (where SIGPIPE is ignored).
 * After a send() that failed, recv() returns that error. recv() returns -EINTR if a signal's handler ran while it waited
 * for input; call it again to go on.
 * Returns 0 or -errno.
 */
int bus_log_open(const char *in, const char *out, const char *const *ifaces, int n_ifaces,
		 struct bus **ret, char *err, int err_len);

/** bus_log_finish - closes the output. 0, or the first error of writing or closing it, -errno; again as often as asked. */
int bus_log_finish(struct bus *b);

/** bus_log_progress - bytes read and total (0 if unknown), for a progress line. */
void bus_log_progress(const struct bus *b, int64_t *read_bytes, int64_t *total);

/**
 * bus_log_parse - one candump line to a frame
 * @iface: receives the interface name [BUS_NAME_MAX]. f->iface is left 0.
 * Returns 0; -ENOMSG for a blank or comment line; -EBADMSG for anything else that is not a frame. Pure.
 */
int bus_log_parse(const char *line, char iface[BUS_NAME_MAX], struct bus_frame *f);

/** bus_log_format - a frame as a candump -L line without newline. Returns its length; @size >= 200. Pure. */
int bus_log_format(const struct bus_frame *f, const char *iface, char *line, int size);

#endif
