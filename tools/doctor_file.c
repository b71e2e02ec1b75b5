/* SPDX-License-Identifier: MIT
 * Files below a root, as aebmc doctor reads them. See doctor_file.h.
 */
#include "doctor_file.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include "text.h"

extern char **environ;

static FILE *open_below(const char *root, const char *path)
{
	char full[PATH_MAX];

	snprintf(full, sizeof(full), "%s%s", root, path);
	return fopen(full, "re");
}

int doctor_file_there(const char *root, const char *path)
{
	char full[PATH_MAX];

	snprintf(full, sizeof(full), "%s%s", root, path);
	return !access(full, F_OK);
}

int doctor_file_line(const char *root, const char *path, const char *start,
		     char line[DOCTOR_LINE_MAX])
{
	FILE *f = open_below(root, path);
	int ret = f ? -ENOENT : -errno;

	while (f && ret && fgets(line, DOCTOR_LINE_MAX, f)) {
		ret = strncmp(line, start, strlen(start)) ? -ENOENT : 0;
	}
	if (f) {
		fclose(f);
	}
	if (ret) {
		return ret;
	}
	line[strcspn(line, "\n")] = '\0';
	return 0;
}

/* Closes @f; NULL holds nothing. */
static int holds(FILE *f, const char *part)
{
	char line[DOCTOR_LINE_MAX];
	int found = 0;

	while (f && fgets(line, sizeof(line), f)) {
		found |= strstr(line, part) != NULL;
	}
	if (f) {
		fclose(f);
	}
	return found;
}

int doctor_file_holds(const char *root, const char *path, const char *part)
{
	return holds(open_below(root, path), part);
}

int doctor_file_gz_holds(const char *root, const char *path, const char *part)
{
	static char program[] = "zcat";
	char *const argv[] = {program, NULL};
	posix_spawn_file_actions_t fa;
	char full[PATH_MAX];
	int out[2], found = 0;
	pid_t pid;

	if (pipe2(out, O_CLOEXEC)) {
		return 0;
	}
	snprintf(full, sizeof(full), "%s%s", root, path);
	posix_spawn_file_actions_init(&fa);
	posix_spawn_file_actions_addopen(&fa, STDIN_FILENO, full, O_RDONLY, 0);
	posix_spawn_file_actions_adddup2(&fa, out[1], STDOUT_FILENO);
	const int error = posix_spawnp(&pid, program, &fa, NULL, argv, environ);

	posix_spawn_file_actions_destroy(&fa);
	close(out[1]);
	found = holds(fdopen(out[0], "r"), part);
	if (!error) {
		waitpid(pid, NULL, 0);
	}
	return found;
}

int doctor_file_number(const char *root, const char *path, int64_t *ret)
{
	char line[DOCTOR_LINE_MAX];
	const int error = doctor_file_line(root, path, "", line);

	return error ? error : text_integer(line, ret);
}

size_t doctor_file_glob(const char *root, const char *pattern, glob_t *found)
{
	char full[PATH_MAX];

	snprintf(full, sizeof(full), "%s%s", root, pattern);
	return glob(full, 0, NULL, found) ? 0 : found->gl_pathc;
}

cpu_set_t doctor_file_cpus(const char *list)
{
	cpu_set_t set;

	CPU_ZERO(&set);
	while (*list >= '0' && *list <= '9') {
		char *end;
		unsigned long first = strtoul(list, &end, 10);
		unsigned long last = *end == '-' ? strtoul(end + 1, &end, 10) : first;

		for (; first <= last && first < CPU_SETSIZE; first++) {
			CPU_SET(first, &set);
		}
		list = end + (*end == ',');
	}
	return set;
}
