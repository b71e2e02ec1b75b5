/* SPDX-License-Identifier: MIT
 * Frames to measurements: every reason for which a frame is refused, and what the others say.
 */
#include "conf_dir.h"

#include <math.h>
#include "../tools/encode.c"
#include "clock.h"
#include "config.h"

static const char dbc[] =
	"VERSION \"\"\n"
	"BO_ 256 EGO: 8 CAR\n"
	" SG_ SPEED : 16|16@1+ (0.01,0) [0|163] \"m/s\" X\n"
	" SG_ YAW : 32|12@1- (0.001,0) [-1|1] \"rad/s\" X\n"
	" SG_ BRAKE : 44|2@1+ (1,0) [0|1] \"\" X\n"
	"BO_ 257 WHEELS: 8 CAR\n"
	" SG_ A : 0|16@1+ (0.01,0) [0|250] \"km/h\" X\n"
	" SG_ B : 16|16@1+ (0.01,0) [0|250] \"km/h\" X\n"
	" SG_ COUNT : 56|4@1+ (1,0) [0|15] \"\" X\n"
	"BO_ 2147484160 FAR: 8 RADAR\n" /* extended id 0x200 */
	" SG_ DIST : 0|13@1+ (0.1,0) [0|600] \"m\" X\n"
	" SG_ VREL : 16|12@1- (0.05,0) [-90|90] \"m/s\" X\n"
	" SG_ LAT : 28|10@1- (0.05,0) [-20|20] \"m\" X\n"
	" SG_ VALID : 40|1@1+ (1,0) [0|1] \"\" X\n"
	" SG_ NEW : 41|1@1+ (1,0) [0|1] \"\" X\n"
	" SG_ PROB : 48|7@1+ (1,0) [0|100] \"%\" X\n"
	" SG_ SUM : 56|8@1+ (1,0) [0|255] \"\" X\n"
	"BO_ 513 NEAR: 8 RADAR\n"
	" SG_ KIND M : 0|2@1+ (1,0) [0|3] \"\" X\n"
	" SG_ DIST m1 : 8|13@1+ (0.1,0) [0|600] \"m\" X\n"
	" SG_ VREL m1 : 24|12@1- (0.05,0) [-90|90] \"m/s\" X\n"
	"BO_ 768 LIST: 2 RADAR\n"
	" SG_ COUNT : 0|8@1+ (1,0) [0|0] \"\" X\n"
	"BO_ 769 OBJECT: 8 RADAR\n"
	" SG_ ID : 0|8@1+ (1,0) [0|255] \"\" X\n"
	" SG_ DIST : 8|13@1+ (0.24,0) [0|600] \"m\" X\n"
	" SG_ VREL : 24|12@1- (0.05,0) [-90|90] \"m/s\" X\n"
	" SG_ STATE : 40|2@1+ (1,0) [0|1] \"\" X\n"
	" SG_ NEW : 42|2@1+ (1,0) [0|1] \"\" X\n"
	"BO_ 770 QUALITY: 3 RADAR\n"
	" SG_ ID : 0|8@1+ (1,0) [0|255] \"\" X\n"
	" SG_ DIST_RMS : 8|4@1+ (1,0) [0|15] \"\" X\n"
	" SG_ VREL_RMS : 12|4@1+ (1,0) [0|15] \"\" X\n"
	" SG_ PROB : 16|2@1+ (1,0) [0|3] \"\" X\n"
	"BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 10000;\n"
	"BA_DEF_ BO_ \"E2EDataIDList\" STRING ;\n"
	"BA_DEF_DEF_ \"GenMsgCycleTime\" 20;\n"
	"BA_DEF_DEF_ \"E2EDataIDList\" \"\";\n"
	"BA_ \"E2EDataIDList\" BO_ 256 \"01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F 10\";\n"
	"VAL_ 256 SPEED 65535 \"not available\" ;\n"
	"VAL_ 256 YAW 2048 \"not available\" ;\n"
	"VAL_ 257 B 65535 \"not available\" ;\n"
	"VAL_ 2147484160 DIST 8191 \"not available\" ;\n"
	"VAL_ 2147484160 VREL 2048 \"not available\" ;\n";

