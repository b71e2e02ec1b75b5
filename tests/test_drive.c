/* SPDX-License-Identifier: MIT
 * Made-up drives: motion, noise, frames through a mapping, and another lead spliced into a drive.
 */
#include "drives.h"

#include <errno.h>

#include "../tools/splice.c"

#define MS CLOCK_NS_PER_MS

static const char *const cars[] = {"generic", "toyota-tss-p"};

/* ---- motion --------------------------------------------------------------------------------- */

static struct drive_truth at_start(const struct drive *d)
{
	struct drive_truth w = {.ego.speed_mps = d->ego.speed_mps};

	for (int i = 0; i < d->n; i++) {
		w.target[i].speed_mps = d->target[i].path.speed_mps;
		w.target[i].gap_m = d->target[i].gap_m;
		w.target[i].lateral_m = d->target[i].lateral_m;
	}
	return w;
}

static void a_path_is_driven(void **state)
{
	const struct drive d = {
		.ego = {.speed_mps = 20},
		.n = 1,
		.target = {{.gap_m = 50,
			    .path = {10, {{1, -5}}},
			    .lateral_m = 1,
			    .to_lateral_m = 3,
			    .change_s = 1,
			    .changed_s = 3}},
	};
	struct drive_truth w = at_start(&d);
	double accel = 0;

	(void)state;
	for (int ms = 1; ms <= 5000; ms++) {
		drive_step(&d, &w);
		assert_true(fabs(w.target[0].accel_mps2 - accel) < 0.0101 ||
			    w.target[0].speed_mps == 0);
		accel = w.target[0].accel_mps2;
		if (ms == 999) {
			assert_true(fabs(w.target[0].gap_m - 40.01) < 1e-9);
		} else if (ms == 2000) {
			/* half a second to reach 5 m/s2, which loses 1.25 m/s, and half a second at it */
			assert_true(fabs(w.target[0].speed_mps - 6.25) < 0.01);
			assert_true(fabs(w.target[0].lateral_m - 2) < 1e-6);
		}
	}
	assert_true(fabs(w.t_s - 5) < 1e-9);
	assert_true(w.target[0].speed_mps == 0 && w.target[0].accel_mps2 == 0);
	assert_true(fabs(w.target[0].lateral_m - 3) < 1e-9);
	assert_true(w.ego.speed_mps == 20);
	/* 100 m for us, 10 m and a stop from 10 m/s for it */
	assert_true(fabs(w.target[0].gap_m - (50 - 100 + 10 + 12.4)) < 0.2);
}

static void drives_have_names_of_their_own(void **state)
{
	(void)state;
	for (const struct drive *d = drive_table; d->name; d++) {
		assert_ptr_equal(drive_find(d->name), d);
		assert_true(d->doc && d->end_s > 0 && d->n >= 1 && d->n <= DRIVE_TARGETS_MAX);
	}
	assert_null(drive_find("nosuch"));
	assert_null(drive_find(""));
}

static void noise_is_standard(void **state)
{
	struct noise r = {.seed = 1}, other = {.seed = 2};
	double sum = 0, square = 0, uniform = 0;
	const int n = 100000;

	(void)state;
	for (int i = 0; i < n; i++) {
		const double z = noise_normal(&r);

		sum += z;
		square += z * z;
		uniform += noise_uniform(&other);
	}
	/* four standard errors */
	assert_true(fabs(sum / n) < 4 / sqrt(n));
	assert_true(fabs(square / n - 1) < 4 * sqrt(2.0 / n));
	assert_true(fabs(uniform / n - 0.5) < 4 * sqrt(1.0 / 12 / n));
	assert_int_equal(r.n, n);
	r = (struct noise){.seed = 1};
	other = (struct noise){.seed = 2};
	assert_true(noise_bits(&r) != noise_bits(&other));
}

/* ---- frames --------------------------------------------------------------------------------- */

