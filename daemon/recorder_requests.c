/* SPDX-License-Identifier: MIT
 * The lines of a .requests file: written by the recorder and aebmc explain, read by aebmc replay. See recorder.h.
 */
#include "recorder.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "hash.h"

_Static_assert(sizeof(struct mc_request) % 4 == 0, "a request is written as 32-bit words");

const char *const recorder_reason_name[RECORDER_REASONS] = {"warn", "request", "fault", "miss",
							    "mark"};

uint64_t recorder_result_hash(const struct mc_result *res)
{
	uint64_t h = hash_u64(hash_u64(HASH_START, res->n), res->floored);

	for (uint32_t i = 0; i < res->n_futures && i < MC_FUTURES_MAX; i++) {
		const struct mc_risk *k = &res->risk[i];

		h = hash_u64(hash_u64(h, k->hits), k->undecided);
		h = hash_f64(hash_f64(h, k->lo), k->hi);
		h = k->hits ? hash_f64(h, k->impact_mps) : h; /* NaN has many faces */
	}
	return h;
}

void recorder_write_head(FILE *f)
{
	fprintf(f, "# aebmc requests 1: (time) hash of request, hash of result, %zu words\n",
		sizeof(struct mc_request) / 4);
}

static void write_time(FILE *f, int64_t t_ns)
{
	fprintf(f, "(%010" PRId64 ".%06" PRId64 ")", t_ns / 1000000000, t_ns / 1000 % 1000000);
}

/* Readable by recorder_parse() on any little-endian machine. */
void recorder_write(FILE *f, int64_t t_ns, const struct mc_request *req, uint64_t result_hash)
{
	uint32_t word[sizeof(struct mc_request) / 4];

	memcpy(word, req, sizeof(*req));
	write_time(f, t_ns);
	fprintf(f, " %016" PRIx64 " %016" PRIx64, mc_request_hash(req), result_hash);
	for (size_t i = 0; i < sizeof(word) / sizeof(word[0]); i++) {
		fprintf(f, " %x", word[i]);
	}
	fputc('\n', f);
}

void recorder_write_reason(FILE *f, enum recorder_reason why, uint64_t n, int64_t first_ns,
			   int64_t last_ns)
{
	fprintf(f, "# %" PRIu64 " %s: ", n, recorder_reason_name[why]);
	write_time(f, first_ns);
	fputs(" to ", f);
	write_time(f, last_ns);
	fputc('\n', f);
}

int recorder_parse(const char *line, struct mc_request *req, uint64_t *result_hash)
{
	uint32_t word[sizeof(struct mc_request) / 4];
	uint64_t hash, result;
	struct mc_request q;
	int at = 0, step;

	if (line[strspn(line, " \t\r\n")] == '\0' || line[0] == '#') {
		return -ENOMSG;
	}
	if (sscanf(line, "(%*d.%*d) %" SCNx64 " %" SCNx64 "%n", &hash, &result, &at) != 2 || !at) {
		return -EBADMSG;
	}
	for (size_t i = 0; i < sizeof(word) / sizeof(word[0]); i++) {
		if (sscanf(line + at, " %8" SCNx32 "%n", &word[i], &step) != 1) {
			return -EBADMSG;
		}
		at += step;
	}
	memcpy(&q, word, sizeof(q));
	if (line[at + (int)strspn(line + at, " \r\n")] != '\0' || mc_check(&q) ||
	    mc_request_hash(&q) != hash) {
		return -EBADMSG;
	}
	*req = q;
	*result_hash = result;
	return 0;
}
