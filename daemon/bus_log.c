/* SPDX-License-Identifier: MIT
 * The bus as a candump log: lines in and out (bus_log_line.c), and virtual time that runs from stamp to stamp.
 * Knows no clock, message or signal.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "bus.h"
#include "clock.h"

#define LOG_LINE_MAX   65536                 /* no candump line exceeds 200 bytes */
#define LOG_STEP_BACK  CLOCK_NS_PER_S        /* beyond these the recorder's clock was set, */
#define LOG_STEP_AHEAD (60 * CLOCK_NS_PER_S) /* no time passed on the bus */

struct bus_log {
	struct bus bus;
	struct bus_stats stats;
	int in, out;     /* ours to close; -1: none */
	int write_error; /* the first one */
	int n_ifaces;
	char iface[BUS_IFACES_MAX][BUS_NAME_MAX];
	int64_t total, consumed; /* bytes of the input */
	int64_t last_ns, shift_ns;
	int started, have_next, at_end, skipping;
	struct bus_frame next;
	int head, fill;
	char buf[LOG_LINE_MAX];
};

/* ---- lines from the input ------------------------------------------------------------------- */

static struct bus_log *log_of(struct bus *b)
{
	return (struct bus_log *)b; /* the first member */
}

/* One more read into the buffer. 1, 0 at the end, -errno; -EINTR is the caller's to judge. */
static int refill(struct bus_log *l)
{
	ssize_t n;

	memmove(l->buf, l->buf + l->head, (size_t)(l->fill - l->head));
	l->fill -= l->head;
	l->head = 0;
	n = read(l->in, l->buf + l->fill, (size_t)(LOG_LINE_MAX - 1 - l->fill));
	if (n < 0) {
		return -errno;
	}
	l->fill += (int)n;
	l->consumed += n;
	return n > 0;
}

/* The next line of the buffer, ended by NUL, which may be the last one without newline. NULL: none is complete. */
static char *take_line(struct bus_log *l, int *len)
{
	char *line = l->buf + l->head;
	const char *nl = memchr(line, '\n', (size_t)(l->fill - l->head));

	if (!nl && (!l->at_end || l->head == l->fill)) {
		return NULL;
	}
	*len = (int)((nl ? nl : l->buf + l->fill) - line);
	line[*len] = '\0';
	l->head += *len + (nl != NULL);
	return line;
}

/* A line longer than the buffer is dropped piece by piece; its last piece ends the skipping. */
static int next_line(struct bus_log *l, char **line, int *len)
{
	for (;;) {
		*line = take_line(l, len);
		if (*line && l->skipping) {
			l->skipping = 0;
			continue;
		}
		if (*line) {
			return 0;
		}
		if (l->at_end) {
			return -ENODATA;
		}
		if (l->head == 0 && l->fill == LOG_LINE_MAX - 1) {
			l->stats.malformed += !l->skipping;
			l->skipping = 1;
			l->head = l->fill;
		}
		int ret = refill(l);

		if (ret < 0) {
			return ret;
		}
		l->at_end = ret == 0;
	}
}

/* Stamps to virtual time: it never runs backwards, and a clock that was set leaves no hole. */
static int64_t virtual_time(struct bus_log *l, int64_t stamp_ns)
{
	int64_t t = stamp_ns + l->shift_ns;

	if (l->started && (t < l->last_ns - LOG_STEP_BACK || t > l->last_ns + LOG_STEP_AHEAD)) {
		l->shift_ns += l->last_ns - t;
		l->stats.disorder++;
		t = l->last_ns;
	} else if (l->started && t < l->last_ns) {
		l->stats.disorder++;
		t = l->last_ns;
	}
	return t;
}

/* -1: not among ours. */
static int find_iface(const struct bus_log *l, const char *name)
{
	int i = l->n_ifaces;

	do {
		i--;
	} while (i >= 0 && strcmp(l->iface[i], name) != 0);
	return i;
}

/* A line's frame to l->next if it is one for us. */
static void take_frame(struct bus_log *l, const char *line, int len)
{
	char name[BUS_NAME_MAX];
	int ret = memchr(line, '\0', (size_t)len) ? -EBADMSG : bus_log_parse(line, name, &l->next);

	if (ret) {
		l->stats.malformed += ret == -EBADMSG;
		return;
	}
	int iface = find_iface(l, name);

	if (iface < 0) {
		l->stats.other_iface++;
		return;
	}
	l->next.iface = (uint8_t)iface;
	l->next.t_ns = virtual_time(l, l->next.t_ns);
	l->have_next = 1;
}

/* Fills l->next. 0, -ENODATA, -errno. */
static int peek(struct bus_log *l)
{
	while (!l->have_next) {
		char *line;
		int len;
		int ret = next_line(l, &line, &len);

		if (ret) {
			return ret;
		}
		take_frame(l, line, len);
	}
	return 0;
}

/* ---- the bus -------------------------------------------------------------------------------- */

static int log_recv(struct bus *b, struct bus_frame *f, int max, int64_t until_ns, int64_t *now_ns)
{
	struct bus_log *l = log_of(b);
	int ret = l->write_error ? l->write_error : peek(l);
	int n = 0;

	if (ret) {
		*now_ns = l->started ? l->last_ns : *now_ns;
		return ret;
	}
	if (l->started && l->next.t_ns > until_ns) {
		l->last_ns = until_ns > l->last_ns ? until_ns : l->last_ns;
		*now_ns = l->last_ns;
		return 0;
	}
	l->started = 1;
	l->last_ns = l->next.t_ns;
	while (n < max && peek(l) == 0 && l->next.t_ns == l->last_ns) {
		l->stats.received++;
		l->stats.error_frames += (l->next.flags & BUS_ERR) != 0;
		l->stats.remote_frames += (l->next.flags & BUS_RTR) != 0;
		l->have_next = 0;
		f[n++] = l->next;
	}
	*now_ns = l->last_ns;
	return n;
}

