/* SPDX-License-Identifier: MIT
 * Rings of frames, evaluations and triggers, and the files written from them. See recorder.h.
 */
#include "recorder.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clock.h"
#include "ring.h"

#define PREFIX     "event-"
#define LATENCY_NS (2 * CLOCK_NS_PER_S) /* until the oldest of an event that is over is read */
#define TRIGGERS   (1u << 14) /* of the longest event and a minute of a slow disk, at 100 a second */

struct trigger {
	int64_t t_ns;
	uint64_t why;
};

/* As far as its triggers were taken; the writer's alone. */
struct event {
	int64_t first_ns, from_ns, to_ns;
	struct tally {
		uint64_t n;
		int64_t first_ns, last_ns;
	} of[RECORDER_REASONS];
	enum recorder_reason name;
	int open;
	uint64_t lost;       /* triggers overwritten before they were taken */
	int64_t complete_ns; /* what was before was in part overwritten before it was written */
};

/* Entries of both rings begin with their time. */
struct evaluation {
	int64_t t_ns;
	uint64_t result_hash;
	struct mc_request req;
};
_Static_assert(sizeof(struct evaluation) % 8 == 0, "ring entries are words");
_Static_assert(offsetof(struct bus_frame, t_ns) == 0, "ring entries begin with their time");
_Static_assert(sizeof(struct bus_frame) % 8 == 0, "ring entries are words");

struct recorder {
	struct recorder_params p;
	char dir[RECORDER_DIR_MAX];
	char iface[BUS_IFACES_MAX][BUS_NAME_MAX];
	struct ring *frames, *evaluations, *triggers;
	uint64_t taken; /* triggers */
	struct event event, last;
	unsigned serial; /* of the last event */
};

/* A ring's entries: what comes during the longest event, a power of two. */
static uint32_t kept(const struct recorder_params *p, uint32_t per_s)
{
	const int64_t kept_ns = p->before_ns + RECORDER_TOGETHER_NS + p->after_ns + LATENCY_NS;
	uint32_t n = 1;

	while (n < kept_ns * per_s / CLOCK_NS_PER_S) {
		n *= 2;
	}
	return n;
}

int recorder_open(const struct recorder_params *p, struct recorder **ret, char *err, int err_len)
{
	struct recorder *r = calloc(1, sizeof(*r));
	DIR *d;
	int status;

	if (!r) {
		snprintf(err, (size_t)err_len, "recorder: out of memory");
		return -ENOMEM;
	}
	r->p = *p;
	snprintf(r->dir, sizeof(r->dir), "%s", p->dir);
	for (int i = 0; i < p->n_ifaces && i < BUS_IFACES_MAX; i++) {
		snprintf(r->iface[i], BUS_NAME_MAX, "%s", p->ifaces[i]);
	}
	d = opendir(r->dir);
	status = d ? 0 : -errno;
	if (!status) {
		for (const struct dirent *e = readdir(d); e; e = readdir(d)) {
			unsigned n;

			if (sscanf(e->d_name, PREFIX "%u", &n) == 1 && n > r->serial) {
				r->serial = n;
			}
		}
		closedir(d);
		status = ring_open(kept(p, p->frames_per_s), sizeof(struct bus_frame), &r->frames);
	}
	status = status ? status
			: ring_open(kept(p, p->requests_per_s), sizeof(struct evaluation),
				    &r->evaluations);
	status = status ? status : ring_open(TRIGGERS, sizeof(struct trigger), &r->triggers);
	if (status) {
		snprintf(err, (size_t)err_len, "recorder: %s: %s", r->dir, strerror(-status));
		recorder_close(r);
		return status;
	}
	*ret = r;
	return 0;
}

void recorder_frame(struct recorder *r, const struct bus_frame *f)
{
	ring_put(r->frames, f);
}

void recorder_evaluation(struct recorder *r, int64_t t_ns, const struct mc_request *req,
			 const struct mc_result *res)
{
	struct evaluation e = {.t_ns = t_ns, .result_hash = recorder_result_hash(res), .req = *req};

	e.req.n = (uint32_t)res->n; /* a batch that was cut is the one of fewer samples */
	if (e.req.n) {
		ring_put(r->evaluations, &e);
	}
}

void recorder_trigger(struct recorder *r, enum recorder_reason why, int64_t t_ns)
{
	const struct trigger t = {.t_ns = t_ns, .why = why};

	ring_put(r->triggers, &t);
}

