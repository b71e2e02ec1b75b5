/* SPDX-License-Identifier: MIT
 * Frames that make a scan: of slots, of slots after a header, of a list of objects with and without a second message.
 * `test_scan --driver CONF LOG` is the other end of tests/vehicles_cantools.py: what the daemon reads in a log, scan by
 * scan.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "clock.h"
#include "config.h"
#include "scan.h"

#define MS CLOCK_NS_PER_MS

/* ---- driver -------------------------------------------------------------------------------------- */

static void print_scan(struct scan *s)
{
	scan_end(s);
	printf("scan %lld %d\n", (long long)s->first_ns, s->n);
	for (int i = 0; i < s->n; i++) {
		const struct detection *d = &s->det[i];

		printf("target %u %.9g %.9g %.9g %.9g %.9g %.9g\n", d->id, d->distance_m,
		       d->rate_mps, d->lateral_m, d->existence, d->distance_sigma_m,
		       d->rate_sigma_mps);
	}
}

static void print_frame(struct decode *d, struct scan *s, const struct bus_frame *f)
{
	struct decode_frame out;

	if (s->open && f->t_ns >= s->last_ns + s->map->scan_gap_ns) {
		print_scan(s);
	}
	if (!decode_take(d, f, &out)) {
		return;
	}
	if (out.roles >> MAP_EGO_SPEED & 1) {
		printf("ego %lld %.9g\n", (long long)f->t_ns, out.value[MAP_EGO_SPEED]);
	}
	if (out.part == MAP_NO_PART) {
		return;
	}
	if (scan_breaks(s, &out)) {
		print_scan(s);
	}
	if (scan_add(s, &out, f->t_ns)) {
		print_scan(s);
	}
}

static int driver(const char *conf, const char *path)
{
	const char *iface[BUS_IFACES_MAX];
	struct bus_frame f[16];
	struct mapping *map;
	struct config cfg;
	struct decode d;
	struct scan s;
	struct bus *log;
	int64_t now_ns;
	char err[512];
	int n;

	if (config_load(conf, NULL, 0, &cfg, &map, err, sizeof(err))) {
		return fprintf(stderr, "%s\n", err) > 0;
	}
	for (int i = 0; i < map->n_ifaces; i++) {
		iface[i] = map->iface[i];
	}
	if (bus_log_open(path, NULL, iface, map->n_ifaces, &log, err, sizeof(err))) {
		return fprintf(stderr, "%s\n", err) > 0;
	}
	decode_open(&d, map, cfg.radar_range_max, cfg.radar_existence_min);
	scan_open(&s, map, cfg.radar_existence_min);
	while ((n = log->ops->recv(log, f, 16, CLOCK_NEVER, &now_ns)) > 0) {
		for (int i = 0; i < n; i++) {
			print_frame(&d, &s, &f[i]);
		}
	}
	log->ops->close(log);
	config_mapping_free(map);
	return 0;
}

/* ---- what is tested ------------------------------------------------------------------------------ */

static const struct dbc_signal sig = {.name = "S", .len = 8};

/* Slots 0..@slots-1, or a list where @slots is 0. */
static struct mapping make_map(int slots, int header, int counts, int quality)
{
	struct mapping m = {.n_tracks = slots ? slots : 1};

	m.list.header = header ? 60 : -1;
	m.list.count.sig = counts ? &sig : NULL;
	m.list.id.sig = slots ? NULL : &sig;
	m.list.quality = quality ? 0 : -1;
	return m;
}

static struct decode_frame header(int count)
{
	return (struct decode_frame){.part = MAP_HEADER, .track = -1, .count = count};
}

static struct decode_frame slot(int track, int target)
{
	return (struct decode_frame){.part = MAP_TARGET,
				     .track = track,
				     .target = target,
				     .det = {.distance_m = 10 + track, .existence = 1}};
}

static struct decode_frame object(uint32_t id, double distance_m)
{
	return (struct decode_frame){
		.part = MAP_TARGET,
		.target = 1,
		.det = {.id = id, .distance_m = distance_m, .existence = 1},
	};
}

static struct decode_frame quality(uint32_t id, double existence)
{
	return (struct decode_frame){
		.part = MAP_QUALITY,
		.track = -1,
		.det = {.id = id,
			.existence = existence,
			.distance_sigma_m = 0.5,
			.rate_sigma_mps = 0.25},
	};
}

/* What becomes of one frame: 1 if it is of the next scan, 2 if it is the last of its own, 3 both. Ended ones are closed. */
static int give(struct scan *s, struct decode_frame d, int ms)
{
	const int breaks = scan_breaks(s, &d);

	if (breaks) {
		scan_end(s);
	}
	const int last = scan_add(s, &d, ms * MS);

	if (last) {
		scan_end(s);
	}
	return breaks + 2 * last;
}

