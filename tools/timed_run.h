/* SPDX-License-Identifier: MIT
 * One long batch, with progress on a terminal and an end on Ctrl-C.
 */
#ifndef AEBMC_TIMED_RUN_H
#define AEBMC_TIMED_RUN_H

#include "mc_ops.h"

/**
 * timed_run - ops->run with a progress line from a thread of its own
 * @what: first word of the line
 * On Ctrl-C the batch ends at its next chunk: res->n is smaller and MC_RES_CUT is set. 0 or -errno of the backend.
 */
int timed_run(const char *what, const struct mc_ops *ops, struct mc_backend *b,
	      const struct mc_request *req, struct mc_result *res);

#endif
