/* SPDX-License-Identifier: MIT
 * usage: trap PID SECONDS
 * Watches every SCHED_FIFO thread of a process from outside for that long, or until SIGTERM: system calls outside a
 * short list (ptrace), page faults (/proc), and calls of the C library's allocator (uprobes; a call of its own must be
 * seen). One line for each thread, one for each kind of call that should not have been:
 *	trap: thread 312, FIFO 80: 4211 calls, 0 outside the list; 0 page faults; 0 allocator calls
 * Meanwhile do what may make the process slip: faults, signals, a tracer that starts and stops. Needs root; slows the
 * threads down, so judge no time. Run it above everything but those threads (chrt -f 50): above them it would find them
 * still running at each stop, and the kernel waits a tick for them. One such watcher at a time.
 * Exit code 0 nothing found, 1 something found or failed, 2 usage.
 */
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#define THREADS_MAX 8
#define CALLS_MAX   512
#define TRACING     "/sys/kernel/tracing"
#define INSTANCE    TRACING "/instances/aebmc"

/* To wait, to read and write what does not block, to wake another thread. */
static const int allowed[] = {
	SYS_ppoll,           /* for a frame, a result, a period */
	SYS_restart_syscall, /* the same, after a stop */
	SYS_recvmmsg,        /* frames */
	SYS_sendto,          /* frames */
	SYS_write,           /* a request or a result announced (eventfd) */
	SYS_read,            /* an announcement taken */
	SYS_clock_gettime,   /* where the vDSO has no clock to read */
	SYS_futex,           /* a batch shared with other compute threads (mc.threads) */
	SYS_getpid,          /* whose events they are: LTTng, once in a process that is recorded */
};

static const char *const allocators[] = {
	"malloc", "calloc", "realloc", "free", "posix_memalign", "aligned_alloc",
};
#define ALLOCATORS (sizeof(allocators) / sizeof(allocators[0]))

struct thread {
	pid_t tid;
	int priority, gone;
	long faults, allocations;
	unsigned long calls, outside, count[CALLS_MAX];
};

struct watch {
	pid_t pid;
	int n;
	long witnessed; /* allocator calls of our own: 0 and nobody's calls are seen */
	struct thread t[THREADS_MAX];
};

static volatile sig_atomic_t over;

static void on_end(int sig)
{
	(void)sig;
	over = 1;
}

/* ---- threads ------------------------------------------------------------------------------------------ */

static void find_threads(struct watch *w)
{
	char path[64];
	struct sched_param sp;
	struct dirent *d;
	DIR *dir;

	snprintf(path, sizeof(path), "/proc/%d/task", w->pid);
	dir = opendir(path);
	while (dir && w->n < THREADS_MAX && (d = readdir(dir))) {
		const pid_t tid = atoi(d->d_name);

		if (tid > 0 && sched_getscheduler(tid) == SCHED_FIFO && !sched_getparam(tid, &sp)) {
			w->t[w->n++] = (struct thread){.tid = tid, .priority = sp.sched_priority};
		}
	}
	if (dir) {
		closedir(dir);
	}
}

/* Minor and major faults until now: fields 10 and 12 of the stat file; -1 if it cannot be read. */
static long faults_of(const struct watch *w, pid_t tid)
{
	char path[64], text[512];
	long minor, major;
	FILE *f;
	size_t n;

	snprintf(path, sizeof(path), "/proc/%d/task/%d/stat", w->pid, tid);
	f = fopen(path, "re");
	if (!f) {
		return -1;
	}
	n = fread(text, 1, sizeof(text) - 1, f);
	fclose(f);
	text[n] = '\0';

	const char *p = strrchr(text, ')'); /* the name before it may hold anything */

	if (!p || sscanf(p + 1, " %*c %*d %*d %*d %*d %*d %*u %ld %*d %ld", &minor, &major) != 2) {
		return -1;
	}
	return minor + major;
}

/* ---- allocator: probes in the C library, seen by a trace of their own -------------------------------------- */

/* By descriptor: these files cannot be sought in, which opening a stream to append does, and truncating drops probes. */
static int put(const char *path, const char *text)
{
	const int fd = open(path, O_WRONLY | O_APPEND | O_CLOEXEC);
	const ssize_t n = fd < 0 ? -1 : write(fd, text, strlen(text));

	if (fd >= 0) {
		close(fd);
	}
	return n < 0 ? -1 : 0;
}

