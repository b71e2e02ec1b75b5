/* SPDX-License-Identifier: MIT
 * How alike two names are, for error messages that name the nearest valid one.
 */
#ifndef AEBMC_NEAREST_H
#define AEBMC_NEAREST_H

#define NEAREST_LEN 128 /* characters compared; what is beyond is ignored */

/** nearest_distance - edits (insert, delete, replace) that turn @a into @b, ignoring case. Pure; no allocation. */
unsigned nearest_distance(const char *a, const char *b);

#endif