struct tape {
	struct config cfg;
	struct mapping *map;
	struct bus_frame *frame;
	int n, max, stop_at; /* stop_at: refuse this frame; 0: none */
	struct drive_truth last;
};

static int record(void *arg, const struct bus_frame *f, const struct drive_truth *now)
{
	struct tape *t = arg;

	if (t->stop_at && t->n == t->stop_at) {
		return -EIO;
	}
	if (t->n == t->max) {
		t->max = t->max ? 2 * t->max : 4096;
		t->frame = realloc(t->frame, (size_t)t->max * sizeof(*t->frame));
		assert_non_null(t->frame);
	}
	t->frame[t->n++] = *f;
	t->last = *now;
	return 0;
}

static struct tape play(const char *car, const char *drive, uint64_t seed, double dropout)
{
	struct tape t = {0};

	t.map = drives_load(car, &t.cfg);
	const struct drive_options o = {
		.seed = seed, .dropout = dropout, .emit = record, .arg = &t};

	assert_int_equal(drive_run(drive_find(drive), &t.cfg, t.map, &o), 0);
	return t;
}

static void put_away(struct tape *t)
{
	free(t->frame);
	config_mapping_free(t->map);
}

static int is_same(const struct tape *a, const struct tape *b)
{
	return a->n == b->n && !memcmp(a->frame, b->frame, (size_t)a->n * sizeof(*a->frame));
}

static void a_seed_is_a_drive(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		struct tape a = play(cars[i], "brake", 1, 0), b = play(cars[i], "brake", 1, 0);
		struct tape c = play(cars[i], "brake", 2, 0);

		assert_true(is_same(&a, &b));
		assert_false(is_same(&a, &c));
		put_away(&a);
		put_away(&b);
		put_away(&c);
	}
}

static void it_ends_at_contact_or_in_time(void **state)
{
	struct tape a = play("generic", "brake", 1, 0), b = play("generic", "follow", 1, 0);

	(void)state;
	assert_true(a.last.t_s > 22 && a.last.t_s < 24);
	assert_true(a.last.target[0].gap_m > -0.5 && a.last.target[0].gap_m < 0.5);
	assert_true(b.last.t_s > 39.9 && b.last.t_s <= 40);
	assert_true(fabs(b.last.target[0].gap_m - 40) < 10);
	put_away(&a);
	put_away(&b);
}

static void frames_come_in_order_and_on_time(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		struct tape t = play(cars[i], "follow", 1, 0);
		int64_t last[MAP_MESSAGES_MAX] = {0};
		int64_t now = DRIVE_START_NS;

		for (int k = 0; k < t.n; k++) {
			const struct bus_frame *f = &t.frame[k];
			const int m = mapping_find(t.map, f->iface, f->id);

			assert_in_range(m, 0, t.map->n_messages - 1);
			assert_true(f->t_ns >= now);
			now = f->t_ns;
			assert_true(last[m] == 0 ||
				    f->t_ns - last[m] == t.map->message[m].period_ns);
			last[m] = now;
		}
		for (int m = 0; m < t.map->n_messages; m++) {
			assert_true(now - last[m] <= t.map->message[m].period_ns);
		}
		put_away(&t);
	}
}

struct seen {
	int frames, targets, fresh, moves, slots;
};

/* What a receiver makes of a tape; nothing may be refused. */
static struct seen receive(const struct tape *t)
{
	static struct decode d;
	struct seen s = {0};
	uint64_t used = 0;
	int slot = -1;

	decode_open(&d, t->map, t->cfg.radar_range_max, t->cfg.radar_existence_min);
	for (int k = 0; k < t->n; k++) {
		struct decode_frame out;

		if (!decode_take(&d, &t->frame[k], &out)) {
			continue;
		}
		s.frames++;
		if (out.target) {
			s.targets++;
			s.fresh += out.det.fresh;
			s.moves += slot >= 0 && slot != out.track;
			slot = out.track;
			used |= 1ull << slot;
		}
	}
	for (int i = 0; i < SCENE_REJECTS; i++) {
		assert_int_equal(d.rejected[i], 0);
	}
	s.slots = __builtin_popcountll(used);
	return s;
}

