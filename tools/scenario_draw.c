/* SPDX-License-Identifier: MIT
 * Cars, sensors and drivers by chance: each line of scenario_draw() says over what.
 */
#include <math.h>
#include "noise.h"
#include "scenario.h"

#define REACTION_S 1.0  /* warning to the driver's brake, FMVSS 127 */
#define MU_NOMINAL 1.02 /* peak friction of the test surface, FMVSS 127 */

static double uniform(struct noise *n, double lo, double hi)
{
	return lo + (hi - lo) * noise_uniform(n);
}

static double normal(struct noise *n, double mean, double sigma)
{
	return mean + sigma * noise_normal(n);
}

/* Not the car's own noise: another stream for each row and car. */
static uint64_t stream(uint64_t seed, int number, int k)
{
	return (seed << 40) + ((uint64_t)number << 24) + (uint64_t)k;
}

static struct plant_vehicle draw_car(const struct config *cfg, struct noise *n)
{
	return (struct plant_vehicle){
		.mass_kg = fmax(normal(n, cfg->vehicle_mass, cfg->vehicle_mass_sigma),
				cfg->vehicle_mass_floor),
		.drag = fmax(normal(n, cfg->vehicle_drag, cfg->vehicle_drag_sigma), 0),
		.mu = normal(n, MU_NOMINAL, 0.02),
		.grade_rad = uniform(n, -0.01, 0.01), /* FMVSS 127: at most 1 % */
		.tau_s = uniform(n, 0.1, 0.2),
		.gain = normal(n, 1, 0.02),
		.delay_s = uniform(n, 0.02, cfg->brake_delay),
	};
}

static struct sensors_params broken(const struct config *cfg, const struct scenario_fault *f,
				    uint64_t seed)
{
	struct sensors_params p = sensors_nominal(cfg, seed);
	const double noise = f && f->noise > 0 ? f->noise : 1;

	p.range_sigma_m *= noise;
	p.rate_sigma_mps *= noise;
	p.ego_sigma_mps *= noise;
	if (f) {
		p.period_s = f->period_s > 0 ? f->period_s : p.period_s;
		p.latency_s = f->latency_s > 0 ? f->latency_s : p.latency_s;
		p.rate_lag_s = f->rate_lag_s;
		p.dropout = f->dropout;
		p.burst = f->burst;
	}
	return p;
}

static void draw_sensors(struct noise *n, struct sensors_params *p)
{
	const double noise = uniform(n, 0.8, 1.2);

	p->range_sigma_m *= noise;
	p->rate_sigma_mps *= noise;
	p->latency_s += uniform(n, -0.025, 0.025);
	p->ego_latency_s = uniform(n, 0, 0.02);
	p->ego_scale = normal(n, 1, 0.002);
	p->dropout += uniform(n, 0, 0.04);
	p->burst = fmax(p->burst, 0.3);
}

struct scenario_draw scenario_draw(const struct config *cfg, const struct scenario *row,
				   uint64_t seed, int k)
{
	const uint64_t own = stream(seed, row->number, k);
	struct noise n = {.seed = ~own};
	struct scenario_draw d = {
		.car = plant_nominal(cfg, MU_NOMINAL),
		.sensors = broken(cfg, row->fault, own),
		.reaction_s = REACTION_S,
	};

	if (k > 0) {
		d.car = draw_car(cfg, &n);
		draw_sensors(&n, &d.sensors);
		d.speed_mps = uniform(&n, -1, 1) * 1.6 / 3.6; /* FMVSS 127: tolerance of a test */
		d.reaction_s += uniform(&n, -0.1, 0.1);
	}
	d.car.grade_rad += row->grade_rad;
	return d;
}
