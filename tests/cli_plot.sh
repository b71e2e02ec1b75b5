#!/bin/sh
# aebmc plot: each picture is well-formed and shows what the file holds; each wrong file is told in one line. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"

# svg NAME FILE EXPRESSION: the file is an SVG picture of which the Python expression holds. texts: its words; paths: the
# data of its marks by class; spans: its lanes; pieces: from and to which px of its panel each unbroken mark reaches; dots
# and points count those of a path.
svg() {
	python3 - "$2" "$3" >"$tmp/py" 2>&1 <<-'EOF'
		import re, sys, xml.etree.ElementTree as xml
		ns = "{http://www.w3.org/2000/svg}"
		root = xml.parse(sys.argv[1]).getroot()
		texts = [t.text for t in root.iter(ns + "text")]
		paths = {}
		for p in root.iter(ns + "path"):
		    paths.setdefault(p.get("class"), []).append(p.get("d"))
		spans = [(r.find(ns + "title").text, float(r.get("width"))) for r in root.iter(ns + "rect") if r.find(ns + "title") is not None]
		pieces = [(min(x), max(x)) for panel in root.iter(ns + "svg") if panel is not root for p in panel.iter(ns + "path")
		          for d in p.get("d").split("M")[1:] for x in [[float(v) for v in re.findall("(?:^|[LH])([0-9.-]+)", d)]]]
		pieces += [(x, x + float(r.get("width"))) for r in root.iter(ns + "rect") if r.find(ns + "title") is not None for x in [float(r.get("x"))]]
		dots = lambda d: d.count("h0")
		points = lambda d: len(re.findall("[ML]", d))
		raw = open(sys.argv[1], encoding="utf-8").read()
		assert root.tag == ns + "svg" and root.find(ns + "title").text
		assert raw.count("http") == 1 and not re.search(r"[ MLHV\"](-?nan|-?inf)", raw)
		sys.exit(0 if eval(sys.argv[2]) else "false: " + sys.argv[2] + " in " + str(texts) + str({k: [d[:80] for d in v] for k, v in paths.items()}) + str(spans))
	EOF
	tap_status=$?
	report $tap_status "$1"
	[ $tap_status -eq 0 ] || show "$tmp/py"
}

# says COMMAND...: fails with 1, one line, no output; the line matches $want
says() {
	refuses 1 "$@"
	like "which says: $want" "$tmp/err" "$want"
}

car="can-dbc/vehicles/generic.conf --set mc.samples=1024" # few, for the sanitizers
out=$tmp/out.svg
ok "curve" "$AEBMC" curve --samples 5000 --csv "$tmp/curve.csv" --json
cp "$tmp/out" "$tmp/curve.json"
json "curve: every sample but those that roll has its metre" "$tmp/curve.json" \
	'4990 <= sum(j["stops"]["count"]) <= 5000 and j["stops"]["count"][0] > 0 and j["stops"]["count"][-1] > 0'
ok "bench" "$AEBMC" bench --rounds 1 --json
cp "$tmp/out" "$tmp/bench.json"
json "bench: ten numbers of samples" "$tmp/bench.json" \
	'[r["n"] for r in j["figure"]] == [10**e * m for e in (3, 4, 5) for m in (1, 2, 5)] + [10**6] and all(0 < r["cpu_simd"]["p50_ns"] <= r["cpu_simd"]["p99_ns"] for r in j["figure"])'
ok "converge" "$AEBMC" converge --json
cp "$tmp/out" "$tmp/converge.json"
ok "a drive" "$AEBMC" generate --drive brake --out "$tmp/brake.log"
# shellcheck disable=SC2086 # $car is words
ok "replay" "$AEBMC" replay --config $car --csv "$tmp/replay.csv" "$tmp/brake.log"

# every kind
ok "risk of JSON" "$AEBMC" plot "$tmp/curve.json" --out "$out"
is "nothing is said" "$(cat "$tmp/out" "$tmp/err")" ""
rows=$(python3 -c 'import json, sys; print(len(json.load(open(sys.argv[1]))["curve"]))' "$tmp/curve.json")
svg "risk: a line with a point for each row" "$out" "max(map(points, paths['c0 l'])) == $rows"
svg "risk: an interval with two" "$out" "points(paths['c0 b'][0]) == 2 * $rows"
svg "risk: three thresholds, each with its headway in words" "$out" \
	"len(paths['c6 l t']) == 3 and sum(dots(d) for d in paths['c1 d']) == 4 and sum('s to collision' in t for t in texts) == 3"
