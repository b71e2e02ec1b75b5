/* SPDX-License-Identifier: MIT
 * For tests that need a car: the shipped mappings, made-up drives (tools/drive.h) and an estimator fed from them.
 */
#ifndef AEBMC_TEST_DRIVES_H
#define AEBMC_TEST_DRIVES_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "conf_dir.h"
#include "../tools/drive.c"
#include "../tools/sensors.c"
#include "../tools/encode.c"
#include "clock.h"
#include "config.h"
#include "estimator.h"
#include "fault.h"
#include "mapping.h"

/* drives_load - "generic" or "toyota-tss-p", with overrides "section.key=value" */
static inline struct mapping *drives_load(const char *car, struct config *cfg)
{
	char path[128], err[1024];
	struct mapping *m = NULL;

	snprintf(path, sizeof(path), "can-dbc/vehicles/%s.conf", car);
	if (config_load(path, NULL, 0, cfg, &m, err, sizeof(err))) {
		fail_msg("%s", err);
	}
	return m;
}

/* drives_load_text - a car made up for a test; @conf has file = test.dbc */
static inline struct mapping *drives_load_text(const char *dbc, const char *conf,
					       struct config *cfg)
{
	char dir[CONF_DIR_PATH], path[2 * CONF_DIR_PATH], err[1024];
	struct mapping *m = NULL;

	conf_dir_open(dir);
	conf_dir_write(dir, "test.dbc", dbc, strlen(dbc), path);
	conf_dir_write(dir, "test.conf", conf, strlen(conf), path);
	if (config_load(path, NULL, 0, cfg, &m, err, sizeof(err))) {
		fail_msg("%s", err);
	}
	conf_dir_close(dir);
	return m;
}

/* drives_factor - lower Cholesky factor; 0 if @p is not positive definite */
static inline int drives_factor(const double p[SCENE_DIM][SCENE_DIM],
				double l[SCENE_DIM][SCENE_DIM])
{
	memset(l, 0, sizeof(double[SCENE_DIM][SCENE_DIM]));
	for (int i = 0; i < SCENE_DIM; i++) {
		for (int j = 0; j <= i; j++) {
			double s = p[i][j];

			for (int k = 0; k < j; k++) {
				s -= l[i][k] * l[j][k];
			}
			if (i == j && !(s > 0)) {
				return 0;
			}
			l[i][j] = i == j ? sqrt(s) : s / l[j][j];
		}
	}
	return 1;
}

/* drives_assert_sound - finite, no car drives backwards, covariance symmetric to the bit and positive definite */
static inline void drives_assert_sound(const struct scene *s)
{
	double l[SCENE_DIM][SCENE_DIM];

	for (int i = 0; i < SCENE_DIM; i++) {
		assert_true(isfinite(s->x[i]));
		for (int j = 0; j < i; j++) {
			assert_memory_equal(&s->cov[i][j], &s->cov[j][i], sizeof(double));
		}
	}
	assert_true(s->x[SCENE_EGO_SPEED] >= 0 && s->x[SCENE_LEAD_SPEED] >= 0 &&
		    s->x[SCENE_HEADWAY] >= 0);
	for (int i = 0; i < SCENE_OTHERS; i++) {
		assert_true(s->other[i].speed_mps >= 0 && s->other[i].headway_m >= 0);
	}
	assert_true(!s->ego_valid || drives_factor(s->cov, l));
}

/* drives_nees - error squared in sigmas, over all states together */
static inline double drives_nees(const struct scene *s, const double truth[SCENE_DIM])
{
	double l[SCENE_DIM][SCENE_DIM], y[SCENE_DIM], sum = 0;

	assert_true(drives_factor(s->cov, l));
	for (int i = 0; i < SCENE_DIM; i++) {
		y[i] = s->x[i] - truth[i];
		for (int j = 0; j < i; j++) {
			y[i] -= l[i][j] * y[j];
		}
		y[i] /= l[i][i];
		sum += y[i] * y[i];
	}
	return sum;
}

#endif
