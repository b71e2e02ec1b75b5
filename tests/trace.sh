#!/bin/sh
# aebmc trace and report against a tracer: a made-up drive of which every figure is known, a flight recorder's snapshot, a
# replay, and frames that recording does not change. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
conf=can-dbc/vehicles/generic.conf
TMP=$tmp

refuses 2 "$AEBMC" trace
refuses 2 "$AEBMC" trace begin
refuses 2 "$AEBMC" trace start stop
refuses 2 "$AEBMC" report
refuses 2 "$AEBMC" report a b
if ! command -v lttng-sessiond >/dev/null || [ ! -e "$O/trace-lttng.so" ]; then
	skip "aebmc trace and report" lttng-tools
	done_testing
	exit
fi
refuses 1 "$AEBMC" report "$tmp"
like "a folder without a trace" "$tmp/err" 'no trace in this folder'
mkdir "$tmp/bad" && echo nonsense >"$tmp/bad/metadata"
refuses 1 "$AEBMC" report "$tmp/bad"
like "a trace that is none" "$tmp/err" 'not a readable trace'
nvtx="$O/aebmcd --config $conf --set trace.provider=nvtx --log"
if [ -e "$O/trace-nvtx.so" ]; then
	"$AEBMC" generate --drive brake --out "$tmp/nvtx.log"
	ok "the provider for Nsight without Nsight" $nvtx "$tmp/nvtx.log"
else
	exits "a provider that is not there" 1 $nvtx /dev/null
	like "is said to be missing" "$tmp/err" 'cannot load trace-nvtx.so: it was not built'
fi

# A session daemon of our own, unless one runs.
export LTTNG_HOME="$tmp"
if ! lttng list >/dev/null 2>&1; then
	lttng-sessiond >"$tmp/sessiond" 2>&1 &
	sessiond=$!
	trap 'kill $sessiond; wait $sessiond 2>/dev/null; rm -rf "$TMP"' EXIT
	until lttng list >/dev/null 2>&1; do sleep 0.1; done
fi

# ---- nowhere to write: no session stays behind
exits "trace start into nowhere" 1 "$AEBMC" trace start --out /proc/nowhere
refuses 1 "$AEBMC" trace on-miss --out /proc/nowhere
exits "nothing to stop" 1 "$AEBMC" trace stop

# ---- a made-up drive
ok "trace start" "$AEBMC" trace start --out "$tmp/drive"
ok "a drive" "$O/made-up-trace"
cp "$tmp/out" "$tmp/status.json"
refuses 1 "$AEBMC" trace start --out "$tmp/second"
like "a second session: how to end the first" "$tmp/err" 'recording already: end that with aebmc trace stop'
ok "trace stop" "$AEBMC" trace stop
ok "report" "$AEBMC" report "$tmp/drive" --html "$tmp/report.html"
like "in words: the stage over its budget" "$tmp/out" '^mc +989 .* 530\.000 +1 '
like "in words: the longest" "$tmp/out" '^mc: longest 600\.000 ms of 530 ms'
like "in words: the bursts" "$tmp/out" '^period +29 .* 1 +29 '
like "in words: it adds up" "$tmp/out" ' 29 missed = 2500, due .*: 2500, adds up'
like "in words: when and which" "$tmp/out" ' s  stage mc, 1 at cycle 400, 70\.000 ms over'
like "in words: the worst first" "$tmp/out" '^400 .* 600\.000 .*late'
ok "report --json" "$AEBMC" report "$tmp/drive" --json
cp "$tmp/out" "$tmp/report.json"
json "misses by kind" "$tmp/report.json" \
	'{k: v["count"] for k, v in j["misses"].items()} == {"stage": 1, "late": 1, "period": 29, "skipped": 11}'
json "their runs" "$tmp/report.json" '(j["misses"]["skipped"]["longest_run"] == 11 and j["misses"]["period"]["runs"] == 1 and
	abs(j["misses"]["period"]["chance_after_one"] - 28 / 29) < 1e-12 and j["misses"]["late"]["chance_after_one"] == 0)'
json "the right stage and cycle" "$tmp/report.json" \
	'[m for m in j["missed"] if m["kind"] == "stage"][0].items() >= {"stage": "mc", "cycle": 400, "count": 1, "late_ms": 70}.items()'
json "the worst, stage by stage" "$tmp/report.json" '(len(j["worst"]) == 10 and j["worst"][0]["cycle"] == 400 and
	j["worst"][0]["mc"] == 600 and j["worst"][0]["late"] and j["worst"][0]["total"] is None and j["worst"][1]["total"] > 0)'
