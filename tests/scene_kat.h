/* SPDX-License-Identifier: MIT
 * tests/kat/rollout.txt: scenes with the oracle's results, see tests/oracle/rollout.py.
 */
#ifndef AEBMC_TESTS_SCENE_KAT_H
#define AEBMC_TESTS_SCENE_KAT_H

#include "kat.h"
#include "model.h"

#define SCENES 200

struct scene_kat {
	struct model_vehicle vehicle;
	struct model_future future;
	float horizon_s;
	float in[MODEL_INPUTS];
	double stop_m, need_m, impact_mps;
	uint32_t flags;
};

/** scene_kat_next - the next scene of @f; 0 at the end. */
static inline int scene_kat_next(FILE *f, struct scene_kat *k)
{
	char line[1024];
	float *in = k->in;

	if (!kat_line(f, line, sizeof(line))) {
		return 0;
	}
	k->vehicle = (struct model_vehicle){1.225f, 2.2f, 9.81f, 0.5f, 2.7f, 0};
	assert_int_equal(sscanf(line, "%a %a %u %a %a %a %a %a %a %a %a %a %a %a %a %la %la %la %u",
				&k->future.accel_cmd_mps2, &k->future.extra_delay_s,
				&k->vehicle.bound, &k->horizon_s, in, in + 1, in + 2, in + 3,
				in + 4, in + 5, in + 6, in + 7, in + 8, in + 9, in + 10, &k->stop_m,
				&k->need_m, &k->impact_mps, &k->flags),
			 19);
	return 1;
}

#endif
