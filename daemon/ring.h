/* SPDX-License-Identifier: MIT
 * A preallocated ring that one thread writes without ever waiting and another reads while it is overwritten.
 * Entries are words, copied atomically word by word and guarded by a sequence number, so a reader gets a whole entry
 * or learns that it is gone. For the event recorder.
 */
#ifndef AEBMC_RING_H
#define AEBMC_RING_H

#include <stddef.h>
#include <stdint.h>

struct ring;

/** ring_open - @count entries (a power of two) of @bytes each (a multiple of 8). Allocates and touches all. 0, -EINVAL,
 * -ENOMEM. */
int ring_open(uint32_t count, uint32_t bytes, struct ring **ret);

/** ring_put - write the next entry, over the oldest one. Writer only; never waits, never fails. */
void ring_put(struct ring *r, const void *entry);

/** ring_end - number of entries ever written; the newest is ring_end() - 1. Any thread. */
uint64_t ring_end(const struct ring *r);

/** ring_begin - the oldest number that may still be there. Any thread. */
uint64_t ring_begin(const struct ring *r);

/** ring_get - copy entry number @i. 0, or -ENOENT if it was overwritten or not written yet. Any thread. */
int ring_get(const struct ring *r, uint64_t i, void *entry);

void ring_close(struct ring *r); /* NULL is fine */

#endif