static int write_line(struct bus_log *l, const char *line, int len)
{
	int done = 0;

	while (l->out >= 0 && done < len) {
		ssize_t n = write(l->out, line + done, (size_t)(len - done));

		if (n >= 0) {
			done += (int)n;
		} else if (errno != EINTR) {
			return -errno;
		}
	}
	return 0;
}

static int log_send(struct bus *b, const struct bus_frame *f)
{
	struct bus_log *l = log_of(b);
	char line[256];
	int len, error;

	if (f->iface >= l->n_ifaces) {
		return -ENODEV;
	}
	len = bus_log_format(f, l->iface[f->iface], line, sizeof(line) - 1);
	line[len++] = '\n';
	error = write_line(l, line, len);
	l->write_error = l->write_error ? l->write_error : error;
	l->stats.sent += !error;
	return error;
}

int bus_log_finish(struct bus *b)
{
	struct bus_log *l = log_of(b);

	if (l->out >= 0 && close(l->out) != 0 && !l->write_error) {
		l->write_error = -errno;
	}
	l->out = -1;
	return l->write_error;
}

static const struct bus_stats *log_stats(const struct bus *b)
{
	return &((const struct bus_log *)b)->stats;
}

static void log_close(struct bus *b)
{
	struct bus_log *l = log_of(b);

	if (!l) {
		return;
	}
	close(l->in);
	bus_log_finish(b);
	free(l);
}

static const struct bus_ops log_ops = {
	.name = "log",
	.recv = log_recv,
	.send = log_send,
	.stats = log_stats,
	.close = log_close,
};

/* ---- open ----------------------------------------------------------------------------------- */

__attribute__((format(printf, 4, 5))) static int refuse(char *err, int err_len, int error,
							const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	vsnprintf(err, (size_t)err_len, format, ap);
	va_end(ap);
	return error;
}

static int open_in(struct bus_log *l, const char *path, char *err, int err_len)
{
	struct stat st;

	l->in = strcmp(path, "-") == 0 ? dup(STDIN_FILENO) : open(path, O_RDONLY | O_CLOEXEC);
	if (l->in < 0 || fstat(l->in, &st) != 0) {
		return refuse(err, err_len, -errno,
			      "%s: cannot read: %s; give a log written by candump -L, or -", path,
			      strerror(errno));
	}
	if (S_ISDIR(st.st_mode)) {
		return refuse(err, err_len, -EISDIR,
			      "%s: is a directory; give a log written by candump -L, or -", path);
	}
	l->total = S_ISREG(st.st_mode) ? st.st_size : 0;
	return 0;
}

static int is_same_file(int a, int b)
{
	struct stat sa, sb;

	return fstat(a, &sa) == 0 && fstat(b, &sb) == 0 && S_ISREG(sa.st_mode) &&
	       sa.st_dev == sb.st_dev && sa.st_ino == sb.st_ino;
}

static int open_out(struct bus_log *l, const char *path, char *err, int err_len)
{
	if (!path) {
		return 0;
	}
	const int is_stdout = strcmp(path, "-") == 0;

	l->out = is_stdout ? dup(STDOUT_FILENO) : open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
	if (l->out < 0) {
		return refuse(err, err_len, -errno, "%s: cannot write: %s", path, strerror(errno));
	}
	if (is_same_file(l->in, l->out)) {
		return refuse(err, err_len, -EINVAL,
			      "%s: is the input as well; write to another file", path);
	}
	if (!is_stdout && ftruncate(l->out, 0) != 0 && errno != EINVAL) {
		return refuse(err, err_len, -errno, "%s: cannot empty: %s", path, strerror(errno));
	}
	return 0;
}

static int take_ifaces(struct bus_log *l, const char *const *ifaces, int n, char *err, int err_len)
{
	if (n < 1 || n > BUS_IFACES_MAX) {
		return refuse(err, err_len, -EINVAL, "%d interfaces; 1 to %d are possible", n,
			      BUS_IFACES_MAX);
	}
	for (int i = 0; i < n; i++) {
		if (strlen(ifaces[i]) >= BUS_NAME_MAX) {
			return refuse(err, err_len, -EINVAL, "interface '%s': longer than %d",
				      ifaces[i], BUS_NAME_MAX - 1);
		}
		strcpy(l->iface[i], ifaces[i]);
	}
	l->n_ifaces = n;
	return 0;
}

int bus_log_open(const char *in, const char *out, const char *const *ifaces, int n_ifaces,
		 struct bus **ret, char *err, int err_len)
{
	struct bus_log *l = calloc(1, sizeof(*l));

	if (!l) {
		return refuse(err, err_len, -ENOMEM, "%s: out of memory", in);
	}
	l->bus.ops = &log_ops;
	l->in = l->out = -1;
	int error = take_ifaces(l, ifaces, n_ifaces, err, err_len);

	error = error ? error : open_in(l, in, err, err_len);
	error = error ? error : open_out(l, out, err, err_len);
	if (error) {
		log_close(&l->bus);
		return error;
	}
	*ret = &l->bus;
	return 0;
}

void bus_log_progress(const struct bus *b, int64_t *read_bytes, int64_t *total)
{
	const struct bus_log *l = (const struct bus_log *)b;

	*read_bytes = l->consumed;
	*total = l->total;
}
