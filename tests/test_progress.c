/* SPDX-License-Identifier: MIT
 * The progress line, with a pseudo-terminal as standard error: only on a terminal, only after 2 s, gone at the end.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <pty.h>
#include <unistd.h>
#include <cmocka.h>
#include "../tools/progress.c"

struct terminal {
	int master, saved;
};

static int setup(void **state)
{
	static struct terminal t;
	int slave;

	if (openpty(&t.master, &slave, NULL, NULL, NULL)) {
		return -1;
	}
	t.saved = dup(STDERR_FILENO);
	dup2(slave, STDERR_FILENO);
	close(slave);
	*state = &t;
	return 0;
}

static int teardown(void **state)
{
	struct terminal *t = *state;

	dup2(t->saved, STDERR_FILENO);
	close(t->saved);
	close(t->master);
	return 0;
}

/* What the terminal got since the last call, ended by a mark so that reading never waits. */
static const char *seen(const struct terminal *t)
{
	static char text[1024];
	size_t n = 0;

	fputc('!', stderr);
	fflush(stderr);
	while (n < sizeof(text) - 1 && (!n || text[n - 1] != '!')) {
		ssize_t got = read(t->master, text + n, sizeof(text) - 1 - n);

		assert_true(got > 0);
		n += (size_t)got;
	}
	text[n - 1] = '\0';
	return text;
}

static void test_line(void **state)
{
	const struct terminal *t = *state;
	struct progress p = progress_start("work");

	assert_true(p.on);
	progress_update(&p, 0.5, "");
	assert_string_equal(seen(t), "");
	p.start_ns -= 90 * CLOCK_NS_PER_S;
	progress_update(&p, 0.9, "fast");
	assert_string_equal(seen(t), "\r\033[Kwork  90 %, 0:10 left, fast");
	progress_update(&p, 0.95, "fast");
	assert_string_equal(seen(t), "");
	p.last_ns = 0;
	progress_update(&p, -1, "");
	assert_memory_equal(seen(t), "\r\033[Kwork 9", 9);
	progress_clear(&p);
	assert_string_equal(seen(t), "\r\033[K");
	progress_clear(&p);
	assert_string_equal(seen(t), "");
}

static void test_no_terminal(void **state)
{
	const struct terminal *t = *state;
	int slave = dup(STDERR_FILENO), fds[2];
	char byte;

	assert_int_equal(pipe(fds), 0);
	dup2(fds[1], STDERR_FILENO);
	close(fds[1]);
	struct progress p = progress_start("work");

	p.start_ns -= 90 * CLOCK_NS_PER_S;
	progress_update(&p, 0.5, "");
	progress_clear(&p);
	dup2(slave, STDERR_FILENO);
	close(slave);
	assert_int_equal(read(fds[0], &byte, 1), 0);
	close(fds[0]);
	assert_string_equal(seen(t), "");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(test_line, setup, teardown),
		cmocka_unit_test_setup_teardown(test_no_terminal, setup, teardown),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
