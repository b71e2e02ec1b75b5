/* SPDX-License-Identifier: MIT
 * What belongs to the running program and lies beside it: in the tree that it was built in, or where it is installed.
 */
#ifndef AEBMC_PROGRAM_H
#define AEBMC_PROGRAM_H

#include <limits.h>
#include <stddef.h>

/**
 * program_file - the first of the folders @place[@n] that has a file @name
 * @place: from the running program's own folder, "" or with '/' at its end
 * @path:  receives where the file is, absolute; where none has it, the last that was tried
 * Returns 0, -ENOENT where none has it, or -errno of asking where the program is. Blocks for a few system calls.
 */
int program_file(const char *const *place, size_t n, const char *name, char path[PATH_MAX]);

#endif
