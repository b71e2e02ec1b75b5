/* SPDX-License-Identifier: MIT
 * What this binary was made from: commit, compiler, CUDA, contract. The Makefile writes the first three.
 */
#ifndef AEBMC_BUILD_INFO_H
#define AEBMC_BUILD_INFO_H

#include <stdio.h>

/** build_info_print - "NAME RELEASE", then one line each for commit, compiler, CUDA and the hash of the bus contract. */
void build_info_print(const char *name, FILE *out);

#endif
