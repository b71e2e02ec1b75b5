/* SPDX-License-Identifier: MIT
 * The snapshot as JSON and in words. See status.h.
 */
#include "status.h"

#include <math.h>

#include "clock.h"
#include "json.h"

static const char *const transmit_name[] = {"none", "shadow", "armed"};

static void reasons(struct json *j, uint32_t fault)
{
	json_open(j, "reasons", '[');
	for (int i = 0; i < FAULTS; i++) {
		if (fault & 1u << i) {
			json_str(j, NULL, fault_table[i].name);
		}
	}
	json_close(j, ']');
}

static void risks(struct json *j, const struct publish_in *p)
{
	static const char *const name[FUTURES] = {"defer", "now", "driver", "nobody"};

	json_open(j, "risk", '{');
	for (int i = 0; i < FUTURES; i++) {
		const struct mc_risk *r = &p->res.risk[i];

		json_open(j, name[i], '{');
		json_num(j, "p", p->have_result ? r->p : NAN);
		json_num(j, "lo", p->have_result ? r->lo : NAN);
		json_num(j, "hi", p->have_result ? r->hi : NAN);
		json_close(j, '}');
	}
	json_close(j, '}');
}

static void scene(struct json *j, const struct scene *s)
{
	json_open(j, "scene", '{');
	json_num(j, "ego_speed_mps", s->ego_valid ? s->x[SCENE_EGO_SPEED] : NAN);
	json_num(j, "headway_m", s->lead_valid ? s->x[SCENE_HEADWAY] : NAN);
	json_num(j, "lead_speed_mps", s->lead_valid ? s->x[SCENE_LEAD_SPEED] : NAN);
	json_num(j, "lead_accel_mps2", s->lead_valid ? s->x[SCENE_LEAD_ACCEL] : NAN);
	json_num(j, "input_age_ms", (double)s->oldest_input_ns / 1e6);
	json_close(j, '}');
}

static void times(struct json *j, const struct publish_in *p)
{
	const struct {
		const char *key;
		int64_t ns;
	} t[] = {
		{"input_age", p->input_age_ns},
		{"mc", p->mc_ns},
		{"decision", p->decision_ns},
		{"total", p->total_ns},
	};

	json_open(j, "last_ms", '{');
	for (size_t i = 0; i < sizeof(t) / sizeof(t[0]); i++) {
		json_num(j, t[i].key, t[i].ns < 0 ? NAN : (double)t[i].ns / 1e6);
	}
	json_close(j, '}');
}

/* A stage that was never passed has no figures. */
static void stages(struct json *j, const struct status *s, const struct hist *hist)
{
	static const struct {
		const char *key;
		double q;
	} figure[] = {{"p50_ms", 0.5}, {"p95_ms", 0.95}, {"p99_ms", 0.99}, {"p99_9_ms", 0.999}};

	json_open(j, "stages", '{');
	for (int i = 0; i < STAGES; i++) {
		const struct hist *h = &hist[i];
		const uint64_t n = hist_count(h);

		json_open(j, stage_table[i].name, '{');
		json_uint(j, "n", n);
		for (size_t k = 0; k < sizeof(figure) / sizeof(figure[0]); k++) {
			json_num(j, figure[k].key,
				 n ? (double)hist_percentile(h, figure[k].q) / 1e6 : NAN);
		}
		json_num(j, "max_ms", n ? (double)hist_max_ns(h) / 1e6 : NAN);
		if (stage_table[i].budget_ns) {
			json_uint(j, "misses", s->stats.stage_misses[i]);
		}
		json_close(j, '}');
	}
	json_close(j, '}');
}

static void counters(struct json *j, const struct status *s)
{
	const struct {
		const char *key;
		uint64_t n;
	} c[] = {
		{"frames", s->stats.frames},
		{"scans", s->stats.scans},
		{"evaluations", s->stats.evaluations},
		{"skipped_scans", s->stats.skipped},
		{"stage_misses", s->stats.stage_miss},
		{"late_results", s->stats.late},
		{"period_misses", s->stats.period_miss},
		{"sent", s->bus.sent},
		{"confirmed", s->bus.confirmed},
		{"tx_refused", s->bus.tx_refused},
		{"rx_dropped", s->bus.dropped},
		{"rx_local", s->bus.local},
		{"foreign", s->bus.foreign},
		{"bad_stamps", s->bus.stamps},
		{"error_frames", s->bus.error_frames},
		{"warn", s->dec.entered[LEVEL_WARN]},
		{"partial", s->dec.entered[LEVEL_PARTIAL]},
		{"full", s->dec.entered[LEVEL_FULL]},
	};

	json_open(j, "counters", '{');
	for (size_t i = 0; i < sizeof(c) / sizeof(c[0]); i++) {
		json_uint(j, c[i].key, c[i].n);
	}
	json_close(j, '}');
	json_open(j, "rejected", '{');
	for (int i = 0; i < SCENE_REJECTS; i++) {
		json_uint(j, scene_reject_name[i], s->rejected[i]);
	}
	json_close(j, '}');
}

static void links_json(struct json *j, const struct status_link *l, int n)
{
	json_open(j, "links", '[');
	for (int i = 0; i < n; i++) {
		json_open(j, NULL, '{');
		json_str(j, "name", l[i].name);
		json_bool(j, "up", l[i].up);
		json_str(j, "state", l[i].link.state);
		json_bool(j, "known", l[i].link.known);
		if (l[i].link.counted) {
			json_uint(j, "tx_errors", l[i].link.tx_errors);
			json_uint(j, "rx_errors", l[i].link.rx_errors);
		}
		json_uint(j, "bitrate", l[i].link.bitrate);
		json_num(j, "sample_point", l[i].link.sample_point);
		json_uint(j, "restart_ms", l[i].link.restart_ms);
		json_close(j, '}');
	}
	json_close(j, ']');
}

void status_json(const struct status *s, const struct hist *hist, const struct status_link *links,
		 int n_links, FILE *out)
{
	struct json j = json_start(out);

	json_open(&j, NULL, '{');
	json_str(&j, "schema", "aebmc.status.1");
	json_num(&j, "time_s", (double)s->t_ns / CLOCK_NS_PER_S);
	json_str(&j, "state", state_name[s->now.state]);
	reasons(&j, s->now.fault);
	json_str(&j, "level", level_name[s->now.dec.level]);
	json_str(&j, "cause", cause_name[s->now.dec.cause]);
	json_num(&j, "accel_mps2", s->now.dec.accel_mps2);
	json_str(&j, "transmit", transmit_name[s->transmit]);
	json_bool(&j, "armed", (int)s->armed);
	json_str(&j, "backend", publish_backend_name[s->now.backend]);
	json_uint(&j, "evaluation", s->now.eval_id);
	json_uint(&j, "samples", s->now.samples);
	json_uint(&j, "hash", s->now.hash);
	risks(&j, &s->now);
	scene(&j, &s->now.scene);
	times(&j, &s->now);
	stages(&j, s, hist);
	counters(&j, s);
	links_json(&j, links, n_links);
	json_close(&j, '}');
}

int status_words(const struct status *s, char *line, int size)
{
	return snprintf(
		line, (size_t)size,
		"%s, %s; %u samples on %s; %llu evaluations, %llu missed periods, %llu "
		"skipped scans",
		state_name[s->now.state], level_name[s->now.dec.level], s->stats.samples,
		publish_backend_name[s->now.backend], (unsigned long long)s->stats.evaluations,
		(unsigned long long)s->stats.period_miss, (unsigned long long)s->stats.skipped);
}
