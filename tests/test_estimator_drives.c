/* SPDX-License-Identifier: MIT
 * Whole drives through decoder, tracker and filter, against their truth; a recorded one where it is at hand.
 */
#include "drives.h"

#include <unistd.h>

struct watch {
	struct estimator *e;
	int n_targets;
	int scans_after, leads, late_faults; /* scans after the first second */
	double nees, bias[SCENE_DIM], worst[SCENE_DIM];
	double lead_accel_sigma; /* the largest */
};

/* The car that should lead: the nearest in the lane. */
static const struct drive_car *true_lead(const struct watch *w, const struct drive_truth *now)
{
	const struct drive_car *lead = NULL;

	for (int i = 0; i < w->n_targets; i++) {
		const struct drive_car *c = &now->target[i];

		if (fabs(c->lateral_m) < 1 && (!lead || c->gap_m < lead->gap_m)) {
			lead = c;
		}
	}
	return lead;
}

static void compare(struct watch *w, const struct scene *s, const struct drive_truth *now)
{
	const struct drive_car *lead = true_lead(w, now);
	const double truth[SCENE_DIM] = {lead->gap_m, now->ego.speed_mps, now->ego.accel_mps2,
					 lead->speed_mps, lead->accel_mps2};

	w->leads++;
	w->lead_accel_sigma =
		fmax(w->lead_accel_sigma, sqrt(s->cov[SCENE_LEAD_ACCEL][SCENE_LEAD_ACCEL]));
	w->nees += drives_nees(s, truth);
	for (int i = 0; i < SCENE_DIM; i++) {
		const double error = s->x[i] - truth[i];

		w->bias[i] += error;
		w->worst[i] = fmax(w->worst[i], fabs(error));
	}
}

static int watch_frame(void *arg, const struct bus_frame *f, const struct drive_truth *now)
{
	struct watch *w = arg;
	struct scene s;

	if (!estimator_frame(w->e, f)) {
		return 0;
	}
	estimator_scene(w->e, f->t_ns, &s);
	drives_assert_sound(&s);
	if (now->t_s > 1) {
		w->scans_after++;
		w->late_faults += s.fault != 0 || !s.ego_valid;
		if (s.lead_valid) {
			compare(w, &s, now);
		}
	}
	return 0;
}

static struct watch run_drive(const char *car, const char *drive, double dropout, double latency_s,
			      double latency_sigma_s)
{
	struct config cfg;
	struct mapping *map = drives_load(car, &cfg);
	const struct drive *d = drive_find(drive);
	struct watch w = {.n_targets = d->n};
	const struct drive_options o = {
		.seed = 5, .dropout = dropout, .emit = watch_frame, .arg = &w};
	struct config told = cfg;

	told.radar_latency += latency_s;
	told.radar_latency_sigma = latency_sigma_s;
	assert_int_equal(estimator_open(&told, map, &w.e), 0);
	assert_int_equal(drive_run(d, &cfg, map, &o), 0);
	for (int i = 0; i < SCENE_REJECTS; i++) {
		assert_int_equal(estimator_rejected(w.e)[i], 0);
	}
	estimator_close(w.e);
	config_mapping_free(map);
	return w;
}

static const char *const cars[] = {"generic", "toyota-tss-p"};

static void errors_are_no_larger_than_it_says(void **state)
{
	static const char *const drives[] = {"brake", "follow", "stopped", "light"};

	(void)state;
	for (int i = 0; i < 16; i++) {
		const struct watch w =
			run_drive(cars[i / 8], drives[i % 4], i / 4 % 2 ? 0.1 : 0, 0, 0);

		assert_int_equal(w.late_faults, 0);
		assert_int_equal(w.leads, w.scans_after);
		/* the jerk of real cars is not white: one-sided */
		assert_true(w.nees / w.leads < SCENE_DIM);
		assert_true(fabs(w.bias[SCENE_HEADWAY] / w.leads) < 0.03);
		assert_true(fabs(w.bias[SCENE_EGO_SPEED] / w.leads) < 0.02);
		assert_true(fabs(w.bias[SCENE_LEAD_SPEED] / w.leads) < 0.05);
		assert_true(w.worst[SCENE_HEADWAY] < 0.5);
		assert_true(w.worst[SCENE_LEAD_SPEED] < 0.8);
	}
}

