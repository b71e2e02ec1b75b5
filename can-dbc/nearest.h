/* SPDX-License-Identifier: MIT
 * The nearest valid name for one that is not: for error lines that say what was probably meant.
 */
#ifndef AEBMC_NEAREST_H
#define AEBMC_NEAREST_H

#define NEAREST_LEN 64 /* longer names are compared by their first 64 characters */

/* Offer every valid name in turn; the first of the nearest stays. Start with { .want = name }. */
struct nearest {
	const char *want;
	const char *best; /* NULL until a name was offered; not copied */
	int distance;     /* edits from want to best */
};

/** nearest_distance - edits (insert, delete, replace) from @a to @b, letter case ignored. Pure. */
int nearest_distance(const char *a, const char *b);

/** nearest_offer - keep @name if it is nearer than the best so far. Does not allocate; NULL is ignored. */
void nearest_offer(struct nearest *n, const char *name);

#endif
