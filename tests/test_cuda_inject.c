/* SPDX-License-Identifier: MIT
 * mc_cuda: every call of the CUDA runtime fails once; answers come late, never, or with wrong bits.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "cuda_backend.h"

/* ---- every call fails ------------------------------------------------------------------------------- */

static const struct {
	cudaError_t cuda;
	int err;
} errors[] = {
	{cudaErrorInsufficientDriver, -ENOSYS},
	{cudaErrorNoDevice, -ENODEV},
	{cudaErrorNoKernelImageForDevice, -ENOEXEC},
	{cudaErrorMemoryAllocation, -ENOMEM},
	{cudaErrorLaunchFailure, -EIO},
	{cudaErrorIllegalAddress, -EFAULT},
	{cudaErrorLaunchTimeout, -ETIMEDOUT},
	{cudaErrorECCUncorrectable, -EBADMSG},
};
#define ERRORS (sizeof(errors) / sizeof(errors[0]))

/* One life of a backend that visits every row; the first error of any step. */
static int live(void)
{
	static struct model_out out[MC_FUTURES_MAX * 64];
	static const float in[MODEL_INPUTS * 2];
	const struct mc_params p = params();
	const struct mc_request req = scene_moving(64);
	struct mc_backend *b;
	struct mc_result res;
	struct mc_cuda_time t;
	int err = mc_cuda_ops.open(&p, &b);

	if (err) {
		return err;
	}
	b->spins = SPINS;
	fake.late = 3;
	err = mc_cuda_ops.run(b, &req, NULL, &res);
	fake.late = 0;
	fake_flush();
	err = err ? err : mc_cuda_ops.samples(b, &req, MC_FAST, 0, 64, out);
	err = err ? err
		  : mc_cuda_ops.roll(b, MC_REFERENCE, &req.vehicle, &req.future[0], 10.0f, in, 2,
				     out);
	for (int rung = 0; rung < MC_CUDA_RUNGS && !err; rung++) {
		err = mc_cuda_time(b, (enum mc_cuda_rung)rung, &req, 1e-3, 1, &t);
	}
	mc_cuda_ops.close(b);
	return err;
}

static void test_every_call_is_made_to_fail(void **state)
{
	(void)state;
	memset(inject.reached, 0, sizeof(inject.reached));
	assert_int_equal(live(), 0);
	for (int site = 0; site < CUDA_SITES; site++) {
		const char *phase = inject_table[site].phase;

		if (!inject.reached[site]) {
			fail_msg("%s was not reached", inject_table[site].name);
		}
		for (size_t e = 0; e < ERRORS; e++) {
			inject.site = site;
			inject.after = 0;
			inject.error = errors[e].cuda;
			const int err = live();

			/* closing goes on whatever happens */
			assert_int_equal(err, strcmp(phase, "CLOSE") ? errors[e].err : 0);
			assert_int_equal(inject.site, -1);
			assert_int_equal(inject.failed[site], e + 1);
			assert_int_equal(fake.live, 0);
		}
	}
}

static void test_no_device(void **state)
{
	const struct mc_params p = params();
	struct mc_backend *b = (struct mc_backend *)&p;

	(void)state;
	fake.device_count = 0;
	assert_int_equal(mc_cuda_ops.open(&p, &b), -ENODEV);
	assert_ptr_equal(b, &p);
	assert_int_equal(fake.live, 0);
	mc_cuda_ops.close(NULL);
}

static void test_errors_are_sticky(void **state)
{
	const struct mc_request req = scene_lead(64);
	struct mc_backend *b = opened();
	struct mc_result res;
	struct model_out out;

	(void)state;
	inject.site = CUDA_SITE_LAUNCH;
	inject.after = 0;
	inject.error = cudaErrorIllegalAddress;
	assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &res), -EFAULT);
	assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &res), -EFAULT);
	assert_int_equal(mc_cuda_ops.samples(b, &req, MC_FAST, 0, 1, &out), -EFAULT);
	closed(b);
}

/* ---- late, never, wrong ------------------------------------------------------------------------------- */

static void test_late_answer_is_waited_for(void **state)
{
	const struct mc_request req = scene_lead(64);
	struct mc_backend *b = opened();
	struct mc_result early, late;

	(void)state;
	assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &early), 0);
	fake.late = 1000;
	assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &late), 0);
	assert_memory_equal(&early, &late, sizeof(early));
	closed(b);
}

/* The first request is given up; its answer arrives during the second, which must not take it for its own. */
static void test_answer_of_another_request_is_discarded(void **state)
{
	const struct mc_request first = scene_lead(64), second = scene_lead(65);
	struct mc_backend *b = opened();
	struct mc_result res;

	(void)state;
	b->sleeps = 100;
	fake.late = 150;
	assert_int_equal(mc_cuda_ops.run(b, &first, NULL, &res), -ETIMEDOUT);
	assert_int_equal(mc_cuda_ops.run(b, &second, NULL, &res), -ETIMEDOUT);
	fake.late = 0;
	fake_flush();
	assert_int_equal(mc_cuda_ops.run(b, &second, NULL, &res), 0);
	assert_int_equal(res.n, 65);
	closed(b);
}

