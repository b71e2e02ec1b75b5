/* SPDX-License-Identifier: MIT
 * The measurements of aebmc verify: fast rollout against reference on hard scenes, the same bits from every variant,
 * backend and number of threads, and what error a resident set of draws has of its own.
 */
#ifndef AEBMC_CHECKS_H
#define AEBMC_CHECKS_H

#include "verify.h"

#define CHECKS_CONTENDERS_MAX 8
#define CHECKS_KINDS          2 /* VERIFY_PAPER, VERIFY_MOVING */
#define CHECKS_STOP_MAX_M     0.5e-3
#define CHECKS_IMPACT_MAX_MPS 0.01

/* One way to compute that must give the same bits as the first. */
struct contender {
	const char *name;
	const struct mc_ops *ops;
	const char *variant; /* of the CPU backend, else NULL */
};

struct checks {
	/* in */
	struct mc_params
		params; /* draws, seed; threads: how many work on the rollouts; n_resident: the set looked at */
	int n;
	struct contender
		contender[CHECKS_CONTENDERS_MAX]; /* the first one is held against the reference */
	uint32_t samples;                         /* of each kind */
	void (*progress)(void *arg,
			 double share); /* called from time to time by the calling thread */
	void *arg;
	/* out */
	struct verify_tally tally[CHECKS_KINDS];
	uint64_t
		differing; /* samples, or whole results, whose bits are not the first contender's */
	double set_p[MC_RISKS], set_lo[MC_RISKS],
		set_hi[MC_RISKS]; /* what the set says where the risk is mc_risk_level[] */
};

extern const uint32_t checks_threads[];
#define CHECKS_THREADS 3

/** checks_rollouts - both kinds of scenes through reference and contenders, on params.threads threads
 * 0, -EINTR with what was done so far once cli_interrupted(), -errno of a backend. Allocates. */
int checks_rollouts(struct checks *c);

/** checks_batches - whole batches of @samples through every contender, on the CPU with 1, 2 and 4 threads. 0, -EINTR,
 * -errno. */
int checks_batches(struct checks *c);

/** checks_resident - the risk that the resident set gives at headways where a far larger set gives 5, 1 and 0.1 %, of
 * the paper's scene. 0, -EINTR, -errno. */
int checks_resident(struct checks *c);

/** checks_bad - 1 if anything measured so far differs or is past its limits. Pure. */
int checks_bad(const struct checks *c);

/** checks_good - 1 if both kinds of scenes were measured and nothing is bad. Pure. */
int checks_good(const struct checks *c);

#endif
