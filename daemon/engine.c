/* SPDX-License-Identifier: MIT
 * Backends in the order they are tried. See engine.h.
 */
#include "engine.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "mc_ops.h"

enum choice { CHOICE_AUTO, CHOICE_CPU, CHOICE_CUDA };

static const struct row {
	const struct mc_ops *ops;
	enum choice choice;
	enum publish_backend which;
} rows[] = {
	{&mc_cuda_ops, CHOICE_CUDA, PUBLISH_BACKEND_GPU},
	{&mc_cpu_ops, CHOICE_CPU, PUBLISH_BACKEND_CPU},
};

static struct mc_params params_of(const struct config *cfg)
{
	struct mc_params p = {
		.kind = (enum mc_draws_kind)cfg->mc_draws,
		.seed = (uint64_t)cfg->mc_seed,
		.n_resident = (uint32_t)cfg->mc_samples,
		.threads = (uint32_t)cfg->mc_threads,
	};

	for (int i = 0; i < MODEL_INPUTS; i++) {
		p.truncate[i] = (float)cfg->mc_truncate;
	}
	return p;
}

int engine_open(const struct config *cfg, enum mc_worker how, struct mc **ret,
		enum publish_backend *which, char *err, int err_len)
{
	const struct mc_params p = params_of(cfg);
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
			 strerror(-status));
	}
	return status;
}
