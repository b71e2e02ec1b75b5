/* SPDX-License-Identifier: MIT
 * What a replay reports: events as they happen, figures at the end; as JSON or in words.
 */
#include <inttypes.h>
#include <math.h>
#include "cli.h"
#include "clock.h"
#include "replay.h"
#include "words.h"

double replay_time_s(const struct replay *r, int64_t t_ns)
{
	return (double)(t_ns - r->bus.first_ns) / CLOCK_NS_PER_S;
}

/* ---- events ------------------------------------------------------------------------------------ */

static void json_faults(struct json *j, uint32_t fault)
{
	json_open(j, "faults", '[');
	for (int i = 0; i < FAULTS; i++) {
		if (fault & 1u << i) {
			json_str(j, NULL, fault_table[i].name);
		}
	}
	json_close(j, ']');
}

static void json_scene(struct json *j, const struct scene *s)
{
	json_num(j, "ego_speed_mps", s->ego_valid ? s->x[SCENE_EGO_SPEED] : NAN);
	json_num(j, "headway_m", s->lead_valid ? s->x[SCENE_HEADWAY] : NAN);
	json_num(j, "lead_speed_mps", s->lead_valid ? s->x[SCENE_LEAD_SPEED] : NAN);
	json_num(j, "lead_accel_mps2", s->lead_valid ? s->x[SCENE_LEAD_ACCEL] : NAN);
	json_num(j, "ttc_s", words_ttc_s(s));
}

static void json_event(struct json *j, double time_s, const struct publish_in *now)
{
	json_open(j, NULL, '{');
	json_num(j, "time_s", time_s);
	json_str(j, "state", state_name[now->state]);
	json_faults(j, now->fault);
	json_str(j, "level", level_name[now->dec.level]);
	json_str(j, "cause", cause_name[now->dec.cause]);
	json_num(j, "accel_mps2", now->dec.accel_mps2);
	json_scene(j, &now->scene);
	json_close(j, '}');
}

/* ARMED and BRAKE follow from the level, which is told already. */
static int is_usual(enum state s)
{
	return s == STATE_ARMED || s == STATE_BRAKE;
}

void replay_begin(struct replay *r)
{
	r->state = STATE_INIT;
	r->line = progress_start(r->name);
	if (r->args->json) {
		r->json = json_start(stdout);
		json_head(&r->json, "replay");
		json_open(&r->json, "events", '[');
	}
}

void replay_change(void *arg, int64_t t_ns, const struct publish_in *now)
{
	struct replay *r = arg;
	double time_s = replay_time_s(r, t_ns);

	progress_clear(&r->line);
	if (r->watch && now->dec.level != r->level) {
		r->watch->level(r->watch->arg, time_s, now->dec.level);
	}
	if (r->args->json) {
		json_event(&r->json, time_s, now);
	}
	if (r->words && now->dec.level != r->level) {
		words_level(r->words, time_s, now, r->level);
	}
	if (r->words && now->state != r->state && !(is_usual(now->state) && is_usual(r->state))) {
		words_state(r->words, time_s, now, r->state);
	}
	r->level = now->dec.level;
	r->state = now->state;
}

/* ---- figures ----------------------------------------------------------------------------------- */

static double realtime_factor(const struct replay *r)
{
	return r->wall_ns > 0 ? (double)(r->bus.last_ns - r->bus.first_ns) / (double)r->wall_ns : 0;
}

/* Without a single hit only a bound is known: below 3/N. NaN without an evaluation. */
static double risk_max(const struct replay *r)
{
	const struct pipeline_stats *s = pipeline_stats(r->pipe);
	double bound = s->evaluations ? 3 / (double)r->cfg.mc_samples : NAN;

	return s->risk_max > 0 ? s->risk_max : bound;
}

static void json_rejected(struct json *j, const struct replay *r)
{
	const uint64_t *rejected = pipeline_rejected(r->pipe);

	json_open(j, "rejected", '{');
	for (int i = 0; i < SCENE_REJECTS; i++) {
		json_uint(j, scene_reject_name[i], rejected[i]);
	}
	json_close(j, '}');
}

