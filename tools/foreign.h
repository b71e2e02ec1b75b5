/* SPDX-License-Identifier: MIT
 * Logs that are no candump logs.
 */
#ifndef AEBMC_FOREIGN_H
#define AEBMC_FOREIGN_H

/**
 * foreign_log - the one line on a log in which no frame was found
 * Says what a file of another logger looks like by its beginning, and how it is converted. Blocks on the file system.
 * Returns CLI_FAILED.
 */
int foreign_log(const char *name, const char *path);

#endif
