/* SPDX-License-Identifier: MIT
 * The folder of the running program, and files beside it. See program.h.
 */
#include "program.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int own_folder(char path[PATH_MAX])
{
	const ssize_t n = readlink("/proc/self/exe", path, PATH_MAX - 1);

	if (n < 0) {
		return -errno;
	}
	path[n] = '\0';
	strrchr(path, '/')[1] = '\0';
	return 0;
}

int program_file(const char *const *place, size_t n, const char *name, char path[PATH_MAX])
{
	char folder[PATH_MAX];
	const int error = own_folder(folder);

	for (size_t i = 0; i < n && !error; i++) {
		const int length = snprintf(path, PATH_MAX, "%s%s%s", folder, place[i], name);

		if (length < PATH_MAX && !access(path, F_OK)) {
			return 0;
		}
	}
	return error ? error : -ENOENT;
}
