/* SPDX-License-Identifier: MIT
 * A backend behind two mailboxes: requests to one worker, results back. Newest wins; nobody waits for the other.
 */
#include "mc_ops.h"
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#define SLOTS   3
#define FRESH   4u  /* beside a slot number: written, not yet taken */
#define WAIT_MS 200 /* for the worker to say hello, or to end */

/* One slot belongs to the writer, one to the reader, and the one between them changes hands. */
struct box {
	uint32_t back;    /* the writer's */
	uint32_t between; /* atomic */
	uint32_t front;   /* the reader's */
};

struct entry {
	uint64_t seq; /* how many requests were submitted up to this one */
	struct mc_request req;
};

struct reply {
	int err;
	struct mc_result res;
};

enum watched { WATCHED_NOT, WATCHED_OFFERED, WATCHED };

struct mc {
	const struct mc_ops *ops;
	struct mc_backend *backend;
	struct box in, out;
	struct entry entry[SLOTS];
	struct reply reply[SLOTS];
	uint64_t submitted, finished; /* sequence numbers; atomic */
	uint64_t cut;                 /* requests up to this id end early; atomic */
	int stop;                     /* atomic */
	int wake_fd, done_fd;         /* -1 for an inline handle */
	int threaded;
	int spins;
	pthread_t thread;
	struct mc_watch watch;
	enum watched watched; /* atomic */
};

const char *const mc_edge_name[MC_EDGES] = {
#define MC_EDGE(name, doc) #name,
#include "mc_edge.def"
};

/* Gives the back slot away; returns 1 if the one before it was never taken. */
static int box_put(struct box *b)
{
	uint32_t old = __atomic_exchange_n(&b->between, b->back | FRESH, __ATOMIC_ACQ_REL);

	b->back = old & ~FRESH;
	return old & FRESH ? 1 : 0;
}

/* Makes the newest slot the front one; returns 0 if there is none since the last time. */
static int box_take(struct box *b)
{
	if (!(__atomic_load_n(&b->between, __ATOMIC_RELAXED) & FRESH)) {
		return 0;
	}
	b->front = __atomic_exchange_n(&b->between, b->front, __ATOMIC_ACQ_REL) & ~FRESH;
	return 1;
}

/* An eventfd refuses only at 2^64 - 2 unread events. */
static void ring(int fd)
{
	ssize_t n = eventfd_write(fd, 1);

	(void)n;
}

/* The backend belongs to the thread that runs it: it learns of the watch there. */
static void greet(struct mc *mc)
{
	if (__atomic_load_n(&mc->watched, __ATOMIC_ACQUIRE) != WATCHED_OFFERED) {
		return;
	}
	mc->watch.hello(mc->watch.arg);
	if (mc->ops->watch) {
		mc->ops->watch(mc->backend, &mc->watch);
	}
	__atomic_store_n(&mc->watched, WATCHED, __ATOMIC_RELEASE);
}

static void pass(const struct mc *mc, enum mc_edge e, uint64_t id)
{
	if (__atomic_load_n(&mc->watched, __ATOMIC_RELAXED) == WATCHED) {
		mc->watch.edge(mc->watch.arg, e, id);
	}
}

static void run_front(struct mc *mc)
{
	const struct entry *e = &mc->entry[mc->in.front];
	struct reply *r = &mc->reply[mc->out.back];

	pass(mc, MC_EDGE_TAKEN, e->req.id);
	memset(r, 0, sizeof(*r));
	r->err = mc->ops->run(mc->backend, &e->req, &mc->cut, &r->res);
	r->res.id = e->req.id;
	box_put(&mc->out);
	pass(mc, MC_EDGE_DONE, e->req.id);
	__atomic_store_n(&mc->finished, e->seq, __ATOMIC_RELEASE);
}

static void *work(void *arg)
{
	struct mc *mc = arg;
	eventfd_t n;

	while (!__atomic_load_n(&mc->stop, __ATOMIC_ACQUIRE)) {
		greet(mc);
		if (box_take(&mc->in)) {
			run_front(mc);
			ring(mc->done_fd);
		} else if (!mc->spins) {
			eventfd_read(mc->wake_fd, &n);
		}
	}
	return NULL;
}

