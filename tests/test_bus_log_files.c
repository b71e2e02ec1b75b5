/* SPDX-License-Identifier: MIT
 * The log bus's input and output: files, standard streams, what cannot be opened, a lost reader, a full disk.
 */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include "log_file.h"

static void read_errors_are_reported(void **state)
{
	int saved = dup(STDIN_FILENO), write_only;
	struct bus *b;
	struct bus_frame f;
	int64_t now;
	char err[256];

	(void)state;
	log_write("in.log", "", 0);
	write_only = open("in.log", O_WRONLY);
	dup2(write_only, STDIN_FILENO);
	close(write_only);
	assert_int_equal(bus_log_open("-", NULL, log_ifaces, 2, &b, err, sizeof(err)), 0);
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -EBADF);
	b->ops->close(b);
	dup2(saved, STDIN_FILENO);
	close(saved);
}

static void on_alarm(int sig)
{
	(void)sig;
}

/* Again and again, so that one of them comes while recv() waits. */
static void signal_ends_the_wait(void **state)
{
	const struct sigaction act = {.sa_handler = on_alarm};
	const struct itimerval often = {{0, 10000}, {0, 10000}}, never = {{0, 0}, {0, 0}};
	static const char text[] = "(1.000000) can0 001#00\n";
	int saved = dup(STDIN_FILENO), fd[2];
	struct bus *b;
	struct bus_frame f;
	int64_t now;
	char err[256];

	(void)state;
	assert_int_equal(pipe(fd), 0);
	dup2(fd[0], STDIN_FILENO);
	close(fd[0]);
	assert_int_equal(bus_log_open("-", NULL, log_ifaces, 2, &b, err, sizeof(err)), 0);
	sigaction(SIGALRM, &act, NULL);
	setitimer(ITIMER_REAL, &often, NULL);
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -EINTR);
	setitimer(ITIMER_REAL, &never, NULL);
	assert_int_equal(write(fd[1], text, strlen(text)), strlen(text));
	close(fd[1]);
	assert_int_equal(log_drain(b), 1); /* nothing was lost */
	b->ops->close(b);
	signal(SIGALRM, SIG_DFL);
	dup2(saved, STDIN_FILENO);
	close(saved);
}

static void standard_input_is_read(void **state)
{
	static const char text[] = "(1.000000) can0 001#00\n";
	int saved = dup(STDIN_FILENO), fd[2];
	struct bus *b;
	char err[256];
	int64_t got, total;

	(void)state;
	assert_int_equal(pipe(fd), 0);
	assert_int_equal(write(fd[1], text, strlen(text)), strlen(text));
	close(fd[1]);
	dup2(fd[0], STDIN_FILENO);
	close(fd[0]);
	assert_int_equal(bus_log_open("-", NULL, log_ifaces, 2, &b, err, sizeof(err)), 0);
	assert_int_equal(log_drain(b), 1);
	bus_log_progress(b, &got, &total);
	assert_int_equal(got, strlen(text));
	assert_int_equal(total, 0);
	b->ops->close(b);
	assert_true(fcntl(STDIN_FILENO, F_GETFD) >= 0); /* not ours to close */
	dup2(saved, STDIN_FILENO);
	close(saved);
}

/* Without a standard input the log gets its number, and gives it back. */
static void log_may_be_descriptor_0(void **state)
{
	int saved = dup(STDIN_FILENO), opened, kept;
	struct bus *b = NULL;
	char err[256] = "";

	(void)state;
	log_write("in.log", "", 0);
	close(STDIN_FILENO);
	errno = EBADF; /* of something else */
	opened = bus_log_open("in.log", NULL, log_ifaces, 2, &b, err, sizeof(err));
	if (b) {
		b->ops->close(b);
	}
	kept = fcntl(STDIN_FILENO, F_GETFD);
	dup2(saved, STDIN_FILENO);
	close(saved);
	assert_string_equal(err, "");
	assert_int_equal(opened, 0);
	assert_int_equal(kept, -1);
}

