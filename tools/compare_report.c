/* SPDX-License-Identifier: MIT
 * What a comparison has to tell: for each log what was gained, lost or changed, then a table over all. Words or JSON.
 */
#include <inttypes.h>
#include <math.h>
#include "compare.h"

#define MOVED_S 0.0005 /* as printed, in hundredths, it would be another time */

static int is_good(const struct compare_log *l)
{
	return !l->run[SIDE_A].head.code && !l->run[SIDE_B].head.code;
}

static const char *one_of(enum compare_kind kind)
{
	return kind == KIND_WARNING ? "warning" : "request";
}

/* ---- words ------------------------------------------------------------------------------------- */

static void print_span(FILE *out, const char *what, enum compare_kind kind,
		       const struct compare_span *s)
{
	fprintf(out, "  %-7s %8.2f s  %s", what, s->from_s, one_of(kind));
	if (kind == KIND_REQUEST) {
		fprintf(out, ", %s", level_name[s->level]);
	}
	fprintf(out, ", for %.2f s\n", s->to_s - s->from_s);
}

static void print_kept(FILE *out, enum compare_kind kind, const struct compare_span *a,
		       const struct compare_span *b)
{
	const double later = b->from_s - a->from_s;
	const int other = kind == KIND_REQUEST && a->level != b->level;

	if (!other && fabs(later) < MOVED_S) {
		return;
	}
	fprintf(out, "  %-7s %8.2f s  %s", other ? "changed" : "moved", a->from_s, one_of(kind));
	if (other) {
		fprintf(out, ", %s -> %s", level_name[a->level], level_name[b->level]);
	}
	fprintf(out, ", %.2f s %s\n", fabs(later), later < 0 ? "sooner" : "later");
}

static void print_diff(FILE *out, enum compare_kind kind, const struct compare_diff *d)
{
	for (int i = 0; i < d->n[SIDE_A]; i++) {
		const struct compare_span *a = &d->span[SIDE_A][i];

		if (d->partner[i] < 0) {
			print_span(out, "lost", kind, a);
		} else {
			print_kept(out, kind, a, &d->span[SIDE_B][d->partner[i]]);
		}
	}
	for (int i = 0; i < d->n[SIDE_B]; i++) {
		if (compare_is_gained(d, i)) {
			print_span(out, "gained", kind, &d->span[SIDE_B][i]);
		}
	}
}

static void print_log(FILE *out, const struct compare_log *l)
{
	fprintf(out, "%s\n", l->path);
	for (int k = 0; k < KINDS && is_good(l); k++) {
		print_diff(out, k, &l->diff[k]);
	}
	if (l->picture) {
		fprintf(out, "  picture %s\n", l->picture);
	}
}

static void print_row(FILE *out, const char *path, double log_s,
		      const struct compare_diff diff[KINDS])
{
	for (int k = 0; k < KINDS; k++) {
		fprintf(out, "%5d %5d %5d %7d  |", diff[k].n[SIDE_A], diff[k].n[SIDE_B],
			diff[k].lost, diff[k].gained);
	}
	fprintf(out, " %8.1f s  %s\n", log_s, path);
}

static void add(struct compare_diff sum[KINDS], const struct compare_diff diff[KINDS])
{
	for (int k = 0; k < KINDS; k++) {
		sum[k].n[SIDE_A] += diff[k].n[SIDE_A];
		sum[k].n[SIDE_B] += diff[k].n[SIDE_B];
		sum[k].lost += diff[k].lost;
		sum[k].gained += diff[k].gained;
	}
}

void compare_words(const struct replay_args *a, const struct compare_log *log, int n, FILE *out)
{
	struct compare_diff sum[KINDS] = {0};
	double all_s = 0;

	fprintf(out, "A %s\nB %s\n\n", a->compare[SIDE_A], a->compare[SIDE_B]);
	for (int i = 0; i < n; i++) {
		print_log(out, &log[i]);
	}
	fprintf(out, "\nwarnings                 | requests                 |\n");
	for (int k = 0; k < KINDS; k++) {
		fprintf(out, "    A     B  lost  gained  |");
	}
	fputs("\n", out);
	for (int i = 0; i < n; i++) {
		const double log_s = log[i].run[SIDE_A].head.log_s;

		if (!is_good(&log[i])) {
			fprintf(out, "%-56s %s\n", "failed", log[i].path);
			continue;
		}
		print_row(out, log[i].path, log_s, log[i].diff);
		add(sum, log[i].diff);
		all_s += log_s;
	}
	print_row(out, "all", all_s, sum);
}