json "within a batch" "$tmp/report.json" '(all(j["batch"][k]["n"] == 989 for k in ("wake", "batch", "gpu", "verify", "back")) and
	abs(j["batch"]["gpu"]["max_ms"] - 300) < 1e-3 and abs(j["batch"]["batch"]["max_ms"] - 480) < 1e-3)'
json "all frames are accounted for" "$tmp/report.json" '(j["request_frames"] == {"period_ms": 20, "in_time": 2471, "missed": 29,
	"due": 2500, "adds_up": True} and j["events_lost"] == 0 and j["events_unknown"] == 0 and not j["replay"])'
json "the daemon's histograms agree" "$tmp/report.json" "(lambda s: all(
	s[k]['n'] == v['n'] and s[k].get('misses') == v.get('misses') and s[k]['max_ms'] == v['max_ms'] and
	all(v[p] <= s[k][p] <= v[p] * 17 / 16 + 0.001025 for p in ('p50_ms', 'p95_ms', 'p99_ms', 'p99_9_ms'))
	for k, v in j['stages'].items()) and sorted(s) == sorted(j['stages']))(json.load(open('$tmp/status.json'))['stages'])"
# address FILE: how many lines name one that a browser might ask
address() {
	sed 's|xmlns="http://www\.w3\.org/2000/svg"||g' "$1" | grep -ciE '(src|href)[[:space:]]*=|url\(|@import|//[a-z0-9]'
}
json "the made-up car could be driven: the distance changes as the speeds say" "$tmp/report.json" '(lambda e: len(e) == 988 and
	all(abs(b["headway_m"] - a["headway_m"] - (b["lead_speed_mps"] - b["ego_speed_mps"] + a["lead_speed_mps"] - a["ego_speed_mps"]) / 2 *
	(b["time_s"] - a["time_s"])) < 0.05 for a, b in zip(e, e[1:]) if b["time_s"] - a["time_s"] < 0.2))(j["evaluations"])'
is "the page names no other address" "$(address "$tmp/report.html")" 0
sed 's|<title>|<title>http://www.w3.org.evil/|' "$tmp/report.html" >"$tmp/address.html"
is "where one is it would be seen" "$(($(address "$tmp/address.html") > 0))" 1
like "the page has the pictures" "$tmp/report.html" 'cycle 400, late'
like "and their headings" "$tmp/report.html" '<h2>The worst cycles</h2>'
exits "the page into nowhere" 1 "$AEBMC" report "$tmp/drive" --html /dev/full

# ---- a flight recorder
ok "trace on-miss" "$AEBMC" trace on-miss --out "$tmp/snap"
"$O/made-up-trace" 2 >/dev/null
for _ in 1 2 3 4 5 6 7 8 9 10; do
	find "$tmp/snap" -name metadata 2>/dev/null | grep -q . && break
	sleep 0.3
done
ok "trace stop" "$AEBMC" trace stop
ok "a snapshot was saved" "$AEBMC" report "$tmp/snap" --json
json "with the cycle that missed" "$tmp/out" \
	'any(m["kind"] == "stage" and m["cycle"] == 400 for m in j["missed"]) and j["worst"][0]["cycle"] == 400'

# ---- a replay
"$AEBMC" generate --drive brake --out "$tmp/brake.log"
"$O/aebmcd" --config $conf --log "$tmp/brake.log" --out "$tmp/plain.log" 2>/dev/null
ok "recorded" "$AEBMC" trace start --out "$tmp/replay"
ok "a replay" "$O/aebmcd" --config $conf --set trace.provider=lttng --log "$tmp/brake.log" --out "$tmp/traced.log"
ok "trace stop" "$AEBMC" trace stop
ok "recording changes no frame" cmp "$tmp/plain.log" "$tmp/traced.log"
ok "its report" "$AEBMC" report "$tmp/replay" --json
cp "$tmp/out" "$tmp/out.json"
json "says that it is one" "$tmp/out.json" '(j["replay"] and j["cycles"] == 463 and j["stages"]["total"]["n"] == 0 and
	j["stages"]["mc"]["p50_ms"] > 0.05 and len(j["evaluations"]) == 463 and j["request_frames"]["adds_up"])'
ok "its page" "$AEBMC" report "$tmp/replay" --html "$tmp/replay.html"
is "has every heading" "$(grep -o '<h2>[^<]*' "$tmp/replay.html" | cut -c5- | tr '\n' ',')" \
	"Where the time goes,How it is spread,What was missed,The worst cycles,Risk over time,"
