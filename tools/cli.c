/* SPDX-License-Identifier: MIT
 * What every subcommand of aebmc needs: exit codes, one-line messages, argument parsing, Ctrl-C, the machine's name.
 */
#include "cli.h"
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>
#include "text.h"

/* ---- messages ---------------------------------------------------------------------------------- */

static void line(const char *name, const char *fmt, va_list ap)
{
	fprintf(stderr, "%s: ", name);
	vfprintf(stderr, fmt, ap);
	fputc('\n', stderr);
}

int cli_error(int code, const char *name, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	line(name, fmt, ap);
	va_end(ap);
	return code;
}

error_t cli_bad(const struct argp_state *st, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	line(st->name, fmt, ap);
	va_end(ap);
	return EINVAL;
}

/* ---- arguments --------------------------------------------------------------------------------- */

struct quiet {
	const struct argp *argp;
	void *input;
};

/* Without an error stream argp neither adds its second line of advice nor exits. */
static error_t parse_quiet(int key, char *arg, struct argp_state *st)
{
	struct quiet *q = st->input;

	(void)arg;
	if (key != ARGP_KEY_INIT) {
		return ARGP_ERR_UNKNOWN;
	}
	st->err_stream = NULL;
	st->child_inputs[0] = q->input;
	return 0;
}

int cli_parse(const struct argp *argp, int argc, char **argv, void *input)
{
	struct quiet q = {argp, input};
	const struct argp_child child[] = {{argp, 0, NULL, 0}, {0}};
	const struct argp root = {NULL, parse_quiet, NULL, argp->doc, child, NULL, NULL};

	return argp_parse(&root, argc, argv, 0, NULL, &q) ? CLI_USAGE : 0;
}

error_t cli_number(const struct argp_state *st, const char *name, const char *arg, double min,
		   double max, double *ret)
{
	double v;

	if (text_number(arg, &v) || v < min || v > max) {
		return cli_bad(st, "%s: '%s' is no number in %g..%g", name, arg, min, max);
	}
	*ret = v;
	return 0;
}

error_t cli_count(const struct argp_state *st, const char *name, const char *arg, int64_t min,
		  int64_t max, int64_t *ret)
{
	int64_t v;

	if (text_integer(arg, &v) || v < min || v > max) {
		return cli_bad(st, "%s: '%s' is no whole number in %lld..%lld", name, arg,
			       (long long)min, (long long)max);
	}
	*ret = v;
	return 0;
}

error_t cli_choice(const struct argp_state *st, const char *name, const char *arg,
		   const char *const *names, size_t n, size_t *ret)
{
	for (size_t i = 0; i < n; i++) {
		if (!strcmp(arg, names[i])) {
			*ret = i;
			return 0;
		}
	}
	return cli_bad(st, "%s: '%s' is not known; nearest is '%s'", name, arg,
		       text_nearest(arg, names, n, sizeof(names[0])));
}

/* ---- files ------------------------------------------------------------------------------------- */

static int file_status(const char *path, int dash, struct stat *st)
{
	return strcmp(path, "-") ? stat(path, st) : fstat(dash, st);
}

int cli_same_file(const char *a, int a_dash, const char *b)
{
	struct stat sa, sb;

	return a && b && !file_status(a, a_dash, &sa) && !file_status(b, STDOUT_FILENO, &sb) &&
	       S_ISREG(sa.st_mode) && sa.st_dev == sb.st_dev && sa.st_ino == sb.st_ino;
}

FILE *cli_create(const char *name, const char *path)
{
	FILE *f = strcmp(path, "-") ? fopen(path, "w") : stdout;

	if (!f) {
		cli_error(0, name, "%s: %s", path, strerror(errno));
	}
	return f;
}

int cli_close(const char *name, const char *path, FILE *f)
{
	int failed = ferror(f);

	errno = 0;
	failed |= f == stdout ? fflush(f) : fclose(f);
	/* Standard output is reported once, at exit. */
	if (!failed || f == stdout) {
		return failed ? CLI_FAILED : 0;
	}
	return cli_error(CLI_FAILED, name, "%s: %s", path,
			 errno ? strerror(errno) : "write failed");
}

/* ---- Ctrl-C ------------------------------------------------------------------------------------ */

static uint64_t interrupt_word;

static void on_interrupt(int sig)
{
	(void)sig;
	__atomic_store_n(&interrupt_word, UINT64_MAX, __ATOMIC_RELEASE);
}

const uint64_t *cli_catch_interrupt(void)
{
	const struct sigaction sa = {.sa_handler = on_interrupt, .sa_flags = SA_RESETHAND};

	sigaction(SIGINT, &sa, NULL);
	sigaction(SIGTERM, &sa, NULL);
	return &interrupt_word;
}

int cli_interrupted(void)
{
	return __atomic_load_n(&interrupt_word, __ATOMIC_ACQUIRE) != 0;
}

/* ---- machine ----------------------------------------------------------------------------------- */

static int cpuinfo_name(char *name, int size)
{
	char text[256];
	FILE *f = fopen("/proc/cpuinfo", "r");
	int found = 0;

	while (f && !found && fgets(text, sizeof(text), f)) {
		const char *value = strchr(text, ':');

		found = value && !strncmp(text, "model name", 10);
		if (found) {
			snprintf(name, (size_t)size, "%s", value + 2);
			name[strcspn(name, "\n")] = '\0';
		}
	}
	if (f) {
		fclose(f);
	}
	return found;
}

void cli_cpu_name(char *name, int size)
{
	struct utsname u;

	if (!cpuinfo_name(name, size)) {
		snprintf(name, (size_t)size, "%s", uname(&u) ? "unknown" : u.machine);
	}
}

uint32_t cli_cpus(void)
{
	cpu_set_t set;
	int n = sched_getaffinity(0, sizeof(set), &set) ? 1 : CPU_COUNT(&set);

	return n > 0 ? (uint32_t)n : 1;
}
