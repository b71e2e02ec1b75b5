/* SPDX-License-Identifier: MIT
 * Which identifiers come on which interfaces, how often; and which interfaces a log has at all.
 */
#ifndef AEBMC_CENSUS_H
#define AEBMC_CENSUS_H

#include <stdint.h>
#include "bus.h"

#define CENSUS_MAX 4096 /* identifiers; beyond that new ones are not counted */

struct census_id {
	uint64_t frames;
	uint32_t id; /* with BUS_ID_EFF */
	uint8_t iface;
};

struct census {
	int n;
	struct census_id at[CENSUS_MAX];
	uint16_t slot[2 * CENSUS_MAX]; /* hash: 0, or index + 1 */
};

/** census_add - count a frame. Zeroed at first. */
void census_add(struct census *c, uint8_t iface, uint32_t id);

/** census_find - where the identifier comes on that interface, or NULL. */
const struct census_id *census_find(const struct census *c, uint8_t iface, uint32_t id);

/** census_elsewhere - the interface on which it comes most often, whichever; or NULL. */
const struct census_id *census_elsewhere(const struct census *c, uint32_t id);

/** census_nearest - the identifier next to @id on that interface that does come, by number; or NULL. */
const struct census_id *census_nearest(const struct census *c, uint8_t iface, uint32_t id);

/**
 * census_interfaces - the names of a log's interfaces
 * @path: a file (a pipe cannot be read twice: then nothing is added)
 * @name, @n: names known already; those found are appended, up to BUS_IFACES_MAX in all
 * Returns the new number. Blocks on the file system.
 */
int census_interfaces(const char *path, char name[BUS_IFACES_MAX][BUS_NAME_MAX], int n);

#endif