static void json_log(struct json *j, const struct bus_stats *s)
{
	json_open(j, "log", '{');
	json_uint(j, "malformed_lines", s->malformed);
	json_uint(j, "other_interfaces", s->other_iface);
	json_uint(j, "error_frames", s->error_frames);
	json_uint(j, "remote_frames", s->remote_frames);
	json_uint(j, "disorder", s->disorder);
	json_close(j, '}');
}

static void json_counts(struct json *j, const struct replay *r)
{
	const struct pipeline_stats *s = pipeline_stats(r->pipe);
	const uint64_t *entered = pipeline_decision(r->pipe)->entered;

	json_uint(j, "frames", s->frames);
	json_uint(j, "scans", s->scans);
	json_uint(j, "evaluations", s->evaluations);
	json_uint(j, "skipped", s->skipped);
	json_uint(j, "frames_out", s->sent);
	json_uint(j, "warn", entered[LEVEL_WARN]);
	json_uint(j, "partial", entered[LEVEL_PARTIAL]);
	json_uint(j, "full", entered[LEVEL_FULL]);
	json_num(j, "risk_max", risk_max(r));
	json_bool(j, "risk_max_is_bound", s->evaluations > 0 && s->risk_max == 0);
}

static void json_figures(struct json *j, const struct replay *r)
{
	char hash[20];

	json_close(j, ']');
	json_counts(j, r);
	json_rejected(j, r);
	json_log(j, r->log->ops->stats(r->log));
	json_uint(j, "samples", (uint64_t)r->cfg.mc_samples);
	json_uint(j, "seed", (uint64_t)r->cfg.mc_seed);
	snprintf(hash, sizeof(hash), "%016" PRIx64, config_hash(&r->cfg, r->map));
	json_str(j, "config_hash", hash);
	json_bool(j, "interrupted", cli_interrupted());
	json_num(j, "log_s", replay_time_s(r, r->bus.last_ns));
	json_num(j, "realtime_factor", realtime_factor(r));
	json_close(j, '}');
}

static void print_refused(const struct replay *r)
{
	const struct bus_stats *s = r->log->ops->stats(r->log);
	const uint64_t *rejected = pipeline_rejected(r->pipe);

	for (int i = 0; i < SCENE_REJECTS; i++) {
		if (rejected[i]) {
			fprintf(r->words, "%" PRIu64 " frames rejected: %s\n", rejected[i],
				scene_reject_name[i]);
		}
	}
	if (s->malformed) {
		fprintf(r->words, "%" PRIu64 " lines of the log are no frames\n", s->malformed);
	}
	if (s->other_iface) {
		fprintf(r->words, "%" PRIu64 " frames on other interfaces\n", s->other_iface);
	}
}

static void print_risk_max(const struct replay *r)
{
	if (pipeline_stats(r->pipe)->evaluations) {
		fprintf(r->words, "; largest risk of waiting one period %s%.3g %%",
			pipeline_stats(r->pipe)->risk_max > 0 ? "" : "below ", risk_max(r) * 100);
	}
	fputc('\n', r->words);
}

static void print_summary(const struct replay *r)
{
	const struct pipeline_stats *s = pipeline_stats(r->pipe);
	const uint64_t *entered = pipeline_decision(r->pipe)->entered;

	fprintf(r->words,
		"%s%.1f s of driving, %" PRIu64 " frames, %" PRIu64
		" evaluations of %lld samples; %.1f times real time\n"
		"warnings %" PRIu64 ", partial requests %" PRIu64 ", full requests %" PRIu64,
		cli_interrupted() ? "Interrupted: " : "", replay_time_s(r, r->bus.last_ns),
		s->frames, s->evaluations, (long long)r->cfg.mc_samples, realtime_factor(r),
		entered[LEVEL_WARN], entered[LEVEL_PARTIAL], entered[LEVEL_FULL]);
	print_risk_max(r);
	print_refused(r);
}

void replay_end(struct replay *r)
{
	progress_clear(&r->line);
	if (r->args->json) {
		json_figures(&r->json, r);
	}
	if (r->words) {
		print_summary(r);
	}
}
