/* SPDX-License-Identifier: MIT
 * From sections and a database to roles: what is found, what is converted, what is refused.
 */
#include "conf_dir.h"

#include <errno.h>

#include "config.h"
#include "mapping.h"

static char dir[CONF_DIR_PATH];

static const char dbc[] = "VERSION \"\"\n"
			  "BO_ 256 EGO: 8 CAR\n"
			  " SG_ SPEED : 0|16@1+ (0.01,0) [0|250] \"km/h\" X\n"
			  " SG_ WHEEL_1 : 16|16@1+ (0.01,0) [0|250] \"m/s\" X\n"
			  " SG_ YAW : 32|12@1- (0.1,0) [0|0] \"deg/s\" X\n"
			  " SG_ BRAKE : 44|1@1+ (1,0) [0|1] \"\" X\n"
			  " SG_ ODD : 48|8@1+ (1,0) [0|255] \"furlongs\" X\n"
			  " SG_ NONE : 56|8@1+ (1,0) [0|255] \"\" X\n"
			  "BO_ 2566914048 SAFE: 8 CAR\n"
			  " SG_ SPEED : 16|16@1+ (0.01,0) [0|163] \"m/s\" X\n"
			  "BO_ 273 OBJ_1: 8 RADAR\n"
			  " SG_ DIST : 0|13@1+ (0.1,0) [0|819] \"m\" X\n"
			  " SG_ VREL : 16|12@1- (0.05,0) [0|0] \"m/s\" X\n"
			  " SG_ DIST_2 : 32|13@1+ (0.1,0) [0|819] \"m\" X\n"
			  " SG_ COUNT : 56|4@1+ (1,0) [0|15] \"\" X\n"
			  "BO_ 272 OBJ_0: 8 RADAR\n"
			  " SG_ DIST : 0|13@1+ (0.1,0) [0|819] \"m\" X\n"
			  " SG_ VREL : 16|12@1- (0.05,0) [0|0] \"m/s\" X\n"
			  " SG_ LAT : 32|12@1- (0.02,0) [0|0] \"cm\" X\n"
			  " SG_ GONE : 44|1@1+ (1,0) [0|1] \"\" X\n"
			  " SG_ PROB : 48|7@1+ (1,0) [0|100] \"%\" X\n"
			  "BO_ 274 STRAY: 8 RADAR\n"
			  " SG_ DIST : 0|13@1+ (0.1,0) [0|819] \"m\" X\n"
			  "BO_ 672 OURS: 8 CAR\n"
			  " SG_ SPEED : 0|16@1+ (0.01,0) [0|250] \"km/h\" X\n"
			  "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 10000;\n"
			  "BA_DEF_ BO_ \"E2EDataIDList\" STRING ;\n"
			  "BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n"
			  "BA_DEF_DEF_ \"E2EDataIDList\" \"\";\n"
			  "BA_ \"GenMsgCycleTime\" BO_ 256 20;\n"
			  "BA_ \"GenMsgCycleTime\" BO_ 2566914048 20;\n"
			  "BA_ \"GenMsgCycleTime\" BO_ 273 50;\n"
			  "BA_ \"GenMsgCycleTime\" BO_ 272 50;\n"
			  "BA_ \"GenMsgCycleTime\" BO_ 672 20;\n"
			  "BA_ \"E2EDataIDList\" BO_ 2566914048 \"01 02 03 04 05 06 07 08 09 0A 0B "
			  "0C 0D 0E 0F 10\";\n"
			  "VAL_ 256 SPEED 65535 \"not available\" ;\n";

/* What every file here starts with; its lines 1 to 5. */
#define HEAD  "[dbc]\nfile = test.dbc\n[bus]\ninterfaces = can0 can1\n#\n"
#define ONE   "[dbc]\nfile = test.dbc\n#\n#\n#\n"
#define SPEED "[signal ego_speed]\nfrom = EGO.SPEED\n"
#define LEAD  "[signal distance]\nfrom = OBJ_0.DIST\n[signal rel_speed]\nfrom = OBJ_0.VREL\n"
#define ALL   ONE SPEED LEAD /* lines 1 to 11 */
#define MANY  "0 1 2 3 4 5 6 7 8 9 0 1 2 3 4 5 6 7 8 9 0 1 2 3 4 5 6 7 8 9 0 1"