/* ---- which triggers are one event (housekeeping thread) --------------------------------------------- */

/* An event's name is the first reason of the highest rank. */
static const int rank[RECORDER_REASONS] = {[RECORDER_MISS] = 0,
					   [RECORDER_FAULT] = 1,
					   [RECORDER_WARN] = 2,
					   [RECORDER_REQUEST] = 2,
					   [RECORDER_MARK] = 2};

static void add(struct recorder *r, const struct trigger *t)
{
	struct event *e = &r->event;
	struct tally *of = &e->of[t->why];

	if (!e->open) {
		e->first_ns = t->t_ns;
		e->from_ns = e->complete_ns = t->t_ns - r->p.before_ns;
	}
	if (!e->open || rank[t->why] > rank[e->name]) {
		e->name = (enum recorder_reason)t->why;
	}
	e->open = 1;
	e->to_ns = t->t_ns + r->p.after_ns;
	of->first_ns = of->n ? of->first_ns : t->t_ns;
	of->last_ns = t->t_ns;
	of->n++;
}

/* What belongs to the next event stays in the ring until this one is written. */
static void take_triggers(struct recorder *r)
{
	struct event *e = &r->event;
	struct trigger t;

	for (; r->taken < ring_end(r->triggers); r->taken++) {
		if (ring_get(r->triggers, r->taken, &t)) {
			e->lost++;
		} else if (!e->open || t.t_ns - e->first_ns <= RECORDER_TOGETHER_NS) {
			add(r, &t);
		} else {
			return;
		}
	}
}

/* ---- files (housekeeping thread) -------------------------------------------------------------------- */

struct cursor {
	const struct ring *ring;
	uint64_t next, end;
	int gone; /* what was before is overwritten */
};

static struct cursor start(const struct ring *ring)
{
	const uint64_t next = ring_begin(ring);

	return (struct cursor){.ring = ring, .next = next, .end = ring_end(ring), .gone = next > 0};
}

static void note_gap(struct event *e, int64_t until_ns)
{
	e->complete_ns = until_ns > e->complete_ns ? until_ns : e->complete_ns;
}

/* 1 with the next entry of the event's time, 0 at the end. */
static int next(struct event *e, struct cursor *c, void *entry)
{
	int64_t t_ns;

	while (c->next < c->end) {
		if (ring_get(c->ring, c->next++, entry)) {
			c->gone = 1;
			continue;
		}
		memcpy(&t_ns, entry, sizeof(t_ns));
		if (c->gone) {
			note_gap(e, t_ns);
		}
		c->gone = 0;
		if (t_ns >= e->from_ns && t_ns <= e->to_ns) {
			return 1;
		}
	}
	if (c->gone) {
		note_gap(e, e->to_ns);
	}
	return 0;
}

static int write_frames(struct recorder *r, FILE *f, int64_t offset)
{
	struct cursor c = start(r->frames);
	struct bus_frame fr;
	char line[256];

	while (next(&r->event, &c, &fr)) {
		fr.t_ns += offset;
		bus_log_format(&fr, r->iface[fr.iface % BUS_IFACES_MAX], line, sizeof(line));
		fprintf(f, "%s\n", line);
	}
	return ferror(f) ? -EIO : 0;
}

static int write_requests(struct recorder *r, FILE *f, int64_t offset)
{
	const struct tally *of = r->event.of;
	struct cursor c = start(r->evaluations);
	struct evaluation e;

	recorder_write_head(f);
	for (int i = 0; i < RECORDER_REASONS; i++) {
		if (of[i].n) {
			recorder_write_reason(f, (enum recorder_reason)i, of[i].n,
					      of[i].first_ns + offset, of[i].last_ns + offset);
		}
	}
	while (next(&r->event, &c, &e)) {
		recorder_write(f, e.t_ns + offset, &e.req, e.result_hash);
	}
	return ferror(f) ? -EIO : 0;
}

typedef int writer(struct recorder *r, FILE *f, int64_t offset);

/* Written beside and renamed, so that a reader never finds half a file. */
static int write_file(struct recorder *r, const char *path, writer *w, int64_t offset)
{
	char part[RECORDER_PATH_MAX + 8];
	FILE *f;
	int ret;

	snprintf(part, sizeof(part), "%s.part", path);
	f = fopen(part, "we");
	if (!f) {
		return -errno;
	}
	ret = w(r, f, offset);
	if (fclose(f) || ret) {
		ret = errno ? -errno : -EIO;
	} else if (rename(part, path)) {
		ret = -errno;
	}
	if (ret) {
		unlink(part);
	}
	return ret;
}