static const char conf[] = "[dbc]\nfile = test.dbc\n"
			   "[bus]\ninterfaces = can0 can1\n"
			   "[message EGO]\ninterface = can0\n"
			   "[message WHEELS]\ninterface = can0\ncounter = COUNT\n"
			   "[message FAR]\ninterface = can1\ncheck = toyota\n"
			   "[signal ego_speed]\nfrom = EGO.SPEED WHEELS.A WHEELS.B\n"
			   "[signal yaw_rate]\nfrom = EGO.YAW\n"
			   "[signal driver_brake]\nfrom = EGO.BRAKE\n"
			   "[signal distance]\nfrom = FAR.DIST\noffset = -0.5\n"
			   "[signal rel_speed]\nfrom = FAR.VREL\n"
			   "[signal lateral]\nfrom = FAR.LAT\nnegate = yes\n"
			   "[signal valid]\nfrom = FAR.VALID\n"
			   "[signal fresh]\nfrom = FAR.NEW\n"
			   "[signal existence]\nfrom = FAR.PROB\n";

/* A radar that says no more than it must. */
static const char plain_conf[] = "[dbc]\nfile = test.dbc\n"
				 "[bus]\ninterfaces = can0\n"
				 "[signal ego_speed]\nfrom = WHEELS.A\n"
				 "[signal distance]\nfrom = NEAR.DIST\n"
				 "[signal rel_speed]\nfrom = NEAR.VREL\n";

/* A radar with a list. */
static const char list_conf[] =
	"[dbc]\nfile = test.dbc\n"
	"[bus]\ninterfaces = can0\n"
	"[signal ego_speed]\nfrom = WHEELS.A\n"
	"[signal object_count]\nfrom = LIST.COUNT\n"
	"[signal object_id]\nfrom = OBJECT.ID\n"
	"[signal quality_id]\nfrom = QUALITY.ID\n"
	"[signal distance]\nfrom = OBJECT.DIST\n"
	"[signal rel_speed]\nfrom = OBJECT.VREL\n"
	"[signal valid]\nfrom = OBJECT.STATE\n"
	"[signal fresh]\nfrom = OBJECT.NEW\n"
	"[signal existence]\nfrom = QUALITY.PROB\ntable = 0 0.5 1\n"
	"[signal distance_sigma]\nfrom = QUALITY.DIST_RMS\nunit = m\ntable = 0 0.01 0.5\nna = 15\n"
	"[signal rate_sigma]\nfrom = QUALITY.VREL_RMS\nunit = m/s\ntable = 0 0.1 0.2\nna = 15\n";

enum { LIST_ID = 768, OBJECT_ID, QUALITY_ID };

enum { EGO_ID = 0x100, WHEELS_ID = 0x101, FAR_ID = 0x200 | BUS_ID_EFF, NEAR_ID = 0x201 };

static struct config cfg;
/* One whose header does not count. */
static const char start_conf[] = "[dbc]\nfile = test.dbc\n"
				 "[bus]\ninterfaces = can0\n"
				 "[signal ego_speed]\nfrom = WHEELS.A\n"
				 "[signal scan_start]\nfrom = LIST.COUNT\n"
				 "[signal object_id]\nfrom = OBJECT.ID\n"
				 "[signal distance]\nfrom = OBJECT.DIST\n"
				 "[signal rel_speed]\nfrom = OBJECT.VREL\n";

static struct mapping *map, *plain, *list, *start;

/* A receiver and a sender of the same car. */
struct wire {
	struct decode d;
	struct encode e;
	struct decode_frame out;
};

static int load_one(const char *dir, const char *text, struct mapping **ret)
{
	char path[2 * CONF_DIR_PATH], err[1024];

	conf_dir_write(dir, "test.conf", text, strlen(text), path);
	if (config_load(path, NULL, 0, &cfg, ret, err, sizeof(err))) {
		print_message("# %s\n", err);
		return -1;
	}
	return 0;
}

static int load(void **state)
{
	char dir[CONF_DIR_PATH], path[2 * CONF_DIR_PATH];

	(void)state;
	conf_dir_open(dir);
	conf_dir_write(dir, "test.dbc", dbc, sizeof(dbc) - 1, path);
	const int bad = load_one(dir, conf, &map) || load_one(dir, plain_conf, &plain) ||
			load_one(dir, list_conf, &list) || load_one(dir, start_conf, &start);

	conf_dir_close(dir);
	return bad;
}

