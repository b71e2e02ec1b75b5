/* SPDX-License-Identifier: MIT
 * Yardsticks for the benchmarks: the paper's kernel as its Sec. V describes it, and plain f32 multiply-adds. Included by
 * mc_cuda.cu alone.
 */

/* Sec. V: one thread per sample, parameters as an array of structures, v0 and results contiguous, state in registers,
 * f64, 1 ms, standstill or T_max as the only ends. No lead, no gap, no statistics. */
static __global__ void __launch_bounds__(256) paper(struct cuda_paper_args a)
{
	const uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
	struct model_sample p = {};
	struct model_state s = {0.0, 0.0, 0.0};
	double t = 0.0;

	if (i >= a.count) {
		return;
	}
	p.drag_pm = 0.5 * a.rho_kgpm3 * a.param[i].drag * a.area_m2 / a.param[i].mass;
	p.grade_mps2 = a.gravity_mps2 * det_sin(a.param[i].grade);
	p.bound_mps2 = a.param[i].mu * a.gravity_mps2 / (1.0 + a.param[i].mu * a.h_over_l);
	p.rate_ps = 1.0 / a.param[i].tau;
	p.cmd_mps2 = a.cmd_mps2;
	s.v = a.v0[i];
	while (s.v > 0.0 && t < a.horizon_s) {
		const struct model_state n = model_step(&p, s, a.dt_s);

		s.x = n.v > 0.0 ? n.x : s.x + 0.5 * s.v * a.dt_s * (s.v / (s.v - n.v));
		s.v = n.v;
		s.a = n.a;
		t += a.dt_s;
	}
	a.stop_m[i] = s.x;
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
