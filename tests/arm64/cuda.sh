#!/bin/sh
# SPDX-License-Identifier: MIT
# The CUDA backend for aarch64 and sm_87, linked against a runtime that has exactly the symbols used, and run: it says
# that there is no driver. TAP. O: the Arm build; HOST_O: the native build, which knows nvcc.
set -u
cd "$(dirname "$0")/../.." || exit 1
ARM=aarch64-linux-gnu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

if [ ! -f "$HOST_O/cuda.env" ]; then
	echo "1..1"
	echo "ok 1 - CUDA for Arm # SKIP needs nvcc"
	exit 0
fi
# shellcheck disable=SC1091 # NVCC, NVCC_FLAGS, CUDA_ROOT
. "$HOST_O/cuda.env"

n=0
report() {
	n=$((n + 1))
	if [ "$1" -eq 0 ]; then echo "ok $n - $2"; else
		echo "not ok $n - $2"
		sed 's/^/# /' "$dir/log"
	fi
}

# shellcheck disable=SC2086 # flags are words
$NVCC $NVCC_FLAGS -ccbin $ARM-g++ -I"$CUDA_ROOT/targets/x86_64-linux/include" -gencode arch=compute_87,code=sm_87 -c \
	-o "$dir/kernels.o" kernels/mc_cuda.cu >"$dir/log" 2>&1
report $? "mc_cuda.cu compiles for aarch64 and sm_87"
for f in cuda_calls mc_cuda mc_cuda_roll mc_cuda_setup mc_cuda_time; do
	$ARM-gcc -std=gnu17 -D_GNU_SOURCE -O2 -Wall -Wextra -Werror -ffp-contract=off -Ikernels \
		-isystem "$CUDA_ROOT/include" -c -o "$dir/$f.o" "kernels/$f.c" >"$dir/log" 2>&1
	report $? "$f.c compiles for aarch64"
done

# A runtime with no driver behind it: what the table of call sites lists, and what nvcc's host stubs need.
sed -n 's/^CUDA_SITE([A-Z_0-9]*, *\(cuda[A-Za-z0-9]*\),.*/\1/p' kernels/cuda_calls.def | sort -u >"$dir/listed"
nm -u "$dir/kernels.o" | sed -n 's/^ *U \(__cuda[A-Za-z]*\)$/\1/p' | sort -u >"$dir/stubs"
{
	sed 's/.*/int &(void) { return 35; }/' "$dir/listed" # cudaErrorInsufficientDriver
	sed 's/.*/void *&(void) { return 0; }/' "$dir/stubs"
} >"$dir/runtime.c"
$ARM-gcc -shared -fPIC -w -o "$dir/libcudart.so" "$dir/runtime.c" >"$dir/log" 2>&1
report $? "the stub runtime: $(wc -l <"$dir/listed") listed calls, $(wc -l <"$dir/stubs") of the host stubs"

cat >"$dir/main.c" <<'EOF'
#include <errno.h>
#include "mc_ops.h"
int main(void)
{
	const struct mc_params p = {.n_resident = 256, .threads = 1};
	struct mc_backend *b;

	return mc_cuda_ops.open(&p, &b) == -ENOSYS ? 0 : 1;
}
EOF
$ARM-gcc -std=gnu17 -Ikernels -o "$dir/main" "$dir/main.c" "$dir"/kernels.o "$dir"/cuda_calls.o "$dir"/mc_cuda*.o \
	"$O/libaebmc.a" -L"$dir" -lcudart -lm -lpthread -Wl,-rpath,"$dir" >"$dir/log" 2>&1
report $? "it links"
nm -D --undefined-only "$dir/main" | sed -n 's/^ *U \(_*cuda[A-Za-z0-9_]*\).*/\1/p' | sort -u >"$dir/used"
sort -u "$dir/listed" "$dir/stubs" | diff - "$dir/used" >"$dir/log" 2>&1
report $? "the symbols used are the symbols listed, no more and no fewer"
qemu-aarch64-static -L /usr/$ARM "$dir/main" >"$dir/log" 2>&1
report $? "without a driver the backend says so"
echo "1..$n"