static int unload(void **state)
{
	(void)state;
	config_mapping_free(map);
	config_mapping_free(plain);
	config_mapping_free(list);
	config_mapping_free(start);
	return 0;
}

static struct wire open_wire_of(const struct mapping *m)
{
	struct wire l;

	decode_open(&l.d, m, 250, 0.5);
	encode_open(&l.e, m);
	return l;
}

static struct wire open_wire(void)
{
	return open_wire_of(map);
}

/* NEAR is in the plain mapping alone. */
static const struct mapping *map_of(uint32_t id)
{
	return id == NEAR_ID ? plain : map;
}

static int message(uint32_t id)
{
	const int m = mapping_find(map_of(id), id == FAR_ID ? 1 : 0, id);

	assert_in_range(m, 0, map_of(id)->n_messages - 1);
	return m;
}

static struct bus_frame make(struct wire *l, uint32_t id, double speed, const struct detection *det)
{
	const double value[MAP_ROLES] = {speed, 0.25, 1, 0};
	struct bus_frame f;

	encode_message(&l->e, message(id), 15, value, det, CLOCK_NS_PER_S, &f);
	return f;
}

static int take(struct wire *l, struct bus_frame f)
{
	return decode_take(&l->d, &f, &l->out);
}

/* Good frames until the counter is in sequence. */
static void settle(struct wire *l, uint32_t id)
{
	while (!take(l, make(l, id, 20, NULL))) {
		continue;
	}
}

/* @count frames were refused for the reason @why, none for another. */
static void assert_rejected(const struct wire *l, enum scene_reject why, uint64_t count)
{
	for (int i = 0; i < SCENE_REJECTS; i++) {
		assert_int_equal(l->d.rejected[i], i == (int)why ? count : 0);
	}
}

static void assert_none_rejected(const struct wire *l)
{
	assert_rejected(l, SCENE_REJECT_CRC, 0);
}

static uint32_t refused(const struct wire *l, uint32_t id)
{
	return l->d.message[message(id)].refused;
}

static void set_raw(struct bus_frame *f, const char *name, uint64_t raw)
{
	const struct map_message *m = &map_of(f->id)->message[message(f->id)];
	const struct e2e_config check = {m->check, m->msg, m->counter};
	struct e2e_state st = {.counter = counter_in(m, f->data)};

	assert_int_equal(codec_set_raw(dbc_find_signal(m->msg, name), f->data, raw), 0);
	e2e_protect(&check, &st, f->data);
}

static const struct detection ahead = {
	.distance_m = 30, .rate_mps = -2, .lateral_m = 1, .existence = 0.9};

static struct bus_frame make_far(struct wire *l, const char *name, uint64_t raw)
{
	struct bus_frame f = make(l, FAR_ID, 0, &ahead);

	if (name) {
		set_raw(&f, name, raw);
	}
	return f;
}

/* ---- what a frame says ---------------------------------------------------------------------- */

static void roles_come_in_si(void **state)
{
	struct wire l = open_wire();

	(void)state;
	settle(&l, EGO_ID);
	assert_int_equal(take(&l, make(&l, EGO_ID, 20.5, NULL)), 1);
	assert_int_equal(l.out.roles,
			 1u << MAP_EGO_SPEED | 1u << MAP_YAW_RATE | 1u << MAP_DRIVER_BRAKE);
	assert_true(fabs(l.out.value[MAP_EGO_SPEED] - 20.5) < 1e-9);
	assert_true(fabs(l.out.value[MAP_YAW_RATE] - 0.25) < 1e-9);
	assert_true(l.out.value[MAP_DRIVER_BRAKE] == 1);
	assert_int_equal(l.out.track, -1);
	assert_int_equal(l.out.message, message(EGO_ID));
	assert_int_equal(l.d.message[message(EGO_ID)].t_ns, CLOCK_NS_PER_S);
	assert_none_rejected(&l);
}

static void several_signals_are_averaged(void **state)
{
	struct wire l = open_wire();

	(void)state;
	settle(&l, WHEELS_ID);
	struct bus_frame f = make(&l, WHEELS_ID, 10, NULL);

	set_raw(&f, "A", 3600); /* 36 km/h */
	set_raw(&f, "B", 7200);
	assert_int_equal(take(&l, f), 1);
	assert_true(fabs(l.out.value[MAP_EGO_SPEED] - 15) < 1e-9);
}

