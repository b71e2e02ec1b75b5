/* SPDX-License-Identifier: MIT
 * Real-time requests: a refusal is an error with the line that mends it, and so is a kernel that says yes and does
 * otherwise.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

/* What the kernel answers and does. pthread functions return their error as a positive number. */
static struct {
	int set_error, get_error;
	int policy, priority; /* in force */
	int keeps;            /* 1: whatever is asked */
	cpu_set_t cpus;
	rlim_t memlock;
	uid_t user;
	int lock_error, locks;
} fake;

static int set_schedparam(pthread_t t, int policy, const struct sched_param *sp)
{
	(void)t;
	if (!fake.set_error && !fake.keeps) {
		fake.policy = policy;
		fake.priority = sp->sched_priority;
	}
	return fake.set_error;
}

static int get_schedparam(pthread_t t, int *policy, struct sched_param *sp)
{
	(void)t;
	*policy = fake.policy;
	sp->sched_priority = fake.priority;
	return fake.get_error;
}

static int set_affinity_of(pthread_t t, size_t size, const cpu_set_t *set)
{
	(void)t;
	assert_int_equal(size, sizeof(*set));
	if (!fake.set_error && !fake.keeps) {
		fake.cpus = *set;
	}
	return fake.set_error;
}

static int get_affinity_of(pthread_t t, size_t size, cpu_set_t *set)
{
	(void)t;
	assert_int_equal(size, sizeof(*set));
	*set = fake.cpus;
	return fake.get_error;
}

static int get_limit(int what, struct rlimit *lim)
{
	assert_int_equal(what, RLIMIT_MEMLOCK);
	*lim = (struct rlimit){fake.memlock, fake.memlock};
	return 0;
}

static uid_t user(void)
{
	return fake.user;
}

static int lock_all(int flags)
{
	assert_int_equal(flags, MCL_CURRENT | MCL_FUTURE);
	fake.locks++;
	errno = fake.lock_error;
	return fake.lock_error ? -1 : 0;
}
#define pthread_setschedparam  set_schedparam
#define pthread_getschedparam  get_schedparam
#define pthread_setaffinity_np set_affinity_of
#define pthread_getaffinity_np get_affinity_of
#define getrlimit(what, lim)   get_limit((int)(what), lim)
#define geteuid                user
#define mlockall               lock_all
#include "../daemon/rt.c"

static char err[256];

static int reset(void **state)
{
	(void)state;
	memset(&fake, 0, sizeof(fake));
	fake.memlock = RLIM_INFINITY;
	fake.user = 1000;
	CPU_SET(0, &fake.cpus);
	CPU_SET(1, &fake.cpus);
	err[0] = '\0';
	return 0;
}

static int ask(int priority, int cpu)
{
	return rt_thread(pthread_self(), "thread", priority, cpu, err, sizeof(err));
}

static void test_priority_and_processor_are_asked_for_and_read_back(void **state)
{
	(void)state;
	assert_int_equal(ask(80, 1), 0);
	assert_int_equal(fake.policy, SCHED_FIFO);
	assert_int_equal(fake.priority, 80);
	assert_int_equal(CPU_COUNT(&fake.cpus), 1);
	assert_true(CPU_ISSET(1, &fake.cpus));
	assert_string_equal(err, "");
}

static void test_none_asked_for_leaves_both_alone(void **state)
{
	(void)state;
	fake.set_error = EPERM;
	assert_int_equal(ask(0, -1), 0);
	assert_int_equal(fake.policy, SCHED_OTHER);
	assert_int_equal(CPU_COUNT(&fake.cpus), 2);
}

static void test_refused_priority(void **state)
{
	(void)state;
	fake.set_error = EPERM;
	assert_int_equal(ask(80, 1), -EPERM);
	assert_string_equal(err, "thread: SCHED_FIFO 80 refused: Operation not permitted: set "
				 "LimitRTPRIO=80 in the unit");
	assert_int_equal(CPU_COUNT(&fake.cpus), 2);
}

static void test_refused_processor(void **state)
{
	(void)state;
	fake.set_error = EINVAL;
	assert_int_equal(ask(0, 7), -EINVAL);
	assert_string_equal(err, "thread: processor 7 refused: Invalid argument: choose one that "
				 "is online");
	fake.set_error = 0;
	assert_int_equal(ask(0, CPU_SETSIZE), -EINVAL); /* more than a mask holds */
}

static void test_what_is_granted_and_not_done_is_an_error(void **state)
{
	(void)state;
	fake.keeps = 1;
	assert_int_equal(ask(80, -1), -EIO);
	fake.policy = SCHED_FIFO;
	fake.priority = 79;
	assert_int_equal(ask(80, -1), -EIO);
	fake.policy = SCHED_RR;
	fake.priority = 80;
	assert_int_equal(ask(80, -1), -EIO);
	assert_int_equal(ask(0, 1), -EIO); /* both processors stay */
	fake.keeps = 0;
	fake.get_error = ESRCH;
	assert_int_equal(ask(80, -1), -ESRCH);
	assert_int_equal(ask(0, 1), -ESRCH);
}

static void test_memory_is_not_locked_within_a_limit(void **state)
{
	(void)state;
	fake.memlock = 65536;
	assert_int_equal(rt_lock_memory(err, sizeof(err)), -EPERM);
	assert_string_equal(err, "memory lock limit is 65536 bytes: set LimitMEMLOCK=infinity in "
				 "the unit");
	assert_int_equal(fake.locks, 0);
}

static void test_refused_lock(void **state)
{
	(void)state;
	fake.lock_error = ENOMEM;
	assert_int_equal(rt_lock_memory(err, sizeof(err)), -ENOMEM);
	assert_string_equal(err, "mlockall: Cannot allocate memory: set LimitMEMLOCK=infinity in "
				 "the unit");
	fake.user = 0; /* whom no limit holds */
	fake.memlock = 65536;
	assert_int_equal(rt_lock_memory(err, sizeof(err)), -ENOMEM);
}

/* This process locked nothing, as its status says. */
static void test_lock_that_locks_nothing_is_an_error(void **state)
{
	(void)state;
	assert_int_equal(rt_lock_memory(err, sizeof(err)), -EIO);
	assert_string_equal(err, "mlockall succeeded but VmLck is 0 kB");
	assert_int_equal(fake.locks, 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(test_priority_and_processor_are_asked_for_and_read_back,
				       reset),
		cmocka_unit_test_setup(test_none_asked_for_leaves_both_alone, reset),
		cmocka_unit_test_setup(test_refused_priority, reset),
		cmocka_unit_test_setup(test_refused_processor, reset),
		cmocka_unit_test_setup(test_what_is_granted_and_not_done_is_an_error, reset),
		cmocka_unit_test_setup(test_memory_is_not_locked_within_a_limit, reset),
		cmocka_unit_test_setup(test_refused_lock, reset),
		cmocka_unit_test_setup(test_lock_that_locks_nothing_is_an_error, reset),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
