/* SPDX-License-Identifier: MIT
 * A radar that reports a list of objects, from frames to the scene: what is heard, what is stale, whose noise counts.
 */
#include "drives.h"

#define MS CLOCK_NS_PER_MS

struct bench {
	struct config cfg;
	struct mapping *map;
	struct encode encode;
	struct estimator *e;
	int64_t t_ns;
	struct detection det[3];
	int n;         /* of them that are there */
	int announced; /* more than those that are sent; -1: no header at all */
	int quality;   /* 0: none is sent */
	int ended;
};

static void open_bench(struct bench *b, const char *car)
{
	*b = (struct bench){.t_ns = 1000 * MS, .n = 1, .quality = 1};
	b->det[0] = (struct detection){.id = 3,
				       .distance_m = 30,
				       .existence = 0.99,
				       .distance_sigma_m = 0.1,
				       .rate_sigma_mps = 0.05};
	b->map = drives_load(car, &b->cfg);
	encode_open(&b->encode, b->map);
	assert_int_equal(estimator_open(&b->cfg, b->map, &b->e), 0);
}

static void close_bench(struct bench *b)
{
	estimator_close(b->e);
	config_mapping_free(b->map);
}

static void give(struct bench *b, const struct bus_frame *f)
{
	b->ended += estimator_frame(b->e, f);
}

static void say_ego(struct bench *b)
{
	const double value[MAP_ROLES] = {[MAP_EGO_SPEED] = 20};
	struct bus_frame f;

	for (int i = 0; i < b->map->n_messages; i++) {
		if (b->map->message[i].ego) {
			encode_message(&b->encode, i, 15, value, NULL, b->t_ns, &f);
			give(b, &f);
		}
	}
}

static void say_each(struct bench *b, int message)
{
	const double none[MAP_ROLES] = {0};
	struct bus_frame f;

	for (int i = 0; i < b->n; i++) {
		encode_message(&b->encode, message, 0, none, &b->det[i], b->t_ns, &f);
		give(b, &f);
	}
}

static void say_scan(struct bench *b)
{
	struct bus_frame f;

	if (b->announced >= 0) {
		encode_header(&b->encode, b->n + b->announced, b->t_ns, &f);
		give(b, &f);
	}
	say_each(b, b->map->track[0].message);
	if (b->quality && b->map->list.quality >= 0) {
		say_each(b, b->map->list.quality);
	}
}

/* One period of the radar, ego messages three times in it. */
static struct scene cycle(struct bench *b)
{
	const int64_t third = (int64_t)b->cfg.radar_period * MS / 3;
	struct scene s;

	for (int i = 0; i < 3; i++) {
		b->t_ns += third;
		b->ended += estimator_tick(b->e, b->t_ns);
		say_ego(b);
	}
	say_scan(b);
	estimator_scene(b->e, b->t_ns, &s);
	drives_assert_sound(&s);
	return s;
}

static struct scene cycles(struct bench *b, int n)
{
	struct scene s = cycle(b);

	for (int i = 1; i < n; i++) {
		s = cycle(b);
	}
	return s;
}

static const char *const cars[] = {"ars408", "generic-objects"};

static void an_object_is_followed(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		struct bench b;

		open_bench(&b, cars[i]);
		const struct scene s = cycles(&b, 20);

		assert_int_equal(s.fault, 0);
		assert_true(s.lead_valid && fabs(s.x[SCENE_HEADWAY] - 30) < 0.2);
		assert_in_range(b.ended, 18, 20);
		close_bench(&b);
	}
}

/* By its number within a scan, by its place between scans. */
static void the_nearest_of_several_leads(void **state)
{
	struct bench b;
	struct scene s;

	(void)state;
	open_bench(&b, "ars408");
	b.n = 3;
	b.det[1] = (struct detection){.id = 7, .distance_m = 20, .existence = 0.99, .lateral_m = 4};
	b.det[2] = (struct detection){.id = 1, .distance_m = 25, .existence = 0.3};
	s = cycles(&b, 10);
	assert_true(fabs(s.x[SCENE_HEADWAY] - 30) < 0.2); /* one is in another lane, one unlikely */
	b.det[2].existence = 0.99;
	s = cycles(&b, 10);
	assert_true(fabs(s.x[SCENE_HEADWAY] - 25) < 0.2);
	const uint32_t lead = s.lead_id;

	b.det[2].id = 0;
	s = cycle(&b);
	assert_int_equal(s.lead_id, lead);
	close_bench(&b);
}