static void a_target_comes_with_sign_and_offset(void **state)
{
	struct wire l = open_wire();

	(void)state;
	assert_int_equal(take(&l, make_far(&l, NULL, 0)), 1);
	assert_int_equal(l.out.target, 1);
	assert_true(fabs(l.out.det.distance_m - 30) < 1e-9);
	assert_true(fabs(l.out.det.rate_mps + 2) < 1e-9);
	assert_true(fabs(l.out.det.lateral_m - 1) < 1e-9);
	assert_true(fabs(l.out.det.existence - 0.9) < 1e-9);
	assert_int_equal(l.out.det.fresh, 0);
	assert_int_equal(l.out.roles, 0);
	assert_int_equal(take(&l, make_far(&l, "NEW", 1)), 1);
	assert_int_equal(l.out.det.fresh, 1);
	assert_int_equal(take(&l, make_far(&l, "LAT", 40)), 1);
	assert_true(fabs(l.out.det.lateral_m + 2) < 1e-9); /* negated */
	assert_none_rejected(&l);
}

static void an_empty_slot_is_no_error(void **state)
{
	struct wire l = open_wire();

	(void)state;
	assert_int_equal(take(&l, make_far(&l, "VALID", 0)), 1);
	assert_true(l.out.track >= 0 && !l.out.target);
	assert_int_equal(take(&l, make_far(&l, "PROB", 49)), 1); /* does not exist */
	assert_int_equal(l.out.target, 0);
	assert_int_equal(take(&l, make_far(&l, "PROB", 50)), 1);
	assert_int_equal(l.out.target, 1);
	assert_int_equal(take(&l, make_far(&l, "DIST", 2506)), 1); /* 250.1 m: beyond range_max */
	assert_int_equal(l.out.target, 0);
	assert_int_equal(take(&l, make_far(&l, "DIST", 2505)), 1);
	assert_int_equal(l.out.target, 1);
	assert_none_rejected(&l);
	/* what the slot holds when it is not valid does not matter */
	struct bus_frame f = make_far(&l, "VALID", 0);

	set_raw(&f, "DIST", 8191);
	assert_int_equal(take(&l, f), 1);
	assert_none_rejected(&l);
	assert_int_equal(refused(&l, FAR_ID), 0);
}

static void what_is_not_mapped_has_its_default(void **state)
{
	struct wire l = open_wire_of(plain);
	struct bus_frame f = make(&l, NEAR_ID, 0, &ahead);

	(void)state;
	set_raw(&f, "KIND", 1);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.target, 1);
	assert_true(l.out.det.lateral_m == 0 && l.out.det.existence == 1 && !l.out.det.fresh);
	assert_true(l.out.det.distance_sigma_m == 0 && l.out.det.rate_sigma_mps == 0);
	assert_int_equal(l.out.det.id, 0);
	/* the multiplexor says that this frame is about something else */
	set_raw(&f, "KIND", 2);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.track, -1);
	assert_int_equal(l.out.part, MAP_NO_PART);
	assert_int_equal(l.out.target, 0);
	assert_none_rejected(&l);
	assert_int_equal(refused(&l, NEAR_ID), 0);
}

static void what_is_not_ours_passes_by(void **state)
{
	struct wire l = open_wire();
	struct bus_frame f = make_far(&l, NULL, 0);

	(void)state;
	f.iface = 0;
	assert_int_equal(take(&l, f), 0);
	f.iface = 1;
	f.id = 0x200; /* the standard id of the same number */
	assert_int_equal(take(&l, f), 0);
	f.id = FAR_ID;
	f.flags = BUS_RTR;
	assert_int_equal(take(&l, f), 0);
	f.flags = BUS_ERR;
	assert_int_equal(take(&l, f), 0);
	f.flags = 0;
	assert_none_rejected(&l);
	assert_int_equal(take(&l, f), 1);
}

/* ---- lists ---------------------------------------------------------------------------------- */

