/* SPDX-License-Identifier: MIT
 * usage: trap PID SECONDS
 * Watches every SCHED_FIFO thread of a process from outside for that long: system calls outside a short list (ptrace),
 * page faults (/proc), and calls of the C library's allocator (uprobes, where the kernel has them). One line for each
 * thread, one for each call that should not have been. Needs root; slows the threads down, so judge no time meanwhile;
 * run it above their priority. It holds no file of the process: start and stop tracers, pull links, send signals.
 * Exit code 0 nothing found, 1 something found or failed, 2 usage.
 *
 *	trap: thread 312, FIFO 80: 4211 calls, 0 outside the list; 0 page faults; 0 allocator calls
 */
#include <dlfcn.h>
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>

#include "trap.h"

#define THREADS_MAX 8
#define CALLS_MAX   512

/* What a real-time thread may ask of the kernel: to wait, to read and write what does not block, and to wake another. */
static const int allowed[] = {
	SYS_ppoll,	   /* waiting for a frame, a result, a period */
	SYS_restart_syscall, /* the same, after the tracer looked */
	SYS_recvmmsg,	   /* frames */
	SYS_write,	   /* frames; a request handed over (eventfd) */
	SYS_read,	   /* a result announced, a request waited for (eventfd) */
	SYS_clock_gettime, /* where the vDSO has no clock to read */
	SYS_futex,	   /* a batch shared with other compute threads (mc.threads) */
};

struct thread {
	pid_t tid;
	int priority;
	long faults; /* before; then during */
	unsigned long calls, outside[CALLS_MAX];
};

static volatile sig_atomic_t over;

static void on_alarm(int sig)
{
	(void)sig;
	over = 1;
}

/* Minor and major faults: fields 10 and 12 of the stat file, counted after the name in brackets. */
static long faults_of(pid_t pid, pid_t tid)
{
	char path[64], text[512], *p;
	long minor, major;
	FILE *f;
	size_t n;

	snprintf(path, sizeof(path), "/proc/%d/task/%d/stat", pid, tid);
	f = fopen(path, "re");
	n = f ? fread(text, 1, sizeof(text) - 1, f) : 0;
	if (f) {
		fclose(f);
	}
	text[n] = '\0';
	p = strrchr(text, ')');
	if (!p || sscanf(p + 2, "%*c %*d %*d %*d %*d %*d %*u %ld %*d %ld", &minor, &major) != 2) {
		return -1;
	}
	return minor + major;
}

static int find_threads(pid_t pid, struct thread *t)
{
	char path[64];
	struct dirent *d;
	DIR *dir;
	int n = 0;

	snprintf(path, sizeof(path), "/proc/%d/task", pid);
	dir = opendir(path);
	while (dir && n < THREADS_MAX && (d = readdir(dir))) {
		const pid_t tid = atoi(d->d_name);
		struct sched_param sp;

		if (tid > 0 && sched_getscheduler(tid) == SCHED_FIFO && !sched_getparam(tid, &sp)) {
			t[n++] = (struct thread){.tid = tid, .priority = sp.sched_priority};
		}
	}
	if (dir) {
		closedir(dir);
	}
	return n;
}
