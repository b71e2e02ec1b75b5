/* SPDX-License-Identifier: MIT
 * usage: stall THREAD-ID MILLISECONDS
 * Stops one thread, not its process, and lets it go on: as if its processor had been taken away. Prints for how long it
 * stood. Raises itself to FIFO 90 once it is loaded: starting a program above the thread would delay it too.
 * Exit code 0, 1 failed, 2 usage.
 */
#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <time.h>

static double now_ms(void)
{
	struct timespec ts;

	clock_gettime(CLOCK_MONOTONIC, &ts);
	return (double)ts.tv_sec * 1e3 + (double)ts.tv_nsec / 1e6;
}

static int stop(pid_t tid)
{
	int status;

	if (ptrace(PTRACE_SEIZE, tid, NULL, NULL) || ptrace(PTRACE_INTERRUPT, tid, NULL, NULL)) {
		return -errno;
	}
	return waitpid(tid, &status, __WALL) == tid && WIFSTOPPED(status) ? 0 : -ESRCH;
}

int main(int argc, char **argv)
{
	const pid_t tid = argc == 3 ? atoi(argv[1]) : 0;
	const long ms = argc == 3 ? atol(argv[2]) : 0;
	const struct timespec ts = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000};
	int err;

	if (tid <= 0 || ms <= 0) {
		fprintf(stderr, "usage: stall THREAD-ID MILLISECONDS\n");
		return 2;
	}
	sched_setscheduler(0, SCHED_FIFO, &(const struct sched_param){.sched_priority = 90});
	err = stop(tid);
	if (err) {
		fprintf(stderr, "stall: thread %d: %s\n", tid, strerror(-err));
		return 1;
	}
	const double start_ms = now_ms();

	nanosleep(&ts, NULL);
	ptrace(PTRACE_DETACH, tid, NULL, NULL);
	printf("stall: thread %d stood still for %.1f ms\n", tid, now_ms() - start_ms);
	return 0;
}