static void a_header_says_how_many(void **state)
{
	struct wire l = open_wire_of(list);
	struct bus_frame f;

	(void)state;
	encode_header(&l.e, 7, CLOCK_NS_PER_S, &f);
	assert_int_equal(f.id, LIST_ID);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.part, MAP_HEADER);
	assert_int_equal(l.out.count, 7);
	assert_int_equal(l.out.track, -1);
}

static void or_does_not_say(void **state)
{
	struct wire l = open_wire_of(start);
	struct bus_frame f;

	(void)state;
	encode_header(&l.e, 7, CLOCK_NS_PER_S, &f);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.part, MAP_HEADER);
	assert_int_equal(l.out.count, -1);
}

static void an_object_in_an_unknown_state_is_none(void **state)
{
	struct wire l = open_wire_of(list);
	const struct detection det = {.id = 1, .distance_m = 24};
	const int m = mapping_find(list, 0, OBJECT_ID);
	struct bus_frame f;

	(void)state;
	encode_message(&l.e, m, 0, NULL, &det, 0, &f);
	for (uint32_t i = 1; i <= 2; i++) { /* neither 0 nor 1; nor is it known whether it is new */
		f.data[5] = i == 1 ? 2 : 1 | 2 << 2;
		assert_int_equal(take(&l, f), 1);
		assert_int_equal(l.out.target, 0);
		assert_int_equal(l.d.message[m].refused, i);
		assert_rejected(&l, SCENE_REJECT_RANGE, i);
	}
}

static void an_object_and_its_quality_have_a_number(void **state)
{
	struct wire l = open_wire_of(list);
	const struct detection det = {.id = 42,
				      .distance_m = 24,
				      .rate_mps = -2,
				      .existence = 0.6,
				      .distance_sigma_m = 0.4,
				      .rate_sigma_mps = 0.11};
	struct bus_frame f;

	(void)state;
	encode_message(&l.e, mapping_find(list, 0, OBJECT_ID), 0, NULL, &det, 0, &f);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.part, MAP_TARGET);
	assert_int_equal(l.out.det.id, 42);
	assert_true(l.out.target && fabs(l.out.det.distance_m - 24) < 1e-9);
	assert_true(l.out.det.existence == 1 && l.out.det.distance_sigma_m == 0);

	encode_message(&l.e, mapping_find(list, 0, QUALITY_ID), 0, NULL, &det, 0, &f);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.part, MAP_QUALITY);
	assert_int_equal(l.out.det.id, 42);
	assert_true(l.out.det.existence == 0.5); /* the nearest entry */
	/* rounding to steps of 0.24 m and 0.05 m/s comes on top of what the radar says */
	assert_true(fabs(l.out.det.distance_sigma_m - sqrt(0.25 + 0.0048)) < 1e-12);
	assert_true(fabs(l.out.det.rate_sigma_mps - sqrt(0.01 + 0.0025 / 12)) < 1e-12);
	assert_none_rejected(&l);
}

static void a_sigma_that_is_not_given_is_none(void **state)
{
	struct wire l = open_wire_of(list);
	const uint8_t data[][3] = {{1, 0xFF, 2}, {1, 0x00, 2}, {1, 0x33, 2}};
	struct bus_frame f = {.id = QUALITY_ID, .len = 3};

	(void)state;
	for (int i = 0; i < 3; i++) { /* not available; zero; beyond the table */
		memcpy(f.data, data[i], 3);
		assert_int_equal(take(&l, f), 1);
		assert_true(l.out.det.distance_sigma_m == 0 && l.out.det.rate_sigma_mps == 0);
		assert_true(l.out.det.existence == 1);
	}
	assert_int_equal(l.d.rejected[SCENE_REJECT_NOT_AVAILABLE], 2);
	assert_int_equal(l.d.rejected[SCENE_REJECT_RANGE], 2);
	f.data[2] = 3; /* a probability beyond the table: the object is as likely as it was */
	f.data[1] = 0x11;
	assert_int_equal(take(&l, f), 1);
	assert_true(l.out.det.existence == 1);
	assert_int_equal(l.d.rejected[SCENE_REJECT_RANGE], 3);
}

/* ---- what is refused ------------------------------------------------------------------------ */

