/* SPDX-License-Identifier: MIT
 * aebmc replay --requests: does the backend give the recorded results again, bit for bit?
 */
#include "requests.h"
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include "cli.h"
#include "engine.h"
#include "recorder.h"

#define HEAD "# aebmc requests 1:"

struct tally {
	int head; /* the file says whose it is */
	uint64_t requests, equal, malformed;
	uint64_t first_differing, first_malformed; /* line numbers; 0 none */
};

/* Identifiers must rise within a handle; those of the recording are another process's. */
static int compare(struct mc *mc, struct mc_request *req, uint64_t want, struct tally *t,
		   uint64_t line)
{
	struct mc_result res;
	int error;

	req->id = ++t->requests;
	error = mc_submit(mc, req);
	error = error < 0 ? error : mc_poll(mc, &res);
	if (error < 0) {
		return error;
	}
	if (recorder_result_hash(&res) == want) {
		t->equal++;
	} else if (!t->first_differing) {
		t->first_differing = line;
	}
	return 0;
}

/* 0 at the end of the file or on Ctrl-C, -errno of the backend or the file. */
static int compare_all(FILE *in, struct mc *mc, struct tally *t)
{
	struct mc_request req;
	uint64_t want, line = 0;
	char *text = NULL;
	size_t size = 0;
	int error = 0;

	while (!error && !cli_interrupted() && getline(&text, &size, in) >= 0) {
		line++;
		t->head |= !strncmp(text, HEAD, strlen(HEAD));
		error = recorder_parse(text, &req, &want);
		if (error == -EBADMSG && !t->malformed++) {
			t->first_malformed = line;
		}
		error = error ? 0 : compare(mc, &req, want, t, line);
	}
	const int failure = errno; /* of a read: EISDIR, EIO */

	free(text);
	return error ? error : ferror(in) && !cli_interrupted() ? -failure : 0;
}

static void report(const struct tally *t, enum publish_backend which, int as_json)
{
	const char *backend = publish_backend_name[which];
	struct json j = json_start(stdout);

	if (!as_json) {
		printf("%" PRIu64 " requests rerun on backend %s: %" PRIu64
		       " results equal bit for bit, %" PRIu64 " differ\n",
		       t->requests, backend, t->equal, t->requests - t->equal);
		return;
	}
	json_head(&j, "requests");
	json_str(&j, "backend", backend);
	json_uint(&j, "requests", t->requests);
	json_uint(&j, "equal", t->equal);
	json_uint(&j, "differing", t->requests - t->equal);
	json_uint(&j, "malformed_lines", t->malformed);
	json_close(&j, '}');
}

static int judge(const char *name, const char *path, const struct tally *t)
{
	if (cli_interrupted()) {
		return cli_error(CLI_FAILED, name, "interrupted");
	}
	if (t->malformed) {
		return cli_error(CLI_FAILED, name,
				 "%s:%" PRIu64
				 ": no request of the recorder, or a damaged one; %" PRIu64
				 " such lines",
				 path, t->first_malformed, t->malformed);
	}
	if (!t->requests && !t->head) {
		return cli_error(CLI_FAILED, name, "%s: no file of the recorder", path);
	}
	if (t->first_differing) {
		return cli_error(CLI_FAILED, name,
				 "%s:%" PRIu64 ": another result than recorded; is the "
				 "configuration the one of then (draws, seed, truncate)?",
				 path, t->first_differing);
	}
	return CLI_GOOD;
}

static int run(const char *name, const struct replay_args *a, FILE *in, struct mc *mc,
	       enum publish_backend which)
{
	struct tally t = {0};
	int error;

	cli_catch_interrupt();
	error = compare_all(in, mc, &t);
	if (error) {
		return cli_error(CLI_FAILED, name, "%s: %s", a->requests, strerror(-error));
	}
	report(&t, which, a->json);
	return judge(name, a->requests, &t);
}

int requests_run(const char *name, const struct replay_args *a)
{
	enum publish_backend which;
	struct config cfg;
	struct mc *mc;
	char err[256];
	int code = setup_load(name, &a->setup, &cfg, NULL);
	FILE *in = code ? NULL : fopen(a->requests, "r");

	if (code) {
		return code;
	}
	if (!in) {
		return cli_error(CLI_FAILED, name, "%s: %s", a->requests, strerror(errno));
	}
	cfg.mc_threads = a->threads ? a->threads : cfg.mc_threads;
	if (engine_open(&cfg, MC_INLINE, &mc, &which, err, sizeof(err))) {
		code = cli_error(CLI_FAILED, name, "%s", err);
	} else {
		code = run(name, a, in, mc, which);
		mc_close(mc);
	}
	fclose(in);
	return code;
}