/* A radar that sends a list: EGO begins a scan, OBJ_1 is an object, SAFE its quality. */
#define OBJECTS                                                                                    \
	ONE SPEED                                                                                  \
		"[signal distance]\nfrom = OBJ_1.DIST\n[signal rel_speed]\nfrom = OBJ_1.VREL\n"    \
		"[signal object_count]\nfrom = EGO.NONE\n[signal object_id]\nfrom = OBJ_1.COUNT\n" \
		"[signal quality_id]\nfrom = SAFE.SPEED\n" /* lines 1 to 17 */

static int load(const char *text, struct config *c, struct mapping **m, char *err)
{
	char path[2 * CONF_DIR_PATH];

	conf_dir_write(dir, "test.conf", text, strlen(text), path);
	return config_load(path, NULL, 0, c, m, err, 1024);
}

static struct mapping *load_good(const char *text, struct config *c)
{
	struct mapping *m = NULL;
	char err[1024];

	if (load(text, c, &m, err)) {
		fail_msg("%s", err);
	}
	return m;
}

static const struct {
	const char *text, *want;
} bad[] = {
	/* the database */
	{"[bus]\n", ": no CAN database; write [dbc] file = NAME.dbc"},
	{"[dbc]\nfile =\n", ":2: dbc.file: no CAN database"},
	{"[dbc]\nfile = nosuch.dbc\n", ":2: dbc.file: cannot open 'DIR/nosuch.dbc': No such file"},
	{"[dbc]\nfile = .\n", ":2: dbc.file: "},
	{"[dbc]\nfile = test.conf\n", ":2: dbc.file: "},
	/* roles */
	{ONE LEAD, ": ego_speed: not mapped; write [signal ego_speed] from = MESSAGE.SIGNAL"},
	{ONE SPEED, ": distance: not mapped; write [signal distance] from"},
	{ONE SPEED "[signal distance]\nfrom = OBJ_0.DIST\n", ": rel_speed: not mapped"},
	{ALL "[signal valid]\nnegate = yes\n", ":12: [signal valid]: valid: not mapped"},
	{ALL "[signal latral]\n", ":12: [signal latral]: no such role 'latral' (nearest: lateral)"},
	{ALL "[signal]\n", ":12: [signal]: no such role ''"},
	{ALL "[signal lateral]\nform = OBJ_0.LAT\n",
	 ":13: signal lateral.form: no such key (nearest: from)"},
	{ALL "[signal lateral]\nfrom =\n", ":13: signal lateral.from: no name given"},
	{ALL "[signal lateral]\nfrom = OBJ_0\n",
	 ":13: signal lateral.from: 'OBJ_0' names no signal; write MESSAGE.SIGNAL"},
	{ALL "[signal lateral]\nfrom = OBJ_7.LAT\n",
	 ":13: signal lateral.from: no message 'OBJ_7' in DIR/test.dbc (nearest: OBJ_"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LATT\n",
	 ":13: signal lateral.from: message OBJ_0 has no signal 'LATT' (nearest: LAT)"},
	{ALL "[signal lateral]\nfrom = OBJ_0.\n",
	 ":13: signal lateral.from: message OBJ_0 has no signal ''"},
	{ALL "[signal lateral]\nfrom = .LAT\n", ":13: signal lateral.from: no message ''"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LAT.X\n",
	 ":13: signal lateral.from: message OBJ_0 has no signal 'LAT.X'"},
	/* ranges */
	{ALL "[signal lateral]\nfrom = OBJ_{0..}.LAT\n",
	 ":13: signal lateral.from: 'OBJ_{0..}.LAT' is no range; write NAME_{0..15}"},
	{ALL "[signal lateral]\nfrom = OBJ_{2..1}.LAT\n",
	 ":13: signal lateral.from: 'OBJ_{2..1}.LAT' is no range"},
	{ALL "[signal lateral]\nfrom = OBJ_{-1..1}.LAT\n",
	 ":13: signal lateral.from: 'OBJ_{-1..1}.LAT' is no range"},
	{ALL "[signal lateral]\nfrom = OBJ_{0..1\n",
	 ":13: signal lateral.from: 'OBJ_{0..1' is no range"},
	{ALL "[signal lateral]\nfrom = {0..1}{0..1}\n",
	 ":13: signal lateral.from: '{0..1}{0..1}' is no range"},
	{ALL "[signal lateral]\nfrom = OBJ_{0..64}.LAT\n",
	 ":13: signal lateral.from: more than 64 names"},
	{ALL "[signal lateral]\nfrom = OBJ_{0..99999999999}.LAT\n",
	 ":13: signal lateral.from: 'OBJ_{0..99999999999}.LAT' is no range"},
	/* targets */
	{ONE SPEED
	 "[signal distance]\nfrom = OBJ_{0..1}.DIST\n[signal rel_speed]\nfrom = OBJ_0.VREL\n",
	 ":11: signal rel_speed.from: 1 signals for 2 targets; name one for each"},
	{ALL "[signal lateral]\nfrom = OBJ_{0..1}.DIST\n",
	 ":13: signal lateral.from: number 2 is in message OBJ_1, unlike its distance"},
	{ONE SPEED "[signal distance]\nfrom = OBJ_{0..1}.DIST\n[signal rel_speed]\nfrom = "
		   "OBJ_1.VREL OBJ_0.VREL\n",
	 ":11: signal rel_speed.from: number 1 is in message OBJ_1, unlike its distance"},
	{ONE SPEED "[signal distance]\nfrom = OBJ_1.DIST OBJ_1.DIST_2\n",
	 ":9: signal distance.from: message OBJ_1 carries two targets"},
	{ONE LEAD "[signal ego_speed]\nfrom = EGO.SPEED EGO.SPEED EGO.SPEED EGO.SPEED EGO.SPEED\n",
	 ":11: signal ego_speed.from: more than 4 signals"},
	/* conversion */
	{ONE LEAD "[signal ego_speed]\nfrom = EGO.ODD\n",
	 ":11: signal ego_speed.from: ODD: unknown unit 'furlongs'; set unit to one of: m/s, km/h, "
	 "kph"},
	{ONE LEAD "[signal ego_speed]\nfrom = EGO.NONE\n",
	 ":11: signal ego_speed.from: NONE: unknown unit ''; set unit to one of: m/s"},
	{ONE LEAD "[signal ego_speed]\nfrom = EGO.NONE\nunit = m\n",
	 ":12: signal ego_speed.unit: NONE: unknown unit 'm'"},
	{ONE LEAD "[signal ego_speed]\nfrom = EGO.SPEED\nunit = KM/H\n",
	 ":12: signal ego_speed.unit: SPEED: unknown unit 'KM/H'"},
	{ALL "[signal yaw_rate]\nfrom = EGO.SPEED\n",
	 ":13: signal yaw_rate.from: SPEED: unknown unit 'km/h'; set unit to one of: rad/s, deg/s"},
	{ALL "[signal existence]\nfrom = OBJ_0.DIST\n",
	 ":13: signal existence.from: DIST: unknown unit 'm'; set unit to one of: 1, %"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LAT\nnegate = maybe\n",
	 ":14: signal lateral.negate: 'maybe' is neither yes nor no"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LAT\noffset = far\n",
	 ":14: signal lateral.offset: 'far' is no number"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LAT\noffset = nan\n",
	 ":14: signal lateral.offset: 'nan' is no number"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LAT\noffset = 1001\n",
	 ":14: signal lateral.offset: '1001' is no number from -1000 to 1000"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LAT\nna = 0x1000\n",
	 ":14: signal lateral.na: '0x1000' is no raw value of LAT; allowed: 0 to 0xFFF"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LAT\nna = -1\n",
	 ":14: signal lateral.na: '-1' is no raw value of LAT"},
	{ALL "[signal lateral]\nfrom = OBJ_0.LAT\nna = none\n",
	 ":14: signal lateral.na: 'none' is no raw value of LAT"},
	/* lists and tables */
	{ALL "[signal object_id]\nfrom = OBJ_0.PROB\n",
	 ":13: signal object_id.from: without a header an empty road looks like a dead radar; map "
	 "object_count or scan_start"},
	{ALL "[signal object_count]\nfrom = EGO.NONE\n[signal object_id]\nfrom = OBJ_1.COUNT\n",
	 ":15: signal object_id.from: the number is in OBJ_1, unlike the distance"},
	{ONE SPEED "[signal distance]\nfrom = OBJ_{0..1}.DIST\n[signal rel_speed]\nfrom = "
		   "OBJ_{0..1}.VREL\n[signal scan_start]\nfrom = EGO.NONE\n[signal object_id]\n"
		   "from = OBJ_0.PROB\n",
	 ":15: signal object_id.from: the number is in OBJ_0, unlike the distance; one message"},
	{ALL "[signal object_count]\nfrom = EGO.NONE EGO.ODD\n",
	 ":13: signal object_count.from: more than one signal; name one"},
	{ALL "[signal object_count]\nfrom = EGO.NONE\n[signal scan_start]\nfrom = SAFE.SPEED\n",
	 ":15: signal scan_start.from: EGO begins each scan already; name one message"},
	{ALL "[signal object_count]\nfrom = EGO.NONE\n[signal quality_id]\nfrom = OBJ_1.COUNT\n",
	 ":15: signal quality_id.from: quality of which object? map object_id too"},
	{ALL "[signal scan_start]\nfrom = OBJ_0.PROB\n",
	 ": header, objects and quality are one message"},
	{ALL "[signal scan_start]\nfrom = EGO.NONE\n[signal object_id]\nfrom = OBJ_0.PROB\n"
	     "[signal quality_id]\nfrom = EGO.ODD\n",
	 ":17: signal quality_id.from: header, objects and quality are one message"},
	{OBJECTS "[signal lateral]\nfrom = SAFE.SPEED\nunit = m\n",
	 ":19: signal lateral.from: number 1 is in message SAFE, unlike its distance"},
	{OBJECTS "[signal distance_sigma]\nfrom = SAFE.SPEED\ntable = 1 x\n",
	 ":20: signal distance_sigma.table: 'x' is no number"},
	{OBJECTS "[signal distance_sigma]\nfrom = SAFE.SPEED\ntable =\n",
	 ":20: signal distance_sigma.table: no numbers; write what raw value 0, 1, ... stands for"},
	{OBJECTS "[signal distance_sigma]\nfrom = SAFE.SPEED\ntable = " MANY " " MANY " 1\n",
	 ":20: signal distance_sigma.table: more than 64 numbers"},
	{OBJECTS "[signal distance_sigma]\nfrom = SAFE.SPEED\ntable = 1 2\n",
	 ":19: signal distance_sigma.from: SPEED: unknown unit 'm/s'"},
	{ONE "[signal ego_speed]\nfrom = EGO.SPEED\ntable = 1\n"
	     "[signal yaw_rate]\nfrom = EGO.YAW\ntable = 1\n"
	     "[signal driver_brake]\nfrom = EGO.BRAKE\ntable = 1\n"
	     "[signal distance]\nfrom = OBJ_0.DIST\ntable = 1\n"
	     "[signal rel_speed]\nfrom = OBJ_0.VREL\ntable = 1\n"
	     "[signal lateral]\nfrom = OBJ_0.LAT\ntable = 1\n"
	     "[signal valid]\nfrom = OBJ_0.GONE\ntable = 1\n"
	     "[signal fresh]\nfrom = OBJ_0.GONE\ntable = 1\n"
	     "[signal existence]\nfrom = OBJ_0.PROB\ntable = 1\n",
	 ":32: signal existence.table: more than 8 tables; map fewer signals by table"},
	/* messages */
	{ALL "[message]\n", ":12: [message]: no name given"},
	{ALL "[message EGOO]\n",
	 ":12: [message EGOO]: no message 'EGOO' in DIR/test.dbc (nearest: EGO)"},
	{ALL "[message STRAY]\ncheck = crc\n",
	 ":13: message STRAY.check: no check 'crc' (nearest: "},
	{ALL "[message EGO]\n[message OBJ_{0..0} EGO]\n",
	 ":13: [message OBJ_{0..0} EGO]: EGO is set twice, first in line 12"},
	{ALL "[message EGO]\ninterfaces = can0\n",
	 ":13: message EGO.interfaces: no such key (nearest: interface)"},
	{ALL "[message EGO]\ninterface = can2\n",
	 ":13: message EGO.interface: 'can2' is not among bus.interfaces (nearest: can0)"},
	{ALL "[message EGO]\ncheck = toyotta\n",
	 ":13: message EGO.check: no check 'toyotta' (nearest: toyota)"},
	{ALL "[message EGO]\ncheck = e2e-p2\n", ":12: [message EGO]: EGO: check e2e-p2: "},
	{ALL "[message EGO]\ncounter = COUNT\n",
	 ":13: message EGO.counter: message EGO has no signal 'COUNT'"},
	{ALL "[message EGO]\nperiod = 0\n",
	 ":13: message EGO.period: '0' is no period; allowed: 1 to 10000 ms"},
	{ALL "[message EGO]\nperiod = 10001\n", ":13: message EGO.period: '10001' is no period"},
	{ALL "[message EGO]\nperiod = 20ms\n", ":13: message EGO.period: '20ms' is no period"},
	{ALL "[message EGO]\nperiod = nan\n", ":13: message EGO.period: 'nan' is no period"},
	{ONE SPEED "[signal distance]\nfrom = STRAY.DIST\n[signal rel_speed]\nfrom = "
		   "STRAY.DIST\nunit = m/s\n",
	 ":9: signal distance.from: STRAY: the database gives no cycle; write [message "
	 "STRAY] "
	 "period = MS"},
	{HEAD SPEED LEAD, ":7: signal ego_speed.from: EGO: which of bus.interfaces? write [message "
			  "EGO] interface = can0"},
	{HEAD SPEED LEAD "[message EGO]\ninterface = can0\n",
	 ":9: signal distance.from: OBJ_0: which of bus.interfaces?"},
	{ONE LEAD "[signal ego_speed]\nfrom = OURS.SPEED\n",
	 ":11: signal ego_speed.from: OURS has an identifier of our own frames, 0x2A0"},
	{ALL "[road]\n[message EGO]\n[signal yaw_rate]\nfrom = "
	     "EGO.YAW\n[mc]\n[driver]\n[bus]\nrequest_id = 0xFC\n",
	 ":13: [message EGO]: EGO has an identifier of our own frames, 0x100; move "
	 "bus.request_id"},
};