ok "risk of CSV" "$AEBMC" plot risk "$tmp/curve.csv" --out "$out"
svg "the same line" "$out" "max(map(points, paths['c0 l'])) == $rows"
ok "distribution" "$AEBMC" plot distribution "$tmp/curve.json" --out "$out"
metres=$(python3 -c 'import json, sys; print(sum(c > 0 for c in json.load(open(sys.argv[1]))["stops"]["count"]))' "$tmp/curve.json")
svg "distribution: a bar for each metre that has samples" "$out" "sum(d.count('Z') for d in paths['c0 f']) == $metres"
svg "distribution: mean and spread" "$out" "any(t.startswith('mean 79.') for t in texts) and len(paths['c1 l t']) == 4"
ok "time" "$AEBMC" plot "$tmp/bench.json" --out "$out"
svg "time: ten dots, the reference, the budget" "$out" \
	"dots(paths['c2 d'][0]) == 10 and any('530 ms' in t for t in texts) and any('reference' in t for t in texts)"
ok "speedup" "$AEBMC" plot speedup "$tmp/bench.json" --out "$out"
svg "speedup: ten dots" "$out" "dots(paths['c2 d'][0]) == 10"
ok "converge" "$AEBMC" plot "$tmp/converge.json" --out "$out"
svg "converge: ten points of the paper in either panel" "$out" "[dots(d) for d in paths['c3 d'] if dots(d) > 1] == [10, 10]"
ok "timeline" "$AEBMC" plot "$tmp/replay.csv" --out "$out"
ego=$(tail -n +2 "$tmp/replay.csv" | cut -d, -f4 | grep -c .)
svg "timeline: a point of the ego's speed for each row that has one" "$out" "max(map(points, paths['c0 l'])) == $ego"
svg "timeline: the driver's risk beside it" "$out" "'if the driver brakes' in texts and points(paths['c4 l'][-1]) > 50"
svg "timeline: stages and states in words" "$out" \
	"[s[0] for s in spans if s[0] in ('none', 'warn', 'partial', 'full')][-1] == 'full' and 'BRAKE' in [s[0] for s in spans]"
svg "timeline: both lanes are full" "$out" "abs(sum(s[1] for s in spans) - 2 * (900 - 64 - 18)) < 3"
ok "the end of the drive" "$AEBMC" plot timeline "$tmp/replay.csv" --from 20 --to 22.5 --title "<a> & \"b\"" --out "$out"
svg "timeline: from, to and title as asked" "$out" "texts[0] == '<a> & \"b\"' and '22.4' in texts and '23' not in texts and '18' not in texts"

# eight to thirteen seconds cut out of the log: nothing is drawn there, in any panel or lane
awk '{ t = substr($1, 2) + 0; if (!from) from = t; if (t - from < 8 || t - from >= 13) print }' "$tmp/brake.log" >"$tmp/hole.log"
# shellcheck disable=SC2086 # $car is words
ok "a log with a hole" "$AEBMC" replay --config $car --csv "$tmp/hole.csv" "$tmp/hole.log"
ok "its timeline" "$AEBMC" plot "$tmp/hole.csv" --out "$out"
# crossing: how many marks there are between 8.5 and 13 s
crossing="(lambda px: sum(a < px(13) and b > px(8.5) for a, b in pieces))(lambda t: (t - ends[0]) / (ends[1] - ends[0]) * 818)"
ends=$(awk -F, 'NR == 2 { from = $1 } { to = $1 } END { print "[" from ", " to "]" }' "$tmp/hole.csv")
svg "nothing is drawn in it, and ARMED on either side" "$out" \
	"(lambda ends: $crossing)($ends) == 0 and len(pieces) > 20 and [s[0] for s in spans].count('ARMED') == 2"
"$AEBMC" plot "$tmp/replay.csv" --out "$out"
svg "where without it every line and lane goes on" "$out" "(lambda ends: $crossing)($ends) >= 10"

# figures of a GPU, as bench and budget write them
timing='{"p50_ns": 1e6, "p99_ns": 2e6}'
for n in 1000 100000; do
	row="$row${row:+,} {\"n\": $n, \"paper_with_copies\": $timing, \"fast_run\": $timing, \"cpu_simd\": $timing}"
done
echo "{\"schema\": \"aebmc.bench-cuda.1\", \"cpu\": \"C\", \"device\": {\"name\": \"G <1>\"}, \"cpu_scalar_ns\": 1e5, \"figure\": [$row]}" >"$tmp/cuda.json"
ok "time of a GPU" "$AEBMC" plot "$tmp/cuda.json" --out "$out"
svg "its name, and lines of two points" "$out" "any('G <1>' in t for t in texts) and [dots(paths[c + ' d'][0]) for c in ('c0', 'c1', 'c2')] == [2, 2, 2]"
ok "its speedup" "$AEBMC" plot speedup "$tmp/cuda.json" --out "$out"
svg "speedup: three lines" "$out" "[dots(paths[c + ' d'][0]) for c in ('c0', 'c1', 'c2')] == [2, 2, 2]"
fits='{"samples_400_ms": 25000, "samples_530_ms": 7047674, "samples_800_ms": 3247653809}'
echo "{\"schema\": \"aebmc.budget.1\", \"device\": \"G\", \"paper\": $fits, \"fast\": $fits}" >"$tmp/budget.json"
ok "budget" "$AEBMC" plot "$tmp/budget.json" --out "$out"
svg "budget: six bars with their numbers" "$out" \
	"sum(d.count('Z') for k in ('c0 f', 'c1 f') for d in paths[k]) == 6 and [t for t in texts if t in ('25,000', '7.05 million', '3.25 billion')] == ['25,000', '7.05 million', '3.25 billion'] * 2"