static void what_is_sent_can_be_replayed(void **state)
{
	struct bus *b = log_open("", 0, "out.log");
	struct bus_frame f = {
		.t_ns = 1500 * CLOCK_NS_PER_MS, .id = 0x2A0, .iface = 1, .len = 2, .data = {1, 2}};
	struct bus_frame back;
	int64_t now;
	char err[256];

	(void)state;
	assert_int_equal(b->ops->send(b, &f), 0);
	assert_int_equal(b->ops->stats(b)->sent, 1);
	f.iface = 2;
	assert_int_equal(b->ops->send(b, &f), -ENODEV);
	b->ops->close(b);

	assert_int_equal(bus_log_open("out.log", NULL, log_ifaces, 2, &b, err, sizeof(err)), 0);
	assert_int_equal(b->ops->recv(b, &back, 1, CLOCK_NEVER, &now), 1);
	f.iface = 1;
	assert_memory_equal(&f, &back, sizeof(f));
	assert_int_equal(b->ops->send(b, &f), 0); /* discarded */
	b->ops->close(b);
}

static void old_output_is_replaced(void **state)
{
	struct stat st;

	(void)state;
	log_write("out.log", "old old old\n", 12);
	struct bus *b = log_open("", 0, "out.log");

	b->ops->close(b);
	assert_int_equal(stat("out.log", &st), 0);
	assert_int_equal(st.st_size, 0);
}

static void new_output_is_as_open_as_the_umask_lets_it(void **state)
{
	mode_t mask = umask(0);
	struct stat st;

	(void)state;
	(void)remove("out.log");
	struct bus *b = log_open("", 0, "out.log");

	umask(mask);
	b->ops->close(b);
	assert_int_equal(stat("out.log", &st), 0);
	assert_int_equal(st.st_mode & 07777, 0666);
}

static int lowest_free_descriptor(void)
{
	int fd = open("/dev/null", O_RDONLY);

	close(fd);
	return fd;
}

static void files_are_closed_and_not_inherited(void **state)
{
	const int first = lowest_free_descriptor();
	struct bus *b = log_open("", 0, "out.log");

	(void)state;
	assert_int_equal(fcntl(first, F_GETFD), FD_CLOEXEC);
	assert_int_equal(fcntl(first + 1, F_GETFD), FD_CLOEXEC);
	assert_int_equal(lowest_free_descriptor(), first + 2);
	b->ops->close(b);
	assert_int_equal(lowest_free_descriptor(), first);
}

static void standard_output_is_appended_to(void **state)
{
	int saved = dup(STDOUT_FILENO), out, opened, sent, finished;
	struct bus_frame f = {.id = 1};
	struct bus *b = NULL;
	struct stat st;
	char err[256];

	(void)state;
	log_write("in.log", "", 0);
	log_write("out.log", "before\n", 7);
	out = open("out.log", O_WRONLY | O_APPEND);
	fflush(stdout);
	dup2(out, STDOUT_FILENO);
	close(out);
	opened = bus_log_open("in.log", "-", log_ifaces, 2, &b, err, sizeof(err));
	sent = b->ops->send(b, &f);
	finished = bus_log_finish(b);
	b->ops->close(b);
	out = fcntl(STDOUT_FILENO, F_GETFD); /* not ours to close */
	dup2(saved, STDOUT_FILENO);
	close(saved);
	assert_int_equal(opened | sent | finished, 0);
	assert_int_not_equal(out, -1);
	assert_int_equal(stat("out.log", &st), 0);
	assert_int_equal(st.st_size, strlen("before\n(0000000000.000000) can0 001#\n"));
}

static void lost_reader_is_reported(void **state)
{
	int saved = dup(STDOUT_FILENO), fd[2], opened, ret;
	struct bus_frame f = {.id = 1};
	struct bus *b = NULL;
	char err[256];

	(void)state;
	signal(SIGPIPE, SIG_IGN);
	assert_int_equal(pipe(fd), 0);
	close(fd[0]);
	log_write("in.log", "", 0);
	fflush(stdout);
	dup2(fd[1], STDOUT_FILENO);
	close(fd[1]);
	opened = bus_log_open("in.log", "-", log_ifaces, 2, &b, err, sizeof(err));
	ret = b->ops->send(b, &f);
	b->ops->close(b);
	dup2(saved, STDOUT_FILENO);
	close(saved);
	assert_int_equal(opened, 0);
	assert_int_equal(ret, -EPIPE);
}