static void bad_checksums_are_refused(void **state)
{
	struct wire l = open_wire();

	(void)state;
	settle(&l, EGO_ID);
	for (int bit = 0; bit < 64; bit++) {
		struct bus_frame f = make(&l, EGO_ID, 20, NULL);

		f.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		assert_int_equal(take(&l, f), 0);
		f.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		assert_int_equal(refused(&l, EGO_ID), 1);
		assert_int_equal(take(&l, f), 1);
		assert_int_equal(refused(&l, EGO_ID), 0);
	}
	assert_rejected(&l, SCENE_REJECT_CRC, 64);

	struct bus_frame f = make_far(&l, NULL, 0);

	f.data[2] ^= 1;
	assert_int_equal(take(&l, f), 0);
	assert_rejected(&l, SCENE_REJECT_CRC, 65);
}

static void repeated_and_reordered_frames_are_refused(void **state)
{
	struct wire l = open_wire();

	(void)state;
	settle(&l, EGO_ID);
	const struct bus_frame old = make(&l, EGO_ID, 20, NULL);

	assert_int_equal(take(&l, old), 1);
	assert_int_equal(take(&l, old), 0);
	assert_int_equal(take(&l, old), 0);
	assert_rejected(&l, SCENE_REJECT_COUNTER, 2);
	for (int i = 0; i < 6; i++) {
		make(&l, EGO_ID, 20, NULL); /* lost: more than may be */
	}
	assert_int_equal(take(&l, make(&l, EGO_ID, 20, NULL)), 0);
	assert_rejected(&l, SCENE_REJECT_COUNTER, 3);
	/* the sequence begins anew, which is nobody's fault */
	settle(&l, EGO_ID);
	assert_rejected(&l, SCENE_REJECT_COUNTER, 3);

	/* a counter that is an ordinary signal */
	settle(&l, WHEELS_ID);
	const struct bus_frame wheels = make(&l, WHEELS_ID, 20, NULL);

	assert_int_equal(take(&l, wheels), 1);
	assert_int_equal(take(&l, wheels), 0);
	assert_rejected(&l, SCENE_REJECT_COUNTER, 4);
}

static void wrong_lengths_are_refused(void **state)
{
	struct wire l = open_wire();
	struct bus_frame f = make_far(&l, NULL, 0);

	(void)state;
	f.len = 7;
	assert_int_equal(take(&l, f), 0);
	f.len = 12;
	assert_int_equal(take(&l, f), 0);
	assert_rejected(&l, SCENE_REJECT_LENGTH, 2);
	assert_int_equal(refused(&l, FAR_ID), 2);

	/* even where nothing is checked */
	struct wire p = open_wire_of(plain);

	f = make(&p, NEAR_ID, 0, &ahead);
	f.len = 0;
	assert_int_equal(take(&p, f), 0);
	assert_rejected(&p, SCENE_REJECT_LENGTH, 1);
}

static void values_not_available_are_left_out(void **state)
{
	struct wire l = open_wire();
	struct bus_frame f;

	(void)state;
	settle(&l, EGO_ID);
	f = make(&l, EGO_ID, 20, NULL);
	set_raw(&f, "SPEED", 65535);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.roles, 1u << MAP_YAW_RATE | 1u << MAP_DRIVER_BRAKE);
	assert_rejected(&l, SCENE_REJECT_NOT_AVAILABLE, 1);
	assert_int_equal(refused(&l, EGO_ID), 0);
	/* one wheel of two */
	settle(&l, WHEELS_ID);
	f = make(&l, WHEELS_ID, 20, NULL);
	set_raw(&f, "B", 65535);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.roles, 0);
	assert_rejected(&l, SCENE_REJECT_NOT_AVAILABLE, 2);
	/* a distance: the slot is empty */
	assert_int_equal(take(&l, make_far(&l, "DIST", 8191)), 1);
	assert_int_equal(l.out.target, 0);
	assert_rejected(&l, SCENE_REJECT_NOT_AVAILABLE, 3);
	assert_int_equal(refused(&l, FAR_ID), 0);
	/* a target whose speed is not available: it is there, but cannot be followed */
	for (uint32_t i = 1; i <= 3; i++) {
		assert_int_equal(take(&l, make_far(&l, "VREL", 2048)), 1);
		assert_int_equal(l.out.target, 0);
		assert_int_equal(refused(&l, FAR_ID), i);
	}
	assert_rejected(&l, SCENE_REJECT_NOT_AVAILABLE, 6);
	assert_int_equal(take(&l, make_far(&l, NULL, 0)), 1);
	assert_int_equal(refused(&l, FAR_ID), 0);
}

