/* SPDX-License-Identifier: MIT
 * The status socket: one line in, one line out; clients that misbehave are dropped and nothing waits.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "control.h"

static char dir[64], path[100], err[256];
static int answered;

static void answer(void *arg, const char *command, char *reply, size_t size)
{
	answered++;
	if (strcmp(command, "long") == 0) {
		memset(reply, 'x', size - 1);
		reply[size - 1] = '\0';
		return;
	}
	snprintf(reply, size, "{\"%s\":\"%s\"}", (const char *)arg, command);
}

static struct control *serve(void)
{
	static char who[] = "you said";
	struct control *c = NULL;

	assert_int_equal(control_open(path, answer, who, &c, err, sizeof(err)), 0);
	answered = 0;
	return c;
}

static int make_dir(void **state)
{
	(void)state;
	strcpy(dir, "/tmp/aebmc-control-XXXXXX");
	if (!mkdtemp(dir)) {
		return -1;
	}
	snprintf(path, sizeof(path), "%s/s", dir);
	return 0;
}

static int remove_dir(void **state)
{
	char cmd[128];

	(void)state;
	snprintf(cmd, sizeof(cmd), "rm -rf %s", dir);
	return system(cmd);
}

static int dial(void)
{
	struct sockaddr_un a = {.sun_family = AF_UNIX};
	const int fd = socket(AF_UNIX, SOCK_STREAM, 0);

	strcpy(a.sun_path, path);
	assert_int_equal(connect(fd, (struct sockaddr *)&a, sizeof(a)), 0);
	return fd;
}

static void serve_a_while(struct control *c)
{
	for (int i = 0; i < 10; i++) {
		control_serve(c);
	}
}

static void test_answers_each_line(void **state)
{
	struct control *c = serve();
	const int fd = dial();
	char buf[256] = "";

	(void)state;
	assert_int_equal(write(fd, "sta", 3), 3);
	serve_a_while(c);
	assert_int_equal(answered, 0);
	assert_int_equal(write(fd, "tus\nmark\n", 9), 9);
	serve_a_while(c);
	assert_true(read(fd, buf, sizeof(buf) - 1) > 0);
	assert_string_equal(buf, "{\"you said\":\"status\"}\n{\"you said\":\"mark\"}\n");
	close(fd);
	serve_a_while(c);
	control_close(c);
	assert_int_equal(access(path, F_OK), -1);
}

static int is_closed(int fd)
{
	char b;

	return recv(fd, &b, 1, MSG_DONTWAIT) == 0 || errno == ECONNRESET;
}

static void test_drops_who_writes_without_end(void **state)
{
	struct control *c = serve();
	const int fd = dial(), nul = dial();
	char junk[CONTROL_LINE_MAX + 10];

	(void)state;
	memset(junk, 'a', sizeof(junk));
	assert_int_equal(write(fd, junk, sizeof(junk)), sizeof(junk));
	assert_int_equal(write(nul, "a\0b\n", 4), 4);
	serve_a_while(c);
	assert_int_equal(answered, 0);
	assert_true(is_closed(fd));
	assert_true(is_closed(nul));
	close(fd);
	close(nul);
	control_close(c);
}

static void test_drops_who_never_reads(void **state)
{
	struct control *c = serve();
	const int fd = dial();
	int i;

	(void)state;
	for (i = 0; i < 10000; i++) {
		if (send(fd, "long\n", 5, MSG_DONTWAIT | MSG_NOSIGNAL) != 5) {
			break;
		}
		control_serve(c);
		control_serve(c);
	}
	assert_true(i < 10000);
	assert_true(answered > 5);
	close(fd);
	control_close(c);
}

static void test_refuses_more_clients_than_it_has_room_for(void **state)
{
	struct control *c = serve();
	int fd[9];

	(void)state;
	for (int i = 0; i < 9; i++) {
		fd[i] = dial();
		serve_a_while(c);
	}
	assert_true(is_closed(fd[8]));
	close(fd[0]);
	serve_a_while(c);
	fd[0] = dial();
	assert_int_equal(write(fd[0], "a\n", 2), 2);
	serve_a_while(c);
	assert_int_equal(answered, 1);
	for (int i = 0; i < 9; i++) {
		close(fd[i]);
	}
	control_close(c);
}

static void test_open_failures(void **state)
{
	struct control *c = serve(), *second = NULL;
	char long_path[200], file[128];

	(void)state;
	assert_int_equal(control_open(path, answer, NULL, &second, err, sizeof(err)), -EADDRINUSE);
	assert_non_null(strstr(err, "another aebmcd"));
	assert_int_equal(access(path, F_OK), 0); /* the living one keeps its socket */
	memset(long_path, 'p', sizeof(long_path));
	long_path[sizeof(long_path) - 1] = '\0';
	assert_int_equal(control_open(long_path, answer, NULL, &second, err, sizeof(err)),
			 -ENAMETOOLONG);
	snprintf(file, sizeof(file), "%s/file", dir);
	fclose(fopen(file, "w"));
	assert_int_equal(control_open(file, answer, NULL, &second, err, sizeof(err)), -EEXIST);
	assert_int_equal(access(file, F_OK), 0);
	assert_int_equal(control_open("/nonexistent/s", answer, NULL, &second, err, sizeof(err)),
			 -ENOENT);
	assert_null(second);
	control_close(c);
	control_close(NULL);
}

static void test_replaces_the_socket_of_a_dead_process(void **state)
{
	struct sockaddr_un a = {.sun_family = AF_UNIX};
	const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
	struct control *c;

	(void)state;
	strcpy(a.sun_path, path);
	assert_int_equal(bind(fd, (struct sockaddr *)&a, sizeof(a)), 0);
	close(fd);
	c = serve();
	close(dial());
	control_close(c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(test_answers_each_line, make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_drops_who_writes_without_end, make_dir,
						remove_dir),
		cmocka_unit_test_setup_teardown(test_drops_who_never_reads, make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_refuses_more_clients_than_it_has_room_for,
						make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_open_failures, make_dir, remove_dir),
		cmocka_unit_test_setup_teardown(test_replaces_the_socket_of_a_dead_process,
						make_dir, remove_dir),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
