# SPDX-License-Identifier: MIT
# From the record so far (times and peak, aebmc bench) and ncu's CSV of tests/gpu/once.c: where the kernel stands, and
# from that a projection for the Jetson modules.
# t = warp instructions / (SMs * 4 schedulers * clock * issue utilisation measured here), or, if longer, the draws'
# bytes over the memory's bandwidth. The band is a factor of two either way: caches, clocks and schedulers differ.
BEGIN {
	split("paper's scene|moving lead|moving lead, counts alone|moving lead, four futures|paper's scene, first half|paper's scene, drawn on the device", name, "|")
	samples = 1048576
}

function fields(line, out,    n, i, c, q, s) {
	n = 0; s = ""; q = 0
	for (i = 1; i <= length(line); i++) {
		c = substr(line, i, 1)
		if (c == "\"") { q = !q } else if (c == "," && !q) { out[++n] = s; s = "" } else { s = s c }
	}
	out[++n] = s
	return n
}

/^Measured f32 peak:/ { peak = $4 }
/^fast, paper.s scene, statistics/ { took[1] = $(NF - 2) }
/^fast, moving lead, statistics/ { took[2] = $(NF - 2) }
/^fast, moving lead, four futures/ { took[4] = $(NF - 2) }
/^"ID"/ { n = fields($0, head); for (i = 1; i <= n; i++) { col[head[i]] = i } next }
/^"[0-9]+"/ {
	fields($0, f)
	id = f[col["ID"]] + 1
	v = f[col["Metric Value"]]
	gsub(/,/, "", v)
	value[id, f[col["Metric Name"]]] = v + 0
	unit[f[col["Metric Name"]]] = f[col["Metric Unit"]]
	rows = id > rows ? id : rows
}

function m(i, key) { return value[i, key] }

function f32_of(i) {
	return m(i, "smsp__sass_thread_inst_executed_op_ffma_pred_on.sum") + m(i, "smsp__sass_thread_inst_executed_op_fadd_pred_on.sum") + m(i, "smsp__sass_thread_inst_executed_op_fmul_pred_on.sum")
}

END {
	if (!rows) { print "not ok - no counters"; exit 1 }
	printf "Counters of one batch of %d samples each (ncu; clocks as they are):\n", samples
	printf "%-34s %9s %9s %9s %9s %9s %9s %9s %9s %9s\n", "", "us", "instr/", "lanes", "f32 ops/", "issue", "warps", "fma pipe", "alu pipe", "DRAM"
	printf "%-34s %9s %9s %9s %9s %9s %9s %9s %9s %9s\n", "", "", "sample", "of 32", "sample", "active %", "active %", "warp/smp", "warp/smp", "MB"
	for (i = 1; i <= rows; i++) {
		futures = i == 4 ? 4 : 1
		inst = m(i, "smsp__inst_executed.sum"); threads = m(i, "smsp__thread_inst_executed.sum")
		f32 = f32_of(i)
		us = m(i, "gpu__time_duration.sum") * (unit["gpu__time_duration.sum"] ~ /^n/ ? 1e-3 : 1)
		bytes = m(i, "dram__bytes_read.sum") * (unit["dram__bytes_read.sum"] ~ /^M/ ? 1 : unit["dram__bytes_read.sum"] ~ /^K/ ? 1e-3 : 1e-6)
		printf "%-34s %9.1f %9.0f %9.1f %9.0f %9.1f %9.1f %9.0f %9.0f %9.1f\n", name[i], us, inst * 32 / samples / futures, threads / inst, f32 / samples / futures, \
			m(i, "smsp__issue_active.avg.pct_of_peak_sustained_active"), m(i, "sm__warps_active.avg.pct_of_peak_sustained_active"), \
			m(i, "sm__inst_executed_pipe_fma.sum") * 32 / samples / futures, m(i, "sm__inst_executed_pipe_alu.sum") * 32 / samples / futures, bytes
	}
	print "Warps stalled for each instruction issued, by reason (moving lead): " \
		"fixed latency " m(2, "smsp__average_warps_issue_stalled_wait_per_issue_active.ratio") \
		", not selected " m(2, "smsp__average_warps_issue_stalled_not_selected_per_issue_active.ratio") \
		", memory " m(2, "smsp__average_warps_issue_stalled_long_scoreboard_per_issue_active.ratio") \
		", shared memory and roots " m(2, "smsp__average_warps_issue_stalled_short_scoreboard_per_issue_active.ratio") \
		", barrier " m(2, "smsp__average_warps_issue_stalled_barrier_per_issue_active.ratio")
	for (i = 1; i <= 4 && peak; i++) {
		if (took[i]) {
			printf "%s: %.1f T f32 additions, multiplications and fused ones a second in the bench above, %.0f %% of the measured peak\n", \
				name[i], f32_of(i) / took[i] * 1e-6, 100 * f32_of(i) / took[i] * 1e-6 / peak
		}
	}
	print ""
	print "PROJECTION, not a measurement: kernel time of one batch, ms, with a band of a factor of two either way."
	print "t = max(warp instructions / (SMs * 4 * clock * issue share), N * 48 bytes / bandwidth); issue share as measured here."
	print "The command that replaces it by a measurement, on the module: make check-gpu (or aebmc bench --backend cuda)."
	project("Jetson AGX Orin 64 GB", 16, 1.3e9, 204.8e9)
	project("Jetson Orin Nano 8 GB", 8, 0.625e9, 68e9)
}

function project(what, sms, clock, bandwidth,    k, i, t, b) {
	printf "%-24s %d SMs, %.3f GHz, %.0f GB/s:", what, sms, clock * 1e-9, bandwidth * 1e-9
	for (k = 1; k <= 3; k++) {
		i = k == 1 ? 1 : k == 2 ? 2 : 4
		t = 1e3 * m(i, "smsp__inst_executed.sum") / (sms * 4 * clock * m(i, "smsp__issue_active.avg.pct_of_peak_sustained_active") / 100)
		b = 1e3 * samples * 48 / bandwidth
		t = t > b ? t : b
		printf "  %s %.2f (%.2f .. %.2f)", k == 1 ? "paper's scene" : k == 2 ? "moving lead" : "four futures", t, t / 2, t * 2
	}
	t = 1e3 * m(4, "smsp__inst_executed.sum") / 64 / (sms * 4 * clock * m(4, "smsp__issue_active.avg.pct_of_peak_sustained_active") / 100)
	printf "  16,384 x 4 futures %.3f (%.3f .. %.3f)\n", t, t / 2, t * 2
}
