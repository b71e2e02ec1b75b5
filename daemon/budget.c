/* SPDX-License-Identifier: MIT
 * Batches timed, and measured cost to batch size.
 */
#include "budget.h"

#include <errno.h>
#include <poll.h>

#include "clock.h"

#define TRIES 3

static double batch_ns(const struct budget_cost *c, double n)
{
	return c->overhead_ns + n * c->sample_ns;
}

uint32_t budget_samples(const struct budget_cost *cost, int64_t target_ns, int64_t ceiling_ns,
			uint32_t min, uint32_t max)
{
	const double aim_ns = (double)(target_ns < ceiling_ns ? target_ns : ceiling_ns);
	uint32_t n = BUDGET_SAMPLES_MIN;

	while (n < min && n <= max / 2) {
		n *= 2;
	}
	/* Written so that a cost that is not a number fits nothing. */
	if (n < min || max < n || !(batch_ns(cost, n) <= (double)ceiling_ns)) {
		return 0;
	}
	while (n <= max / 2 && batch_ns(cost, 2.0 * n) <= aim_ns) {
		n *= 2;
	}
	return n;
}

/* One batch, waited for. */
static int run(struct mc *mc, const struct mc_request *req, int64_t limit_ns, int64_t *took_ns)
{
	struct pollfd done = {.fd = mc_eventfd(mc), .events = POLLIN};
	const int64_t start_ns = clock_now_ns();
	struct mc_result res;
	int got = mc_submit(mc, req);

	while (got >= 0) {
		got = mc_poll(mc, &res);
		*took_ns = clock_now_ns() - start_ns;
		if (got) {
			break;
		}
		if (*took_ns >= limit_ns) {
			return -ETIMEDOUT;
		}
		poll(&done, 1, (int)((limit_ns - *took_ns) / CLOCK_NS_PER_MS) + 1);
	}
	return got < 0 ? got : 0;
}

static int shortest(struct mc *mc, struct mc_request *req, uint32_t n, int64_t limit_ns,
		    int64_t *ret_ns)
{
	int64_t least_ns = INT64_MAX, took_ns;
	int err = 0;

	req->n = n;
	for (int i = 0; i < TRIES && !err; i++) {
		err = run(mc, req, limit_ns, &took_ns);
		least_ns = !err && took_ns < least_ns ? took_ns : least_ns;
	}
	*ret_ns = least_ns;
	return err;
}

int budget_measure(struct mc *mc, const struct mc_request *like, int64_t target_ns,
		   int64_t limit_ns, uint32_t max, struct budget_cost *ret)
{
	struct mc_request req = *like;
	int64_t small_ns, large_ns;
	uint32_t n = BUDGET_SAMPLES_MIN;

	req.id = 1;
	int err = shortest(mc, &req, n, limit_ns, &small_ns);

	large_ns = small_ns;
	while (!err && large_ns < target_ns && n <= max / 2) {
		n *= 2;
		err = shortest(mc, &req, n, limit_ns, &large_ns);
	}
	if (err) {
		return err;
	}
	if (n == BUDGET_SAMPLES_MIN) {
		*ret = (struct budget_cost){(double)small_ns / n, 0};
		return 0;
	}
	/* Where the fixed cost hides that of a sample, all of it counts as the samples'. */
	const double slope = (double)(large_ns - small_ns) / (n - BUDGET_SAMPLES_MIN);
	const double sample_ns = slope > 0 ? slope : (double)large_ns / n;
	const double rest_ns = (double)large_ns - n * sample_ns;

	*ret = (struct budget_cost){sample_ns, rest_ns > 0 ? rest_ns : 0};
	return 0;
}
