/* SPDX-License-Identifier: MIT
 * Quantities in SI to a car's frames, through its mapping: the way back of daemon/decode.h. For made-up drives.
 */
#ifndef AEBMC_ENCODE_H
#define AEBMC_ENCODE_H

#include <stdint.h>
#include "decode.h"
#include "mapping.h"

struct encode {
	const struct mapping *map;
	struct e2e_state e2e[MAP_MESSAGES_MAX]; /* a sender's counters */
};

/** encode_open - counters start at 0; @map must outlive it. */
void encode_open(struct encode *e, const struct mapping *map);

/**
 * encode_message - one frame, protected as the receiver will check it
 * @message: index into the mapping
 * @roles: bits MAP_* of @value that are known; what is not known is "not available" where the database has such a value
 * @det: target of the message's slot or list, or whose quality it tells; NULL: the slot is empty (or the message has none)
 * Values beyond a signal's range are set to its end.
 */
void encode_message(struct encode *e, int message, uint32_t roles, const double value[MAP_ROLES],
		    const struct detection *det, int64_t t_ns, struct bus_frame *f);

/** encode_header - the message that begins a scan of @count objects; the mapping has one. */
void encode_header(struct encode *e, int count, int64_t t_ns, struct bus_frame *f);

/** encode_track - put a target, or none (@det NULL), into a frame that exists; its counter stays, its checksum follows. */
void encode_track(const struct mapping *map, int message, const struct detection *det,
		  struct bus_frame *f);

#endif
