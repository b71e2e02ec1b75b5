/* SPDX-License-Identifier: MIT
 * Mutations of files, the same each time: bits, digits, pieces out, in and elsewhere, a cut. How many are tried is for the
 * environment to say (FUZZ_INPUTS, `make fuzz`).
 */
#ifndef AEBMC_TEST_FUZZ_H
#define AEBMC_TEST_FUZZ_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FUZZ_TEXT_MAX (1 << 16)

struct fuzz {
	uint64_t seed;
	const char *const *pieces; /* what such files are made of, and what they should not be */
	uint32_t n_pieces;
};

static inline uint32_t fuzz_pick(struct fuzz *z, uint32_t n)
{
	z->seed = z->seed * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)((z->seed >> 33) % n);
}

/* fuzz_inputs - how many in all, for one of @parts that share them */
static inline uint32_t fuzz_inputs(uint32_t usual, uint32_t parts)
{
	const char *wanted = getenv("FUZZ_INPUTS");

	return (wanted ? (uint32_t)strtoul(wanted, NULL, 10) : usual) / parts;
}

/* fuzz_read - a whole file into @text; its length */
static inline size_t fuzz_read(const char *path, char text[FUZZ_TEXT_MAX])
{
	FILE *f = fopen(path, "r");
	size_t n;

	assert_non_null(f);
	n = fread(text, 1, FUZZ_TEXT_MAX / 2, f);
	fclose(f);
	return n;
}

/* Replaces @old bytes at @at by @new ones. */
static inline size_t fuzz_splice(char *text, size_t len, size_t at, size_t old, const char *bytes,
				 size_t new)
{
	memmove(text + at + new, text + at + old, len - at - old);
	memcpy(text + at, bytes, new);
	return len - old + new;
}

static inline size_t fuzz_once(struct fuzz *z, char *text, size_t len)
{
	char copy[64];
	size_t at = fuzz_pick(z, (uint32_t)len), rest = len - at;
	size_t some = 1 + fuzz_pick(z, rest < sizeof(copy) ? (uint32_t)rest : sizeof(copy));
	const char *piece = z->pieces[fuzz_pick(z, z->n_pieces)];

	some = some < rest ? some : rest;
	switch (fuzz_pick(z, 6)) {
	case 0: /* flip a bit */
		text[at] ^= (char)(1 << fuzz_pick(z, 8));
		return len;
	case 1: /* another digit, where there is one nearby */
		at += strcspn(text + at, "0123456789");
		if (at < len) {
			text[at] = (char)('0' + fuzz_pick(z, 10));
		}
		return len;
	case 2: /* remove */
		return fuzz_splice(text, len, at, some, "", 0);
	case 3: /* repeat elsewhere */
		memcpy(copy, text + at, some);
		return fuzz_splice(text, len, fuzz_pick(z, (uint32_t)len), 0, copy, some);
	case 4: /* insert or replace by a piece */
		return fuzz_splice(text, len, at, fuzz_pick(z, 2) ? some : 0, piece, strlen(piece));
	default: /* cut off */
		return fuzz_pick(z, 8) ? len : at + 1;
	}
}

/* fuzz_mutate - 1 to @most mutations of @text, which has room for FUZZ_TEXT_MAX; the new length */
static inline size_t fuzz_mutate(struct fuzz *z, char *text, size_t len, uint32_t most)
{
	for (uint32_t k = 1 + fuzz_pick(z, most); k && len; k--) {
		text[len] = 0;
		len = fuzz_once(z, text, len);
	}
	return len;
}

#endif
