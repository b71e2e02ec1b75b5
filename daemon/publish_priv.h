/* SPDX-License-Identifier: MIT
 * What publish.c and publish_words.c share.
 */
#ifndef AEBMC_PUBLISH_PRIV_H
#define AEBMC_PUBLISH_PRIV_H

#include "e2e.h"
#include "publish.h"

struct publish {
	uint32_t first_id; /* of AEB_REQUEST; the others follow */
	uint8_t iface;
	int64_t ttl_ns;
	uint32_t transmit; /* as bus.transmit and the contract count them */
	int shadow;        /* decide, but never ask for braking */
	uint32_t page;     /* of the next AEB_TIMING */
	struct e2e_state e2e[PUBLISH_MSGS];
};

_Static_assert((int)PUBLISH_REQUEST == (int)AEB_REQUEST && (int)PUBLISH_TIMING == (int)AEB_TIMING,
	       "messages are numbered as in the contract");

#endif
