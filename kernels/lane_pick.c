/* SPDX-License-Identifier: MIT
 * The table of lane variants, fastest first, and what each needs of the processor.
 */
#include "lane_block.h"
#include <stdlib.h>
#include <string.h>

struct variant {
	const struct lanes *lanes;
	int (*runs)(void);
};

static int always(void)
{
	return 1;
}

#ifdef __x86_64__
extern const struct lanes lanes_avx512, lanes_avx2, lanes_plain;

static int has_avx2(void)
{
	return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
	       __builtin_cpu_supports("bmi2");
}

static int has_avx512(void)
{
	return has_avx2() && __builtin_cpu_supports("avx512f") &&
	       __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
	       __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}

static const struct variant variants[] = {
	{&lanes_avx512, has_avx512},
	{&lanes_avx2, has_avx2},
	{&lanes_plain, always},
};
#elif defined(__aarch64__)
extern const struct lanes lanes_neon;

static const struct variant variants[] = {{&lanes_neon, always}};
#else
extern const struct lanes lanes_plain;

static const struct variant variants[] = {{&lanes_plain, always}};
#endif

#define VARIANTS (sizeof(variants) / sizeof(variants[0]))

const struct lanes *lanes_pick(const char *name)
{
	for (size_t i = 0; i < VARIANTS; i++) {
		if ((!name || !strcmp(name, variants[i].lanes->name)) && variants[i].runs()) {
			return variants[i].lanes;
		}
	}
	return NULL;
}

const char *lanes_name(unsigned int i)
{
	return i < VARIANTS ? variants[i].lanes->name : NULL;
}

struct lanes_work *lanes_work_open(void)
{
	struct lanes_work *w = aligned_alloc(64, sizeof(*w));

	if (w) {
		memset(w, 0, sizeof(*w));
	}
	return w;
}

void lanes_work_close(struct lanes_work *w)
{
	free(w);
}
