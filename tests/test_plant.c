/* SPDX-License-Identifier: MIT
 * The ego of closed loops: what its brake controller acts on, and how it moves.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "../tools/drive.c"
#include "../tools/plant.c"
#include "publish.h"

#define MS CLOCK_NS_PER_MS

struct world {
	struct config cfg;
	struct plant plant;
	struct publish *pub;
	struct publish_in in;
	struct drive_car ego;
	int64_t now_ns;
};

static int begin(void **state)
{
	static struct world w;

	memset(&w, 0, sizeof(w));
	config_defaults(&w.cfg);
	w.cfg.brake_accel = -9.5;
	w.ego.speed_mps = 30;

	const struct plant_vehicle v = plant_nominal(&w.cfg, 1.02);

	plant_open(&w.plant, &w.cfg, &v);
	w.in = (struct publish_in){
		.state = STATE_BRAKE, .have_scan = 1, .dec = {LEVEL_FULL, CAUSE_RISK, -9.5, 0}};
	*state = &w;
	return publish_open(&w.cfg, &w.pub);
}

static int end(void **state)
{
	publish_close(((struct world *)*state)->pub);
	return 0;
}

static struct bus_frame frame(struct world *w, enum publish_msg which)
{
	struct bus_frame f;

	w->in.scan_ns = w->now_ns;
	publish_pack(w->pub, which, &w->in, w->now_ns, &f);
	return f;
}

static void drive(struct world *w, int ms, double driver_mps2)
{
	for (int i = 0; i < ms; i++) {
		w->now_ns += MS;
		plant_step(&w->plant, w->now_ns, driver_mps2, &w->ego);
	}
}

/* Frames each 20 ms. */
static void ask(struct world *w, int n)
{
	for (int i = 0; i < n; i++) {
		const struct bus_frame f = frame(w, PUBLISH_REQUEST);

		plant_receive(&w->plant, &f, w->now_ns);
		drive(w, 20, 0);
	}
}

static void acts_on_the_third_good_frame(void **state)
{
	struct world *w = *state;

	ask(w, 2);
	assert_true(w->plant.asked_mps2 == 0);
	ask(w, 1);
	assert_true(w->plant.asked_mps2 == -9.5);
	assert_int_equal(w->plant.stage, AEB_REQUEST_STAGE_FULL);
}

static void ignores_what_it_must(void **state)
{
	struct world *w = *state;
	struct bus_frame f;

	ask(w, 5);
	f = frame(w, PUBLISH_RISK);
	plant_receive(&w->plant, &f, w->now_ns);
	assert_true(w->plant.asked_mps2 == -9.5);
	w->in.dec = (struct decision){LEVEL_NONE, CAUSE_NONE, 0, 0};
	f = frame(w, PUBLISH_REQUEST);
	f.data[5] ^= 1; /* a wrong bit: neither believed nor obeyed */
	plant_receive(&w->plant, &f, w->now_ns);
	assert_true(w->plant.asked_mps2 == -9.5);
	f.len = 7;
	plant_receive(&w->plant, &f, w->now_ns);
	assert_true(w->plant.asked_mps2 == -9.5);
	ask(w, 1);
	assert_true(w->plant.asked_mps2 == 0);
}

static void no_time_to_live_is_no_request(void **state)
{
	struct world *w = *state;

	ask(w, 5);
	w->in.have_scan = 0;
	ask(w, 1);
	assert_true(w->plant.asked_mps2 == 0);
}

static void silence_ends_a_request(void **state)
{
	struct world *w = *state;

	ask(w, 5);
	drive(w, 40, 0);
	assert_true(w->plant.asked_mps2 == -9.5);
	drive(w, 1, 0);
	assert_true(w->plant.asked_mps2 == 0);
	assert_int_equal(w->plant.stage, AEB_REQUEST_STAGE_NONE);
	ask(w, 2);
	assert_true(w->plant.asked_mps2 == 0); /* as at the start */
	ask(w, 1);
	assert_true(w->plant.asked_mps2 == -9.5);
}

/* Against the reference rollout of the same car: the distance to standstill. */
static void stops_where_the_model_does(void **state)
{
	struct world *w = *state;
	const struct model_vehicle veh = {1.225f, 2.2f, 9.81f, 0.5f, 2.7f, MODEL_BOUND_FRICTION};
	const struct model_future full = {-9.5f, 0};
	const float in[MODEL_INPUTS] = {1000, 30, 0, 0, 0, 1.02f, 0, 1500, 0.3f, 0.15f, 0.05f};
	const struct model_out out = model_rollout(&veh, &full, 10, 1e-3, in, 1);
	double at_m = 0;

	plant_ask(&w->plant, -9.5);
	while (w->ego.speed_mps > 0) {
		const double before = w->ego.speed_mps;

		drive(w, 1, 0);
		at_m += (before + w->ego.speed_mps) / 2 * DRIVE_STEP_S;
	}
	assert_true(fabs(at_m - (double)out.stop_m) < 0.05);
}

static void friction_bounds_it(void **state)
{
	struct world *w = *state;

	w->cfg.vehicle_bound = MODEL_BOUND_PAPER; /* what the daemon believes does not matter */
	plant_ask(&w->plant, -15);
	drive(w, 1500, 0);
	assert_true(fabs(w->ego.accel_mps2 + 1.02 * 9.81 +
			 0.5 * 1.225 * 2.2 * 0.3 / 1500 * w->ego.speed_mps * w->ego.speed_mps) <
		    1e-3);
}

/* Without a request the driver gets the net acceleration that he seeks, downhill too. */
static void follows_the_driver(void **state)
{
	static const double seeks[] = {0, 1, -0.5, -1, -4};

	for (size_t i = 0; i < sizeof(seeks) / sizeof(seeks[0]); i++) {
		struct world *w = *state;
		struct plant_vehicle v = plant_nominal(&w->cfg, 1.02);

		v.grade_rad = -0.06;
		plant_open(&w->plant, &w->cfg, &v);
		w->ego = (struct drive_car){.speed_mps = 20};
		drive(w, 2000, seeks[i]);
		assert_true(fabs(w->ego.accel_mps2 - seeks[i]) < 0.01);
	}
}

static void gain_and_delay_are_the_cars(void **state)
{
	struct world *w = *state;
	struct plant_vehicle v = plant_nominal(&w->cfg, 1.02);

	v.gain = 0.8;
	v.delay_s = 0.1;
	plant_open(&w->plant, &w->cfg, &v);
	plant_ask(&w->plant, -5);
	drive(w, 100, 0);
	assert_true(w->plant.brake_mps2 == 0);
	drive(w, 1, 0);
	assert_true(w->plant.brake_mps2 < 0);
	drive(w, 2000, 0);
	assert_true(fabs(w->plant.brake_mps2 + 4) < 1e-3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(acts_on_the_third_good_frame, begin, end),
		cmocka_unit_test_setup_teardown(ignores_what_it_must, begin, end),
		cmocka_unit_test_setup_teardown(no_time_to_live_is_no_request, begin, end),
		cmocka_unit_test_setup_teardown(silence_ends_a_request, begin, end),
		cmocka_unit_test_setup_teardown(stops_where_the_model_does, begin, end),
		cmocka_unit_test_setup_teardown(friction_bounds_it, begin, end),
		cmocka_unit_test_setup_teardown(follows_the_driver, begin, end),
		cmocka_unit_test_setup_teardown(gain_and_delay_are_the_cars, begin, end),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
