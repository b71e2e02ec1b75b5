#!/bin/sh
# aebmc replay --compare: what B gains and loses, told in words, JSON and pictures. TAP.
# shellcheck disable=SC2086 # $few and $both are words
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
a=can-dbc/vehicles/generic.conf
b=$tmp/deaf.conf
few="--set mc.samples=1024"
both="--compare $a $b"
cp can-dbc/vehicles/generic.dbc "$tmp/"
{
	cat $a
	printf '[decision]\np_warn = 0.9\np_defer = 0.9\np_driver = 0.9\n'
} >"$b"
for drive in brake light follow; do
	"$AEBMC" generate --drive $drive --out "$tmp/$drive.log"
done

# arguments
refuses 2 "$AEBMC" replay --compare $a
refuses 2 "$AEBMC" replay $both
like "it says what is missing" "$tmp/err" "LOG is missing"
refuses 2 "$AEBMC" replay $both --config $a "$tmp/brake.log"
refuses 2 "$AEBMC" replay $both --csv "$tmp/x.csv" "$tmp/brake.log"
refuses 2 "$AEBMC" replay $both --jobs 0 "$tmp/brake.log"
refuses 2 "$AEBMC" replay $both -
refuses 2 "$AEBMC" replay --config $a --jobs 2 "$tmp/brake.log"
refuses 2 "$AEBMC" replay --config $a --pictures "$tmp" "$tmp/brake.log"
refuses 2 "$AEBMC" replay --config $a "$tmp/brake.log" "$tmp/light.log"
refuses 78 "$AEBMC" replay --compare $a "$tmp/light.log" "$tmp/light.log"
refuses 78 "$AEBMC" replay $both --set mc.sample=3 "$tmp/light.log"

# words
ok "three logs" "$AEBMC" replay $both $few --pictures "$tmp" "$tmp/brake.log" "$tmp/light.log" "$tmp/follow.log"
is "no progress without a terminal" "$(cat "$tmp/err")" ""
cp "$tmp/out" "$tmp/words"
like "a warning is lost, with its time" "$tmp/words" '^  lost +1[0-9]\.[0-9]{2} s  warning, for [0-9.]+ s$'
like "the table has a row for each log" "$tmp/words" '^ +1 +0 +1 +0  \| +0 +0 +0 +0  \| +30\.0 s  .*/light\.log$'
like "and one for all" "$tmp/words" '^ +[0-9]+ +[0-9]+ +[0-9]+ +[0-9]+  \|.* 93\.4 s  all$'
like "a picture is named" "$tmp/words" "^  picture $tmp/light\.log\.svg$"
ok "it is there, and XML" python3 -c 'import sys, xml.dom.minidom as m; m.parse(sys.argv[1])' "$tmp/light.log.svg"
like "and shows what differs, five seconds more on either side" "$tmp/light.log.svg" \
	">A .*; [56]\.[0-9] to 1[5-9]\.[0-9] s of 30\.0 s</text>"
exits "none of a log without a difference" 1 test -e "$tmp/follow.log.svg"
awk '{ t = substr($1, 2) + 0; if (!from) from = t; if (t - from < 7 || t - from >= 8.5) print }' "$tmp/light.log" >"$tmp/hole.log"
ok "a log with a hole" "$AEBMC" replay $both $few --pictures "$tmp" "$tmp/hole.log"
for log in light.1 hole.2; do
	is "lines of ${log%.*} in so many pieces: ${log#*.}" "$(python3 -c 'import sys, xml.dom.minidom as m
panel = m.parse(sys.argv[1]).documentElement.getElementsByTagName("svg")[0]
print(*[p.getAttribute("d").count("M") for p in panel.getElementsByTagName("path")])' "$tmp/${log%.*}.log.svg")" "${log#*.} ${log#*.}"
done
ok "the other way round" "$AEBMC" replay --compare "$b" $a $few "$tmp/light.log"
like "it is gained" "$tmp/out" '^  gained +1[0-9]\.[0-9]{2} s  warning'

