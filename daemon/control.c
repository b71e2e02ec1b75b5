/* SPDX-License-Identifier: MIT
 * Lines in, lines out over a local socket, without ever waiting. See control.h.
 */
#include "control.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define CLIENTS_MAX 8

struct client {
	int fd; /* -1: free */
	size_t len;
	char line[CONTROL_LINE_MAX];
};

struct control {
	int listen_fd, epoll_fd;
	control_answer *answer;
	void *arg;
	struct sockaddr_un addr;
	struct client client[CLIENTS_MAX];
	char reply[CONTROL_REPLY_MAX];
};

/* A socket left behind refuses connections; one that is listened to accepts them. */
static int somebody_listens(const struct sockaddr_un *addr)
{
	const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	const int alive = fd >= 0 && connect(fd, (const struct sockaddr *)addr, sizeof(*addr)) == 0;

	if (fd >= 0) {
		close(fd);
	}
	return alive;
}

static int start_listening(struct control *c)
{
	struct epoll_event ev = {.events = EPOLLIN, .data.ptr = NULL};
	struct stat st;

	if (somebody_listens(&c->addr)) {
		return -EADDRINUSE;
	}
	if (!stat(c->addr.sun_path, &st)) {
		if (!S_ISSOCK(st.st_mode)) {
			return -EEXIST;
		}
		unlink(c->addr.sun_path);
	}
	c->listen_fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	c->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	if (c->listen_fd < 0 || c->epoll_fd < 0 ||
	    bind(c->listen_fd, (struct sockaddr *)&c->addr, sizeof(c->addr)) ||
	    listen(c->listen_fd, CLIENTS_MAX) ||
	    epoll_ctl(c->epoll_fd, EPOLL_CTL_ADD, c->listen_fd, &ev)) {
		return -errno;
	}
	return 0;
}

static const char *why_not(int status)
{
	return status == -EADDRINUSE ? "another aebmcd serves it: stop it, or use another name"
	       : status == -EEXIST   ? "there is a file that is no socket: use another name"
				     : strerror(-status);
}

int control_open(const char *path, control_answer *answer, void *arg, struct control **ret,
		 char *err, int err_len)
{
	struct control *c = calloc(1, sizeof(*c));
	int status = c ? 0 : -ENOMEM;

	if (c) {
		c->listen_fd = c->epoll_fd = -1;
		c->answer = answer;
		c->arg = arg;
		c->addr.sun_family = AF_UNIX;
		for (int i = 0; i < CLIENTS_MAX; i++) {
			c->client[i].fd = -1;
		}
		status = strlen(path) < sizeof(c->addr.sun_path) ? 0 : -ENAMETOOLONG;
	}
	if (!status) {
		memcpy(c->addr.sun_path, path, strlen(path) + 1);
		status = start_listening(c);
	}
	if (status) {
		snprintf(err, (size_t)err_len, "status socket %s: %s", path, why_not(status));
		if (status == -EADDRINUSE || status == -EEXIST) {
			c->addr.sun_path[0] = '\0'; /* not ours to remove */
		}
		control_close(c);
		return status;
	}
	*ret = c;
	return 0;
}

int control_fd(const struct control *c)
{
	return c->epoll_fd;
}

static void drop(struct client *k)
{
	close(k->fd);
	k->fd = -1;
	k->len = 0;
}

static void accept_clients(struct control *c)
{
	int fd;

	while ((fd = accept4(c->listen_fd, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0) {
		struct client *k = NULL;

		for (int i = 0; i < CLIENTS_MAX && !k; i++) {
			k = c->client[i].fd < 0 ? &c->client[i] : NULL;
		}
		struct epoll_event ev = {.events = EPOLLIN | EPOLLRDHUP, .data.ptr = k};

		if (!k || epoll_ctl(c->epoll_fd, EPOLL_CTL_ADD, fd, &ev)) {
			close(fd);
			continue;
		}
		k->fd = fd;
		k->len = 0;
	}
}

/* A client whose socket buffer is full has stopped reading. */
static int answer_line(struct control *c, struct client *k)
{
	size_t len;

	c->reply[0] = '\0';
	c->answer(c->arg, k->line, c->reply, sizeof(c->reply) - 1);
	len = strlen(c->reply);
	c->reply[len++] = '\n';
	return send(k->fd, c->reply, len, MSG_NOSIGNAL | MSG_DONTWAIT) == (ssize_t)len;
}

/* One character at a time: lines are short and rare. Returns 0 to drop the client. */
static int take(struct control *c, struct client *k, char ch)
{
	if (ch == '\n') {
		k->line[k->len] = '\0';
		k->len = 0;
		return answer_line(c, k);
	}
	if (ch == '\0' || k->len + 1 >= sizeof(k->line)) {
		return 0;
	}
	k->line[k->len++] = ch;
	return 1;
}

static void read_client(struct control *c, struct client *k)
{
	char buf[256];
	const ssize_t n = recv(k->fd, buf, sizeof(buf), MSG_DONTWAIT);

	if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) {
		drop(k);
		return;
	}
	for (ssize_t i = 0; i < n; i++) {
		if (!take(c, k, buf[i])) {
			drop(k);
			return;
		}
	}
}

void control_serve(struct control *c)
{
	struct epoll_event ev[CLIENTS_MAX + 1];
	const int n = epoll_wait(c->epoll_fd, ev, CLIENTS_MAX + 1, 0);

	for (int i = 0; i < n; i++) {
		struct client *k = ev[i].data.ptr;

		if (!k) {
			accept_clients(c);
		} else if (k->fd >= 0) {
			read_client(c, k);
		}
	}
}

void control_close(struct control *c)
{
	if (!c) {
		return;
	}
	for (int i = 0; i < CLIENTS_MAX; i++) {
		if (c->client[i].fd >= 0) {
			close(c->client[i].fd);
		}
	}
	if (c->listen_fd >= 0) {
		close(c->listen_fd);
		unlink(c->addr.sun_path);
	}
	if (c->epoll_fd >= 0) {
		close(c->epoll_fd);
	}
	free(c);
}
