/* SPDX-License-Identifier: MIT
 * What is asked of the kernel for real time: locked memory, SCHED_FIFO, processor affinity, shallow idle states.
 * Every request is verified by reading it back: a refusal is an error, never a log line that says it worked.
 */
#ifndef AEBMC_RT_H
#define AEBMC_RT_H

#include <pthread.h>
#include <stddef.h>

/**
 * rt_lock_memory - lock all present and future pages and prefault this thread's stack and the heap
 * @err: one line saying what was refused and how to mend it
 * Returns 0 or -errno; -EPERM or -ENOMEM where RLIMIT_MEMLOCK is too small (checked before mlockall, because threads
 * created later would fail instead). May block.
 */
int rt_lock_memory(char *err, int err_len);

/**
 * rt_thread - give a thread SCHED_FIFO and a processor, and read both back
 * @priority: 1..99; 0 leaves the policy alone     @cpu: >= 0; -1 leaves the affinity alone
 * @name: for @err. Returns 0 or -errno: -EPERM without RLIMIT_RTPRIO, -EINVAL for a processor that is not there,
 * -EIO where the kernel said yes and did otherwise.
 */
int rt_thread(pthread_t thread, const char *name, int priority, int cpu, char *err, int err_len);

/**
 * rt_latency_open - hold /dev/cpu_dma_latency at 0 us, so that processors do not sleep deeply
 * Returns a descriptor to keep open, or -errno (the device is root-only without our udev rule).
 */
int rt_latency_open(char *err, int err_len);

/** rt_prefault_stack - touch @bytes of the calling thread's stack, at most 512 KiB, so that they are resident. */
void rt_prefault_stack(size_t bytes);

#endif
