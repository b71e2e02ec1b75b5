/* SPDX-License-Identifier: MIT
 * aebmc arm, disarm, mark: one command to a running aebmcd.
 */
#include "ask.h"
#include "cli.h"
#include "cmd.h"
#include "json_path.h"

static error_t parse(int key, char *arg, struct argp_state *st)
{
	(void)arg;
	if (key != ARGP_KEY_INIT) {
		return ARGP_ERR_UNKNOWN;
	}
	st->child_inputs[0] = st->input;
	return 0;
}

static int tell(int argc, char **argv, const char *command, const char *doc)
{
	const struct argp_child children[] = {{&ask_argp, 0, NULL, 0}, {0}};
	const struct argp argp = {NULL, parse, "[NAME]", doc, children, NULL, NULL};
	struct ask_args args = {0};
	struct ask a;
	char done[64];
	int code = cli_parse(&argp, argc, argv, &args);

	code = code ? code : ask_open(argv[0], &args, &a);
	if (code) {
		return code;
	}
	code = ask(argv[0], &a, command);
	if (!code) {
		puts(json_path_text(a.reply, "ok", done, sizeof(done)) ? a.reply : done);
	}
	ask_close(&a);
	return code;
}

int cmd_arm(int argc, char **argv)
{
	return tell(argc, argv, "arm",
		    "Allows aebmcd@NAME to request braking, until it ends, fails or is disarmed. "
		    "Its configuration must say bus.transmit = armed.");
}

int cmd_disarm(int argc, char **argv)
{
	return tell(argc, argv, "disarm", "Takes back what arm allowed.");
}

int cmd_mark(int argc, char **argv)
{
	return tell(argc, argv, "mark",
		    "Has the recorder of aebmcd@NAME keep what is happening now.");
}
