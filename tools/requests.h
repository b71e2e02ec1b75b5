/* SPDX-License-Identifier: MIT
 * aebmc replay --requests: does the backend give the recorded results again, bit for bit?
 */
#ifndef AEBMC_REQUESTS_H
#define AEBMC_REQUESTS_H

#include "replay.h"

/**
 * requests_run - rerun every request of @a->requests, a file of the event recorder, and compare the results' hashes
 * @name: "aebmc replay", for messages
 * Draws, seed and truncation are those of the configuration. Returns an exit code: CLI_FAILED after one line where a
 * line is malformed, a result differs or the file is not the recorder's; an event without any request is good.
 */
int requests_run(const char *name, const struct replay_args *a);

#endif
