/* SPDX-License-Identifier: MIT
 * Real-time requests to the kernel, each read back. See rt.h.
 */
#include "rt.h"

#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#define STACK_MAX  (512 * 1024)
#define HEAP_BYTES (8 * 1024 * 1024)
#define PAGE       4096

__attribute__((noinline)) void rt_prefault_stack(size_t bytes)
{
	volatile char page[STACK_MAX];

	for (size_t i = 0; i < bytes && i < sizeof(page); i += PAGE) {
		page[i] = 1;
	}
}

/* Keep what is freed and never map anew: the next malloc before arming finds resident pages. */
static int prefault_heap(void)
{
	char *heap;

	mallopt(M_TRIM_THRESHOLD, -1);
	mallopt(M_MMAP_MAX, 0);
	heap = malloc(HEAP_BYTES);
	if (!heap) {
		return -ENOMEM;
	}
	for (size_t i = 0; i < HEAP_BYTES; i += PAGE) {
		((volatile char *)heap)[i] = 0;
	}
	free(heap);
	return 0;
}

static long locked_kib(void)
{
	FILE *f = fopen("/proc/self/status", "re");
	char line[256];
	long kib = -1;

	while (f && fgets(line, sizeof(line), f)) {
		if (sscanf(line, "VmLck: %ld", &kib) == 1) {
			break;
		}
	}
	if (f) {
		fclose(f);
	}
	return kib;
}

int rt_lock_memory(char *err, int err_len)
{
	struct rlimit lim;
	int ret;

	if (getrlimit(RLIMIT_MEMLOCK, &lim) == 0 && lim.rlim_cur != RLIM_INFINITY &&
	    geteuid() != 0) {
		snprintf(err, (size_t)err_len,
			 "memory lock limit is %llu bytes: set LimitMEMLOCK=infinity in the unit",
			 (unsigned long long)lim.rlim_cur);
		return -EPERM;
	}
	if (mlockall(MCL_CURRENT | MCL_FUTURE)) {
		ret = -errno;
		snprintf(err, (size_t)err_len,
			 "mlockall: %s: set LimitMEMLOCK=infinity in the unit", strerror(-ret));
		return ret;
	}
	ret = prefault_heap();
	if (ret || locked_kib() <= 0) {
		snprintf(err, (size_t)err_len, "mlockall succeeded but VmLck is %ld kB",
			 locked_kib());
		return ret ? ret : -EIO;
	}
	rt_prefault_stack(STACK_MAX);
	return 0;
}

/* pthread functions return the error as a positive number. */
static int set_policy(pthread_t thread, int priority)
{
	struct sched_param sp = {.sched_priority = priority};
	int policy;
	int ret = pthread_setschedparam(thread, SCHED_FIFO, &sp);

	if (ret) {
		return -ret;
	}
	ret = pthread_getschedparam(thread, &policy, &sp);
	if (ret) {
		return -ret;
	}
	return policy == SCHED_FIFO && sp.sched_priority == priority ? 0 : -EIO;
}

static int set_affinity(pthread_t thread, int cpu)
{
	cpu_set_t want, have;
	int ret;

	if (cpu >= CPU_SETSIZE) {
		return -EINVAL;
	}
	CPU_ZERO(&want);
	CPU_SET(cpu, &want);
	ret = pthread_setaffinity_np(thread, sizeof(want), &want);
	if (ret) {
		return -ret;
	}
	ret = pthread_getaffinity_np(thread, sizeof(have), &have);
	if (ret) {
		return -ret;
	}
	return CPU_EQUAL(&want, &have) ? 0 : -EIO;
}

int rt_thread(pthread_t thread, const char *name, int priority, int cpu, char *err, int err_len)
{
	int ret;

	ret = priority > 0 ? set_policy(thread, priority) : 0;
	if (ret) {
		snprintf(err, (size_t)err_len,
			 "%s: SCHED_FIFO %d refused: %s: set LimitRTPRIO=%d in the unit", name,
			 priority, strerror(-ret), priority);
		return ret;
	}
	ret = cpu >= 0 ? set_affinity(thread, cpu) : 0;
	if (ret) {
		snprintf(err, (size_t)err_len,
			 "%s: processor %d refused: %s: choose one that is online", name, cpu,
			 strerror(-ret));
	}
	return ret;
}

int rt_latency_open(char *err, int err_len)
{
	const int32_t zero_us = 0;
	int32_t now_us = -1;
	const int fd = open("/dev/cpu_dma_latency", O_RDWR | O_CLOEXEC);
	int ret;

	if (fd < 0) {
		ret = -errno;
		snprintf(err, (size_t)err_len,
			 "/dev/cpu_dma_latency: %s: install the udev rule 60-aebmc.rules",
			 strerror(-ret));
		return ret;
	}
	if (write(fd, &zero_us, sizeof(zero_us)) != sizeof(zero_us) ||
	    read(fd, &now_us, sizeof(now_us)) <= 0 || now_us != 0) {
		snprintf(err, (size_t)err_len,
			 "/dev/cpu_dma_latency: asked for 0 us, reads back %d us", now_us);
		close(fd);
		return -EIO;
	}
	return fd;
}