/* Where the file that holds @address is mapped here: its path and the address's place in it. */
static long file_offset(const void *address, char path[256])
{
	const uintptr_t at = (uintptr_t)address;
	unsigned long from, to, offset;
	long ret = -1;
	char line[512];
	FILE *f = fopen("/proc/self/maps", "re");

	while (f && ret < 0 && fgets(line, sizeof(line), f)) {
		if (sscanf(line, "%lx-%lx %*s %lx %*s %*s %255s", &from, &to, &offset, path) == 4 &&
		    at >= from && at < to) {
			ret = (long)(at - from + offset);
		}
	}
	if (f) {
		fclose(f);
	}
	return ret;
}

static void probes_close(void)
{
	char text[64];

	put(INSTANCE "/events/aebmc/enable", "0");
	rmdir(INSTANCE);
	for (size_t i = 0; i < ALLOCATORS; i++) {
		snprintf(text, sizeof(text), "-:aebmc/%s\n", allocators[i]);
		put(TRACING "/uprobe_events", text);
	}
}

/* Of the watched threads and of this one. */
static void probes_filter(const struct watch *w, char filter[256])
{
	int len = snprintf(filter, 256, "common_pid==%d", getpid());

	for (int i = 0; i < w->n; i++) {
		len += snprintf(filter + len, 256 - (size_t)len, "||common_pid==%d", w->t[i].tid);
	}
}

static int probes_open(const struct watch *w)
{
	char text[512], path[256], filter[256];
	void *volatile witness;

	for (size_t i = 0; i < ALLOCATORS; i++) {
		const long offset = file_offset(dlsym(RTLD_DEFAULT, allocators[i]), path);

		snprintf(text, sizeof(text), "p:aebmc/%s %s:0x%lx\n", allocators[i], path, offset);
		if (offset < 0 || put(TRACING "/uprobe_events", text)) {
			fprintf(stderr, "trap: uprobe %s: %s\n", text, strerror(errno));
			return -1;
		}
	}
	probes_filter(w, filter);
	if (mkdir(INSTANCE, 0700) || put(INSTANCE "/events/aebmc/filter", filter) ||
	    put(INSTANCE "/events/aebmc/enable", "1")) {
		fprintf(stderr, "trap: %s, filter %s: %s\n", INSTANCE, filter, strerror(errno));
		return -1;
	}
	witness = malloc(1);
	free(witness);
	return 0;
}

static int is_of(const char *line, pid_t tid)
{
	char thread[32];

	snprintf(thread, sizeof(thread), "-%d ", tid);
	return line[0] != '#' && strstr(line, thread);
}

static void probes_count(struct watch *w)
{
	char line[512];
	FILE *f = fopen(INSTANCE "/trace", "re");

	while (f && fgets(line, sizeof(line), f)) {
		w->witnessed += is_of(line, getpid());
		for (int i = 0; i < w->n; i++) {
			w->t[i].allocations += is_of(line, w->t[i].tid);
		}
	}
	if (f) {
		fclose(f);
	}
}

/* ---- system calls --------------------------------------------------------------------------------------- */

static int is_allowed(uint64_t call)
{
	for (size_t i = 0; i < sizeof(allowed) / sizeof(allowed[0]); i++) {
		if (call == (uint64_t)allowed[i]) {
			return 1;
		}
	}
	return 0;
}

static void count_call(struct thread *t)
{
	struct __ptrace_syscall_info info;

	if (ptrace(PTRACE_GET_SYSCALL_INFO, t->tid, sizeof(info), &info) < 0 ||
	    info.op != PTRACE_SYSCALL_INFO_ENTRY) {
		return;
	}
	t->calls++;
	if (!is_allowed(info.entry.nr)) {
		t->outside++;
		t->count[info.entry.nr < CALLS_MAX ? info.entry.nr : CALLS_MAX - 1]++;
	}
}

static int is_job_control(int sig)
{
	return sig == SIGSTOP || sig == SIGTSTP || sig == SIGTTIN || sig == SIGTTOU;
}