static void test_never(void **state)
{
	const struct mc_request req = scene_lead(64);
	struct mc_backend *b = opened();
	struct mc_result res;

	(void)state;
	fake.late = -1;
	assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &res), -ETIMEDOUT);
	assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &res), -ETIMEDOUT);
	const int kept = fake.live;

	mc_cuda_ops.close(b); /* keeps what the device may still write to, and does not wait */
	assert_int_equal(fake.live, kept);
	fake.queued = 0;
	fake.late = 0;
	b->pending = 0;
	closed(b);
}

static void test_end_without_an_answer(void **state)
{
	const struct mc_request req = scene_lead(64);
	struct mc_backend *b = opened();
	struct mc_result res;

	(void)state;
	fake.late = -1;
	fake.queued = 0;
	inject.site = CUDA_SITE_QUERY;
	inject.after = 0;
	inject.error = cudaSuccess;
	assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &res), -EBADMSG);
	fake.queued = 0;
	closed(b);
}

/* Where a bit may be wrong. */
enum target {
	DRAWS, /* resident, before the batch */
	JOB,
	SUM,
	CHECK,
	CANARY,
	HASH,
	DIGEST,
	SLICE,
	STOP,
	NEED,
	LAST_BIN,
	TARGETS
};
static enum target spoilt;

static void flip(void *p, size_t byte)
{
	((unsigned char *)p)[byte] ^= 0x10;
}

static void spoil_before(struct cuda_args *a)
{
	const uint32_t word = a->work->job.slice * CUDA_SLICE_WORDS;

	if (spoilt == DRAWS) {
		flip((void *)a->resident, word * 4 + 12);
	} else if (spoilt == JOB) {
		flip(&a->work->job.sample.mean[MODEL_EGO_SPEED], 2);
	}
}

static void spoil_after(struct cuda_args *a)
{
	struct cuda_out *o = a->out;
	void *const target[TARGETS] = {[SUM] = &o->sum[0][CUDA_HITS],
				       [CHECK] = &o->check,
				       [CANARY] = &o->canary[7].need_m,
				       [HASH] = &o->hash,
				       [DIGEST] = &o->digest,
				       [SLICE] = &o->slice_sum,
				       [STOP] = &o->stop[400],
				       [NEED] = &o->need[1500],
				       [LAST_BIN] = &o->hi};

	if (target[spoilt]) {
		flip(target[spoilt], 0);
	}
}

static void spoil(struct cuda_args *a, int done)
{
	if (done) {
		spoil_after(a);
	} else {
		spoil_before(a);
	}
}

static void test_wrong_bits_are_an_error(void **state)
{
	const struct mc_request req = scene_moving(64);

	(void)state;
	for (int t = 0; t < TARGETS; t++) {
		struct mc_backend *b = opened();
		struct mc_result res;

		spoilt = (enum target)t;
		fake.spoil = spoil;
		assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &res), -EBADMSG);
		fake.spoil = NULL;
		if (t != DRAWS) { /* it was this batch alone */
			assert_int_equal(mc_cuda_ops.run(b, &req, NULL, &res), 0);
		}
		closed(b);
	}
}

/* One changed bit anywhere in the resident memory is found within one round of slices. */
static void test_every_slice_is_looked_at(void **state)
{
	const struct mc_request req = scene_lead(1);
	struct mc_backend *b = opened();
	struct mc_result res;

	(void)state;
	assert_true(b->slices > 3);
	for (uint32_t i = 0; i < b->slices; i++) {
		const size_t byte = 4ull * CUDA_SLICE_WORDS * i + 1;
		uint32_t wrong = 0;

		flip(b->resident, byte);
		for (uint32_t run = 0; run < b->slices; run++) {
			wrong += mc_cuda_ops.run(b, &req, NULL, &res) == -EBADMSG;
		}
		assert_true(wrong >= 1);
		flip(b->resident, byte);
	}
	closed(b);
}

static void test_errno_of(void **state)
{
	(void)state;
	assert_int_equal(cuda_calls_errno(cudaSuccess), 0);
	assert_int_equal(cuda_calls_errno(cudaErrorNotReady), -EAGAIN);
	assert_int_equal(cuda_calls_errno(cudaErrorUnknown), -EIO);
	for (size_t e = 0; e < ERRORS; e++) {
		assert_int_equal(cuda_calls_errno(errors[e].cuda), errors[e].err);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(test_every_call_is_made_to_fail, reset),
		cmocka_unit_test_setup(test_no_device, reset),
		cmocka_unit_test_setup(test_errors_are_sticky, reset),
		cmocka_unit_test_setup(test_late_answer_is_waited_for, reset),
		cmocka_unit_test_setup(test_answer_of_another_request_is_discarded, reset),
		cmocka_unit_test_setup(test_never, reset),
		cmocka_unit_test_setup(test_end_without_an_answer, reset),
		cmocka_unit_test_setup(test_wrong_bits_are_an_error, reset),
		cmocka_unit_test_setup(test_every_slice_is_looked_at, reset),
		cmocka_unit_test(test_errno_of),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