ok "and the worst cycle's parts, one after the other" python3 -c 'import json, re, sys
worst = json.load(open(sys.argv[1]))["worst"][0]
page = open(sys.argv[2]).read()
svg = page[page.index("<h2>The worst cycles"):]
bars = [float(v) for v in re.findall(r"<rect class=\"c\d sp\" x=\"([0-9.]+)\" ", svg)][:4]
mc = re.search(r"width=\"([0-9.]+)\"[^>]*><title>mc ([0-9.]+) ms", svg)
input = re.search(r"width=\"([0-9.]+)\"[^>]*><title>input ([0-9.]+) ms", svg)
assert bars[0] == 0 and abs(bars[1] - float(input[1])) <= 0.2, bars
assert abs(float(mc[2]) - worst["mc"]) < 0.002 and "{:.3f}".format(worst["input"]) == input[2]
assert abs(float(mc[1]) / float(input[1]) - worst["mc"] / worst["input"]) < 0.05' "$tmp/out.json" "$tmp/replay.html"
json "with the risk" "$tmp/out.json" 'max(e["p"] for e in j["evaluations"]) > 0.9 and {e["level"] for e in j["evaluations"]} >= {"none", "full"}'

# ---- two at once: one reads the first half of its log, the other all of its own, the first the rest
mkfifo "$tmp/half"
traced="$O/aebmcd --config $conf --set trace.provider=lttng --out /dev/null --log"
ok "recorded" "$AEBMC" trace start --out "$tmp/two"
$traced "$tmp/half" 2>/dev/null &
first=$!
exec 3>"$tmp/half"
head -n 2000 "$tmp/brake.log" >&3 # more than a pipe holds
$traced "$tmp/brake.log" 2>/dev/null &
second=$!
wait $second
tail -n +2001 "$tmp/brake.log" >&3
exec 3>&-
wait $first
ok "trace stop" "$AEBMC" trace stop
refuses 1 "$AEBMC" report "$tmp/two"
like "two at once, and which" "$tmp/err" \
	"several processes in one trace, ($first \(463 evaluations\), $second|$second \(463 evaluations\), $first) \(463 evaluations\): choose one with --pid"
for pid in $first $second; do
	ok "one of them" "$AEBMC" report "$tmp/two" --pid "$pid" --json
	json "is whole" "$tmp/out" 'j["cycles"] == len(j["evaluations"]) == 463 and j["request_frames"]["adds_up"]'
done
refuses 1 "$AEBMC" report "$tmp/two" --pid 1
like "neither of them" "$tmp/err" "no process 1 in this trace, but $first "
refuses 2 "$AEBMC" report "$tmp/two" --pid none

# ---- one after the other: a daemon that was restarted is one story
ok "recorded" "$AEBMC" trace start --out "$tmp/again"
"$O/made-up-trace" >/dev/null
"$O/made-up-trace" >/dev/null
ok "trace stop" "$AEBMC" trace stop
ok "report of a restart" "$AEBMC" report "$tmp/again" --json
json "has both runs" "$tmp/out" '(j["cycles"] == 2 * 989 and j["misses"]["late"]["count"] == 2 and
	j["request_frames"]["due"] == 5000 and j["request_frames"]["adds_up"])'

# ---- damage
files=$(dirname "$(find "$tmp/replay" -name metadata)")
cp -r "$files" "$tmp/whole"
for size in 36 40 100 500 2000 4096 5000 $(($(wc -c <"$files/metadata") - 1)); do
	head -c "$size" "$tmp/whole/metadata" >"$files/metadata"
	refuses 1 timeout 60 "$AEBMC" report "$tmp/replay"
	like "metadata cut to $size bytes, and which" "$tmp/err" \
		"^aebmc report: $files: (its file metadata is cut off or damaged: copy .*|not a readable trace: cut off, .*)$"
done
for at in 24 28; do # sizes in a packet's head
	cp "$tmp/whole/metadata" "$files/metadata"
	printf '\001\001' | dd of="$files/metadata" bs=1 seek=$at conv=notrunc status=none
	refuses 1 timeout 60 "$AEBMC" report "$tmp/replay"
	like "a size in metadata that cannot be" "$tmp/err" 'its file metadata is cut off or damaged'
done
cp "$tmp/whole/metadata" "$files/metadata"
ok "whole again" "$AEBMC" report "$tmp/replay"
stream=$(find "$files" -maxdepth 1 -name 'aebmc_*' -size +32k | head -n 1)
for size in 10 4000 20000; do
	head -c $size "$tmp/whole/${stream##*/}" >"$stream"
	refuses 1 timeout 60 "$AEBMC" report "$tmp/replay"
	like "events cut to $size bytes" "$tmp/err" 'not a readable trace: cut off, damaged'
done

exits "nothing to stop" 1 "$AEBMC" trace stop
PATH=/nonexistent exits "without lttng" 77 "$AEBMC" trace start
done_testing