/* ---- JSON -------------------------------------------------------------------------------------- */

static void json_span(struct json *j, const char *key, const struct compare_span *s)
{
	json_open(j, key, '{');
	json_num(j, "time_s", s->from_s);
	json_num(j, "until_s", s->to_s);
	json_str(j, "level", level_name[s->level]);
	json_close(j, '}');
}

static void json_kept(struct json *j, const struct compare_diff *d)
{
	json_open(j, "kept", '[');
	for (int i = 0; i < d->n[SIDE_A]; i++) {
		if (d->partner[i] >= 0) {
			json_open(j, NULL, '{');
			json_span(j, "a", &d->span[SIDE_A][i]);
			json_span(j, "b", &d->span[SIDE_B][d->partner[i]]);
			json_close(j, '}');
		}
	}
	json_close(j, ']');
}

static void json_diff(struct json *j, const char *key, const struct compare_diff *d)
{
	json_open(j, key, '{');
	json_uint(j, "a", (uint64_t)d->n[SIDE_A]);
	json_uint(j, "b", (uint64_t)d->n[SIDE_B]);
	json_open(j, "lost", '[');
	for (int i = 0; i < d->n[SIDE_A]; i++) {
		if (d->partner[i] < 0) {
			json_span(j, NULL, &d->span[SIDE_A][i]);
		}
	}
	json_close(j, ']');
	json_open(j, "gained", '[');
	for (int i = 0; i < d->n[SIDE_B]; i++) {
		if (compare_is_gained(d, i)) {
			json_span(j, NULL, &d->span[SIDE_B][i]);
		}
	}
	json_close(j, ']');
	json_kept(j, d);
	json_close(j, '}');
}

static void json_log(struct json *j, const struct compare_log *l)
{
	static const char *const key[SIDES] = {"risk_max_a", "risk_max_b"};

	json_open(j, NULL, '{');
	json_str(j, "log", l->path);
	json_bool(j, "failed", !is_good(l));
	json_str(j, "picture", l->picture);
	if (is_good(l)) {
		json_num(j, "log_s", l->run[SIDE_A].head.log_s);
		json_uint(j, "evaluations", l->run[SIDE_A].head.evaluations);
		for (int side = 0; side < SIDES; side++) {
			json_num(j, key[side], l->run[side].head.risk_max);
		}
		for (int k = 0; k < KINDS; k++) {
			json_diff(j, compare_kind_name[k], &l->diff[k]);
		}
	}
	json_close(j, '}');
}

static void json_side(struct json *j, const char *key, const char *path,
		      const struct compare_log *log, int n, enum compare_side side)
{
	char hash[20];

	json_open(j, key, '{');
	json_str(j, "config", path);
	for (int i = 0; i < n; i++) {
		if (is_good(&log[i])) {
			snprintf(hash, sizeof(hash), "%016" PRIx64, log[i].run[side].head.hash);
			json_str(j, "config_hash", hash);
			break;
		}
	}
	json_close(j, '}');
}

void compare_json(const struct replay_args *a, const struct compare_log *log, int n, FILE *out)
{
	struct json j = json_start(out);

	json_head(&j, "compare");
	json_side(&j, "a", a->compare[SIDE_A], log, n, SIDE_A);
	json_side(&j, "b", a->compare[SIDE_B], log, n, SIDE_B);
	json_open(&j, "logs", '[');
	for (int i = 0; i < n; i++) {
		json_log(&j, &log[i]);
	}
	json_close(&j, ']');
	json_open(&j, "all", '{');
	for (int k = 0; k < KINDS; k++) {
		uint64_t lost = 0, gained = 0;

		for (int i = 0; i < n; i++) {
			lost += (uint64_t)log[i].diff[k].lost;
			gained += (uint64_t)log[i].diff[k].gained;
		}
		json_open(&j, compare_kind_name[k], '{');
		json_uint(&j, "lost", lost);
		json_uint(&j, "gained", gained);
		json_close(&j, '}');
	}
	json_close(&j, '}');
	json_close(&j, '}');
}
