/* SPDX-License-Identifier: MIT
 * The three standard streams as a program may expect them.
 */
#include "streams.h"
#include <fcntl.h>
#include <unistd.h>

void streams_ensure(void)
{
	/* Opened the wrong way round, so that using one is an error and nothing is lost in silence. */
	static const int mode[] = {O_WRONLY, O_RDONLY, O_WRONLY};

	for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++) {
		if (fcntl(fd, F_GETFD) < 0) {
			(void)!open("/dev/null", mode[fd]); /* the lowest one free is this */
		}
	}
}