static void a_receiver_refuses_nothing(void **state)
{
	struct tape a = play("generic", "follow", 1, 0), b = play("toyota-tss-p", "follow", 1, 0);
	const struct seen sa = receive(&a), sb = receive(&b);

	(void)state;
	assert_int_equal(sa.frames, a.n - 3 * 2); /* three messages whose counter starts */
	assert_int_equal(sa.targets, 800 - 2);
	assert_true(sa.fresh == 0 && sa.slots == 1);
	assert_int_equal(sb.targets, 800 - 2);
	assert_int_equal(sb.slots, 16);
	assert_in_range(sb.moves, 150, 300);
	assert_in_range(sb.fresh, sb.moves, sb.moves + 1);
	put_away(&a);
	put_away(&b);
}

static void dropouts_leave_the_slot_empty(void **state)
{
	struct tape t = play("generic", "follow", 1, 0.25);

	(void)state;
	assert_in_range(receive(&t).targets, 550, 650);
	put_away(&t);
}

static void emit_can_end_it(void **state)
{
	struct tape t = {.stop_at = 100};

	(void)state;
	t.map = drives_load("toyota-tss-p", &t.cfg);
	const struct drive_options o = {.seed = 1, .emit = record, .arg = &t};

	assert_int_equal(drive_run(drive_find("follow"), &t.cfg, t.map, &o), -EIO);
	assert_int_equal(t.n, 100);
	put_away(&t);
}

static void what_does_not_fit_is_set_to_the_end(void **state)
{
	struct config cfg;
	struct mapping *map = drives_load("generic", &cfg);
	const double value[MAP_ROLES] = {1000, -50, 7, 500};
	const struct detection det = {
		.distance_m = 1e6, .rate_mps = -1e6, .lateral_m = 1e6, .existence = 2};
	struct encode e;
	struct bus_frame f;

	(void)state;
	encode_open(&e, map);
	const int ego = map->role[MAP_EGO_SPEED].message[0], lead = map->track[0].message;

	encode_message(&e, ego, 3, value, NULL, 0, &f);
	assert_true(codec_phys(map->role[MAP_EGO_SPEED].signal[0].sig,
			       codec_raw(map->role[MAP_EGO_SPEED].signal[0].sig, f.data)) ==
		    163.82);
	assert_true(codec_raw(map->role[MAP_YAW_RATE].signal[0].sig, f.data) == 0);
	encode_message(&e, lead, 0, value, &det, 0, &f);
	const struct map_signal *s[] = {&map->track[0].distance, &map->track[0].rel_speed,
					&map->track[0].lateral, &map->track[0].existence};
	const double end[] = {327.64, -80, 20, 1};

	for (int i = 0; i < 4; i++) {
		assert_true(fabs(codec_phys(s[i]->sig, codec_raw(s[i]->sig, f.data)) - end[i]) <
			    1e-9);
	}
	config_mapping_free(map);
}

static void what_is_unknown_is_not_available(void **state)
{
	struct config cfg;
	struct mapping *map = drives_load("generic", &cfg);
	const double value[MAP_ROLES] = {20};
	struct encode e;
	struct bus_frame f;

	(void)state;
	encode_open(&e, map);
	const struct dbc_message *ego = map->message[map->role[MAP_EGO_SPEED].message[0]].msg;

	encode_message(&e, map->role[MAP_EGO_SPEED].message[0], 1, value, NULL, 0, &f);
	assert_int_equal(codec_raw(dbc_find_signal(ego, "ACCEL"), f.data), 4095);
	assert_int_equal(codec_raw(dbc_find_signal(ego, "YAW_RATE"), f.data), 4095);
	assert_int_equal(codec_raw(dbc_find_signal(ego, "SPEED"), f.data), 2000);
	encode_message(&e, map->track[0].message, 0, value, NULL, 0, &f);
	assert_int_equal(codec_raw(map->track[0].distance.sig, f.data), 16383);
	assert_int_equal(codec_raw(map->track[0].valid.sig, f.data), 0);
	config_mapping_free(map);
}