static void a_wrong_latency_shows(void **state)
{
	const struct watch w = run_drive("generic", "stopped", 0, -0.075, 0);

	(void)state;
	assert_true(w.nees / w.leads > 10 * SCENE_DIM);
	assert_true(fabs(w.bias[SCENE_HEADWAY] / w.leads - 13.9 * 0.075) < 0.1);
}

/* A latency that is off by what its sigma allows is within the errors that it states. */
static void a_latency_within_its_sigma_is_covered(void **state)
{
	(void)state;
	assert_true(run_drive("generic", "stopped", 0, -0.025, 0).nees >
		    2 * run_drive("generic", "stopped", 0, -0.025, 0.025).nees);
	for (int i = -1; i <= 1; i += 2) {
		const struct watch w = run_drive("generic", "stopped", 0, 0.025 * i, 0.025);

		assert_true(fabs(w.bias[SCENE_HEADWAY] / w.leads) > 0.25);
		assert_true(w.nees / w.leads < SCENE_DIM);
	}
}

/* Cars that move in and out: which car leads, and when. */
struct change {
	struct estimator *e;
	double first_s[DRIVE_TARGETS_MAX], last_s[DRIVE_TARGETS_MAX]; /* when each led */
	int none;                                                     /* scans without a lead */
	double nearer_s, behind_s; /* when each became more probable than the lead */
	double object_gap_m;       /* largest error of their headways from then on */
};

static void watch_others(struct change *c, const struct scene *s, const struct drive_truth *now)
{
	const struct scene_object *near = &s->other[SCENE_NEARER], *far = &s->other[SCENE_BEHIND];

	if (near->p > scene_lead_p(s)) {
		c->nearer_s = c->nearer_s > 0 ? c->nearer_s : now->t_s;
		c->object_gap_m =
			fmax(c->object_gap_m, fabs(near->headway_m - now->target[1].gap_m));
	}
	if (far->p > scene_lead_p(s)) {
		c->behind_s = c->behind_s > 0 ? c->behind_s : now->t_s;
		c->object_gap_m =
			fmax(c->object_gap_m, fabs(far->headway_m - now->target[1].gap_m));
	}
}

static int watch_change(void *arg, const struct bus_frame *f, const struct drive_truth *now)
{
	struct change *c = arg;
	struct scene s;

	if (!estimator_frame(c->e, f) || now->t_s < 1) {
		return 0;
	}
	estimator_scene(c->e, f->t_ns, &s);
	drives_assert_sound(&s);
	c->none += !s.lead_valid;
	watch_others(c, &s, now);
	for (int i = 0; i < DRIVE_TARGETS_MAX && s.lead_valid; i++) {
		if (fabs(s.x[SCENE_HEADWAY] - now->target[i].gap_m) < 1 &&
		    fabs(s.lateral_m - now->target[i].lateral_m) < 1) {
			c->first_s[i] = c->first_s[i] > 0 ? c->first_s[i] : now->t_s;
			c->last_s[i] = now->t_s;
		}
	}
	return 0;
}

static struct change run_change(const char *car, const char *drive)
{
	struct config cfg;
	struct mapping *map = drives_load(car, &cfg);
	struct change c = {0};
	const struct drive_options o = {.seed = 2, .emit = watch_change, .arg = &c};

	assert_int_equal(estimator_open(&cfg, map, &c.e), 0);
	drive_run(drive_find(drive), &cfg, map, &o);
	estimator_close(c.e);
	config_mapping_free(map);
	return c;
}

