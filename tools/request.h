/* SPDX-License-Identifier: MIT
 * From options to one Monte Carlo request: the paper's preset, or any scene under a configuration. An argp child with
 * --preset, --future, --samples and, for each of the five state inputs, its mean and its standard deviation.
 */
#ifndef AEBMC_REQUEST_H
#define AEBMC_REQUEST_H

#include <argp.h>
#include "mc.h"
#include "setup.h"

struct request_args {
	struct setup setup;        /* given: the scene is evaluated under this configuration */
	int preset_paper;          /* --preset paper was given */
	size_t future;             /* enum future that the histograms describe */
	int64_t samples;           /* 0: the configuration's, or 100,000 */
	double mean[MC_STATE_DIM]; /* SI units; NaN: not given */
	double sigma[MC_STATE_DIM];
};

/* Child parser; its input is a struct request_args that request_defaults filled. */
extern const struct argp request_argp;

struct request_args request_defaults(void);

/**
 * request_build - the request, with histograms and impact speeds wanted
 * Without a configuration it is the paper's (Sec. IV), changed by the state inputs given; with one it is what the
 * pipeline would submit for that scene, with independent errors. The state's defaults are the paper's in both cases.
 * A lead that moves takes back the paper's verdict on samples that still roll at the horizon.
 * Returns 0, or an exit code after one line.
 */
int request_build(const char *name, const struct request_args *a, struct mc_request *req);

#endif
