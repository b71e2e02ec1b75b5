/* SPDX-License-Identifier: MIT
 * lanes: the same bits whatever the variant, the block a sample falls into, and its neighbours there; and the scalar
 * rollout gives them too.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>
#include "lanes.h"
#include "verify.h"

#define COUNT  700 /* more than five blocks, the last one incomplete */
#define GROUPS 12

/* Of GROUPS groups of scenes, on any machine. */
#define ALL_BITS 0x9fa1abe17142cf7cu

static float in[MODEL_INPUTS * COUNT];
static struct model_out want[COUNT], got[COUNT];

static void roll(const struct lanes *v, const struct verify_group *g, uint32_t first,
		 uint32_t count, struct model_out *out)
{
	struct lanes_work *w = lanes_work_open();
	const struct lanes_job job = {
		.z = g->in + first,
		.stride = g->count,
		.count = count,
		.n_futures = 1,
		.future = {rollout_plan(&g->vehicle, &g->future, g->horizon_s)},
		.flags = MC_WANT_IMPACT,
		.out = out,
		.out_stride = count};

	assert_non_null(w);
	v->run(w, &job);
	lanes_work_close(w);
}

static void each_variant(void (*check)(const struct lanes *v))
{
	int ran = 0;

	for (unsigned int i = 0; lanes_name(i); i++) {
		if (!lanes_pick(lanes_name(i))) {
			print_message("needs %s\n", lanes_name(i));
			continue;
		}
		check(lanes_pick(lanes_name(i)));
		ran++;
	}
	assert_true(ran > 0);
}

/* FNV-1a over the bits of all results. */
static uint64_t mix(uint64_t h, const struct model_out *out)
{
	for (uint32_t i = 0; i < COUNT; i++) {
		const uint32_t word[] = {det_bits(out[i].stop_m), det_bits(out[i].need_m),
					 det_bits(out[i].impact_mps), out[i].flags};

		for (int k = 0; k < 4; k++) {
			h = (h ^ word[k]) * 0x100000001b3u;
		}
	}
	return h;
}

static void check_scalar(const struct lanes *v)
{
	uint64_t h = 0xcbf29ce484222325u;

	for (uint64_t group = 0; group < GROUPS; group++) {
		struct verify_group g = {.count = COUNT, .in = in};
		struct rollout_plan p;

		verify_scenes(group % 4 ? VERIFY_MOVING : VERIFY_PAPER, 2, group, &g);
		p = rollout_plan(&g.vehicle, &g.future, g.horizon_s);
		for (uint32_t i = 0; i < COUNT; i++) {
			want[i] = rollout_sample(&p, in + i, COUNT);
		}
		roll(v, &g, 0, COUNT, got);
		assert_memory_equal(got, want, sizeof(want));
		h = mix(h, got);
	}
	assert_true(h == ALL_BITS);
}

static void test_scalar(void **arg)
{
	(void)arg;
	each_variant(check_scalar);
}

static void check_offsets(const struct lanes *v)
{
	static const uint32_t first[] = {0, 1, 63, 64, 65, 127, 128, 129, 500, 699};
	struct verify_group g = {.count = COUNT, .in = in};

	verify_scenes(VERIFY_MOVING, 9, 3, &g);
	roll(v, &g, 0, COUNT, want);
	for (size_t i = 0; i < sizeof(first) / sizeof(first[0]); i++) {
		for (uint32_t count = 1; first[i] + count <= COUNT; count = 3 * count + 1) {
			roll(v, &g, first[i], count, got);
			assert_memory_equal(got, want + first[i], count * sizeof(got[0]));
		}
	}
}

static void test_offsets(void **arg)
{
	(void)arg;
	each_variant(check_offsets);
}

/* Counts of one future as its samples have them. */
static void check_future(const struct stats_sums *sums, uint32_t f, const struct model_out *out)
{
	uint64_t hits = 0, open = 0, impact = 0;

	for (uint32_t i = 0; i < COUNT; i++) {
		hits += (out[i].flags & MODEL_CONTACT) != 0;
		open += (out[i].flags & MODEL_UNDECIDED) != 0;
		impact += (uint64_t)(out[i].impact_mps * 1024.0f + 0.5f);
	}
	assert_int_equal(sums->hits[f], hits);
	assert_int_equal(sums->undecided[f], open);
	assert_int_equal(sums->impact_units[f], impact);
	assert_true(hits > 100 && hits < COUNT);
}

/* Braking at once, and coasting; both in contact and not, the latter often open at the horizon. */
static void scene(struct mc_request *req, float z[MC_DIM * COUNT])
{
	for (size_t i = 0; i < MC_DIM * COUNT; i++) {
		z[i] = (float)(int32_t)(2654435761u * (uint32_t)(i + 1)) * 0x1p-30f;
	}
	mc_preset_paper(req, 300.0f, COUNT);
	req->n_futures = 2;
	req->future[1].accel_cmd_mps2 = 0.0f;
	req->factor[0] = 200.0f; /* headway */
	req->mean[MODEL_LEAD_SPEED] = 4.0f;
	req->factor[9] = 3.0f;
}

/* The statistics are what the samples say. */
static void check_counts(const struct lanes *v)
{
	static float z[MC_DIM * COUNT];
	static struct lanes_hist hist;
	static struct model_out out[2 * COUNT];
	struct lanes_work *w = lanes_work_open();
	struct stats_sums sums = {0};
	struct sample_plan plan;
	struct mc_request req;
	struct lanes_job job;
	uint64_t stops = 0, needs = 0;

	assert_non_null(w);
	scene(&req, z);
	sample_plan(&req, &plan);
	memset(&hist, 0, sizeof(hist));
	job = (struct lanes_job){.sample = &plan,
				 .z = z,
				 .stride = COUNT,
				 .count = COUNT,
				 .n_futures = 2,
				 .future = {rollout_plan(&req.vehicle, &req.future[0], 10.0f),
					    rollout_plan(&req.vehicle, &req.future[1], 10.0f)},
				 .flags = MC_WANT_HIST | MC_WANT_IMPACT,
				 .centre = stats_centre(&req),
				 .mean_headway_m = 300.0f,
				 .sums = &sums,
				 .hist = &hist};
	v->run(w, &job);
	job.sums = NULL;
	job.hist = NULL;
	job.out = out;
	job.out_stride = COUNT;
	v->run(w, &job);
	assert_int_equal(sums.n, COUNT);
	check_future(&sums, 0, out);
	check_future(&sums, 1, out + COUNT);
	assert_true(sums.undecided[1] > 50);
	for (int i = 0; i < MC_HIST_BINS; i++) {
		stops += hist.stop[i];
		needs += hist.need[i];
	}
	assert_int_equal(stops, COUNT);
	assert_int_equal(needs, COUNT);
	lanes_work_close(w);
}

static void test_counts(void **arg)
{
	(void)arg;
	each_variant(check_counts);
}

static void test_pick(void **arg)
{
	(void)arg;
	assert_null(lanes_pick("sse9"));
	assert_null(lanes_pick(""));
	assert_non_null(lanes_pick(NULL));
	assert_null(lanes_name(16));
	lanes_work_close(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_scalar),
		cmocka_unit_test(test_offsets),
		cmocka_unit_test(test_counts),
		cmocka_unit_test(test_pick),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