static void values_out_of_range_are_left_out(void **state)
{
	struct wire l = open_wire();
	struct bus_frame f;

	(void)state;
	settle(&l, EGO_ID);
	f = make(&l, EGO_ID, 20, NULL);
	set_raw(&f, "SPEED", 16301);
	assert_int_equal(take(&l, f), 1);
	assert_int_equal(l.out.roles, 1u << MAP_YAW_RATE | 1u << MAP_DRIVER_BRAKE);
	assert_rejected(&l, SCENE_REJECT_RANGE, 1);

	static const struct {
		const char *name;
		uint64_t raw;
	} far[] = {{"DIST", 6001}, {"VREL", 1801}, {"LAT", 401}, {"PROB", 101}};

	for (uint64_t i = 0; i < 4; i++) {
		assert_int_equal(take(&l, make_far(&l, far[i].name, far[i].raw)), 1);
		assert_int_equal(l.out.target, 0);
		assert_rejected(&l, SCENE_REJECT_RANGE, 2 + i);
		assert_int_equal(refused(&l, FAR_ID), 1 + i);
	}
}

/* ---- trust ---------------------------------------------------------------------------------- */

static void a_counter_needs_three_frames_to_start(void **state)
{
	struct wire l = open_wire();

	(void)state;
	assert_int_equal(take(&l, make(&l, EGO_ID, 20, NULL)), 0);
	assert_int_equal(take(&l, make(&l, EGO_ID, 20, NULL)), 0);
	assert_true(l.d.message[message(EGO_ID)].t_ns == DECODE_NEVER);
	assert_int_equal(take(&l, make(&l, EGO_ID, 20, NULL)), 1);
	assert_none_rejected(&l);
}

static void distrust_takes_three_frames_to_end(void **state)
{
	struct wire l = open_wire();

	(void)state;
	settle(&l, EGO_ID);
	assert_int_equal(take(&l, make_far(&l, NULL, 0)), 1);
	decode_distrust(&l.d);
	assert_true(l.d.message[message(FAR_ID)].t_ns == DECODE_NEVER);
	for (int i = 1; i <= 3; i++) {
		assert_int_equal(take(&l, make(&l, EGO_ID, 20, NULL)), i == 3);
		assert_int_equal(take(&l, make_far(&l, NULL, 0)), i == 3);
	}
	assert_none_rejected(&l);
}

static void rejects_have_names(void **state)
{
	(void)state;
	for (int i = 0; i < SCENE_REJECTS; i++) {
		assert_non_null(scene_reject_name[i]);
	}
	assert_string_equal(scene_reject_name[SCENE_REJECT_CRC], "crc");
	assert_string_equal(scene_reject_name[SCENE_REJECT_IMPLAUSIBLE], "implausible");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(roles_come_in_si),
		cmocka_unit_test(several_signals_are_averaged),
		cmocka_unit_test(a_target_comes_with_sign_and_offset),
		cmocka_unit_test(an_empty_slot_is_no_error),
		cmocka_unit_test(what_is_not_mapped_has_its_default),
		cmocka_unit_test(what_is_not_ours_passes_by),
		cmocka_unit_test(a_header_says_how_many),
		cmocka_unit_test(or_does_not_say),
		cmocka_unit_test(an_object_in_an_unknown_state_is_none),
		cmocka_unit_test(an_object_and_its_quality_have_a_number),
		cmocka_unit_test(a_sigma_that_is_not_given_is_none),
		cmocka_unit_test(bad_checksums_are_refused),
		cmocka_unit_test(repeated_and_reordered_frames_are_refused),
		cmocka_unit_test(wrong_lengths_are_refused),
		cmocka_unit_test(values_not_available_are_left_out),
		cmocka_unit_test(values_out_of_range_are_left_out),
		cmocka_unit_test(a_counter_needs_three_frames_to_start),
		cmocka_unit_test(distrust_takes_three_frames_to_end),
		cmocka_unit_test(rejects_have_names),
	};

	return cmocka_run_group_tests_name("decode", tests, load, unload);
}
