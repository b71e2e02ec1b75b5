#!/bin/sh
# The figures, words and pictures that the README quotes, from the commands that it names. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"

# block TEXT: what the README prints in the fence after TEXT, or in the rest of the fence that TEXT is in
block() {
	awk -v text="$1" '/^```/ { fence = !fence; if (found && !fence) exit; next }
		found && fence { print }
		index($0, text) { found = 1 }' README.md
}

# quotes NAME TEXT FILE: each line of that block is one of the file, or the beginning of one where it ends in dots; how fast
# a machine is does not count
quotes() {
	block "$2" | python3 -c 'import re, sys
plain = lambda line: re.sub(r"; [0-9.]+ times real time", "", line.rstrip("\n"))
lines = [plain(line) for line in open(sys.argv[1])]
block = [plain(line) for line in sys.stdin]
wrong = [b for b in block if not any(l.startswith(b[:-3].rstrip()) if b.endswith("...") else l == b for l in lines)]
sys.exit("\n".join(wrong) if wrong or len(block) < 5 else 0)' "$3" 2>"$tmp/wrong"
	tap_status=$?
	report $tap_status "$1"
	[ $tap_status -eq 0 ] || { echo "# README.md says, $3 does not:"; show "$tmp/wrong"; }
}

# the demo
car=can-dbc/vehicles/generic.conf
mkdir "$tmp/drives"
ok "the demo's drive" "$AEBMC" generate --drive brake --out "$tmp/drives/brake.log"
ok "its replay" "$AEBMC" replay --config $car --csv "$tmp/brake.csv" "$tmp/drives/brake.log"
cp "$tmp/out" "$tmp/demo"
sed -n "s|^\t@echo '\(The last.*\)\$(O)\(.*\)'$|\n\1build\2|p" Makefile >>"$tmp/demo"
quotes "what make demo ends with" 'make demo` needs a C compiler' "$tmp/demo"
ok "its picture" "$AEBMC" plot "$tmp/brake.csv" --from 17 --title 'The lead brakes, the driver does nothing' --out "$tmp/timeline.svg"
ok "is the README's (tools/pictures/make)" cmp "$tmp/timeline.svg" tools/pictures/timeline.svg
ok "why there was a risk" "$AEBMC" explain --config $car --at 21 "$tmp/drives/brake.log"
cp "$tmp/out" "$tmp/explain"
quotes "is what the README quotes" '$ aebmc explain --config' "$tmp/explain"
"$AEBMC" generate --drive light --out "$tmp/drives/light.log"
{
	cat $car
	block 'bolder.conf is car.conf with'
} >"$tmp/bolder.conf"
cp can-dbc/vehicles/generic.dbc "$tmp/"
ok "another configuration" "$AEBMC" replay --compare $car "$tmp/bolder.conf" --pictures "$tmp" "$tmp/drives/brake.log" "$tmp/drives/light.log"
sed "s|$tmp/drives|drives|; s|$tmp/light|./light|" "$tmp/out" >"$tmp/compare"
quotes "does what the README says" 'tells for each log which warnings' "$tmp/compare"
is "every picture of the README is there" "$(sed -n 's/^!\[.*(\(.*\))$/\1/p' README.md | xargs ls 2>&1 >/dev/null)" ""

near='lambda x, want, tolerance: abs(x - want) <= tolerance'
for draws in sobol philox; do
	ok "curve --preset paper, $draws draws" "$AEBMC" curve --preset paper --samples 1500000 --draws $draws --json
	cp "$tmp/out" "$tmp/$draws"
	json "$draws: 1.5 M samples" "$tmp/$draws" 'j["samples"] == 1500000'
	json "$draws: mean" "$tmp/$draws" "($near)(j['mean_m'], 79.22, 0.05)"
	json "$draws: standard deviation" "$tmp/$draws" "($near)(j['sd_m'], 12.27, 0.05)"
	json "$draws: headway at 5 %" "$tmp/$draws" "($near)(j['headway_m']['0.05'], 100.6, 0.3)"
	json "$draws: headway at 1 %" "$tmp/$draws" "($near)(j['headway_m']['0.01'], 111.9, 0.4)"
	json "$draws: headway at 0.1 %" "$tmp/$draws" "($near)(j['headway_m']['0.001'], 127.7, 1.0)"
	json "$draws: time to collision at 1 %, Sec. VI" "$tmp/$draws" "($near)(j['ttc_s']['0.01'], 3.7, 0.05)"
done

# figures FILE: all but what names the machine's part in them
figures() {
	python3 -c 'import json, sys
j = json.load(open(sys.argv[1]))
print({k: v for k, v in j.items() if k not in ("threads", "variant")})' "$1"
}
"$AEBMC" curve --samples 300001 --threads 1 --json >"$tmp/one"
for threads in 2 4; do
	"$AEBMC" curve --samples 300001 --threads $threads --json >"$tmp/more"
	is "the same curve with $threads threads" "$(figures "$tmp/more")" "$(figures "$tmp/one")"
done

ok "verify" "$AEBMC" verify --json
cp "$tmp/out" "$tmp/verify"
json "100,000 scenes of each kind" "$tmp/verify" 'j["paper"]["scenes"] == j["moving"]["scenes"] == 100000'
json "they are hard: a third in contact, a third grazing" "$tmp/verify" \
	'j["moving"]["contacts"] > 30000 and j["moving"]["grazing"] > 30000'
json "stopping distance within 0.5 mm" "$tmp/verify" '0 < j["max_stop_dev_m"] <= 5e-4'
json "impact speed within 0.01 m/s" "$tmp/verify" '0 < j["max_impact_dev_mps"] <= 0.01'
json "no verdict differs" "$tmp/verify" 'j["verdict_mismatches"] == 0'
json "the same bits from all variants, 1, 2 and 4 threads" "$tmp/verify" \
	'j["bits_equal"] is True and j["threads_used"] == [1, 2, 4] and len(j["variants"]) >= 1'
json "the resident set's own error is stated" "$tmp/verify" \
	'all(abs(j["resident_set"][k]["error"]) < float(k) / 2 for k in ("0.05", "0.01", "0.001"))'
for variant in $(python3 -c 'import json, sys; print(*json.load(open(sys.argv[1]))["variants_skipped"])' "$tmp/verify"); do
	skip "bits of variant $variant" "$variant"
done
done_testing
