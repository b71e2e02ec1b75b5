/* SPDX-License-Identifier: MIT
 * Closed loops: the suites' rows, cars by chance, the physical limit, and figures over many runs.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>

#include "../tools/cli.c"
#include "../tools/drive.c"
#include "../tools/encode.c"
#include "../tools/plant.c"
#include "../tools/scenario_calm.c"
#undef KMH
#undef G
#include "../tools/scenario_draw.c"
#include "../tools/scenario_latest.c"
#undef STEPS
#include "../tools/scenario_loop.c"
#include "../tools/scenario_report.c"
#include "../tools/scenario_suite.c"
#undef KMH
#include "../tools/scenario_traffic.c"
#include "../tools/sensors.c"

static struct scenario rows[SCENARIO_ROWS_MAX];

static const struct scenario *row(const char *name)
{
	for (int i = 0; i < SCENARIO_ROWS_MAX; i++) {
		if (!strcmp(rows[i].name, name)) {
			return &rows[i];
		}
	}
	fail_msg("no row %s", name);
	return NULL;
}

static void rows_have_names_of_their_own(void **state)
{
	static const int n[] = {213, 41, 24, 180, 10}, least_short[] = {10, 10, 10, 10, 4};

	(void)state;
	for (int i = 0; scenario_suites[i].name; i++) {
		const int found = scenario_suites[i].rows(rows, SCENARIO_ROWS_MAX);
		int in_short = 0;

		assert_int_equal(found, n[i]);
		assert_int_equal(scenario_suites[i].rows(rows + found, 1), found); /* no further */
		for (int k = 0; k < found; k++) {
			assert_ptr_equal(row(rows[k].name), &rows[k]);
			assert_true(rows[k].drive.n >= 1 && rows[k].drive.end_s > 5);
			in_short += rows[k].in_short;
		}
		assert_true(in_short >= least_short[i] && in_short < found);
	}
}

/* FMVSS 127: every combination is there. */
static void the_regulation_is_complete(void **state)
{
	char name[64];

	(void)state;
	fmvss127(rows, SCENARIO_ROWS_MAX);
	for (int v = 10; v <= 100; v += 10) {
		snprintf(name, sizeof(name), "stopped-%d%s", v, v > 80 ? "-driver" : "");
		assert_true(fabs(row(name)->drive.target[0].gap_m / (v / 3.6) - 8) < 1e-9);
	}
	for (int m = 12; m <= 40; m += 4) {
		for (int g = 3; g <= 5; g++) {
			snprintf(name, sizeof(name), "brake-80-%dm-0.%dg-step-driver", m, g);
			assert_true(row(name)->drive.target[0].gap_m == m);
			assert_int_equal(row(name)->driver, DRIVER_WARNED);
			snprintf(name, sizeof(name), "brake-50-%dm-0.%dg-ramp", m, g);
			assert_int_equal(row(name)->driver, DRIVER_PATH);
		}
	}
}

/* The lead's braking: 0.05 g at the onset, all of it after 1.5 s, until it stands. */
static void a_ramp_is_a_ramp(void **state)
{
	const struct drive *d;
	struct drive_truth w;
	double at_s[3] = {0};

	(void)state;
	fmvss127(rows, SCENARIO_ROWS_MAX);
	d = &row("brake-80-12m-0.5g-ramp")->drive;
	w = drive_begin(d);
	while (w.target[0].speed_mps > 0) {
		drive_step(d, &w);
		at_s[0] = at_s[0] > 0 || w.target[0].accel_mps2 > -0.49 ? at_s[0] : w.t_s;
		at_s[1] = at_s[1] > 0 || w.target[0].accel_mps2 > -4.9049 ? at_s[1] : w.t_s;
	}
	assert_true(fabs(at_s[0] - 3) < 0.002 && fabs(at_s[1] - 4.5) < 0.003);
}

