#!/bin/sh
# The figures that the README quotes, from the commands that it names. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"

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
