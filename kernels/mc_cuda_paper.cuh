/* SPDX-License-Identifier: MIT
 * Yardsticks for the benchmarks: the paper's kernel as its Sec. V describes it, and plain f32 multiply-adds. Included by
 * mc_cuda.cu alone.
 */

/* Eq. 4 to 6 as they are printed, eq. 5 solved for a. */
static __device__ __forceinline__ void paper_rates(const struct cuda_paper_args *a, const struct cuda_paper_sample *p,
						   double v, double brake, double *dv, double *da)
{
	const double bound = -p->mu * a->gravity_mps2 / (1.0 + p->mu * a->h_over_l);
	const double held = brake > bound ? brake : bound;

	*dv = held - a->rho_kgpm3 * p->drag * a->area_m2 * v * v / (2.0 * p->mass) -
	      a->gravity_mps2 * det_sin(p->grade);
	*da = (a->cmd_mps2 - brake) / p->tau;
}

/* Sec. V: one thread per sample, parameters as an array of structures, v0 and results contiguous, state in registers,
 * f64, 1 ms, standstill or T_max as the only ends. No lead, no gap, no statistics. */
static __global__ void __launch_bounds__(256) paper(struct cuda_paper_args a)
{
	const uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
	const double h = a.dt_s;

	if (i >= a.count) {
		return;
	}
	const struct cuda_paper_sample p = a.param[i];
	double x = 0.0, v = a.v0[i], brake = 0.0;

	for (double t = 0.0; v > 0.0 && t < a.horizon_s; t += h) {
		double v1, v2, v3, v4, a1, a2, a3, a4;

		paper_rates(&a, &p, v, brake, &v1, &a1);
		paper_rates(&a, &p, v + 0.5 * h * v1, brake + 0.5 * h * a1, &v2, &a2);
		paper_rates(&a, &p, v + 0.5 * h * v2, brake + 0.5 * h * a2, &v3, &a3);
		paper_rates(&a, &p, v + h * v3, brake + h * a3, &v4, &a4);
		x += h / 6.0 * (v + 2.0 * (v + 0.5 * h * v1) + 2.0 * (v + 0.5 * h * v2) + (v + h * v3));
		v += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
		brake += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
	}
	a.stop_m[i] = x;
}

/* Eight independent chains a thread: what the f32 pipes can issue. The result is only there so that it is computed. */
static __global__ void __launch_bounds__(256) peak(struct cuda_peak_args a)
{
	float x[8];
	float sum = 0.0f;

	for (int k = 0; k < 8; k++) {
		x[k] = (float)(threadIdx.x + k);
	}
	for (uint32_t i = 0; i < a.rounds; i++) {
#pragma unroll
		for (int k = 0; k < 8; k++) {
			x[k] = det_fmaf(x[k], a.gain, a.offset);
		}
	}
	for (int k = 0; k < 8; k++) {
		sum += x[k];
	}
	a.out[blockIdx.x * blockDim.x + threadIdx.x] = sum;
}