static void an_empty_road_is_no_fault_and_a_silent_radar_is(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		struct bench b;
		struct scene s;

		open_bench(&b, cars[i]);
		b.n = 0;
		s = cycles(&b, 30);
		assert_true(s.fault == 0 && s.ego_valid && !s.lead_valid);
		b.announced = -1;
		assert_int_equal(cycles(&b, 3).fault, 0);
		assert_int_equal(cycle(&b).fault, FAULT_BIT(RADAR_STALE));
		b.announced = 0;
		assert_int_equal(cycle(&b).fault, 0);
		close_bench(&b);
	}
}

static void what_is_announced_must_come(void **state)
{
	struct bench b;
	struct scene s;

	(void)state;
	open_bench(&b, "ars408");
	cycles(&b, 10);
	b.quality = 0; /* switched off in the radar, say */
	s = cycles(&b, 3);
	assert_int_equal(s.fault, 0);
	assert_true(s.lead_valid); /* with the noise that the configuration assumes */
	s = cycle(&b);             /* ends the third scan that is incomplete */
	assert_int_equal(s.fault, FAULT_BIT(RADAR_STALE));
	assert_false(s.lead_valid);
	b.quality = 1;
	assert_int_equal(cycles(&b, 2).fault, 0);
	b.announced = 1; /* an object's frames are lost each time */
	assert_int_equal(cycles(&b, 5).fault, FAULT_BIT(RADAR_STALE));
	close_bench(&b);
}

static void the_noise_of_each_object_is_its_own(void **state)
{
	double p[2];

	(void)state;
	for (int i = 0; i < 2; i++) {
		struct bench b;

		open_bench(&b, "ars408");
		b.det[0].distance_sigma_m = i ? 1.7 : 0.1;
		p[i] = cycles(&b, 60).cov[SCENE_HEADWAY][SCENE_HEADWAY];
		close_bench(&b);
	}
	assert_true(p[1] > 4 * p[0]);
}

/* Time passes for what the radar sees: it moves on, and the second one brakes. */
static void let_drive(struct bench *b, double brake_mps2)
{
	const double dt = b->cfg.radar_period / 1000;

	for (int i = 0; i < b->n; i++) {
		b->det[i].distance_m += b->det[i].rate_mps * dt;
	}
	b->det[1].distance_m -= brake_mps2 * dt * dt / 2;
	b->det[1].rate_mps -= brake_mps2 * dt;
}

/* What the ego may meet instead of the lead is said as it is now, not as it was when the radar saw it. */
static void what_is_behind_the_lead_is_described(void **state)
{
	struct bench b;
	struct scene s;

	(void)state;
	open_bench(&b, "ars408");
	b.n = 2;
	b.det[1] = (struct detection){.id = 7,
				      .distance_m = 90,
				      .existence = 0.99,
				      .distance_sigma_m = 0.06, /* the signals' steps of 0.2 m */
				      .rate_sigma_mps = 0.07};  /* and 0.25 m/s, over sqrt(12) */
	for (int i = 0; i < 40; i++) {
		s = cycle(&b);
		let_drive(&b, 2);
	}
	const struct scene_object *o = &s.other[SCENE_BEHIND];
	const double brakes_s = 39 * b.cfg.radar_period / 1000 + b.cfg.radar_latency;

	assert_true(s.lead_valid && o->p > 0 && s.other[SCENE_NEARER].p == 0);
	assert_true(fabs(o->headway_m - (90 - brakes_s * brakes_s)) < 0.2);
	assert_true(fabs(o->speed_mps - (20 - 2 * brakes_s)) < 0.3);
	/* sqrt(2) q^(3/4) (rate's variance times period)^(1/4) is 0.83^2 */
	assert_true(fabs(o->accel_mps2 + 2) < 0.83);
	assert_true(s.other[SCENE_HIDDEN].headway_m == s.x[SCENE_HEADWAY] + 10);
	close_bench(&b);
}

/* It drives on the corridor's edge and may be in the way. */
static void what_is_nearer_than_the_lead_is_described(void **state)
{
	struct bench b;

	(void)state;
	open_bench(&b, "ars408");
	b.n = 2;
	b.det[1] =
		(struct detection){.id = 7, .distance_m = 20, .lateral_m = 1.8, .existence = 0.99};
	const struct scene s = cycles(&b, 20);
	const struct scene_object *o = &s.other[SCENE_NEARER];

	assert_true(s.lead_valid && fabs(s.x[SCENE_HEADWAY] - 30) < 0.2);
	assert_true(o->p > 0.1 && o->p < 0.5 && s.other[SCENE_BEHIND].p == 0);
	assert_true(fabs(o->headway_m - 20) < 0.2 && fabs(o->speed_mps - 20) < 0.1);
	close_bench(&b);
}