/* expand - "DIR" in @want becomes the directory */
static void expand(const char *want, char *text, size_t size)
{
	const char *at = strstr(want, "DIR");
	int n = at ? (int)(at - want) : (int)strlen(want);

	snprintf(text, size, "%s/test.conf%.*s%s%s", dir, n, want, at ? dir : "", at ? at + 3 : "");
}

static void errors_are_named(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		char err[1024] = "", want[1024];
		struct mapping *m = NULL;
		struct config c;

		assert_int_equal(load(bad[i].text, &c, &m, err), -EINVAL);
		expand(bad[i].want, want, sizeof(want));
		if (strncmp(err, want, strlen(want)) != 0) {
			fail_msg("wanted %s, got %s", want, err);
		}
		assert_null(strchr(err, '\n'));
		assert_null(m);
	}
}

static void too_many_messages(void **state)
{
	static char text[65536];
	char path[2 * CONF_DIR_PATH], err[1024];
	struct mapping *m;
	struct config c;
	int n = 0;

	(void)state;
	for (int i = 0; i < 66; i++) {
		n += snprintf(text + n, sizeof(text) - (size_t)n,
			      "BO_ %d M%d: 8 X\n SG_ D : 0|8@1+ (1,0) [0|0] \"m\" X\n"
			      " SG_ V : 8|8@1+ (1,0) [0|0] \"m/s\" X\n",
			      i + 1, i);
	}
	conf_dir_write(dir, "many.dbc", text, (size_t)n, path);
	assert_int_equal(load("[dbc]\nfile = many.dbc\n[signal ego_speed]\nfrom = M64.V\n"
			      "[signal distance]\nfrom = M{0..63}.D\n",
			      &c, &m, err),
			 -EINVAL);
	assert_non_null(
		strstr(err, ":6: signal distance.from: signals from more than 64 messages"));
}

