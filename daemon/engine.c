/* SPDX-License-Identifier: MIT
 * Backends in the order they are tried. See engine.h.
 */
#include "engine.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "calibration.h"
#include "clock.h"
#include "fault.h"
#include "mc_ops.h"
#include "pipeline.h"

enum choice { CHOICE_AUTO, CHOICE_CPU, CHOICE_CUDA };

static const struct row {
	const struct mc_ops *ops;
	enum choice choice;
	enum publish_backend which;
} rows[] = {
	{&mc_cuda_ops, CHOICE_CUDA, PUBLISH_BACKEND_GPU},
	{&mc_cpu_ops, CHOICE_CPU, PUBLISH_BACKEND_CPU},
};

struct mc_params engine_params(const struct config *cfg, config_int samples)
{
	struct mc_params p = {
		.kind = (enum mc_draws_kind)cfg->mc_draws,
		.seed = (uint64_t)cfg->mc_seed,
		.n_resident = (uint32_t)samples,
		.threads = (uint32_t)cfg->mc_threads,
	};

	for (int i = 0; i < MODEL_INPUTS; i++) {
		p.truncate[i] = (float)cfg->mc_truncate;
	}
	return p;
}

static const char *why_not(int status)
{
	switch (status) {
	case -ENOTSUP:
		return "it is not built into this binary";
	case -ENOSYS:
	case -ENODEV:
		return "no device, or no driver";
	default:
		return strerror(-status);
	}
}

int engine_open(const struct config *cfg, enum mc_worker how, struct mc **ret,
		enum publish_backend *which, char *err, int err_len)
{
	const struct mc_params p = engine_params(cfg, cfg->mc_samples);
	int status = -ENODEV;

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		const struct row *r = &rows[i];

		if (cfg->mc_backend != CHOICE_AUTO && cfg->mc_backend != (config_choice)r->choice) {
			continue;
		}
		status = mc_open(r->ops, &p, how, ret);
		if (!status) {
			*which = r->which;
			return 0;
		}
		snprintf(err, (size_t)err_len, "cannot open the %s backend: %s", r->ops->name,
			 why_not(status));
	}
	return status;
}

uint32_t engine_fault(int err)
{
	static const struct {
		int err;
		uint32_t fault;
	} row[] = {
		{-ENOTSUP, FAULT_BIT(GPU_NONE)},   {-ENOSYS, FAULT_BIT(GPU_DRIVER)},
		{-ENODEV, FAULT_BIT(GPU_NONE)},    {-ENOEXEC, FAULT_BIT(GPU_OLD)},
		{-ENOMEM, FAULT_BIT(GPU_MEMORY)},  {-EFAULT, FAULT_BIT(GPU_ADDRESS)},
		{-ETIMEDOUT, FAULT_BIT(GPU_HANG)}, {-EBADMSG, FAULT_BIT(GPU_BITS)},
	};

	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		if (row[i].err == err) {
			return row[i].fault;
		}
	}
	return FAULT_BIT(GPU_LOST);
}

/* `auto` takes what there is. */
static int is_absent(int err)
{
	return err == -ENOTSUP || err == -ENOSYS || err == -ENODEV;
}

static void check_calibration(const struct config *cfg, char *err, int err_len)
{
	struct mc_cuda_info now;
	int ret = cfg->mc_calibration[0] ? mc_cuda_info(&now) : 0;

	ret = ret || !cfg->mc_calibration[0]
		      ? ret
		      : calibration_differs(cfg->mc_calibration, &now, err, err_len);
	if (ret < 0) {
		snprintf(err, (size_t)err_len, "mc.calibration: %s: %s", cfg->mc_calibration,
			 strerror(-ret));
	}
}

/* Behind a slower car, as uncertain as traffic is: every input drawn, every future rolled. */
static int typical(const struct config *cfg, struct mc_request *req)
{
	static const double sigma[SCENE_DIM] = {0.3, 0.05, 0.3, 0.2, 0.8};
	struct scene s = {.ego_valid = 1, .lead_valid = 1, .x = {40, 25, -0.5, 20, -1}};

	for (int i = 0; i < SCENE_DIM; i++) {
		s.cov[i][i] = sigma[i] * sigma[i];
	}
	return pipeline_request(cfg, &s, 1, req);
}

static int choose_size(const struct config *cfg, struct mc *mc, config_int most,
		       struct engine_size *ret)
{
	const int64_t target_ns = clock_s_to_ns(cfg->mc_target / 1e3);
	const int64_t limit_ns = clock_s_to_ns(cfg->mc_budget / 1e3);
	struct mc_request req;
	int err = typical(cfg, &req);

	err = err ? err : budget_measure(mc, &req, target_ns, limit_ns, (uint32_t)most, &ret->cost);
	if (err) {
		return err;
	}
	ret->samples = budget_samples(&ret->cost, target_ns, limit_ns,
				      (uint32_t)cfg->decision_samples_min, (uint32_t)most);
	return ret->samples ? 0 : -ETIMEDOUT;
}

static int open_sized(const struct mc_ops *ops, const struct config *cfg, config_int most,
		      struct mc **ret, struct engine_size *size)
{
	const struct mc_params p = engine_params(cfg, most);
	int err = mc_open(ops, &p, MC_WORKER, ret);

	err = err ? err : choose_size(cfg, *ret, most, size);
	if (err) {
		mc_close(*ret);
		*ret = NULL;
		*size = (struct engine_size){0};
	}
	return err;
}

/* The GPU before the CPU that @e has, or a reason why not. */
static void open_gpu(const struct config *cfg, struct engine *e, char *err, int err_len)
{
	struct engine gpu = {.spare = e->mc, .spare_size = e->size, .which = PUBLISH_BACKEND_GPU};
	const int status = open_sized(&mc_cuda_ops, cfg, cfg->mc_samples_cuda, &gpu.mc, &gpu.size);

	if (!status) {
		*e = gpu;
		check_calibration(cfg, err, err_len);
	} else if (cfg->mc_backend != CHOICE_AUTO || !is_absent(status)) {
		e->faults = engine_fault(status);
		snprintf(err, (size_t)err_len,
			 "cannot open the cuda backend: %s; running on the CPU", strerror(-status));
	}
}

int engine_open_live(const struct config *cfg, struct engine *ret, char *err, int err_len)
{
	struct engine e = {.which = PUBLISH_BACKEND_CPU};
	const int status = open_sized(&mc_cpu_ops, cfg, cfg->mc_samples, &e.mc, &e.size);

	err[0] = '\0';
	if (status == -ETIMEDOUT) {
		snprintf(err, (size_t)err_len,
			 "no power of two from decision.samples_min = %u to mc.samples = %u "
			 "samples runs within mc.budget = %g ms on the CPU",
			 (unsigned int)cfg->decision_samples_min, (unsigned int)cfg->mc_samples,
			 cfg->mc_budget);
	} else if (status) {
		snprintf(err, (size_t)err_len, "cannot open the cpu backend: %s",
			 strerror(-status));
	}
	if (status) {
		return status;
	}
	if (cfg->mc_backend != CHOICE_CPU) {
		open_gpu(cfg, &e, err, err_len);
	}
	*ret = e;
	return 0;
}

void engine_close(struct engine *e)
{
	mc_close(e->mc);
	mc_close(e->spare);
}