/* The worker takes no signal: they belong to the threads of the caller. */
static int start(struct mc *mc)
{
	sigset_t all, old;
	int err;

	mc->wake_fd = eventfd(0, EFD_CLOEXEC);
	mc->done_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (mc->wake_fd < 0 || mc->done_fd < 0) {
		return -errno;
	}
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &old);
	err = pthread_create(&mc->thread, NULL, work, mc);
	pthread_sigmask(SIG_SETMASK, &old, NULL);
	mc->threaded = !err;
	return -err;
}

int mc_open(const struct mc_ops *ops, const struct mc_params *p, int worker, struct mc **ret)
{
	struct mc *mc = calloc(1, sizeof(*mc));
	int err;

	if (!mc) {
		return -ENOMEM;
	}
	mc->ops = ops;
	mc->in = mc->out = (struct box){.back = 0, .between = 1, .front = 2};
	mc->spins = worker == MC_WORKER_SPINS;
	mc->wake_fd = mc->done_fd = -1;
	err = ops->open(p, &mc->backend);
	if (!err && worker) {
		err = start(mc);
	}
	if (err) {
		mc_close(mc);
		return err;
	}
	*ret = mc;
	return 0;
}

int mc_submit(struct mc *mc, const struct mc_request *req)
{
	struct entry *e = &mc->entry[mc->in.back];
	int replaced;

	if (req->id == 0 || mc_check(req)) {
		return -EINVAL;
	}
	e->seq = mc->submitted + 1;
	e->req = *req;
	__atomic_store_n(&mc->submitted, e->seq, __ATOMIC_RELAXED);
	replaced = box_put(&mc->in);
	if (mc->threaded && !mc->spins) {
		ring(mc->wake_fd);
	} else if (!mc->threaded && box_take(&mc->in)) {
		run_front(mc);
	}
	return replaced;
}

int mc_poll(struct mc *mc, struct mc_result *res)
{
	const struct reply *r;
	eventfd_t n;

	/* Silence first, then look: the other way round a result between the two would stay unannounced. */
	if (mc->threaded) {
		eventfd_read(mc->done_fd, &n);
	}
	if (!box_take(&mc->out)) {
		return 0;
	}
	r = &mc->reply[mc->out.front];
	*res = r->res;
	return r->err ? r->err : 1;
}

int mc_busy(const struct mc *mc)
{
	return __atomic_load_n(&mc->finished, __ATOMIC_ACQUIRE) !=
	       __atomic_load_n(&mc->submitted, __ATOMIC_RELAXED);
}

void mc_cut(struct mc *mc, uint64_t id)
{
	if (id > __atomic_load_n(&mc->cut, __ATOMIC_RELAXED)) {
		__atomic_store_n(&mc->cut, id, __ATOMIC_RELEASE);
	}
}

int mc_watch(struct mc *mc, const struct mc_watch *w)
{
	mc->watch = *w;
	__atomic_store_n(&mc->watched, WATCHED_OFFERED, __ATOMIC_RELEASE);
	if (mc->threaded) {
		ring(mc->wake_fd);
	} else {
		greet(mc);
	}
	for (int ms = 0; ms < WAIT_MS; ms++) {
		if (__atomic_load_n(&mc->watched, __ATOMIC_ACQUIRE) == WATCHED) {
			return 0;
		}
		poll(NULL, 0, 1);
	}
	return -ETIMEDOUT;
}

int mc_eventfd(const struct mc *mc)
{
	return mc->done_fd;
}

unsigned long mc_thread(const struct mc *mc)
{
	return mc->threaded ? (unsigned long)mc->thread : 0;
}

/* Counts short sleeps: this room reads no clock. */
static int join(struct mc *mc)
{
	for (int ms = 0; ms < WAIT_MS; ms++) {
		if (pthread_tryjoin_np(mc->thread, NULL) == 0) {
			return 0;
		}
		poll(NULL, 0, 1);
	}
	return -ETIMEDOUT;
}

static void close_fd(int fd)
{
	if (fd >= 0) {
		close(fd);
	}
}

void mc_close(struct mc *mc)
{
	if (!mc) {
		return;
	}
	if (mc->threaded) {
		__atomic_store_n(&mc->stop, 1, __ATOMIC_RELEASE);
		mc_cut(mc, UINT64_MAX);
		ring(mc->wake_fd);
		if (join(mc)) {
			/* It may still write to all of this, so all of it stays, file descriptors too. */
			pthread_detach(mc->thread);
			return;
		}
	}
	mc->ops->close(mc->backend);
	close_fd(mc->wake_fd);
	close_fd(mc->done_fd);
	free(mc);
}