/* Latest moments after the onset at 80 and 50 km/h, computed elsewhere for this car without drag. */
static void the_limit_is_physical(void **state)
{
	static const struct {
		const char *name;
		double accel, latest_s;
	} at[] = {
		{"brake-50-12m-0.5g-step", -6, 0.98},   {"brake-50-12m-0.5g-ramp", -6, 1.62},
		{"brake-50-12m-0.5g-step", -8, 1.27},   {"brake-50-12m-0.5g-ramp", -9.5, 2.05},
		{"brake-80-12m-0.5g-step", -9.5, 1.40}, {"brake-80-12m-0.5g-ramp", -9.5, 2.04},
		{"brake-80-12m-0.3g-step", -9.5, 2.23}, {"brake-80-12m-0.3g-ramp", -8, 2.72},
		{"brake-80-20m-0.5g-step", -9.5, 1.84}, {"brake-80-20m-0.5g-ramp", -8, 2.28},
		{"brake-80-40m-0.5g-step", -9.5, 2.75}, {"brake-80-40m-0.5g-ramp", -9.5, 3.40},
	};
	struct config c;

	(void)state;
	config_defaults(&c);
	fmvss127(rows, SCENARIO_ROWS_MAX);
	for (size_t i = 0; i < sizeof(at) / sizeof(at[0]); i++) {
		c.brake_accel = at[i].accel;
		if (fabs(scenario_latest(&c, row(at[i].name)) - at[i].latest_s) > 0.02) {
			fail_msg("%s: %g", at[i].name, scenario_latest(&c, row(at[i].name)));
		}
	}
	scenario_calm(rows, SCENARIO_ROWS_MAX);
	assert_true(isinf(scenario_latest(&c, row("follow-80-12m"))));
	c.brake_accel = -0.5;
	fmvss127(rows, SCENARIO_ROWS_MAX);
	assert_true(isnan(scenario_latest(&c, row("stopped-80"))));
}

static void cars_are_drawn(void **state)
{
	struct scenario r = {.number = 3};
	double mass = 0, latency = 0;
	struct config c;

	(void)state;
	config_defaults(&c);
	const struct scenario_draw nominal = scenario_draw(&c, &r, 1, 0);

	assert_true(nominal.car.mass_kg == c.vehicle_mass && nominal.car.mu == 1.02);
	assert_true(nominal.sensors.dropout == 0 && nominal.speed_mps == 0);
	assert_true(nominal.sensors.latency_s == c.radar_latency && nominal.reaction_s == 1);
	for (int k = 1; k <= 1000; k++) {
		const struct scenario_draw d = scenario_draw(&c, &r, 1, k);

		assert_true(d.sensors.latency_s >= 0.05 && d.sensors.latency_s <= 0.1);
		assert_true(d.car.delay_s <= c.brake_delay && fabs(d.car.grade_rad) <= 0.01);
		assert_true(fabs(d.speed_mps) <= 1.6 / 3.6 && fabs(d.reaction_s - 1) <= 0.1);
		mass += d.car.mass_kg / 1000;
		latency += d.sensors.latency_s / 1000;
	}
	assert_true(fabs(mass - 1500) < 10 && fabs(latency - 0.075) < 0.0015);

	const struct scenario_draw a = scenario_draw(&c, &r, 1, 5);
	const struct scenario_draw again = scenario_draw(&c, &r, 1, 5);

	assert_memory_equal(&a, &again, sizeof(a));
	r.number = 4;
	assert_true(scenario_draw(&c, &r, 1, 5).car.mass_kg != a.car.mass_kg);
	assert_true(scenario_draw(&c, &r, 1, 5).sensors.seed != a.sensors.seed);
}

static void faults_break_the_sensors(void **state)
{
	struct config c;

	(void)state;
	config_defaults(&c);
	for (size_t i = 0; i < sizeof(faults) / sizeof(faults[0]); i++) {
		const struct scenario r = {.fault = &faults[i]}, whole = {0};
		const struct sensors_params a = scenario_draw(&c, &r, 1, 0).sensors;
		const struct sensors_params b = scenario_draw(&c, &whole, 1, 0).sensors;
		const int differ = (a.period_s != b.period_s) + (a.latency_s != b.latency_s) +
				   (a.dropout != b.dropout) + (a.rate_lag_s != b.rate_lag_s) +
				   (a.range_sigma_m != b.range_sigma_m);

		assert_int_equal(differ, 1);
	}
}

