/* SPDX-License-Identifier: MIT
 * Two kernels that do wrong on purpose, for tests/gpu/faults.c. Compiled into mc_cuda.cu by -DMC_CUDA_FAULTS, never into
 * the product.
 */

static __global__ void stray(uint32_t *p)
{
	p[1ull << 42] = 1;
}

/* Until the host says so, 5 s at the longest: the card may be shared. */
static __global__ void hang(uint32_t *flag)
{
	uint64_t start, now;

	asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(start));
	do {
		asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(now));
	} while (!*(volatile uint32_t *)flag && now - start < 5000000000ull);
}

extern "C" const void *const cuda_fault_stray = (const void *)stray;
extern "C" const void *const cuda_fault_hang = (const void *)hang;
