/* SPDX-License-Identifier: MIT
 * Measured cost to batch size.
 */
#include "budget.h"

uint32_t budget_samples(double ns_per_sample, double overhead_ns, int64_t target_ns,
			int64_t ceiling_ns, uint32_t max)
{
	double aim_ns = (double)(target_ns < ceiling_ns ? target_ns : ceiling_ns);
	uint32_t n = BUDGET_SAMPLES_MIN;

	/* Written so that a cost that is not a number fits nothing. */
	if (max < n || !(overhead_ns + n * ns_per_sample <= (double)ceiling_ns)) {
		return 0;
	}
	while (n <= max / 2 && overhead_ns + 2.0 * n * ns_per_sample <= aim_ns) {
		n *= 2;
	}
	return n;
}
