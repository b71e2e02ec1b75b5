/* SPDX-License-Identifier: MIT
 * mc_cpu: a flipped bit in the resident draws is found within one round of batches, and no batch is believed after it.
 * Reads the backend's own file for a way to its memory.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include "../kernels/mc_cpu.c"

#define N 10000

static struct mc_backend *opened(void)
{
	const struct mc_params p = {.kind = MC_SOBOL, .seed = 1, .n_resident = N, .threads = 1};
	struct mc_backend *b = NULL;

	assert_int_equal(mc_cpu_ops.open(&p, &b), 0);
	return b;
}

/* Batches until one is refused, at most @max; 0 if none is. */
static int refused_after(struct mc_backend *b, int max)
{
	struct mc_request req;
	struct mc_result res;

	mc_preset_paper(&req, 100.0f, 64);
	req.id = 1;
	for (int i = 1; i <= max; i++) {
		const int err = mc_cpu_ops.run(b, &req, NULL, &res);

		if (err) {
			assert_int_equal(err, -EBADMSG);
			return i;
		}
	}
	return 0;
}

/* First and last word, and the ones at the seams of the slices of 16,384. */
static void test_any_flipped_bit_is_found(void **arg)
{
	struct mc_backend *b = opened();
	uint32_t stride;
	float *z = (float *)draws_table(b->draws, &stride);
	const size_t words = (size_t)MC_DIM * stride;
	const int slices = (int)((words + 16383) / 16384);
	const size_t at[] = {0, 16383, 16384, words / 2, words - 1};

	(void)arg;
	assert_int_equal(refused_after(b, 3 * slices), 0);
	for (size_t i = 0; i < sizeof(at) / sizeof(at[0]); i++) {
		for (int bit = 0; bit < 32; bit += 31) {
			uint32_t word = det_bits(z[at[i]]);

			z[at[i]] = det_float(word ^ 1u << bit);
			assert_in_range(refused_after(b, slices), 1, slices);
			assert_in_range(refused_after(b, slices), 1, slices); /* it stays so */
			z[at[i]] = det_float(word);
			assert_int_equal(refused_after(b, slices), 0);
		}
	}
	mc_cpu_ops.close(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(test_any_flipped_bit_is_found)};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
