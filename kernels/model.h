/* SPDX-License-Identifier: MIT
 * The vehicle model: one sampled scene in, stopping distance and closest approach out.
 * One header for host and device. This file holds the parameters and the f64 RK4 reference rollout of
 * the paper (Sec. III, eq. 1-6), extended by the ego's present acceleration, a brake delay and a moving lead.
 * It knows nothing of batches, draws or statistics.
 */
#ifndef AEBMC_MODEL_H
#define AEBMC_MODEL_H

#include <stdint.h>
#include "detmath.h"

/* Every input of a sample, in the order of struct mc_request and of the draws. The first five are
 * correlated (a filter's errors are); the rest are independent. */
enum model_input {
	MODEL_HEADWAY,    /* gap from ego front to lead rear at t = 0           [m]                */
	MODEL_EGO_SPEED,  /* v0                                                 [m/s], >= 0        */
	MODEL_EGO_ACCEL,  /* a0, net acceleration until the brake acts          [m/s2], signed     */
	MODEL_LEAD_SPEED, /* vl                                                 [m/s], >= 0        */
	MODEL_LEAD_ACCEL, /* al, constant down to standstill                    [m/s2], signed     */
	MODEL_MU,         /* peak friction                                      [1], > 0           */
	MODEL_GRADE,      /* theta, uphill positive                             [rad], |.| <= 0.5  */
	MODEL_MASS,       /* m                                                  [kg], > 0          */
	MODEL_DRAG,       /* C_d                                                [1], >= 0          */
	MODEL_TAU,        /* actuator time constant                             [s], > 0           */
	MODEL_DELAY,      /* from t = 0 to brake onset, before a future's extra [s], >= 0          */
	MODEL_INPUTS
};

enum model_bound {
	MODEL_BOUND_PAPER,    /* eq. 5 solved for a: a >= -mu g / (1 + mu h/L)   */
	MODEL_BOUND_FRICTION, /* a >= -mu g                                      */
};

/* What all samples of a batch share. */
struct model_vehicle {
	float rho_kgpm3;    /* air density, 1.225 */
	float area_m2;      /* frontal area A_f, 2.2 */
	float gravity_mps2; /* 9.81 */
	float cg_height_m;  /* h, 0.5 */
	float wheelbase_m;  /* L, 2.7 */
	uint32_t bound;     /* enum model_bound */
};

/* One thing that may happen next. "Nobody brakes" is extra_delay_s >= horizon. */
struct model_future {
	float accel_cmd_mps2; /* a_cmd <= 0; -6 in the paper */
	float extra_delay_s;  /* >= 0, added to the sample's delay */
};

/* What one rollout yields. All f32 so that CPU and GPU results compare with memcmp. */
struct model_out {
	float stop_m;     /* distance travelled to standstill, eq. 3; at the horizon if still rolling  */
	float need_m;     /* headway at which the sample just touches: -min(x_lead - x_ego) over [0,T] */
	float impact_mps; /* closing speed at first contact; 0 without contact                         */
	uint32_t flags;   /* MODEL_* below */
};
#define MODEL_CONTACT   1u /* headway <= need */
#define MODEL_ROLLING   2u /* ego still moving at the horizon */
#define MODEL_UNDECIDED 4u /* no contact yet, and the gap is still closing at the horizon */

#endif