/* Noise may have it roll backwards. */
static void what_stands_behind_the_lead_stands(void **state)
{
	struct bench b;
	struct scene s;

	(void)state;
	open_bench(&b, "ars408");
	b.n = 2;
	b.det[1] = (struct detection){
		.id = 7, .distance_m = 150, .rate_mps = -20.25, .existence = 0.99};
	for (int i = 0; i < 20; i++) {
		s = cycle(&b);
		let_drive(&b, 0);
	}
	assert_true(s.lead_valid && s.other[SCENE_BEHIND].p > 0);
	assert_true(s.other[SCENE_BEHIND].speed_mps == 0 && s.other[SCENE_BEHIND].accel_mps2 >= 0);
	close_bench(&b);
}

/* A radar that repeats the speed it was told in the message that begins its scans: the first message there is. */
static void open_echo(struct bench *b)
{
	static const char dbc[] = "VERSION \"\"\n"
				  "BO_ 256 HEAD: 3 RADAR\n"
				  " SG_ SPEED : 0|16@1+ (0.01,0) [0|163] \"m/s\" X\n"
				  " SG_ COUNT : 16|8@1+ (1,0) [0|64] \"\" X\n"
				  "BO_ 257 OBJECT: 5 RADAR\n"
				  " SG_ ID : 0|8@1+ (1,0) [0|255] \"\" X\n"
				  " SG_ DIST : 8|16@1+ (0.01,0) [0|600] \"m\" X\n"
				  " SG_ RATE : 24|16@1- (0.01,0) [-90|90] \"m/s\" X\n"
				  "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 10000;\n"
				  "BA_DEF_DEF_ \"GenMsgCycleTime\" 20;\n";
	static const char conf[] = "[dbc]\nfile = test.dbc\n"
				   "[bus]\ninterfaces = can0\n"
				   "[signal ego_speed]\nfrom = HEAD.SPEED\n"
				   "[signal object_count]\nfrom = HEAD.COUNT\n"
				   "[signal object_id]\nfrom = OBJECT.ID\n"
				   "[signal distance]\nfrom = OBJECT.DIST\n"
				   "[signal rel_speed]\nfrom = OBJECT.RATE\n";

	*b = (struct bench){.t_ns = 1000 * MS};
	b->map = drives_load_text(dbc, conf, &b->cfg);
	encode_open(&b->encode, b->map);
	assert_int_equal(estimator_open(&b->cfg, b->map, &b->e), 0);
}

static void the_first_message_may_begin_the_scans(void **state)
{
	struct bench b;

	(void)state;
	open_echo(&b);
	assert_int_equal(b.map->list.header, 0);
	for (int i = 0; i < 10; i++) { /* nothing ahead: no object is ever sent */
		b.t_ns += 20 * MS;
		say_ego(&b);
	}
	struct scene s;

	estimator_scene(b.e, b.t_ns, &s);
	assert_int_equal(s.fault, 0);
	assert_true(s.ego_valid && s.scan == 10);
	close_bench(&b);
}

static void any_frame_is_survived(void **state)
{
	struct noise r = {.seed = 4};
	struct bench b;
	struct scene s;
	int leads = 0;

	(void)state;
	open_bench(&b, "ars408");
	cycles(&b, 10);
	for (int i = 0; i < 100000; i++) {
		const struct map_message *m =
			&b.map->message[(int)(noise_uniform(&r) * b.map->n_messages)];
		struct bus_frame f = {.id = m->msg->id, .len = m->msg->size};

		b.t_ns += (int64_t)(noise_uniform(&r) * 4) * MS;
		f.t_ns = b.t_ns;
		for (int k = 0; k < f.len; k++) {
			f.data[k] = (uint8_t)noise_bits(&r);
		}
		if (m->part != MAP_NO_PART) {
			f.data[0] &= 7; /* few objects, so that numbers meet and lists end */
		}
		estimator_frame(b.e, &f);
		estimator_scene(b.e, b.t_ns, &s);
		drives_assert_sound(&s);
		leads += s.lead_valid;
	}
	assert_in_range(leads, 1, 99999);
	close_bench(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_object_is_followed),
		cmocka_unit_test(the_nearest_of_several_leads),
		cmocka_unit_test(an_empty_road_is_no_fault_and_a_silent_radar_is),
		cmocka_unit_test(what_is_announced_must_come),
		cmocka_unit_test(the_noise_of_each_object_is_its_own),
		cmocka_unit_test(what_is_behind_the_lead_is_described),
		cmocka_unit_test(what_is_nearer_than_the_lead_is_described),
		cmocka_unit_test(what_stands_behind_the_lead_stands),
		cmocka_unit_test(the_first_message_may_begin_the_scans),
		cmocka_unit_test(any_frame_is_survived),
	};

	return cmocka_run_group_tests_name("objects", tests, NULL, NULL);
}