# JSON
ok "--json" "$AEBMC" replay $both $few --json --jobs 1 "$tmp/brake.log" "$tmp/light.log"
cp "$tmp/out" "$tmp/one.json"
json "schema, configurations, logs" "$tmp/one.json" \
	'j["schema"] == "aebmc.compare.1" and j["a"]["config_hash"] != j["b"]["config_hash"] and [l["evaluations"] > 100 for l in j["logs"]] == [True, True]'
json "what is lost, with its time" "$tmp/one.json" \
	'len(j["logs"][1]["warnings"]["lost"]) == 1 and 10 < j["logs"][1]["warnings"]["lost"][0]["time_s"] < 14 and j["all"]["warnings"]["lost"] >= 1 and j["all"]["warnings"]["gained"] == 0'
json "counts add up" "$tmp/one.json" \
	'all(len(d["kept"]) + len(d["lost"]) == d["a"] and len(d["kept"]) + len(d["gained"]) == d["b"] for l in j["logs"] for d in (l["warnings"], l["requests"]))'
ok "several at a time" "$AEBMC" replay $both $few --json --jobs 4 "$tmp/brake.log" "$tmp/light.log"
cp "$tmp/out" "$tmp/four.json"
ok "give the same" cmp "$tmp/four.json" "$tmp/one.json"
ok "a replay by itself" "$AEBMC" replay --config $a $few --json "$tmp/brake.log"
cp "$tmp/out" "$tmp/alone.json"
is "has the request at the same time" \
	"$(python3 -c 'import json, sys
c = json.load(open(sys.argv[1]))["logs"][0]["requests"]
print(*[s["time_s"] for s in c["lost"] + [k["a"] for k in c["kept"]]])' "$tmp/one.json")" \
	"$(python3 -c 'import json, sys
e = json.load(open(sys.argv[1]))["events"]
print(*[x["time_s"] for before, x in zip([{"level": "none"}] + e, e) if x["level"] == "full" != before["level"]])' "$tmp/alone.json")"

# what goes wrong
exits "a log that is not there" 1 "$AEBMC" replay $both $few "$tmp/none.log" "$tmp/light.log"
is "is told once" "$(wc -l <"$tmp/err")" 1
like "and named" "$tmp/err" "none.log: cannot read"
like "the others are compared" "$tmp/out" '1 +0  \|.*light\.log$'
like "its row says so" "$tmp/out" '^failed .*none\.log$'
ok "pictures into a folder that is not there" "$AEBMC" replay $both $few --pictures "$tmp/new" "$tmp/light.log"
ok "which is made" test -s "$tmp/new/light.log.svg"
refuses 1 "$AEBMC" replay $both $few --pictures "$tmp/words/x" "$tmp/light.log"
like "a folder that cannot be made is told" "$tmp/err" '/words/x: Not a directory$'
mkdir -p "$tmp/taken/light.log.svg"
exits "a picture that cannot be written" 1 "$AEBMC" replay $both $few --pictures "$tmp/taken" "$tmp/light.log"
is "is told once" "$(wc -l <"$tmp/err")" 1
is "and is not said to be there" "$(grep -c '^  picture' "$tmp/out")" 0

# a replay never writes over what it reads
cp $a "$tmp/own.conf"
for option in --csv --out; do
	refuses 2 "$AEBMC" replay --config "$tmp/own.conf" $option "$tmp/own.conf" "$tmp/brake.log"
	refuses 2 "$AEBMC" replay --config "$tmp/own.conf" $option "$tmp/generic.dbc" "$tmp/brake.log"
done
ok "the configuration is as it was" cmp "$tmp/own.conf" $a
ok "and the database" cmp "$tmp/generic.dbc" can-dbc/vehicles/generic.dbc
done_testing
