#!/bin/sh
# aebmc paper: all of the paper's figures, the GPU's as they stand in the record, and Table I in three forms. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
record=tests/gpu/record-h200.txt
dir=$tmp/paper

# figure NAME FILE EXPRESSION: as svg of cli_plot.sh, with what the record says: n, us (by column), stops
figure() {
	python3 - "$dir/$2.svg" "$3" "$record" >"$tmp/py" 2>&1 <<-'EOF'
		import math, re, sys, xml.etree.ElementTree as xml
		ns = "{http://www.w3.org/2000/svg}"
		root = xml.parse(sys.argv[1]).getroot()
		texts = [t.text for t in root.iter(ns + "text")]
		paths = {}
		for p in root.iter(ns + "path"):
		    paths.setdefault(p.get("class"), []).append(p.get("d"))
		dots = lambda d: d.count("h0")
		record = open(sys.argv[3]).read()
		date = re.search(r"make check-gpu: (\S{10})", record)[1]
		rows = [[float(w.strip("()")) for w in re.sub(r"[()]", " ", line).split()]
		        for line in record.splitlines() if re.match(r" +\d+ +[\d.]+ \(", line)]
		stops = re.findall(r"^# STOP \d+ (\S+)$", record, re.M)
		def decade(d, column): # px, from the first and the last dot
		    y = [float(v) for v in re.findall(r"M\S+ (\S+?)h0", d)]
		    return (y[0] - y[-1]) / math.log10(rows[-1][column] / rows[0][column])
		fits = dict(re.findall(r"^((?:paper|fast)_\d+_ms) = (\d+)$", record, re.M))
		sys.exit(0 if eval(sys.argv[2]) else "false: " + sys.argv[2] + " in " + str(texts) + str(paths)[:300])
	EOF
	tap_status=$?
	report $tap_status "$1"
	[ $tap_status -eq 0 ] || show "$tmp/py"
}

start=$(date +%s)
ok "paper" "$AEBMC" paper --out "$dir"
cp "$tmp/out" "$tmp/said"
echo "# took $(($(date +%s) - start)) s"
is "nothing on standard error" "$(cat "$tmp/err")" ""
is "one line for each file" "$(sed 's/:.*//' "$tmp/said" | sort)" "$(find "$dir" -type f | sort)"
is "which are" "$(cd "$dir" && echo ./*)" \
	"./budget.svg ./cpu-gpu.svg ./distribution.svg ./risk.svg ./speedup.svg ./table1.csv ./table1.md ./table1.svg ./table1.txt ./time.svg"

figure "CPU against GPU: every stop of the record, none of which differs here" cpu-gpu \
	"len(stops) == 256 and dots(paths['c0 d'][0]) == 256 and 'the same samples; largest difference 0.000000 m' in texts"
figure "it names GPU and day" cpu-gpu "any('NVIDIA H200' in t and date in t for t in texts)"
figure "and below, the differences in micrometres" cpu-gpu \
	"sum(dots(d) for d in paths['c0 d'][1:]) == 256 and len({d.split()[1] for d in paths['c0 d'][1:]}) == 1 and '[\u00b5m]' in texts"
for name in cpu-gpu distribution risk table1 time; do
	figure "$name: this machine and day" $name "any(re.search(r'\\w, $(date +%Y-%m)-\\d\\d($|, \\d+ threads)', t) for t in texts)"
done
figure "budget: no word across a bar" budget \
	"(lambda edges: len(edges) == 6 and all(e[1] <= 403 - 27 or e[0] >= 403 + 27 for e in edges))([(float(a) + 64, float(b) + 64) for k in ('c0 f', 'c1 f') for d in paths[k] for a, b in re.findall(r'M([0-9.]+) \S+H([0-9.]+)', d)])"
figure "distribution: mean and standard deviation as Sec. VI has them" distribution \
	"any(re.match(r'mean 79\.2\d m and one standard deviation, 12\.2\d m', t) for t in texts)"
figure "risk: three thresholds, near those of the paper" risk \
	"len(paths['c6 l t']) == 3 and any(re.match(r'100\.[4-8] m, 3\.3\d s', t) for t in texts) and any(re.match(r'11[12]\.\d m, 3\.7\d s', t) for t in texts)"
figure "risk: the paper's own beside them" risk "dots(paths['c3 d'][-1]) == 3 and 'the paper, N = 12,000' in texts"
figure "time: as many dots as the record has rows, ours up to a million" time \
	"len(rows) == 13 and sorted(dots(d) for k in ('c0 d', 'c1 d', 'c2 d', 'c4 d') for d in paths[k]) == [10, 13, 13, 13]"