static void go_on(struct thread *t, int status)
{
	const int sig = WSTOPSIG(status), event = status >> 16;

	if (sig == (SIGTRAP | 0x80)) {
		count_call(t);
		ptrace(PTRACE_SYSCALL, t->tid, NULL, NULL);
	} else if (event == PTRACE_EVENT_STOP && is_job_control(sig)) {
		ptrace(PTRACE_LISTEN, t->tid, NULL, NULL); /* stopped like its process */
	} else {
		ptrace(PTRACE_SYSCALL, t->tid, NULL, event ? 0L : (long)sig);
	}
}

static struct thread *thread_of(struct watch *w, pid_t tid)
{
	for (int i = 0; i < w->n; i++) {
		if (w->t[i].tid == tid) {
			return &w->t[i];
		}
	}
	return NULL;
}

static int seize(struct watch *w)
{
	for (int i = 0; i < w->n; i++) {
		struct thread *t = &w->t[i];

		if (ptrace(PTRACE_SEIZE, t->tid, NULL, PTRACE_O_TRACESYSGOOD) ||
		    ptrace(PTRACE_INTERRUPT, t->tid, NULL, NULL)) {
			fprintf(stderr, "trap: thread %d: %s\n", t->tid, strerror(errno));
			return -1;
		}
		t->faults = faults_of(w, t->tid);
	}
	return 0;
}

/* Until the alarm, or all threads have ended. */
static void watch_calls(struct watch *w)
{
	int status;

	while (!over) {
		const pid_t tid = waitpid(-1, &status, __WALL);
		struct thread *t = tid > 0 ? thread_of(w, tid) : NULL;

		if (tid < 0 && errno == ECHILD) {
			return;
		}
		if (t && WIFSTOPPED(status)) {
			go_on(t, status);
		} else if (t) {
			t->gone = 1;
		}
	}
}

static void let_go(struct watch *w)
{
	int status;

	for (int i = 0; i < w->n; i++) {
		struct thread *t = &w->t[i];

		t->faults = t->gone ? -1 : faults_of(w, t->tid) - t->faults;
		if (!t->gone && !ptrace(PTRACE_INTERRUPT, t->tid, NULL, NULL) &&
		    waitpid(t->tid, &status, __WALL) == t->tid) {
			ptrace(PTRACE_DETACH, t->tid, NULL, NULL);
		}
	}
}

/* ---- report ----------------------------------------------------------------------------------------------- */

/* 1 if nothing was found. */
static int report(const struct watch *w, const struct thread *t)
{
	char allocations[64] = "allocator calls not seen";

	if (w->witnessed) {
		snprintf(allocations, sizeof(allocations), "%ld allocator calls", t->allocations);
	}
	printf("trap: thread %d, FIFO %d: %lu calls, %lu outside the list; %ld page faults; %s%s\n",
	       t->tid, t->priority, t->calls, t->outside, t->faults, allocations,
	       t->gone ? "; it ended" : "");
	for (int i = 0; i < CALLS_MAX; i++) {
		if (t->count[i]) {
			printf("trap: thread %d: system call %d, %lu times\n", t->tid, i,
			       t->count[i]);
		}
	}
	return t->calls && !t->outside && !t->faults && w->witnessed && !t->allocations && !t->gone;
}

int main(int argc, char **argv)
{
	struct watch w = {.pid = argc == 3 ? atoi(argv[1]) : 0};
	const unsigned int seconds = argc == 3 ? (unsigned int)atoi(argv[2]) : 0;
	const struct sigaction ends = {.sa_handler = on_end};
	int good = 1;

	if (w.pid <= 0 || !seconds) {
		fprintf(stderr, "usage: trap PID SECONDS\n");
		return 2;
	}
	find_threads(&w);
	if (!w.n) {
		fprintf(stderr, "trap: process %d has no SCHED_FIFO thread\n", w.pid);
		return 1;
	}
	sigaction(SIGALRM, &ends, NULL);
	sigaction(SIGTERM, &ends, NULL);
	good = !probes_open(&w) && !seize(&w);
	alarm(seconds);
	if (good) {
		watch_calls(&w);
	}
	let_go(&w);
	probes_count(&w);
	probes_close();
	for (int i = 0; i < w.n; i++) {
		good &= report(&w, &w.t[i]);
	}
	return good ? 0 : 1;
}
