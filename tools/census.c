/* SPDX-License-Identifier: MIT
 * Identifiers in a hash table of fixed size.
 */
#include "census.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define SLOTS      (2 * CENSUS_MAX)
#define LINE_BYTES 1024

/* The slot of an identifier, or the empty one where it belongs. */
static uint32_t slot_of(const struct census *c, uint8_t iface, uint32_t id)
{
	uint32_t at = (id * 2654435761u ^ iface * 40503u) % SLOTS;

	while (c->slot[at] &&
	       (c->at[c->slot[at] - 1].id != id || c->at[c->slot[at] - 1].iface != iface)) {
		at = (at + 1) % SLOTS;
	}
	return at;
}

void census_add(struct census *c, uint8_t iface, uint32_t id)
{
	const uint32_t at = slot_of(c, iface, id);

	if (!c->slot[at] && c->n < CENSUS_MAX) {
		c->at[c->n] = (struct census_id){.id = id, .iface = iface};
		c->slot[at] = (uint16_t)++c->n;
	}
	if (c->slot[at]) {
		c->at[c->slot[at] - 1].frames++;
	}
}

const struct census_id *census_find(const struct census *c, uint8_t iface, uint32_t id)
{
	const uint16_t slot = c->slot[slot_of(c, iface, id)];

	return slot ? &c->at[slot - 1] : NULL;
}

const struct census_id *census_elsewhere(const struct census *c, uint32_t id)
{
	const struct census_id *best = NULL;

	for (int i = 0; i < c->n; i++) {
		if (c->at[i].id == id && (!best || c->at[i].frames > best->frames)) {
			best = &c->at[i];
		}
	}
	return best;
}

const struct census_id *census_nearest(const struct census *c, uint8_t iface, uint32_t id)
{
	const struct census_id *best = NULL;
	uint32_t least = UINT32_MAX;

	for (int i = 0; i < c->n; i++) {
		const uint32_t other = c->at[i].id, far = other > id ? other - id : id - other;

		if (c->at[i].iface == iface && far < least) {
			least = far;
			best = &c->at[i];
		}
	}
	return best;
}

/* What a terminal can show. */
static int is_plain(const char *name)
{
	while (*name > ' ' && *name < 0x7F) {
		name++;
	}
	return !*name;
}

static int is_known(char name[BUS_IFACES_MAX][BUS_NAME_MAX], int n, const char *want)
{
	while (n > 0 && strcmp(name[n - 1], want)) {
		n--;
	}
	return n > 0;
}

int census_interfaces(const char *path, char name[BUS_IFACES_MAX][BUS_NAME_MAX], int n)
{
	char line[LINE_BYTES], iface[BUS_NAME_MAX];
	struct bus_frame f;
	struct stat st;
	FILE *in = stat(path, &st) || !S_ISREG(st.st_mode) ? NULL : fopen(path, "r");

	while (in && n < BUS_IFACES_MAX && fgets(line, sizeof(line), in)) {
		line[strcspn(line, "\n")] = '\0';
		if (!bus_log_parse(line, iface, &f) && is_plain(iface) &&
		    !is_known(name, n, iface)) {
			memcpy(name[n++], iface, sizeof(iface));
		}
	}
	if (in) {
		fclose(in);
	}
	return n;
}