figure "time: budget and machine" time "any('530 ms' in t for t in texts) and any('NVIDIA H200' in t and date in t for t in texts)"
figure "time: both of the GPU's lines are drawn to one logarithmic scale" time \
	"abs(decade(paths['c1 d'][0], 3) - decade(paths['c0 d'][0], 7)) < 0.02 * decade(paths['c1 d'][0], 3) and decade(paths['c1 d'][0], 3) > 20"
figure "speedup: three lines of the record and ours" speedup "sorted(dots(d) for k in ('c0 d', 'c1 d', 'c2 d', 'c4 d') for d in paths[k]) == [10, 13, 13, 13]"
figure "speedup: the paper's peaks" speedup "all(any(p in t for t in texts) for p in ('13.3', '29.8', '31.2', '54.6'))"
figure "budget: what the record says fits" budget \
	"all('%.2f million' % (int(fits['paper_%s_ms' % ms]) / 1e6) in texts and '%.2f billion' % (int(fits['fast_%s_ms' % ms]) / 1e9) in texts for ms in (400, 530, 800))"
figure "Table I as a picture" table1 "[dots(d) for d in paths['c3 d'] if dots(d) > 1] == [10, 10]"

"$AEBMC" converge --json --threads 1 >"$tmp/converge.json"
ok "Table I as CSV is what converge says" python3 -c 'import csv, json, sys
want = json.load(open(sys.argv[1]))["rows"]
got = list(csv.DictReader(open(sys.argv[2])))
assert len(got) == len(want) == 10
for g, w in zip(got, want):
    assert all(abs(float(g[k]) - w[k]) <= 1e-6 * abs(w[k]) for k in g), (g, w)' "$tmp/converge.json" "$dir/table1.csv"
is "as text" "$("$AEBMC" converge | tail -n 12)" "$(cat "$dir/table1.txt")"
is "as markdown: head, rule and ten rows" "$(grep -c '^| .* |$\|^|--:' "$dir/table1.md")" 12

# again, into what is there, with PNG
if command -v rsvg-convert >/dev/null; then
	ok "once more, with PNG" "$AEBMC" paper --png --out "$dir"
	is "still a line for each figure and table" "$(wc -l <"$tmp/out")" 10
	is "a PNG for each figure" "$(cd "$dir" && echo ./*.png)" \
		"./budget.png ./cpu-gpu.png ./distribution.png ./risk.png ./speedup.png ./table1.png ./time.png"
else
	skip "PNG" rsvg-convert
fi
refuses 77 env PATH=/nowhere "$AEBMC" paper --png --out "$tmp/none"

# the table that is built in
ok "the record as a table" tools/record-def "$record"
is "a row for each stop" "$(grep -c '^RECORD_STOP(0x1\.[0-9a-f]*p+[0-9]*)$' "$tmp/out")" 256
sed '/^# STOP/d' "$record" >"$tmp/stopless.txt"
exits "a record without stops makes no table" 1 tools/record-def "$tmp/stopless.txt"
is "and says what it lacks" "$(cat "$tmp/err")" "record-def: $tmp/stopless.txt: sections bench, budget and stops are needed"

# wrong
refuses 2 "$AEBMC" paper
refuses 2 "$AEBMC" paper "$dir"
refuses 1 "$AEBMC" paper --out "$tmp/no/such"
like "which names the folder" "$tmp/err" "no/such: No such file or directory"
: >"$tmp/file"
refuses 1 "$AEBMC" paper --out "$tmp/file"
like "and what stands in its place" "$tmp/err" "file/cpu-gpu.svg: Not a directory"
ln -sf /dev/full "$dir/table1.md"
exits "a full disk" 1 "$AEBMC" paper --out "$dir"
is "is told in one line" "$(cat "$tmp/err")" "aebmc paper: $dir/table1.md: No space left on device"
"$AEBMC" paper --out "$tmp/cut" >"$tmp/out" 2>"$tmp/err" &
child=$!
interrupt $child 0.3 2>/dev/null
wait $child
case $? in
1) is "Ctrl-C ends it with a word" "$(cat "$tmp/err")" "aebmc paper: interrupted" ;;
*) is "it was quicker than Ctrl-C" "$(cat "$tmp/err")" "" ;;
esac
done_testing