static void full_disk_is_reported(void **state)
{
	static const char frame[] = "(1.000000) can0 001#00\n";
	struct bus *b = log_open("", 0, "/dev/full");
	struct bus_frame f = {.id = 1};
	int64_t now;

	(void)state;
	assert_int_equal(bus_log_finish(b), 0);
	assert_int_equal(bus_log_finish(b), 0);
	b->ops->close(b);
	b = log_open(frame, strlen(frame), "/dev/full");
	assert_int_equal(b->ops->send(b, &f), -ENOSPC);
	assert_int_equal(b->ops->stats(b)->sent, 0);
	/* whoever does not look at send() learns it here */
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -ENOSPC);
	assert_int_equal(b->ops->recv(b, &f, 1, CLOCK_NEVER, &now), -ENOSPC);
	assert_int_equal(b->ops->stats(b)->received, 0);
	assert_int_equal(bus_log_finish(b), -ENOSPC);
	assert_int_equal(bus_log_finish(b), -ENOSPC);
	b->ops->close(b);
}

static void error_of_close_is_reported(void **state)
{
	struct bus *b = log_open("", 0, "out.log");

	(void)state;
	close(lowest_free_descriptor() - 1); /* the output's: the last one opened before */
	assert_int_equal(bus_log_finish(b), -EBADF);
	b->ops->close(b);
}

static void refuse_open(const char *in, const char *out, int n_ifaces, int error, const char *words)
{
	static const char *const many[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
	static const char *const wide[] = {"sixteen_letters_"};
	const int first = lowest_free_descriptor();
	struct bus *b = NULL;
	char err[256] = "";

	assert_int_equal(bus_log_open(in, out, n_ifaces < 0 ? wide : many, abs(n_ifaces), &b, err,
				      sizeof(err)),
			 error);
	assert_null(b);
	assert_non_null(strstr(err, words));
	assert_null(strchr(err, '\n'));
	assert_int_equal(lowest_free_descriptor(), first);
}

static void what_cannot_be_opened_is_named(void **state)
{
	(void)state;
	log_write("in.log", "x", 1);
	refuse_open("missing.log", NULL, 1, -ENOENT, "missing.log: cannot read: No such file");
	refuse_open(".", NULL, 1, -EISDIR, ".: is a directory");
	refuse_open("in.log", "none/out.log", 1, -ENOENT, "none/out.log: cannot write");
	refuse_open("in.log", ".", 1, -EISDIR, ".: cannot write: Is a directory");
	refuse_open("in.log", "in.log", 1, -EINVAL, "in.log: is the input as well");
	refuse_open("in.log", NULL, 0, -EINVAL, "0 interfaces");
	refuse_open("in.log", NULL, 9, -EINVAL, "9 interfaces");
	refuse_open("in.log", NULL, -1, -EINVAL, "'sixteen_letters_': longer than 15");

	struct stat st;

	assert_int_equal(stat("in.log", &st), 0);
	assert_int_equal(st.st_size, 1); /* refused before it was emptied */
}

static void close_takes_null(void **state)
{
	struct bus *b = log_open("", 0, NULL);

	(void)state;
	assert_string_equal(b->ops->name, "log");
	b->ops->close(NULL);
	b->ops->close(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(read_errors_are_reported),
		cmocka_unit_test(signal_ends_the_wait),
		cmocka_unit_test(standard_input_is_read),
		cmocka_unit_test(log_may_be_descriptor_0),
		cmocka_unit_test(what_is_sent_can_be_replayed),
		cmocka_unit_test(old_output_is_replaced),
		cmocka_unit_test(new_output_is_as_open_as_the_umask_lets_it),
		cmocka_unit_test(files_are_closed_and_not_inherited),
		cmocka_unit_test(standard_output_is_appended_to),
		cmocka_unit_test(lost_reader_is_reported),
		cmocka_unit_test(full_disk_is_reported),
		cmocka_unit_test(error_of_close_is_reported),
		cmocka_unit_test(what_cannot_be_opened_is_named),
		cmocka_unit_test(close_takes_null),
	};

	return cmocka_run_group_tests(tests, log_make_dir, log_remove_dir);
}