/* The database's absolute path is an option like others, and must fit. */
static void long_path(void **state)
{
	char name[251], text[512], path[2 * CONF_DIR_PATH], err[1024];
	struct mapping *m;
	struct config c;

	(void)state;
	memset(name, 'x', sizeof(name) - 1);
	name[sizeof(name) - 1] = '\0';
	conf_dir_write(dir, name, dbc, sizeof(dbc) - 1, path);
	snprintf(text, sizeof(text), "[dbc]\nfile = %s\n", name);
	assert_int_equal(load(text, &c, &m, err), -EINVAL);
	assert_non_null(strstr(err, "is longer than 255 characters; move it"));
}

static void roles_are_filled(void **state)
{
	static const char text[] =
		HEAD "[vehicle]\nfront_offset = -0.5\n[radar]\nscan_gap = 15\nperiod = 50\n"
		     "[signal ego_speed]\nfrom = EGO.SPEED SAFE.SPEED\n"
		     "[signal yaw_rate]\nfrom = EGO.YAW\nnegate = yes\noffset = 0.25\n"
		     "[signal driver_brake]\nfrom = EGO.BRAKE\n"
		     "[signal distance]\nfrom = OBJ_{0..1}.DIST\noffset = 2\n"
		     "[signal rel_speed]\nfrom = OBJ_{0..1}.VREL\nna = 0x800\n"
		     "[message EGO SAFE]\ninterface = can1\nperiod = 24.5\n"
		     "[message OBJ_{0..1}]\ninterface = can0\n";
	struct config c;
	struct mapping *m;

	(void)state;
	m = load_good(text, &c);
	assert_int_equal(m->n_ifaces, 2);
	assert_string_equal(m->iface[1], "can1");
	assert_int_equal(m->n_messages, 4);
	assert_int_equal(m->n_tracks, 2);
	assert_true(m->scan_gap_ns == 15000000);

	const struct map_role_signals *speed = &m->role[MAP_EGO_SPEED];

	assert_int_equal(speed->n, 2);
	assert_true(speed->signal[0].gain == 1.0 / 3.6 && speed->signal[1].gain == 1.0);
	assert_true(speed->signal[0].has_na && speed->signal[0].na_raw == 65535);
	assert_false(speed->signal[1].has_na);
	assert_true(m->role[MAP_YAW_RATE].signal[0].gain == -3.14159265358979323846 / 180.0);
	assert_true(m->role[MAP_YAW_RATE].signal[0].offset == 0.25);
	assert_int_equal(m->role[MAP_DRIVER_BRAKE].n, 1);
	assert_int_equal(m->role[MAP_DRIVER_ACCEL].n, 0);

	const struct map_message *ego = &m->message[speed->message[0]],
				 *safe = &m->message[speed->message[1]];

	assert_string_equal(ego->msg->name, "EGO");
	assert_true(ego->ego == 1 && ego->track == -1 && ego->iface == 1 && ego->check == E2E_NONE);
	assert_true(ego->period_ns == 24500000);
	assert_true(safe->check == E2E_P2 && (safe->msg->id & BUS_ID_EFF));

	for (int i = 0; i < 2; i++) {
		const struct map_track *t = &m->track[i];
		const struct map_message *obj = &m->message[t->message];

		assert_int_equal(obj->msg->id, 272 + i);
		assert_true(obj->track == i && obj->ego == 0 && obj->iface == 0 &&
			    obj->period_ns == 50000000);
		assert_true(t->distance.gain == 1.0 && t->distance.offset == 1.5);
		assert_true(t->rel_speed.has_na && t->rel_speed.na_raw == 0x800);
		assert_null(t->lateral.sig);
		assert_int_equal(mapping_find(m, 0, (uint32_t)(272 + i)), t->message);
		assert_int_equal(mapping_find(m, 1, (uint32_t)(272 + i)), -1);
	}
	assert_int_equal(mapping_find(m, 1, 256), speed->message[0]);
	assert_int_equal(mapping_find(m, 1, 2566914048u), speed->message[1]);
	assert_int_equal(mapping_find(m, 1, 2566914048u & BUS_ID_MASK), -1);
	assert_int_equal(mapping_find(m, 0, 0), -1);
	config_mapping_free(m);
}

