/* SPDX-License-Identifier: MIT
 * 64-bit FNV-1a over values, byte by byte with the lowest first: the same on any machine.
 */
#ifndef AEBMC_HASH_H
#define AEBMC_HASH_H

#include <stdint.h>
#include <string.h>

#define HASH_START 0xCBF29CE484222325u

/** hash_u64 - @h continued by a number. */
static inline uint64_t hash_u64(uint64_t h, uint64_t value)
{
	for (int i = 0; i < 64; i += 8) {
		h = (h ^ (value >> i & 0xFF)) * 0x100000001B3u;
	}
	return h;
}

/** hash_f64 - @h continued by the bits of @value; -0 counts as 0. */
static inline uint64_t hash_f64(uint64_t h, double value)
{
	uint64_t bits;

	value += 0.0;
	memcpy(&bits, &value, sizeof(bits));
	return hash_u64(h, bits);
}

/** hash_text - @h continued by a string and its end. */
static inline uint64_t hash_text(uint64_t h, const char *text)
{
	do {
		h = (h ^ (unsigned char)*text) * 0x100000001B3u;
	} while (*text++);
	return h;
}

#endif
