/* SPDX-License-Identifier: MIT
 * The rollout as anybody would write it down: a plain C loop of RK4 steps over the paper's equations, against which
 * bench holds the reference of kernels/, so that the reference cannot be slow to the fast rollout's advantage.
 */
#ifndef AEBMC_PLAIN_H
#define AEBMC_PLAIN_H

#include "model.h"

/**
 * plain_rollout - one sample that brakes from t = 0 behind a lead with constant acceleration
 * @in: MODEL_INPUTS inputs, @stride floats apart; ego acceleration and delay are not looked at
 * @dt_s: fixed step                                                        [s], 0.001 in the paper
 * RK4 on eq. 4 and 6 with the friction bound of eq. 5 (a >= -mu g / (1 + mu h/L)) until v <= 0 or the horizon, with the
 * closest approach and the closing speed in the step of first contact. Fills @out but for MODEL_UNDECIDED. Pure.
 */
void plain_rollout(const struct model_vehicle *veh, float accel_cmd_mps2, double horizon_s,
		   const float *in, uint32_t stride, double dt_s, struct model_out *out);

#endif