# pipes
"$AEBMC" plot - --out - <"$tmp/curve.json" 2>"$tmp/err" | cat >"$tmp/piped.svg"
is "from standard input into a pipe" "$?$(cat "$tmp/err")" "0"
"$AEBMC" plot "$tmp/curve.json" --out "$out"
ok "the same picture" cmp "$tmp/piped.svg" "$out"

# PNG
if command -v rsvg-convert >/dev/null; then
	for kind in timeline.replay.csv risk.curve.json; do
		ok "${kind%%.*} as PNG" "$AEBMC" plot "$tmp/${kind#*.}" --out "$tmp/out.png"
		ok "it is one, twice as large" python3 -c 'import struct, sys
head = open(sys.argv[1], "rb").read(24)
assert head[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">I", head[16:20])[0] in (1440, 1800)' "$tmp/out.png"
	done
	ln -s /dev/full "$tmp/full.png"
	want="full.png: No space left on device"
	says "$AEBMC" plot "$tmp/curve.json" --out "$tmp/full.png"
	want="no/such/out.png: No such file or directory"
	says "$AEBMC" plot "$tmp/curve.json" --out "$tmp/no/such/out.png"
else
	skip "PNG" rsvg-convert
fi
mkdir "$tmp/bin"
ln -s /bin/false "$tmp/bin/rsvg-convert"
want="failed.png: rsvg-convert failed"
says env PATH="$tmp/bin" "$AEBMC" plot "$tmp/curve.json" --out "$tmp/failed.png"
refuses 77 env PATH=/nowhere "$AEBMC" plot "$tmp/curve.json" --out "$tmp/none.png"
like "which names program and package" "$tmp/err" "needs rsvg-convert \(apt-get install librsvg2-bin\)"
is "and leaves no file" "$(ls "$tmp/none.png" 2>/dev/null)" ""

# wrong files
want="nothing.json: No such file or directory"
says "$AEBMC" plot "$tmp/nothing.json" --out "$out"
want="$tmp: Is a directory"
says "$AEBMC" plot "$tmp" --out "$out"
: >"$tmp/empty"
want="empty: is empty"
says "$AEBMC" plot "$tmp/empty" --out "$out"
printf 'time_s,evaluation,\000\n' >"$tmp/binary"
want="binary: is no text"
says "$AEBMC" plot "$tmp/binary" --out "$out"
want="brake.log: this is nothing that plot draws: JSON of curve, bench"
says "$AEBMC" plot "$tmp/brake.log" --out "$out"
echo '{"schema": "aebmc.replay.1"}' >"$tmp/other.json"
want="schema aebmc.replay.1 is nothing that plot draws"
says "$AEBMC" plot "$tmp/other.json" --out "$out"
want="curve.json: there is no picture 'speedup' of it, but risk, distribution"
says "$AEBMC" plot speedup "$tmp/curve.json" --out "$out"
for file in curve bench converge cuda budget; do
	size=$(wc -c <"$tmp/$file.json")
	for part in 3 2 1; do
		head -c $((size * part / 4)) "$tmp/$file.json" >"$tmp/cut.json"
		want="cut.json: is no whole JSON object: cut off\?"
		says "$AEBMC" plot "$tmp/cut.json" --out "$out"
	done
done
for file in curve replay; do
	size=$(wc -c <"$tmp/$file.csv")
	head -c $((size * 3 / 4)) "$tmp/$file.csv" >"$tmp/cut.csv"
	want="cut.csv: line [0-9]+ ends in the middle: cut off\?"
	says "$AEBMC" plot "$tmp/cut.csv" --out "$out"
	head -n 1 "$tmp/$file.csv" >"$tmp/cut.csv"
	want="cut.csv: no rows"
	says "$AEBMC" plot "$tmp/cut.csv" --out "$out"
done

