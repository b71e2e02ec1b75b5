/* SPDX-License-Identifier: MIT
 * The ego car of a closed loop: brake controller, actuator, dynamics.
 */
#include "plant.h"
#include <math.h>
#include "clock.h"
#include "codec.h"

#define ENGINE_MPS2     -1.0 /* what the engine brakes with */
#define TIMEOUT_PERIODS 3    /* the contract's */
#define PAST            (sizeof(((struct plant *)0)->past) / sizeof(double))

struct plant_vehicle plant_nominal(const struct config *cfg, double mu)
{
	return (struct plant_vehicle){
		.mass_kg = cfg->vehicle_mass,
		.drag = cfg->vehicle_drag,
		.mu = mu,
		.tau_s = cfg->brake_tau,
		.gain = 1,
		.delay_s = cfg->brake_delay / 2,
	};
}

void plant_open(struct plant *p, const struct config *cfg, const struct plant_vehicle *v)
{
	const struct model_vehicle shared = {
		.rho_kgpm3 = (float)cfg->vehicle_rho,
		.area_m2 = (float)cfg->vehicle_area,
		.gravity_mps2 = (float)cfg->vehicle_gravity,
		.cg_height_m = (float)cfg->vehicle_cg_height,
		.wheelbase_m = (float)cfg->vehicle_wheelbase,
		.bound = MODEL_BOUND_FRICTION,
	};
	const struct model_future none = {0};
	const float in[MODEL_INPUTS] = {
		[MODEL_MU] = (float)v->mu,        [MODEL_GRADE] = (float)v->grade_rad,
		[MODEL_MASS] = (float)v->mass_kg, [MODEL_DRAG] = (float)v->drag,
		[MODEL_TAU] = (float)v->tau_s,
	};

	*p = (struct plant){.cfg = cfg, .car = *v, .good_ns = -1};
	p->braking = model_sample(&shared, &none, 1, in, 1);
}

/* ---- the brake controller ------------------------------------------------------------------- */

void plant_ask(struct plant *p, double accel_mps2)
{
	p->asked_mps2 = accel_mps2 * p->car.gain;
}

static double request(const uint8_t *data)
{
	const struct dbc_signal *decel = &contract_signal[AEB_REQUEST_DECEL];
	const uint64_t code = codec_raw(&contract_signal[AEB_REQUEST_REQUEST], data);
	const uint64_t ttl = codec_raw(&contract_signal[AEB_REQUEST_TTL], data);
	const uint64_t raw = codec_raw(decel, data);

	if (code != AEB_REQUEST_REQUEST_BRAKE || !ttl || raw == AEB_REQUEST_DECEL_NOT_AVAILABLE) {
		return 0;
	}
	return codec_phys(decel, raw);
}

void plant_receive(struct plant *p, const struct bus_frame *f, int64_t now_ns)
{
	const struct e2e_config check = {E2E_P2, &contract_message[AEB_REQUEST], NULL};

	if ((f->id & BUS_ID_MASK) != (uint32_t)p->cfg->bus_request_id ||
	    !e2e_usable(e2e_check(&check, &p->e2e, f->data, f->len))) {
		return;
	}
	p->good_ns = now_ns;
	p->stage = (int)codec_raw(&contract_signal[AEB_REQUEST_STAGE], f->data);
	plant_ask(p, request(f->data));
}

static void time_out(struct plant *p, int64_t now_ns)
{
	const double silence_s = (double)(now_ns - p->good_ns) / CLOCK_NS_PER_S;

	if (p->good_ns >= 0 && silence_s > TIMEOUT_PERIODS * p->cfg->bus_period / 1000) {
		p->good_ns = -1;
		p->stage = AEB_REQUEST_STAGE_NONE;
		p->asked_mps2 = 0;
		e2e_reset(&p->e2e);
	}
}

/* ---- motion --------------------------------------------------------------------------------- */

/* The command that has reached the actuator. */
static double arrived(struct plant *p)
{
	const uint64_t delay = (uint64_t)(p->car.delay_s * 1000 + 0.5);

	p->past[p->step % PAST] = p->asked_mps2;
	return p->step++ < delay ? 0 : p->past[(p->step - 1 - delay) % PAST];
}

/* With the brake released the driver's foot makes up for drag and grade. */
static struct model_sample forces(const struct plant *p, double driver_mps2, double aeb_mps2)
{
	struct model_sample f = p->braking;

	if (aeb_mps2 < 0) {
		f.cmd_mps2 = fmin(aeb_mps2, driver_mps2);
		return f;
	}
	f.cmd_mps2 = fmin(driver_mps2 - ENGINE_MPS2, 0);
	f.drag_pm = 0;
	f.grade_mps2 = -fmax(driver_mps2, ENGINE_MPS2);
	return f;
}

void plant_step(struct plant *p, int64_t now_ns, double driver_mps2, struct drive_car *ego)
{
	const double h = DRIVE_STEP_S, before = ego->speed_mps;

	time_out(p, now_ns);
	const struct model_sample f = forces(p, driver_mps2, arrived(p));
	const struct model_state next =
		model_step(&f, (struct model_state){0, before, p->brake_mps2}, h);

	p->brake_mps2 = next.a;
	ego->speed_mps = fmax(next.v, 0);
	ego->accel_mps2 = (ego->speed_mps - before) / h;
}
