/* SPDX-License-Identifier: MIT
 * One command to the status socket of a running aebmcd, one line back (daemon/control.h): the options --socket PATH and
 * NAME through an argp child, and the exchange.
 */
#ifndef AEBMC_ASK_H
#define AEBMC_ASK_H

#include <argp.h>
#include "control.h"

struct ask_args {
	const char *path; /* --socket */
	const char *name; /* of the service aebmcd@NAME */
};

struct ask {
	int fd;
	char reply[CONTROL_REPLY_MAX]; /* the last line, without its end */
};

/* Child parser; its input is a zeroed struct ask_args. */
extern const struct argp ask_argp;

/**
 * ask_open - connect to the named daemon, or to the only one that runs
 * @who: "aebmc SUB", for messages. Returns 0, or an exit code after one line.
 */
int ask_open(const char *who, const struct ask_args *a, struct ask *ret);

/**
 * ask - send @command and wait up to 2 s for the answer in @a->reply
 * Returns 0, or CLI_FAILED after one line: no answer, or the daemon refused (its "error").
 */
int ask(const char *who, struct ask *a, const char *command);

void ask_close(struct ask *a);

#endif
