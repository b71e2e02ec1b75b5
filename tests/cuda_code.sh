#!/bin/sh
# SPDX-License-Identifier: MIT
# What nvcc makes of kernels/mc_cuda.cu, without a device: no fused operation that the source did not ask for, nothing
# approximate, nothing spilled; and the host side against CUDA 12.6, the version of JetPack 6. TAP.
set -u
. "$(dirname "$0")/tap.sh"

if [ ! -f "$O/cuda.env" ]; then
	skip "machine code for the GPU" nvcc
	skip "the CUDA 12.6 runtime" nvcc
	done_testing
	exit 0
fi
# shellcheck disable=SC1091 # NVCC, NVCC_FLAGS
. "$O/cuda.env"

# ---- code ------------------------------------------------------------------------------------------

# fmaf as a product and a sum: what is still fused then was fused by the compiler
cat >"$tmp/apart.h" <<'EOF'
#include <math.h>
#include <cuda_runtime.h>
#define fmaf(a, b, c) ((a) * (b) + (c))
EOF

count() {
	grep -cE "$1" "$2"
}

for sm in 87 90; do
	# shellcheck disable=SC2086 # flags are words
	ok "PTX for sm_$sm" $NVCC $NVCC_FLAGS -ptx -arch=compute_$sm -o "$tmp/sm.ptx" kernels/mc_cuda.cu
	# shellcheck disable=SC2086
	ok "PTX for sm_$sm without fmaf" $NVCC $NVCC_FLAGS -include "$tmp/apart.h" -ptx -arch=compute_$sm \
		-o "$tmp/apart.ptx" kernels/mc_cuda.cu
	[ "$(count 'fma\.rn\.f32' "$tmp/sm.ptx")" -gt 100 ]
	report $? "sm_$sm: fused where the source says fmaf"
	is "sm_$sm: fused nowhere else" "$(count '\b(fma|mad)\.(rn\.)?f(32|64)' "$tmp/apart.ptx")" 0
	is "sm_$sm: f64 is never fused" "$(count '(fma|mad)\.(rn\.)?f64' "$tmp/sm.ptx")" 0
	is "sm_$sm: every sum and product is rounded, so ptxas may not fuse them" \
		"$(count '\b(add|sub|mul)\.f(32|64)' "$tmp/sm.ptx")" 0
	is "sm_$sm: nothing approximate, no flush to zero" "$(count '\.(approx|full|ftz)' "$tmp/sm.ptx")" 0
	is "sm_$sm: divisions and roots are rounded" "$(count '\b(div|sqrt|rcp)\.(f|full|approx)' "$tmp/sm.ptx")" 0
done
tools/ptxas-report "$O/kernels/mc_cuda.cu.o.log" >"$tmp/regs"
report $? "no kernel spills registers"
sed 's/^/#/' "$tmp/regs"

# ---- CUDA 12.6 -------------------------------------------------------------------------------------

old=$(echo build/venv/lib/python3*/site-packages/nvidia/cuda_runtime)
if [ -d "$old/include" ]; then
	for f in kernels/cuda_calls.c kernels/mc_cuda.c kernels/mc_cuda_roll.c kernels/mc_cuda_setup.c kernels/mc_cuda_time.c; do
		ok "$f compiles with CUDA 12.6's headers" gcc -std=gnu17 -D_GNU_SOURCE -Wall -Wextra -Werror -Ikernels \
			-isystem "$old/include" -c -o "$tmp/$(basename "$f").o" "$f"
	done
	nm -u "$tmp"/*.o | sed -n 's/^ *U \(cuda[A-Z].*\)/\1/p' | sort -u >"$tmp/used"
	nm -D --defined-only "$old/lib/libcudart.so.12" | awk '{ sub(/@.*/, "", $3); print $3 }' | sort -u >"$tmp/there"
	[ -s "$tmp/used" ]
	report $? "$(wc -l <"$tmp/used") symbols of the runtime are used"
	is "all of them are in CUDA 12.6's runtime" "$(comm -23 "$tmp/used" "$tmp/there" | xargs)" ""
else
	skip "the CUDA 12.6 runtime" nvidia-cuda-runtime-cu12
fi
done_testing