static void all_slots_make_a_scan(void **state)
{
	const struct mapping m = make_map(3, 0, 0, 0);
	struct scan s;

	(void)state;
	scan_open(&s, &m, 0.5);
	assert_int_equal(s.open, 0);
	assert_int_equal(give(&s, slot(2, 1), 1), 0);
	assert_int_equal(s.open, 1);
	assert_int_equal(give(&s, slot(0, 0), 2), 0);
	assert_int_equal(give(&s, slot(1, 1), 3), 2);
	assert_int_equal(s.open, 0);
	assert_true(s.n == 2 && s.first_ns == 1 * MS && s.last_ns == 3 * MS);
	assert_true(s.det[0].distance_m == 12 && s.det[1].distance_m == 11);
	/* one is lost: the next scan's first frame ends it */
	assert_int_equal(give(&s, slot(0, 1), 11), 0);
	assert_int_equal(give(&s, slot(1, 1), 12), 0);
	assert_int_equal(give(&s, slot(1, 1), 21), 1);
	assert_true(s.n == 1 && s.first_ns == 21 * MS);
	assert_int_equal(s.incomplete,
			 0); /* nothing was announced: each slot is judged by itself */
}

static void sixty_four_slots_fit(void **state)
{
	const struct mapping m = make_map(64, 0, 0, 0);
	struct scan s;

	(void)state;
	scan_open(&s, &m, 0.5);
	for (int i = 0; i < 64; i++) {
		assert_int_equal(give(&s, slot(i, 1), i), i == 63 ? 2 : 0);
	}
	assert_int_equal(s.n, 64);
}

static void a_header_says_how_many_slots_follow(void **state)
{
	const struct mapping m = make_map(8, 1, 1, 0);
	struct scan s;

	(void)state;
	scan_open(&s, &m, 0.5);
	assert_int_equal(give(&s, header(2), 0), 0);
	assert_int_equal(give(&s, slot(5, 1), 1), 0);
	assert_int_equal(give(&s, slot(7, 1), 2), 2);
	assert_int_equal(s.n, 2);
	assert_int_equal(give(&s, header(0), 10), 2); /* an empty road */
	assert_int_equal(s.n, 0);
	assert_int_equal(s.incomplete, 0);
}

static void objects_and_their_quality_make_a_scan(void **state)
{
	const struct mapping m = make_map(0, 1, 1, 1);
	struct scan s;

	(void)state;
	scan_open(&s, &m, 0.5);
	assert_int_equal(give(&s, header(3), 0), 0);
	assert_int_equal(give(&s, object(9, 40), 1), 0);
	assert_int_equal(give(&s, object(4, 20), 2), 0);
	assert_int_equal(give(&s, object(2, 30), 3), 0);
	assert_int_equal(give(&s, quality(4, 0.5), 4), 0);
	assert_int_equal(give(&s, quality(9, 0.49), 5), 0);
	assert_int_equal(give(&s, quality(77, 0.9), 6), 2); /* of no object of this scan */
	assert_int_equal(s.n, 2);
	assert_true(s.det[0].id == 4 && s.det[0].distance_sigma_m == 0.5 &&
		    s.det[0].rate_sigma_mps == 0.25 && s.det[0].existence == 0.5);
	/* without its quality an object is what it was */
	assert_true(s.det[1].id == 2 && s.det[1].distance_sigma_m == 0 && s.det[1].existence == 1);
}

static void what_was_announced_and_is_missing_is_counted(void **state)
{
	const struct mapping m = make_map(0, 1, 1, 1);
	struct scan s;

	(void)state;
	scan_open(&s, &m, 0.5);
	for (uint32_t i = 1; i <= 4; i++) {
		assert_int_equal(give(&s, header(2), 0), i == 1 ? 0 : 1);
		assert_int_equal(s.incomplete, i - 1);
		give(&s, object(1, 40), 1);
		give(&s, object(2, 50), 2);
		give(&s, quality(1, 1), 3);
	}
	assert_int_equal(give(&s, quality(2, 1), 4), 2);
	assert_int_equal(s.incomplete, 0);
	/* a lost header: what follows is a scan, but nobody knows whether it is whole */
	assert_int_equal(give(&s, object(1, 40), 10), 0);
	assert_int_equal(give(&s, object(2, 41), 11), 0);
	assert_int_equal(give(&s, object(1, 39), 20), 1);
	assert_int_equal(s.incomplete, 1);
	assert_int_equal(s.n, 1);
}

