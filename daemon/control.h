/* SPDX-License-Identifier: MIT
 * The status socket: clients write one command a line, each is answered by one line of JSON.
 * Housekeeping thread only. A client that does not read, or writes without end, is dropped; the daemon never waits.
 */
#ifndef AEBMC_CONTROL_H
#define AEBMC_CONTROL_H

#include <stddef.h>

#define CONTROL_LINE_MAX  128
#define CONTROL_REPLY_MAX 8192

/* Answers a command: writes at most @size bytes of one line without newline into @reply. */
typedef void control_answer(void *arg, const char *command, char *reply, size_t size);

struct control;

/**
 * control_open - listen at @path (a stale socket of a dead process is replaced)
 * Returns 0; -EADDRINUSE if a living process listens there; -EEXIST if the file is no socket; -errno with one line in @err. Allocates.
 */
int control_open(const char *path, control_answer *answer, void *arg, struct control **ret,
		 char *err, int err_len);

/** control_fd - readable when there is something to serve (an epoll descriptor). */
int control_fd(const struct control *c);

/** control_serve - accept, read and answer what is there. Never blocks. */
void control_serve(struct control *c);

void control_close(struct control *c); /* removes the socket; NULL is fine */

#endif
