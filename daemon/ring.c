/* SPDX-License-Identifier: MIT
 * A ring of words with a sequence number per entry. See ring.h.
 */
#include "ring.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct ring {
	uint64_t end;          /* atomic */
	uint32_t count, words; /* words of payload; a slot has one more, its sequence number */
	uint64_t slot[];
};

static uint64_t *slot_of(const struct ring *r, uint64_t i)
{
	return (uint64_t *)&r->slot[(i & (r->count - 1)) * (r->words + 1)];
}

int ring_open(uint32_t count, uint32_t bytes, struct ring **ret)
{
	const uint32_t words = bytes / 8;
	struct ring *r;
	size_t size;

	if (!count || (count & (count - 1)) || !words || bytes % 8) {
		return -EINVAL;
	}
	size = sizeof(*r) + (size_t)count * (words + 1) * 8;
	r = malloc(size);
	if (!r) {
		return -ENOMEM;
	}
	memset(r, 0, size); /* resident before anything is real-time */
	r->count = count;
	r->words = words;
	*ret = r;
	return 0;
}

/* Sequence 0 while the payload changes, i + 1 once it is whole. */
void ring_put(struct ring *r, const void *entry)
{
	const uint64_t i = r->end;
	uint64_t *s = slot_of(r, i);
	uint64_t w;

	__atomic_exchange_n(&s[0], 0, __ATOMIC_ACQ_REL); /* acquire: what follows stays behind it */
	for (uint32_t k = 0; k < r->words; k++) {
		memcpy(&w, (const char *)entry + 8 * k, 8);
		__atomic_store_n(&s[1 + k], w, __ATOMIC_RELEASE);
	}
	__atomic_store_n(&s[0], i + 1, __ATOMIC_RELEASE);
	__atomic_store_n(&r->end, i + 1, __ATOMIC_RELEASE);
}

uint64_t ring_end(const struct ring *r)
{
	return __atomic_load_n(&r->end, __ATOMIC_ACQUIRE);
}

uint64_t ring_begin(const struct ring *r)
{
	const uint64_t end = ring_end(r);

	return end > r->count ? end - r->count : 0;
}

int ring_get(const struct ring *r, uint64_t i, void *entry)
{
	const uint64_t *s = slot_of(r, i);
	uint64_t w;

	if (__atomic_load_n(&s[0], __ATOMIC_ACQUIRE) != i + 1) {
		return -ENOENT;
	}
	for (uint32_t k = 0; k < r->words; k++) {
		w = __atomic_load_n(&s[1 + k], __ATOMIC_ACQUIRE);
		memcpy((char *)entry + 8 * k, &w, 8);
	}
	return __atomic_load_n(&s[0], __ATOMIC_RELAXED) == i + 1 ? 0 : -ENOENT;
}

void ring_close(struct ring *r)
{
	free(r);
}
