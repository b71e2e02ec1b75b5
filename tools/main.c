/* SPDX-License-Identifier: MIT
 * aebmc: picks a subcommand from cmd.def and makes sure that what it printed arrived.
 * Knows nothing of what the subcommands do.
 */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "build_info.h"
#include "cli.h"
#include "cmd.h"
#include "streams.h"
#include "text.h"

struct cmd {
	const char *name;
	int (*run)(int argc, char **argv);
	const char *help;
};

static const struct cmd cmd_table[] = {
#define CMD(name, help) {#name, cmd_##name, help},
#include "cmd.def"
#undef CMD
};
#define CMDS (sizeof(cmd_table) / sizeof(cmd_table[0]))

static const struct cmd *find(const char *name)
{
	for (size_t i = 0; i < CMDS; i++) {
		if (!strcmp(cmd_table[i].name, name)) {
			return &cmd_table[i];
		}
	}
	return NULL;
}

static int unknown(const char *name)
{
	fprintf(stderr, "aebmc: no subcommand '%s'; nearest is '%s', aebmc help lists all\n", name,
		text_nearest(name, &cmd_table[0].name, CMDS, sizeof(cmd_table[0])));
	return CLI_USAGE;
}

static int run(const struct cmd *cmd, int argc, char **argv)
{
	char name[32];

	snprintf(name, sizeof(name), "aebmc %s", cmd->name);
	argv[0] = name;
	return cmd->run(argc, argv);
}

static int version(void)
{
	build_info_print("aebmc", stdout);
	return CLI_GOOD;
}

static int help(const char *name)
{
	char option[] = "--help";
	char *argv[] = {NULL, option, NULL};

	if (name && strcmp(name, "help") != 0) {
		const struct cmd *cmd = find(name);

		return cmd ? run(cmd, 2, argv) : unknown(name);
	}
	puts("Usage: aebmc SUBCOMMAND [OPTION...]\n"
	     "Collision probability by Monte Carlo for automatic emergency braking.\n");
	for (size_t i = 0; i < CMDS; i++) {
		printf("  %-10s %s\n", cmd_table[i].name, cmd_table[i].help);
	}
	puts("\naebmc help SUBCOMMAND lists its options; aebmc --version prints the version.\n"
	     "Exit codes: 0 good, 1 failed, 2 usage, 77 skipped, 78 bad configuration.");
	return CLI_GOOD;
}

/* Also reached by argp's own exit after --help; a lost byte turns success into failure. */
static void close_stdout(void)
{
	int failed = ferror(stdout);

	errno = 0;
	if (fclose(stdout) || failed) {
		fprintf(stderr, "aebmc: standard output: %s\n",
			errno ? strerror(errno) : "write failed");
		_exit(CLI_FAILED);
	}
}

int main(int argc, char **argv)
{
	const struct cmd *cmd = argc > 1 ? find(argv[1]) : NULL;

	streams_ensure();
	signal(SIGPIPE, SIG_IGN);
	atexit(close_stdout);
	if (argc < 2) {
		fputs("aebmc: which subcommand? aebmc help lists them\n", stderr);
		return CLI_USAGE;
	}
	if (cmd) {
		return run(cmd, argc - 1, argv + 1);
	}
	if (!strcmp(argv[1], "help") || !strcmp(argv[1], "--help")) {
		return help(argv[2]);
	}
	return strcmp(argv[1], "--version") ? unknown(argv[1]) : version();
}