static void a_list_has_header_objects_and_quality(void **state)
{
	struct config c;
	struct mapping *m = load_good(OBJECTS "[signal existence]\nfrom = SAFE.SPEED\nunit = %\n"
					      "table = 0 50 100\n[signal rate_sigma]\n"
					      "from = OBJ_1.DIST_2\nunit = m/s\n",
				      &c);
	const struct map_list *l = &m->list;
	const struct map_track *t = &m->track[0];

	(void)state;
	assert_string_equal(m->message[l->header].msg->name, "EGO");
	assert_int_equal(m->message[l->header].part, MAP_HEADER);
	assert_int_equal(m->message[l->header].ego, 1); /* both at once */
	assert_string_equal(m->message[l->quality].msg->name, "SAFE");
	assert_int_equal(m->message[l->quality].part, MAP_QUALITY);
	assert_int_equal(m->message[t->message].part, MAP_TARGET);
	assert_true(l->count.sig && l->id.sig && l->quality_id.sig && !l->start.sig);
	assert_int_equal(m->n_tracks, 1);
	assert_int_equal(t->existence.message, l->quality);
	assert_int_equal(t->rate_sigma.message, t->message);
	assert_true(t->existence.table->n == 3 && t->existence.table->value[1] == 50);
	assert_true(t->existence.gain == 0.01 && !t->rate_sigma.table);

	const uint64_t hash = config_hash(&c, m);

	config_mapping_free(m);
	m = load_good(OBJECTS "[signal existence]\nfrom = SAFE.SPEED\nunit = %\n"
			      "table = 0 51 100\n[signal rate_sigma]\n"
			      "from = OBJ_1.DIST_2\nunit = m/s\n",
		      &c);
	assert_true(config_hash(&c, m) != hash);
	config_mapping_free(m);
	/* slots have none of it */
	m = load_good(ALL, &c);
	assert_true(m->list.header == -1 && m->list.quality == -1);
	assert_int_equal(m->message[m->track[0].message].part, MAP_TARGET);
	assert_int_equal(m->message[m->role[MAP_EGO_SPEED].message[0]].part, MAP_NO_PART);
	config_mapping_free(m);
}

