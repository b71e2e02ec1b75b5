/* SPDX-License-Identifier: MIT
 * A closed loop against somebody else's requests, on a bus whose time passes at once.
 */
#include "drives.h"

#include <errno.h>

#include "../tools/cli.c"
#include "../tools/plant.c"
#include "../tools/progress.c"
#include "../tools/scenario_draw.c"
#include "../tools/scenario_latest.c"
#include "../tools/scenario_live.c"
#undef FRAMES
#include "../tools/scenario_loop.c"
#include "publish.h"

#define MS CLOCK_NS_PER_MS

/* The other side: requests every 20 ms; full braking from @full_ms on. */
static struct other {
	struct bus bus;
	struct config cfg;
	struct mapping *map;
	struct publish *pub;
	struct scenario row;
	double latest_s;
	int64_t ms, full_ms;
	uint64_t sent[MAP_MESSAGES_MAX];
	int error;
} o;

static int other_recv(struct bus *b, struct bus_frame *f, int max, int64_t until_ns,
		      int64_t *now_ns)
{
	const int due = o.ms++ % 20 == 0;
	struct publish_in in = {.state = STATE_ARMED, .have_scan = 1, .scan_ns = until_ns};

	assert_ptr_equal(b, &o.bus);
	assert_true(max >= 1);
	*now_ns = until_ns;
	if (o.error) {
		return o.error;
	}
	if (o.ms >= o.full_ms) {
		in.state = STATE_BRAKE;
		in.dec = (struct decision){LEVEL_FULL, CAUSE_RISK, -9.5, 0};
	}
	if (due) {
		publish_pack(o.pub, PUBLISH_REQUEST, &in, until_ns, f);
	}
	return due;
}

static int other_send(struct bus *b, const struct bus_frame *f)
{
	const int m = mapping_find(o.map, f->iface, f->id);

	(void)b;
	assert_true(m >= 0);
	o.sent[m]++;
	return -ENOBUFS; /* counts for nothing */
}

static const struct bus_ops other_ops = {.name = "other", .recv = other_recv, .send = other_send};

static int open_other(void **state)
{
	memset(&o, 0, sizeof(o));
	o.bus.ops = &other_ops;
	o.map = drives_load("generic-objects", &o.cfg);
	o.row = (struct scenario){
		.name = "stopped",
		.drive = {.end_s = 12, .ego = {20}, .n = 1, .target = {{.gap_m = 100}}},
	};
	*state = &o;
	return publish_open(&o.cfg, &o.pub);
}

static int close_other(void **state)
{
	(void)state;
	publish_close(o.pub);
	mapping_free(o.map);
	return 0;
}

static struct scenario_plan plan(void)
{
	return (struct scenario_plan){.name = "test",
				      .row = &o.row,
				      .rows = 1,
				      .cars = 1,
				      .cfg = &o.cfg,
				      .told = &o.cfg,
				      .map = o.map,
				      .latest_s = &o.latest_s};
}

static struct progress silent;

static void brakes_in_time(void **state)
{
	const struct scenario_plan p = plan();
	struct scenario_result r;

	(void)state;
	o.full_ms = 3500;
	assert_int_equal(scenario_live_run(&o.bus, &p, 0, 0, &silent, &r), 0);
	assert_int_equal(r.contact, 0);
	assert_true(fabs(r.full_s - 3.5) < 0.021 && r.full == 1 && r.peak_after_mps2 > 9);
	assert_true(r.closest_m > 1 && r.closest_m < 15);
	for (int i = 0; i < o.map->n_messages; i++) {
		assert_true(o.sent[i] > 50);
	}
}

static void nobody_brakes(void **state)
{
	const struct scenario_plan p = plan();
	struct scenario_result r;

	(void)state;
	o.full_ms = INT64_MAX;
	assert_int_equal(scenario_live_run(&o.bus, &p, 0, 0, &silent, &r), 0);
	assert_true(r.contact && fabs(r.impact_mps - 20) < 0.1 && isnan(r.full_s));
}

/* A line that is on, as it is after two seconds at a terminal: it names the run. */
static void a_person_sees_how_far_it_is(void **state)
{
	struct progress line = {.what = "# test", .on = 1};
	struct scenario_plan p = plan();
	struct scenario_result r;
	char text[256] = "";
	int pipe_fd[2];

	(void)state;
	p.cars = 4;
	assert_int_equal(pipe(pipe_fd), 0);
	const int was = dup(STDERR_FILENO);

	dup2(pipe_fd[1], STDERR_FILENO);
	const int ret = scenario_live_run(&o.bus, &p, 0, 2, &line, &r);

	dup2(was, STDERR_FILENO);
	assert_int_equal(ret, 0);
	assert_true(line.shown && read(pipe_fd[0], text, sizeof(text) - 1) > 0);
	assert_non_null(strstr(text, "50 %"));
	assert_non_null(strstr(text, "2 of 4 runs, stopped"));
	close(was);
	close(pipe_fd[0]);
	close(pipe_fd[1]);
}

static void errors_of_the_bus_end_it(void **state)
{
	const struct scenario_plan p = plan();
	struct scenario_result r;

	(void)state;
	o.error = -EIO;
	assert_int_equal(scenario_live_run(&o.bus, &p, 0, 0, &silent, &r), -EIO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(brakes_in_time, open_other, close_other),
		cmocka_unit_test_setup_teardown(nobody_brakes, open_other, close_other),
		cmocka_unit_test_setup_teardown(a_person_sees_how_far_it_is, open_other,
						close_other),
		cmocka_unit_test_setup_teardown(errors_of_the_bus_end_it, open_other, close_other),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