static int by_name(const struct dirent *e)
{
	return strncmp(e->d_name, PREFIX, strlen(PREFIX)) == 0;
}

static uint64_t size_of(const char *path)
{
	struct stat st;

	return stat(path, &st) ? 0 : (uint64_t)st.st_size;
}

/* Faults and misses come in floods. */
static int may_flood(const char *path)
{
	const char *name = strrchr(path, '/');

	return strstr(name, "-fault.") || strstr(name, "-miss.");
}

/* Half of it is for the others. */
static uint64_t room(const struct recorder *r, const char *path)
{
	return may_flood(path) ? r->p.bytes_max / 2 : r->p.bytes_max;
}

static int is_too_much(uint64_t *total, uint64_t size, uint64_t most)
{
	*total += size;
	return *total > most;
}

/* Names carry the serial number, zero-padded: sorted by name is sorted by age. */
static void remove_oldest(const struct recorder *r)
{
	struct dirent **e = NULL;
	const int n = scandir(r->dir, &e, by_name, alphasort);
	uint64_t floods = 0, total = 0;

	for (int i = n - 1; i >= 0; i--) {
		char path[sizeof(r->dir) + 256 + 1];

		snprintf(path, sizeof(path), "%s/%s", r->dir, e[i]->d_name);

		const uint64_t size = size_of(path);

		if ((may_flood(path) && is_too_much(&floods, size, room(r, path))) ||
		    is_too_much(&total, size, r->p.bytes_max)) {
			unlink(path);
		}
		free(e[i]);
	}
	free(e);
}

static int write_event(struct recorder *r, int64_t offset, char path[RECORDER_PATH_MAX])
{
	const char *why = recorder_reason_name[r->event.name];
	char requests[RECORDER_PATH_MAX];
	int ret;

	r->serial++;
	snprintf(path, RECORDER_PATH_MAX, "%s/" PREFIX "%06u-%s.log", r->dir, r->serial, why);
	snprintf(requests, sizeof(requests), "%s/" PREFIX "%06u-%s.requests", r->dir, r->serial,
		 why);
	ret = write_file(r, path, write_frames, offset);
	ret = ret ? ret : write_file(r, requests, write_requests, offset);
	if (!ret && size_of(path) + size_of(requests) > room(r, path)) {
		ret = -EFBIG; /* to make room for it would remove all the others, and then it */
	}
	if (ret) {
		unlink(path);
		unlink(requests);
	}
	remove_oldest(r);
	return ret ? ret : 1;
}

int recorder_service(struct recorder *r, int64_t now_ns, int64_t real_minus_mono_ns, int finish,
		     char path[RECORDER_PATH_MAX])
{
	int ret;

	take_triggers(r);
	if (!r->event.open || (now_ns < r->event.to_ns && !finish)) {
		return 0;
	}
	ret = write_event(r, real_minus_mono_ns, path);
	r->last = r->event;
	r->event = (struct event){0};
	return ret;
}

int recorder_words(const struct recorder *r, char *line, int size)
{
	const struct event *e = &r->last;
	const int64_t missing_ns = clock_earlier(e->complete_ns, e->to_ns) - e->from_ns;
	FILE *f = fmemopen(line, (size_t)size, "w");
	const char *comma = "";

	line[0] = '\0';
	if (!f) {
		return 0;
	}
	for (int i = 0; i < RECORDER_REASONS; i++) {
		if (e->of[i].n) {
			fprintf(f, "%s%" PRIu64 " %s", comma, e->of[i].n, recorder_reason_name[i]);
			comma = ", ";
		}
	}
	if (missing_ns > 0) {
		fprintf(f, "; the first %.1f s are incomplete, memory holds no more",
			(double)missing_ns / CLOCK_NS_PER_S);
	}
	if (e->lost) {
		fprintf(f, "; %" PRIu64 " triggers before were lost, the disk is too slow",
			e->lost);
	}
	fclose(f);
	return missing_ns > 0 || e->lost;
}

void recorder_close(struct recorder *r)
{
	if (r) {
		ring_close(r->frames);
		ring_close(r->evaluations);
		ring_close(r->triggers);
		free(r);
	}
}