static void flags_and_shares(void **state)
{
	struct config c;
	struct mapping *m = load_good(
		ALL "[signal valid]\nfrom = OBJ_0.GONE\nnegate = yes\n"
		    "[signal existence]\nfrom = OBJ_0.PROB\n[signal lateral]\nfrom = OBJ_0.LAT\n",
		&c);
	const struct map_signal *valid = &m->track[0].valid;

	(void)state;
	assert_true(valid->gain * 1.0 + valid->offset == 0.0);
	assert_true(valid->gain * 0.0 + valid->offset == 1.0);
	assert_true(m->track[0].existence.gain == 0.01);
	assert_true(m->track[0].lateral.gain == 0.01);
	config_mapping_free(m);
}

static void ours_may_be_elsewhere(void **state)
{
	struct config c;
	struct mapping *m = load_good(
		HEAD "[signal ego_speed]\nfrom = OURS.SPEED\n" LEAD
		     "[message OURS]\ninterface = can1\n[message OBJ_0]\ninterface = can0\n",
		&c);

	(void)state;
	assert_int_equal(m->message[m->role[MAP_EGO_SPEED].message[0]].msg->id, 0x2A0);
	config_mapping_free(m);
}

static void ranges_keep_their_width(void **state)
{
	static const char text[] = "BO_ 1 T08: 8 X\n SG_ D : 0|8@1+ (1,0) [0|0] \"m\" X\n SG_ V : "
				   "8|8@1+ (1,0) [0|0] \"m/s\" X\n"
				   "BO_ 2 T09: 8 X\n SG_ D : 0|8@1+ (1,0) [0|0] \"m\" X\n SG_ V : "
				   "8|8@1+ (1,0) [0|0] \"m/s\" X\n"
				   "BO_ 3 T10: 8 X\n SG_ D : 0|8@1+ (1,0) [0|0] \"m\" X\n SG_ V : "
				   "8|8@1+ (1,0) [0|0] \"m/s\" X\n";
	char path[2 * CONF_DIR_PATH];
	struct config c;
	struct mapping *m;

	(void)state;
	conf_dir_write(dir, "width.dbc", text, sizeof(text) - 1, path);
	m = load_good("[dbc]\nfile = width.dbc\n[signal ego_speed]\nfrom = T{08..10}.V\n[signal "
		      "distance]\nfrom = T{08..10}.D\n"
		      "[signal rel_speed]\nfrom = T{08..10}.V\n[message T{08..10}]\nperiod = 50\n",
		      &c);
	assert_int_equal(m->n_tracks, 3);
	assert_int_equal(m->message[m->track[2].message].msg->id, 3);
	assert_true(m->message[0].ego == 1 && m->message[0].track == 0);
	config_mapping_free(m);
}

static int setup(void **state)
{
	char path[2 * CONF_DIR_PATH];

	(void)state;
	conf_dir_open(dir);
	conf_dir_write(dir, "test.dbc", dbc, sizeof(dbc) - 1, path);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	conf_dir_close(dir);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(errors_are_named),
		cmocka_unit_test(too_many_messages),
		cmocka_unit_test(long_path),
		cmocka_unit_test(roles_are_filled),
		cmocka_unit_test(a_list_has_header_objects_and_quality),
		cmocka_unit_test(flags_and_shares),
		cmocka_unit_test(ours_may_be_elsewhere),
		cmocka_unit_test(ranges_keep_their_width),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
