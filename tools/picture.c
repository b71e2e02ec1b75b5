/* SPDX-License-Identifier: MIT
 * A picture into a file. See picture.h.
 */
#include "picture.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include "cli.h"

#define ZOOM "2" /* PNG pixels for one of SVG's */

extern char **environ;

static int is_png(const char *path)
{
	const size_t n = strlen(path);

	return n > 4 && !strcmp(path + n - 4, ".png");
}

static int write_svg(const char *name, const char *path, void (*draw)(FILE *out, const void *arg),
		     const void *arg)
{
	FILE *f = cli_create(name, path);

	if (!f) {
		return CLI_FAILED;
	}
	draw(f, arg);
	return cli_close(name, path, f);
}

/* ---- PNG --------------------------------------------------------------------------------------- */

/* rsvg-convert between two pipes. Returns 0 or an error as of posix_spawn. */
static int start(pid_t *pid, int *to, int *from)
{
	static char program[] = "rsvg-convert", zoom[] = "--zoom=" ZOOM;
	char *const argv[] = {program, zoom, NULL};
	posix_spawn_file_actions_t fa;
	int in[2] = {-1, -1}, out[2] = {-1, -1};
	int error = pipe2(in, O_CLOEXEC) || pipe2(out, O_CLOEXEC) ? errno : 0;

	posix_spawn_file_actions_init(&fa);
	posix_spawn_file_actions_adddup2(&fa, in[0], STDIN_FILENO);
	posix_spawn_file_actions_adddup2(&fa, out[1], STDOUT_FILENO);
	error = error ? error : posix_spawnp(pid, program, &fa, NULL, argv, environ);
	posix_spawn_file_actions_destroy(&fa);
	close(in[0]);
	close(out[1]);
	*to = in[1];
	*from = out[0];
	return error;
}

/* Returns 0 or -errno of what failed first: reading, or writing in the midst of it. */
static int copy(int from, FILE *out)
{
	char part[65536];
	ssize_t n;

	while ((n = read(from, part, sizeof(part))) > 0 || (n < 0 && errno == EINTR)) {
		if (n > 0 && fwrite(part, 1, (size_t)n, out) < (size_t)n) {
			return -errno;
		}
	}
	return n < 0 ? -errno : 0;
}

/* It reads all of its input before it writes, so neither waits for the other. */
static int convert(const char *name, const char *path, pid_t pid, int from)
{
	FILE *f = cli_create(name, path);
	const int error = f ? copy(from, f) : 0;
	int status = -1, code = CLI_FAILED;

	if (!f || error) {
		kill(pid, SIGKILL); /* it would complain, too */
	}
	if (error) {
		cli_error(CLI_FAILED, name, "%s: %s", path, strerror(-error));
		fclose(f);
	} else if (f) {
		code = cli_close(name, path, f);
	}
	close(from);
	waitpid(pid, &status, 0);
	return code || !status ? code
			       : cli_error(CLI_FAILED, name, "%s: rsvg-convert failed", path);
}

static int write_png(const char *name, const char *path, void (*draw)(FILE *out, const void *arg),
		     const void *arg)
{
	int to, from;
	pid_t pid;
	const int error = start(&pid, &to, &from);

	if (error) {
		close(to);
		close(from);
		return error == ENOENT
			       ? cli_error(CLI_SKIPPED, name,
					   "%s: PNG needs rsvg-convert (apt-get install "
					   "librsvg2-bin); SVG needs nothing",
					   path)
			       : cli_error(CLI_FAILED, name, "rsvg-convert: %s", strerror(error));
	}
	FILE *f = fdopen(to, "w");

	if (f) {
		draw(f, arg);
		fclose(f); /* what it missed shows in its exit code */
	} else {
		close(to);
	}
	return convert(name, path, pid, from);
}

int picture_write(const char *name, const char *path, void (*draw)(FILE *out, const void *arg),
		  const void *arg)
{
	return is_png(path) ? write_png(name, path, draw, arg) : write_svg(name, path, draw, arg);
}
