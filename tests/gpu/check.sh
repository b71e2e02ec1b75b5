#!/bin/sh
# SPDX-License-Identifier: MIT
# Everything about the CUDA backend on a machine with a GPU: equality, faults, flips, sanitizers, code, latency, tables.
# Needs the built programs and nvcc alone. All output also goes to $O/gpu/record.txt. Figures are stated beside their
# targets; what fails is what is wrong. Called by make check-gpu.
# SKIP="bench budget" leaves sections out; REFERENCE=N shortens the comparison of reference rollouts.
set -u
cd "$(dirname "$0")/../.." || exit 1
O=${O:-build}
T=$O/tests/gpu
dir=$O/gpu
mkdir -p "$dir"
record=$dir/record.txt
: >"$record"
exec 3>&1

say() {
	printf '%s\n' "$@" | tee -a "$record" >&3
}

# section NAME: a heading; fails if it is left out
section() {
	case " ${SKIP:-} " in *" $1 "*) return 1 ;; esac
	say "" "==== $1"
}

# run COMMAND...: its output into the record; not ok if it fails
failed=0 passed=0 skipped=0
run() {
	say "\$ $*"
	"$@" >"$dir/out" 2>&1
	status=$?
	say "$(cat "$dir/out")"
	count
	if [ $status -ne 0 ] && ! grep -q '^not ok' "$dir/out"; then
		failed=$((failed + 1))
		say "not ok - exit code $status: $*"
	fi
}

count() {
	passed=$((passed + $(grep -c '^ok .*' "$dir/out")))
	skipped=$((skipped + $(grep -c '^ok .*# SKIP' "$dir/out")))
	passed=$((passed - $(grep -c '^ok .*# SKIP' "$dir/out")))
	failed=$((failed + $(grep -c '^not ok' "$dir/out")))
}

say "aebmc, make check-gpu: $(date -u +%Y-%m-%dT%H:%M:%SZ)"
say "$("$O/aebmc" --version)" "$(uname -srm), $(nproc) processors, $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1)"
say "$(nvidia-smi --query-gpu=name,driver_version,clocks.max.sm,clocks.max.mem,clocks.sm,temperature.gpu,power.draw \
	--format=csv 2>/dev/null || echo 'no nvidia-smi')"

if section equality; then
	run "$T/equal" 1048576 "${REFERENCE:-1048576}"
fi
if section stops; then
	run "$T/stops"
fi
if section code; then
	run tests/cuda_code.sh
fi
if section faults; then
	run "$T/faults"
	run "$T/inject"
	run "$T/quiet"
	run "$T/locked"
fi
if section flips; then
	run "$T/flips" 10000
fi
if section sanitizer; then
	for tool in memcheck racecheck initcheck; do
		if compute-sanitizer --tool $tool "$T/equal" 64 16 >"$dir/out" 2>&1 || ! grep -q 'Device not supported' "$dir/out"; then
			run compute-sanitizer --tool $tool --error-exitcode 1 "$T/equal" 4096 64
		else
			say "ok - compute-sanitizer $tool # SKIP needs compute-sanitizer that supports this device"
			skipped=$((skipped + 1))
		fi
	done
fi
if section latency; then
	say "targets: spinning p50 <= 40, p99 <= 80 us; sleeping p50 <= 150, p99 <= 300 us"
	run "$T/substages"
	run "$T/latency" 100000
	run "$T/latency" 20000 load
fi
if section rare; then
	say "targets: 500,000,000 samples within 530 ms, relative standard error below 5 % at a risk of 1e-6"
	run "$T/rare"
fi
if section verify; then
	run "$O/aebmc" verify --backend cuda
fi
if section bench; then
	say "targets: paper's scene >= 1,500 x the paper's kernel, moving lead >= 1,000 x, at N = 1,048,576"
	run "$O/aebmc" bench --backend cuda
fi
if section budget; then
	run "$O/aebmc" budget --out "$dir/calibration.txt"
	say "$(cat "$dir/calibration.txt")"
fi
if section counters; then
	metrics=smsp__inst_executed.sum,smsp__thread_inst_executed.sum,smsp__issue_active.avg.pct_of_peak_sustained_active
	metrics=$metrics,sm__warps_active.avg.pct_of_peak_sustained_active,gpu__time_duration.sum
	metrics=$metrics,smsp__sass_thread_inst_executed_op_ffma_pred_on.sum,smsp__sass_thread_inst_executed_op_fadd_pred_on.sum
	metrics=$metrics,smsp__sass_thread_inst_executed_op_fmul_pred_on.sum,sm__inst_executed_pipe_fma.sum
	metrics=$metrics,sm__inst_executed_pipe_alu.sum,sm__inst_executed_pipe_xu.sum,sm__inst_executed_pipe_lsu.sum,dram__bytes_read.sum
	metrics=$metrics,smsp__average_warps_issue_stalled_wait_per_issue_active.ratio
	metrics=$metrics,smsp__average_warps_issue_stalled_long_scoreboard_per_issue_active.ratio
	metrics=$metrics,smsp__average_warps_issue_stalled_not_selected_per_issue_active.ratio
	metrics=$metrics,smsp__average_warps_issue_stalled_short_scoreboard_per_issue_active.ratio
	metrics=$metrics,smsp__average_warps_issue_stalled_barrier_per_issue_active.ratio
	if ncu --version >/dev/null 2>&1; then
		ncu --clock-control none --profile-from-start off -k regex:batch --csv --metrics "$metrics" "$T/once" \
			>"$dir/ncu.csv" 2>"$dir/ncu.err"
		say "$(awk -f tests/gpu/counters.awk "$record" "$dir/ncu.csv")"
	else
		say "ok - hardware counters # SKIP needs ncu"
		skipped=$((skipped + 1))
	fi
fi
say "" "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
