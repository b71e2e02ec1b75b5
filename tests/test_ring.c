/* SPDX-License-Identifier: MIT
 * The recorder's ring: order, overwriting, and a reader racing the writer.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <errno.h>
#include <pthread.h>

#include "ring.h"

#define WORDS 16

struct entry {
	uint64_t word[WORDS];
};

static struct entry entry_of(uint64_t i)
{
	struct entry e;

	for (int k = 0; k < WORDS; k++) {
		e.word[k] = i * 1000 + (uint64_t)k;
	}
	return e;
}

static void test_refuses_odd_shapes(void **state)
{
	struct ring *r = NULL;

	(void)state;
	assert_int_equal(ring_open(0, 8, &r), -EINVAL);
	assert_int_equal(ring_open(3, 8, &r), -EINVAL);
	assert_int_equal(ring_open(4, 0, &r), -EINVAL);
	assert_int_equal(ring_open(4, 12, &r), -EINVAL);
	assert_null(r);
	ring_close(NULL);
}

static void test_keeps_the_newest(void **state)
{
	struct ring *r;
	struct entry e;

	(void)state;
	assert_int_equal(ring_open(4, sizeof(e), &r), 0);
	assert_int_equal(ring_get(r, 0, &e), -ENOENT);
	for (uint64_t i = 0; i < 6; i++) {
		e = entry_of(i);
		ring_put(r, &e);
	}
	assert_int_equal(ring_end(r), 6);
	assert_int_equal(ring_begin(r), 2);
	assert_int_equal(ring_get(r, 1, &e), -ENOENT);
	assert_int_equal(ring_get(r, 6, &e), -ENOENT);
	for (uint64_t i = 2; i < 6; i++) {
		const struct entry want = entry_of(i);

		assert_int_equal(ring_get(r, i, &e), 0);
		assert_memory_equal(&e, &want, sizeof(e));
	}
	ring_close(r);
}

struct race {
	struct ring *ring;
	int stop; /* atomic */
};

static void *write_until_told(void *arg)
{
	struct race *x = arg;

	for (uint64_t i = 0; !__atomic_load_n(&x->stop, __ATOMIC_ACQUIRE); i++) {
		const struct entry e = entry_of(i);

		ring_put(x->ring, &e);
	}
	return NULL;
}

/* Whatever the reader gets while it is overwritten is whole. */
static void test_a_reader_never_sees_a_torn_entry(void **state)
{
	struct race x = {0};
	pthread_t writer;

	(void)state;
	assert_int_equal(ring_open(4, sizeof(struct entry), &x.ring), 0);
	assert_int_equal(pthread_create(&writer, NULL, write_until_told, &x), 0);
	for (int seen = 0; seen < 20000;) {
		const uint64_t end = ring_end(x.ring), i = end ? end - 1 : 0;
		struct entry e;

		if (ring_get(x.ring, i, &e) == 0) {
			const struct entry want = entry_of(i);

			assert_memory_equal(&e, &want, sizeof(e));
			seen++;
		}
	}
	__atomic_store_n(&x.stop, 1, __ATOMIC_RELEASE);
	pthread_join(writer, NULL);
	ring_close(x.ring);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_refuses_odd_shapes),
		cmocka_unit_test(test_keeps_the_newest),
		cmocka_unit_test(test_a_reader_never_sees_a_torn_entry),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