/* What the words say of the dropouts: 0.1 / (0.1 + 0.5). */
static void one_scan_in_six_is_missed(void **state)
{
	const struct drive one = {.n = 1};
	struct scenario r = {0};
	struct sensors s = {.drive = &one, .noise.seed = 1};
	struct config c;
	int missed = 0, in_row = 0;

	(void)state;
	config_defaults(&c);
	for (size_t i = 0; i < sizeof(faults) / sizeof(faults[0]); i++) {
		r.fault = strcmp(faults[i].name, "dropouts") ? r.fault : &faults[i];
	}
	s.p = scenario_draw(&c, &r, 1, 0).sensors;
	for (int i = 0; i < 60000; i++) {
		const int before = s.missed[0];

		missed += is_missed(&s, 0);
		in_row += before && s.missed[0];
	}
	assert_true(abs(missed - 10000) < 300 && abs(in_row - 5000) < 300);
	assert_non_null(strstr(r.fault->doc, "1 scan in 6"));
}

/* Figures over runs whose results are given. */
static void figures_are_counted(void **state)
{
	const struct scenario two[] = {{.name = "a", .onset_s = 3},
				       {.name = "b", .goal = GOAL_NO_REQUEST}};
	double latest_s[] = {2, NAN};
	const struct scenario_plan p = {
		.row = two, .rows = 2, .cars = 2, .first_car = 1, .latest_s = latest_s};
	const struct scenario_result r[] = {
		{.closest_m = 2,
		 .warn_s = 3.5,
		 .warn = 1,
		 .partial_s = NAN,
		 .full_s = 4.5,
		 .full = 1,
		 .peak_after_mps2 = 9,
		 .evaluations = 7},
		{.contact = 1,
		 .impact_mps = 3,
		 .warn_s = 5,
		 .warn = 1,
		 .partial_s = 4.75,
		 .full_s = 5,
		 .partial = 1,
		 .full = 1,
		 .evaluations = 1},
		{.closest_m = NAN, .warn_s = NAN, .partial_s = NAN, .full_s = NAN},
		{.closest_m = 5,
		 .warn_s = NAN,
		 .partial_s = NAN,
		 .full_s = 7,
		 .full = 1,
		 .peak_before_mps2 = 1,
		 .peak_after_mps2 = 4},
	};
	const struct scenario_row a = scenario_row_of(&p, 0, r), b = scenario_row_of(&p, 1, r + 2);
	const struct scenario_sum s = scenario_sum_of(&p, r);

	(void)state;
	assert_true(a.runs == 2 && a.contacts == 1 && a.requests == 2 && a.failed == 1);
	assert_true(a.impact_mps == 3 && a.closest_m == 0 && a.request_s == 1.5 &&
		    a.request99_s == 1.75);
	assert_true(isnan(a.spare_s) && a.warn_s == 0.5 && a.after_mps2 == 9);
	assert_true(b.failed == 1 && b.requests == 1 && b.closest_m == 5 && isnan(b.warn_s));
	assert_true(a.evaluated == 2 && b.evaluated == 0 && s.evaluated == 2);
	assert_true(s.runs == 4 && s.all.judged == 4 && s.all.failed == 2 && s.requests == 3);
	assert_true(s.in_evaluated.judged == 2 && s.in_evaluated.failed == 1);
	assert_true(s.unwarned == 2 && s.lead_s == 1 && s.lead_least_s == 1);
	assert_true(isnan(a.added_mps2) && b.added_mps2 == 3 && s.added_mps2 == 3 && s.calm == 2);
	assert_true(s.all.lo > 0.1 && s.all.hi < 0.9);
	assert_true(s.in_evaluated.lo < s.all.lo && s.in_evaluated.hi > s.all.hi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_have_names_of_their_own),
		cmocka_unit_test(the_regulation_is_complete),
		cmocka_unit_test(a_ramp_is_a_ramp),
		cmocka_unit_test(the_limit_is_physical),
		cmocka_unit_test(cars_are_drawn),
		cmocka_unit_test(faults_break_the_sensors),
		cmocka_unit_test(one_scan_in_six_is_missed),
		cmocka_unit_test(figures_are_counted),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