# without WHAT FILE KIND WANT: the file with WHAT in it changed
without() {
	sed "s/$1/gone/" "$tmp/$2" >"$tmp/less.${2##*.}"
	want=$4
	says "$AEBMC" plot "$3" "$tmp/less.${2##*.}" --out "$out"
}
without '"curve":' curve.json risk "is no whole JSON object"
without stops curve.json distribution "there is no number 'stops.first_m'"
without mean_m curve.json distribution "there is no number 'mean_m'"
without sd_m curve.json distribution "there is no number 'sd_m'"
without samples curve.json distribution "there is no number 'samples'"
without reference_ns bench.json time "there is no number 'reference_ns'"
without p50_ns bench.json time "row 1 of 'figure' has no number 'cpu_simd.p50_ns'"
without fast_run cuda.json time "row 1 of 'figure' has no number 'fast_run.p50_ns'"
without cpu_scalar_ns cuda.json speedup "there is no number 'cpu_scalar_ns'"
without samples_530_ms budget.json budget "there is no number 'paper.samples_530_ms'"
without sd_se_m converge.json converge "row 1 of 'rows' has no number 'sd_se_m'"
without p_defer_lo replay.csv timeline "no column p_defer_lo"
without level_name replay.csv timeline "no column level_name"
without ',state,' replay.csv timeline "line 2 has [0-9]+ fields, the first line"
without risk_hi curve.csv risk "no column risk_hi"
without '^[0-9][0-9.]*' replay.csv timeline "line 2: time_s is 'gone"
sed 's/"lo":[0-9.e-]*/"lo":[]/g' "$tmp/curve.json" >"$tmp/odd.json"
want="row 1 of 'curve' has no number 'lo'"
says "$AEBMC" plot "$tmp/odd.json" --out "$out"
echo '{"schema": "aebmc.curve.1", "curve": []}' >"$tmp/rowless.json"
want="there are no rows in 'curve'"
says "$AEBMC" plot "$tmp/rowless.json" --out "$out"
sed 's/"count":\[/"count":[null,/' "$tmp/curve.json" >"$tmp/null.json"
want="row 1 of 'stops.count' is no number"
says "$AEBMC" plot distribution "$tmp/null.json" --out "$out"
sed 's/"count":\[.*\]/"count":[]/' "$tmp/curve.json" >"$tmp/null.json"
want="there are no counts in 'stops.count'"
says "$AEBMC" plot distribution "$tmp/null.json" --out "$out"
python3 -c 'import json, sys
j = json.load(open(sys.argv[1]))
j["figure"] = j["figure"] * 4
json.dump(j, open(sys.argv[2], "w"))' "$tmp/bench.json" "$tmp/long.json"
want="more than 32 rows in 'figure'"
says "$AEBMC" plot "$tmp/long.json" --out "$out"
want="fewer than two rows between --from and --to"
says "$AEBMC" plot "$tmp/replay.csv" --from 1000 --out "$out"

# numbers that no axis can show are no reason to fail
sed 's/"n":[0-9]*/"n":0/; s/"reference_ns":[0-9.]*/"reference_ns":1e308/' "$tmp/bench.json" >"$tmp/odd.json"
ok "figures that a logarithm does not have" "$AEBMC" plot "$tmp/odd.json" --out "$out"

# wrong arguments
refuses 2 "$AEBMC" plot --out "$out"
refuses 2 "$AEBMC" plot "$tmp/curve.json"
refuses 2 "$AEBMC" plot risk "$tmp/curve.json" more --out "$out"
refuses 2 "$AEBMC" plot "$tmp/replay.csv" --from 5 --to 5 --out "$out"
refuses 2 "$AEBMC" plot "$tmp/replay.csv" --from soon --out "$out"
refuses 2 "$AEBMC" plot timline "$tmp/replay.csv" --out "$out"
like "with the nearest name" "$tmp/err" "'timline' is not known; nearest is 'timeline'"
refuses 2 "$AEBMC" plot "$tmp/curve.json" --out "$tmp/curve.json"
json "the input is as it was" "$tmp/curve.json" 'j["samples"] == 5000'

# nowhere to write
want="/dev/full: No space left on device"
says "$AEBMC" plot "$tmp/curve.json" --out /dev/full
want="no/out.svg: No such file or directory"
says "$AEBMC" plot "$tmp/curve.json" --out "$tmp/no/out.svg"
"$AEBMC" plot "$tmp/curve.json" --out - >/dev/full 2>"$tmp/err"
is "standard output is full" $? 1
like "and says so" "$tmp/err" "^aebmc: standard output: (write failed|No space left on device)$"
is "once" "$(wc -l <"$tmp/err")" 1
python3 - "$AEBMC" plot "$tmp/replay.csv" --out - 2>"$tmp/err" <<-'EOF'
	import os, subprocess, sys
	r, w = os.pipe()
	os.close(r)
	sys.exit(subprocess.call(sys.argv[1:], stdout=w))
EOF
is "whoever read is gone" $? 1
is "in one line" "$(wc -l <"$tmp/err")" 1
done_testing