/* ---- another lead --------------------------------------------------------------------------- */

struct spliced {
	double last_gap_m, decel; /* what an estimator sees of the new lead */
	int changed_before, changed_after, contact;
	double end_s;
	uint32_t leads;
	uint64_t rejected;
};

static struct spliced splice_tape(const struct tape *t, double at_s)
{
	struct spliced r = {0};
	struct estimator *e;
	struct splice s;

	assert_int_equal(splice_open(&s, &t->cfg, t->map, at_s, 3), 0);
	assert_int_equal(estimator_open(&t->cfg, t->map, &e), 0);
	for (int k = 0; k < t->n && !r.contact; k++) {
		const double now_s = (double)(t->frame[k].t_ns - t->frame[0].t_ns) * 1e-9;
		struct bus_frame f = t->frame[k];
		struct scene scene;

		r.contact = splice_frame(&s, &f);
		r.end_s = now_s;
		*(now_s <= at_s ? &r.changed_before : &r.changed_after) +=
			memcmp(&f, &t->frame[k], sizeof(f)) != 0;
		if (estimator_frame(e, &f)) {
			estimator_scene(e, f.t_ns, &scene);
			r.leads += scene.lead_valid && now_s > at_s;
			r.decel = fmin(r.decel, scene.x[SCENE_LEAD_ACCEL]);
			r.last_gap_m = scene.x[SCENE_HEADWAY];
		}
	}
	for (int i = 0; i < SCENE_REJECTS; i++) {
		r.rejected += estimator_rejected(e)[i];
	}
	estimator_close(e);
	splice_close(&s);
	return r;
}

static void a_spliced_lead_brakes_until_contact(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		struct tape t = play(cars[i], "follow", 1, 0);
		const struct spliced r = splice_tape(&t, 5);

		assert_int_equal(r.changed_before, 0);
		assert_true(r.changed_after > 50);
		assert_true(r.contact);
		/* 40 m at 0.5 g */
		assert_true(fabs(r.end_s - 5 - sqrt(2 * 40 / 4.9)) < 0.3);
		assert_true(r.decel < -4.5 && r.decel > -7);
		assert_true(r.last_gap_m < 2);
		assert_int_equal(r.rejected, 0);
		assert_in_range(r.leads, (uint64_t)((r.end_s - 5) * 20) - 2,
				(uint64_t)((r.end_s - 5) * 20) + 2);
		put_away(&t);
	}
}

static void without_a_lead_nothing_is_spliced(void **state)
{
	struct tape t = play("generic", "follow", 1, 1); /* the radar sees nothing */
	const struct spliced r = splice_tape(&t, 5);

	(void)state;
	assert_int_equal(r.changed_before + r.changed_after, 0);
	assert_false(r.contact);
	put_away(&t);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_path_is_driven),
		cmocka_unit_test(drives_have_names_of_their_own),
		cmocka_unit_test(noise_is_standard),
		cmocka_unit_test(a_seed_is_a_drive),
		cmocka_unit_test(it_ends_at_contact_or_in_time),
		cmocka_unit_test(frames_come_in_order_and_on_time),
		cmocka_unit_test(a_receiver_refuses_nothing),
		cmocka_unit_test(dropouts_leave_the_slot_empty),
		cmocka_unit_test(emit_can_end_it),
		cmocka_unit_test(what_does_not_fit_is_set_to_the_end),
		cmocka_unit_test(what_is_unknown_is_not_available),
		cmocka_unit_test(a_spliced_lead_brakes_until_contact),
		cmocka_unit_test(without_a_lead_nothing_is_spliced),
	};

	return cmocka_run_group_tests_name("drive", tests, NULL, NULL);
}