static void who_cuts_in_leads_and_who_cuts_out_does_not(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		const struct change in = run_change(cars[i], "cutin");
		const struct change out = run_change(cars[i], "cutout");

		/* at 8.6 s it crosses the corridor's edge */
		assert_true(in.first_s[1] > 8.5 && in.first_s[1] < 9.1);
		assert_true(in.last_s[0] < in.first_s[1] && in.last_s[0] > 8.5);
		/* at 9.2 s */
		assert_true(out.last_s[0] > 9.1 && out.last_s[0] < 9.6);
		assert_true(out.first_s[1] > out.last_s[0] && out.first_s[1] < 9.9);
		assert_int_equal(in.none + (i ? out.none : 0), 0);
		/* a radar that sees both says so before, and where they are */
		if (i) {
			assert_true(in.nearer_s > 8 && in.nearer_s < in.first_s[1] - 0.2);
			assert_true(out.behind_s > 8 && out.behind_s < out.first_s[1] - 0.2);
			assert_true(in.object_gap_m < 1 && out.object_gap_m < 1);
		}
		assert_true(in.behind_s == 0 && out.nearer_s == 0);
	}
}

static void a_standing_lead_stays_where_it_is(void **state)
{
	const struct watch w = run_drive("generic", "stopped", 0, 0, 0);

	(void)state;
	assert_true(w.worst[SCENE_LEAD_ACCEL] < 1);
	assert_true(w.lead_accel_sigma < 0.11);
}

/* ---- a recorded drive ----------------------------------------------------------------------- */

struct recording {
	struct estimator *e;
	const struct mapping *map;
	int64_t first_ns;
	int frames, scans, leads;
	double nearest_m, farthest_m;
};

static void take_line(struct recording *r, const char *line)
{
	char iface[BUS_NAME_MAX];
	struct bus_frame f;
	struct scene s;

	assert_int_equal(bus_log_parse(line, iface, &f), 0);
	f.iface = strcmp(iface, r->map->iface[0]) ? 1 : 0;
	r->first_ns = r->frames++ ? r->first_ns : f.t_ns;
	if (!estimator_frame(r->e, &f)) {
		return;
	}
	estimator_scene(r->e, f.t_ns, &s);
	drives_assert_sound(&s);
	r->scans++;
	assert_true(r->scans < 3 || s.fault == 0);
	if (s.lead_valid) {
		r->leads++;
		r->nearest_m = fmin(r->nearest_m, s.x[SCENE_HEADWAY]);
		r->farthest_m = fmax(r->farthest_m, s.x[SCENE_HEADWAY]);
	}
}

#define RECORDED "../shared/canlog/comma2k19-rav4-seg40-speed-radar.log.xz"

static void a_recorded_lead_is_followed(void **state)
{
	struct recording r = {.nearest_m = 1e9};
	struct config cfg;
	char line[256];

	(void)state;
	if (access(RECORDED, R_OK)) {
		print_message("needs shared\n");
		skip();
	}
	struct mapping *map = drives_load("toyota-tss-p", &cfg);
	FILE *in = popen("xz -dc " RECORDED, "r");

	assert_non_null(in);
	r.map = map;
	assert_int_equal(estimator_open(&cfg, map, &r.e), 0);
	while (fgets(line, sizeof(line), in)) {
		line[strcspn(line, "\n")] = '\0';
		take_line(&r, line);
	}
	assert_int_equal(pclose(in), 0);
	assert_int_equal(r.frames, 26661);
	assert_int_equal(r.scans, 1198); /* two go to the counters' start */
	assert_in_range(r.leads, 1190, 1198);
	assert_true(r.nearest_m > 19.5 && r.nearest_m < 20.7);
	assert_true(r.farthest_m > 74 && r.farthest_m < 78);
	/* two spikes of the speed at a bump */
	assert_int_equal(estimator_rejected(r.e)[SCENE_REJECT_IMPLAUSIBLE], 2);
	estimator_close(r.e);
	config_mapping_free(map);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(errors_are_no_larger_than_it_says),
		cmocka_unit_test(a_wrong_latency_shows),
		cmocka_unit_test(a_latency_within_its_sigma_is_covered),
		cmocka_unit_test(who_cuts_in_leads_and_who_cuts_out_does_not),
		cmocka_unit_test(a_standing_lead_stays_where_it_is),
		cmocka_unit_test(a_recorded_lead_is_followed),
	};

	return cmocka_run_group_tests_name("estimator_drives", tests, NULL, NULL);
}