static void a_count_is_of_its_own_scan(void **state)
{
	const struct mapping m = make_map(0, 1, 1, 0);
	struct scan s;

	(void)state;
	scan_open(&s, &m, 0.5);
	assert_int_equal(give(&s, header(1), 0), 0);
	assert_int_equal(give(&s, object(1, 40), 1), 2);
	assert_int_equal(give(&s, object(1, 40), 50), 0); /* its header was lost */
	assert_int_equal(s.open, 1);
	/* nor does a number of the scan before mean anything */
	assert_int_equal(give(&s, header(2), 100), 1);
	assert_int_equal(give(&s, object(7, 40), 101), 0);
	assert_int_equal(give(&s, object(1, 41), 102), 2);
	assert_int_equal(s.n, 2);
}

static void without_a_count_the_next_header_ends_a_scan(void **state)
{
	const struct mapping m = make_map(0, 1, 0, 0);
	struct scan s;

	(void)state;
	scan_open(&s, &m, 0.5);
	assert_int_equal(give(&s, header(-1), 0), 0);
	assert_int_equal(give(&s, object(1, 40), 1), 0);
	assert_int_equal(give(&s, header(-1), 50), 1);
	assert_int_equal(s.open, 1);
	assert_int_equal(give(&s, header(-1), 100), 1);
	assert_int_equal(s.incomplete, 0);
	scan_forget(&s);
	assert_int_equal(s.open, 0);
	assert_int_equal(give(&s, header(-1), 150), 0);
}

static void of_too_many_objects_the_nearest_are_kept(void **state)
{
	const struct mapping m = make_map(0, 1, 1, 0);
	struct scan s;
	int near = 0;

	(void)state;
	scan_open(&s, &m, 0.5);
	give(&s, header(100), 0);
	for (uint32_t i = 0; i < 100; i++) {
		/* 1 to 100 m, in no order */
		assert_int_equal(give(&s, object(i, 1 + (int)(i * 37 % 100)), 1), i == 99 ? 2 : 0);
	}
	assert_int_equal(s.n, MAP_TRACKS_MAX);
	for (int i = 0; i < s.n; i++) {
		near += s.det[i].distance_m <= MAP_TRACKS_MAX;
	}
	assert_int_equal(near, MAP_TRACKS_MAX);
}

/* Fills a scan with objects 0..63 at @distance_m(i) and gives one more, number 64. Returns which number is gone. */
static int displaced(double (*distance_m)(int i), double last_m)
{
	const struct mapping m = make_map(0, 1, 1, 0);
	uint64_t there = 0;
	int gone = 0;
	struct scan s;

	scan_open(&s, &m, 0.5);
	give(&s, header(65), 0);
	for (int i = 0; i < MAP_TRACKS_MAX; i++) {
		give(&s, object((uint32_t)i, distance_m(i)), 1);
	}
	give(&s, object(MAP_TRACKS_MAX, last_m), 1);
	assert_int_equal(s.n, MAP_TRACKS_MAX);
	for (int i = 0; i < s.n; i++) {
		there |= s.det[i].id < MAP_TRACKS_MAX ? 1ull << s.det[i].id : 0;
	}
	while (gone < MAP_TRACKS_MAX && (there >> gone & 1)) {
		gone++;
	}
	return gone;
}

static double first_is_farthest(int i)
{
	return i == 0 ? 100 : 50;
}

static double second_is_farthest(int i)
{
	return i == 1 ? 100 : 50;
}

static double two_are_farthest(int i)
{
	return i == 5 || i == 9 ? 100 : 50;
}

static void the_farthest_makes_room(void **state)
{
	(void)state;
	assert_int_equal(displaced(first_is_farthest, 99), 0);
	assert_int_equal(displaced(second_is_farthest, 99), 1);
	assert_int_equal(displaced(two_are_farthest, 99), 5);
	assert_int_equal(displaced(two_are_farthest, 100), MAP_TRACKS_MAX); /* none */
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_slots_make_a_scan),
		cmocka_unit_test(sixty_four_slots_fit),
		cmocka_unit_test(a_header_says_how_many_slots_follow),
		cmocka_unit_test(objects_and_their_quality_make_a_scan),
		cmocka_unit_test(what_was_announced_and_is_missing_is_counted),
		cmocka_unit_test(without_a_count_the_next_header_ends_a_scan),
		cmocka_unit_test(a_count_is_of_its_own_scan),
		cmocka_unit_test(of_too_many_objects_the_nearest_are_kept),
		cmocka_unit_test(the_farthest_makes_room),
	};

	if (argc == 4 && !strcmp(argv[1], "--driver")) {
		return driver(argv[2], argv[3]);
	}
	return cmocka_run_group_tests_name("scan", tests, NULL, NULL);
}
