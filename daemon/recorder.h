/* SPDX-License-Identifier: MIT
 * The event recorder: keeps the latest accepted frames and evaluations in memory and, around a warning, a request, a
 * fault, a miss or a mark, writes what came before and after as a candump log with the requests beside it.
 * The real-time thread only puts and triggers; files are another thread's.
 */
#ifndef AEBMC_RECORDER_H
#define AEBMC_RECORDER_H

#include <stdio.h>
#include "bus.h"
#include "mc.h"

#define RECORDER_DIR_MAX  400
#define RECORDER_PATH_MAX 512

/* From an event's first trigger to its last at most: memory must hold what is before the first until it is written. */
#define RECORDER_TOGETHER_NS (30LL * 1000000000)

enum recorder_reason {
	RECORDER_WARN,
	RECORDER_REQUEST,
	RECORDER_FAULT,
	RECORDER_MISS,
	RECORDER_MARK,
	RECORDER_REASONS
};
extern const char *const recorder_reason_name[RECORDER_REASONS]; /* "warn", "request", ... */

struct recorder_params {
	const char *dir;           /* must exist */
	const char *const *ifaces; /* names for the log, by index */
	int n_ifaces;
	int64_t before_ns, after_ns;
	uint32_t frames_per_s, requests_per_s; /* at most: what memory is sized for */
	uint64_t bytes_max; /* of all files, half of it at most for faults and misses */
};

struct recorder;

/** recorder_open - allocates what the longest event needs; finds the number of the last event in the folder. 0 or -errno,
 * @err says why. */
int recorder_open(const struct recorder_params *p, struct recorder **ret, char *err, int err_len);

/** recorder_frame - keep a frame. Real-time thread; no allocation, no system call. */
void recorder_frame(struct recorder *r, const struct bus_frame *f);

/** recorder_evaluation - keep a request and the hash of its result. Real-time thread. */
void recorder_evaluation(struct recorder *r, int64_t t_ns, const struct mc_request *req,
			 const struct mc_result *res);

/** recorder_trigger - something happened at @t_ns. What comes before the time after is over makes the event longer, by
 * RECORDER_TOGETHER_NS at most; what comes later than that begins the next one, with its own time before. Real-time
 * thread. */
void recorder_trigger(struct recorder *r, enum recorder_reason why, int64_t t_ns);

/**
 * recorder_service - write the event whose time after is over (or @finish)
 * @real_minus_mono_ns: what turns a frame's time into that of the log
 * @path: receives the log's path [RECORDER_PATH_MAX] when one was due; its name carries the first reason, but a fault gives
 *        way to a warning, request or mark, and a miss to all. The .requests file beside it begins with all of them.
 * One thread alone; blocks on the file system. Returns 1 if an event was written (call again: the next one may be due),
 * 0 if none was due, -errno (the event is lost, the partial file removed; -EFBIG: larger than all may be together).
 */
int recorder_service(struct recorder *r, int64_t now_ns, int64_t real_minus_mono_ns, int finish,
		     char path[RECORDER_PATH_MAX]);

/** recorder_words - what the last event due was of and what is missing from it: "1 warn, 2 request". Service thread.
 * Returns 1 if something is missing. */
int recorder_words(const struct recorder *r, char *line, int size);

void recorder_close(struct recorder *r); /* NULL is fine */

/** recorder_result_hash - of the integers and figures of a result, the same on any machine and backend. Pure. */
uint64_t recorder_result_hash(const struct mc_result *res);

/** recorder_write_head, recorder_write - a .requests file: its first line, and one line for each request with its result's
 * hash; @t_ns is what the line names as its time. Write errors stay in ferror(@f). */
void recorder_write_head(FILE *f);
void recorder_write(FILE *f, int64_t t_ns, const struct mc_request *req, uint64_t result_hash);

/** recorder_write_reason - a comment of such a file: @n triggers of a kind, the first and the last of them. */
void recorder_write_reason(FILE *f, enum recorder_reason why, uint64_t n, int64_t first_ns,
			   int64_t last_ns);

/**
 * recorder_parse - one line of a .requests file
 * Returns 0 with @req and the recorded result's hash; -ENOMSG for a comment or blank line; -EBADMSG for anything else,
 * a request whose content does not give the hash beside it included. Pure.
 */
int recorder_parse(const char *line, struct mc_request *req, uint64_t *result_hash);

#endif
