/* SPDX-License-Identifier: MIT
 * One command to the status socket of a running aebmcd, one line back. See ask.h.
 */
#include "ask.h"
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>
#include "cli.h"
#include "json_path.h"

#define SOCKETS "/run/aebmc/%s/status.sock"
#define WAIT_S  2

enum { KEY_SOCKET = 0x280 };

static const struct argp_option options[] = {
	{"socket", KEY_SOCKET, "PATH", 0,
	 "status socket (default: that of aebmcd@NAME, or of the only one that runs)", 5},
	{0},
};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct ask_args *a = st->input;

	switch (key) {
	case KEY_SOCKET:
		a->path = arg;
		return 0;
	case ARGP_KEY_ARG:
		if (a->name) {
			return cli_bad(st, "'%s': one NAME at a time", arg);
		}
		a->name = arg;
		return 0;
	case ARGP_KEY_END:
		return a->name && a->path ? cli_bad(st, "NAME or --socket, not both") : 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

const struct argp ask_argp = {options, parse, NULL, NULL, NULL, NULL, NULL};

static int only_socket(const char *who, char *path, size_t size)
{
	glob_t found;
	char pattern[64];
	int code = 0;

	snprintf(pattern, sizeof(pattern), SOCKETS, "*");
	if (glob(pattern, 0, NULL, &found)) {
		return cli_error(CLI_FAILED, who, "no aebmcd runs (nothing in /run/aebmc)");
	}
	if (found.gl_pathc > 1) {
		code = cli_error(CLI_USAGE, who, "which NAME? %zu daemons run: ls /run/aebmc",
				 found.gl_pathc);
	} else {
		snprintf(path, size, "%s", found.gl_pathv[0]);
	}
	globfree(&found);
	return code;
}

static int find_socket(const char *who, const struct ask_args *a, char *path, size_t size)
{
	int len;

	if (!a->path && !a->name) {
		return only_socket(who, path, size);
	}
	len = a->path ? snprintf(path, size, "%s", a->path)
		      : snprintf(path, size, SOCKETS, a->name);
	return len < (int)size ? 0 : cli_error(CLI_USAGE, who, "the socket's path is too long");
}

int ask_open(const char *who, const struct ask_args *a, struct ask *ret)
{
	const struct timeval wait = {.tv_sec = WAIT_S};
	struct sockaddr_un addr = {.sun_family = AF_UNIX};
	int code = find_socket(who, a, addr.sun_path, sizeof(addr.sun_path));

	if (code) {
		return code;
	}
	ret->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (ret->fd < 0 || setsockopt(ret->fd, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait)) ||
	    setsockopt(ret->fd, SOL_SOCKET, SO_SNDTIMEO, &wait, sizeof(wait)) ||
	    connect(ret->fd, (const struct sockaddr *)&addr, sizeof(addr))) {
		code = cli_error(CLI_FAILED, who, "%s: %s", addr.sun_path, strerror(errno));
		ask_close(ret);
	}
	return code;
}

/* A line that does not end is no answer. */
static int receive(struct ask *a)
{
	size_t n = 0;

	while (n < sizeof(a->reply)) {
		const ssize_t got = recv(a->fd, a->reply + n, sizeof(a->reply) - n, 0);

		if (got < 0 && errno == EINTR) {
			continue; /* Ctrl-C: this answer is still wanted */
		}
		if (got <= 0) {
			return got ? -errno : -ECONNRESET;
		}
		n += (size_t)got;
		if (a->reply[n - 1] == '\n') {
			a->reply[n - 1] = '\0';
			return 0;
		}
	}
	return -EMSGSIZE;
}

int ask(const char *who, struct ask *a, const char *command)
{
	char line[CONTROL_LINE_MAX], why[256];
	const int len = snprintf(line, sizeof(line), "%s\n", command);
	int error = send(a->fd, line, (size_t)len, MSG_NOSIGNAL) == len ? receive(a) : -errno;

	if (error) {
		return cli_error(CLI_FAILED, who, "aebmcd does not answer: %s",
				 error == -EAGAIN ? "nothing for 2 s" : strerror(-error));
	}
	if (!json_path_text(a->reply, "error", why, sizeof(why))) {
		return cli_error(CLI_FAILED, who, "%s", why);
	}
	return 0;
}

void ask_close(struct ask *a)
{
	if (a->fd >= 0) {
		close(a->fd);
	}
	a->fd = -1;
}
