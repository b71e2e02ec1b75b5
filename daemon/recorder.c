/* SPDX-License-Identifier: MIT
 * Rings of frames and evaluations, and the files written from them. See recorder.h.
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
#include "hash.h"
#include "ring.h"

#define PREFIX     "event-"
#define LATENCY_NS (2 * CLOCK_NS_PER_S) /* until the oldest of an event that is over is read */

const char *const recorder_reason_name[RECORDER_REASONS] = {"warn", "request", "fault", "miss",
							    "mark"};

struct evaluation {
	int64_t t_ns;
	uint64_t result_hash;
	struct mc_request req;
};
_Static_assert(sizeof(struct evaluation) % 8 == 0, "ring entries are words");
_Static_assert(sizeof(struct bus_frame) % 8 == 0, "ring entries are words");
_Static_assert(sizeof(struct mc_request) % 4 == 0, "a request is written as 32-bit words");

struct recorder {
	struct recorder_params p;
	char dir[RECORDER_DIR_MAX];
	char iface[BUS_IFACES_MAX][BUS_NAME_MAX];
	struct ring *frames, *evaluations;
	int64_t event_ns; /* atomic; 0: no event open */
	int event_why;    /* atomic */
	unsigned serial;  /* of the last event */
};

/* A ring's entries: what comes while an event lasts, a power of two. */
static uint32_t kept(const struct recorder_params *p, uint32_t per_s)
{
	const int64_t kept_ns = p->before_ns + p->after_ns + LATENCY_NS;
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

uint64_t recorder_result_hash(const struct mc_result *res)
{
	uint64_t h = hash_u64(hash_u64(HASH_START, res->n), res->floored);

	for (uint32_t i = 0; i < res->n_futures && i < MC_FUTURES_MAX; i++) {
		const struct mc_risk *k = &res->risk[i];

		h = hash_u64(hash_u64(h, k->hits), k->undecided);
		h = hash_f64(hash_f64(h, k->lo), k->hi);
		h = k->hits ? hash_f64(h, k->impact_mps) : h; /* NaN has many faces */
	}
	return h;
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
	int64_t none = 0;

	if (__atomic_load_n(&r->event_ns, __ATOMIC_RELAXED) == 0) {
		__atomic_store_n(&r->event_why, (int)why, __ATOMIC_RELAXED);
		__atomic_compare_exchange_n(&r->event_ns, &none, t_ns, 0, __ATOMIC_RELEASE,
					    __ATOMIC_RELAXED);
	}
}

/* ---- files (housekeeping thread) -------------------------------------------------------------------- */

static int write_frames(const struct recorder *r, FILE *f, int64_t from, int64_t to, int64_t offset)
{
	struct bus_frame fr;
	char line[256];

	for (uint64_t i = ring_begin(r->frames); i < ring_end(r->frames); i++) {
		if (ring_get(r->frames, i, &fr) || fr.t_ns < from || fr.t_ns > to) {
			continue;
		}
		fr.t_ns += offset;
		bus_log_format(&fr, r->iface[fr.iface % BUS_IFACES_MAX], line, sizeof(line));
		fprintf(f, "%s\n", line);
	}
	return ferror(f) ? -EIO : 0;
}

void recorder_write_head(FILE *f)
{
	fprintf(f, "# aebmc requests 1: (time) hash of request, hash of result, %zu words\n",
		sizeof(struct mc_request) / 4);
}

/* Readable by recorder_parse() on any little-endian machine. */
void recorder_write(FILE *f, int64_t t_ns, const struct mc_request *req, uint64_t result_hash)
{
	uint32_t word[sizeof(struct mc_request) / 4];

	memcpy(word, req, sizeof(*req));
	fprintf(f, "(%010" PRId64 ".%06" PRId64 ") %016" PRIx64 " %016" PRIx64, t_ns / 1000000000,
		t_ns / 1000 % 1000000, mc_request_hash(req), result_hash);
	for (size_t i = 0; i < sizeof(word) / sizeof(word[0]); i++) {
		fprintf(f, " %x", word[i]);
	}
	fputc('\n', f);
}

static int write_requests(const struct recorder *r, FILE *f, int64_t from, int64_t to,
			  int64_t offset)
{
	struct evaluation e;

	recorder_write_head(f);
	for (uint64_t i = ring_begin(r->evaluations); i < ring_end(r->evaluations); i++) {
		if (!ring_get(r->evaluations, i, &e) && e.t_ns >= from && e.t_ns <= to) {
			recorder_write(f, e.t_ns + offset, &e.req, e.result_hash);
		}
	}
	return ferror(f) ? -EIO : 0;
}

int recorder_parse(const char *line, struct mc_request *req, uint64_t *result_hash)
{
	uint32_t word[sizeof(struct mc_request) / 4];
	uint64_t hash, result;
	struct mc_request q;
	int at = 0, step;

	if (line[strspn(line, " \t\r\n")] == '\0' || line[0] == '#') {
		return -ENOMSG;
	}
	if (sscanf(line, "(%*d.%*d) %" SCNx64 " %" SCNx64 "%n", &hash, &result, &at) != 2 || !at) {
		return -EBADMSG;
	}
	for (size_t i = 0; i < sizeof(word) / sizeof(word[0]); i++) {
		if (sscanf(line + at, " %8" SCNx32 "%n", &word[i], &step) != 1) {
			return -EBADMSG;
		}
		at += step;
	}
	memcpy(&q, word, sizeof(q));
	if (line[at + (int)strspn(line + at, " \r\n")] != '\0' || mc_check(&q) ||
	    mc_request_hash(&q) != hash) {
		return -EBADMSG;
	}
	*req = q;
	*result_hash = result;
	return 0;
}

typedef int writer(const struct recorder *r, FILE *f, int64_t from, int64_t to, int64_t offset);

/* Written beside and renamed, so that a reader never finds half a file. */
static int write_file(const struct recorder *r, const char *path, writer *w, int64_t t,
		      int64_t offset)
{
	char part[RECORDER_PATH_MAX + 8];
	FILE *f;
	int ret;

	snprintf(part, sizeof(part), "%s.part", path);
	f = fopen(part, "we");
	if (!f) {
		return -errno;
	}
	ret = w(r, f, t - r->p.before_ns, t + r->p.after_ns, offset);
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

/* Names carry the serial number, zero-padded: sorted by name is sorted by age. */
static void remove_oldest(const struct recorder *r)
{
	struct dirent **e = NULL;
	const int n = scandir(r->dir, &e, by_name, alphasort);
	uint64_t total = 0;

	for (int i = n - 1; i >= 0; i--) {
		char path[sizeof(r->dir) + 256 + 1];
		struct stat st;

		snprintf(path, sizeof(path), "%s/%s", r->dir, e[i]->d_name);
		total += stat(path, &st) ? 0 : (uint64_t)st.st_size;
		if (total > r->p.bytes_max) {
			unlink(path);
		}
		free(e[i]);
	}
	free(e);
}

static int write_event(struct recorder *r, int64_t t, int64_t offset, char path[RECORDER_PATH_MAX])
{
	const char *why = recorder_reason_name[__atomic_load_n(&r->event_why, __ATOMIC_RELAXED)];
	char requests[RECORDER_PATH_MAX];
	int ret;

	r->serial++;
	snprintf(path, RECORDER_PATH_MAX, "%s/" PREFIX "%06u-%s.log", r->dir, r->serial, why);
	snprintf(requests, sizeof(requests), "%s/" PREFIX "%06u-%s.requests", r->dir, r->serial,
		 why);
	ret = write_file(r, path, write_frames, t, offset);
	if (!ret) {
		ret = write_file(r, requests, write_requests, t, offset);
	}
	if (ret) {
		unlink(path);
	}
	remove_oldest(r);
	return ret ? ret : 1;
}

int recorder_service(struct recorder *r, int64_t now_ns, int64_t real_minus_mono_ns, int finish,
		     char path[RECORDER_PATH_MAX])
{
	const int64_t t = __atomic_load_n(&r->event_ns, __ATOMIC_ACQUIRE);
	int ret;

	if (!t || (now_ns < t + r->p.after_ns && !finish)) {
		return 0;
	}
	ret = write_event(r, t, real_minus_mono_ns, path);
	__atomic_store_n(&r->event_ns, 0, __ATOMIC_RELEASE);
	return ret;
}

void recorder_close(struct recorder *r)
{
	if (r) {
		ring_close(r->frames);
		ring_close(r->evaluations);
		free(r);
	}
}
