/* SPDX-License-Identifier: MIT
 * The file of `aebmc budget`. See calibration.h.
 */
#include "calibration.h"
#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define LINE_MAX_BYTES 400

static const int budget_ms[CALIBRATION_BUDGETS] = {CALIBRATION_MS};
static const char *const kernel_key[CALIBRATION_KERNELS] = {"paper", "fast"};

/* What must be the same; all of them int. */
static const struct field {
	const char *key;
	size_t offset;
} fields[] = {
	{"capability_major", offsetof(struct mc_cuda_info, major)},
	{"capability_minor", offsetof(struct mc_cuda_info, minor)},
	{"multiprocessors", offsetof(struct mc_cuda_info, sms)},
	{"clock_khz", offsetof(struct mc_cuda_info, clock_khz)},
	{"memory_clock_khz", offsetof(struct mc_cuda_info, memory_clock_khz)},
	{"cuda_driver", offsetof(struct mc_cuda_info, driver)},
	{"cuda_runtime", offsetof(struct mc_cuda_info, runtime)},
};
#define FIELDS (sizeof(fields) / sizeof(fields[0]))

static int value_of(const struct mc_cuda_info *i, const struct field *f)
{
	int v;

	memcpy(&v, (const char *)i + f->offset, sizeof(v));
	return v;
}

void calibration_write(const struct calibration *c, FILE *f)
{
	fprintf(f, "device = %s\n", c->device.name);
	for (size_t i = 0; i < FIELDS; i++) {
		fprintf(f, "%s = %d\n", fields[i].key, value_of(&c->device, &fields[i]));
	}
	for (int k = 0; k < CALIBRATION_KERNELS; k++) {
		for (int i = 0; i < CALIBRATION_BUDGETS; i++) {
			fprintf(f, "%s_%d_ms = %u\n", kernel_key[k], budget_ms[i],
				c->samples[k][i]);
		}
	}
}

static const char *now_text(const struct mc_cuda_info *now, const char *key, char *text,
			    size_t size)
{
	if (!strcmp(key, "device")) {
		return now->name;
	}
	for (size_t i = 0; i < FIELDS; i++) {
		if (!strcmp(key, fields[i].key)) {
			snprintf(text, size, "%d", value_of(now, &fields[i]));
			return text;
		}
	}
	return NULL;
}

/* One line; counts what must be the same in @seen. */
static int line_differs(char *line, const struct mc_cuda_info *now, unsigned int *seen, char *why,
			int why_len)
{
	char *value = strstr(line, " = ");
	char text[32];

	if (!value) {
		return -EINVAL;
	}
	*value = '\0';
	value += 3;
	value[strcspn(value, "\n")] = '\0';
	const char *is = now_text(now, line, text, sizeof(text));

	*seen += is != NULL;
	if (!is || !strcmp(is, value)) {
		return 0;
	}
	snprintf(why, (size_t)why_len,
		 "calibrated with %s = %s, here it is %s: run aebmc budget again", line, value, is);
	return 1;
}

int calibration_differs(const char *path, const struct mc_cuda_info *now, char *why, int why_len)
{
	char line[LINE_MAX_BYTES];
	unsigned int seen = 0;
	FILE *f = fopen(path, "re");
	int ret = f ? 0 : -errno;

	while (!ret && fgets(line, sizeof(line), f)) {
		ret = line_differs(line, now, &seen, why, why_len);
	}
	if (f && !ret && ferror(f)) {
		ret = -EIO;
	}
	if (f) {
		fclose(f);
	}
	return ret ? ret : seen == FIELDS + 1 ? 0 : -EINVAL;
}
