/* SPDX-License-Identifier: MIT
 * The three standard streams as a program may expect them: open, whoever started it.
 */
#ifndef AEBMC_STREAMS_H
#define AEBMC_STREAMS_H

/**
 * streams_ensure - gives each of descriptors 0 to 2 that is closed to /dev/null, before any file can get it
 * Reading such an input and writing to such an output fails with EBADF; what goes to such an error stream is lost.
 */
void streams_ensure(void);

#endif
