#!/bin/sh
# aebmc explain: on drives with one planted cause it names that cause first; the worst samples run again bit for bit;
# wrong use is refused. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
car=can-dbc/vehicles/generic.conf
toyota=can-dbc/vehicles/toyota-tss-p.conf

for drive in brake stopped; do
	ok "generate $drive" "$AEBMC" generate --config $car --drive $drive --out "$tmp/$drive.log"
done
ok "generate cutin" "$AEBMC" generate --config $toyota --drive cutin --out "$tmp/cutin.log"

# names WHAT DRIVE AT OPTION...: that input comes first, with a share well above the second
names() {
	what=$1 drive=$2 at=$3
	shift 3
	ok "explain $drive at $at s $*" "$AEBMC" explain --config $car --json --at "$at" "$@" "$tmp/$drive.log"
	json "$drive at $at s $*: $what comes first" "$tmp/out" \
		"j['inputs'][0]['name'] == '$what' and j['inputs'][0]['share'] > 2 * j['inputs'][1]['share']"
}

# friction and grade, each unknown alone
for at in 7 7.5 8 8.4; do
	names mu stopped $at --set road.mu_sigma=0.3
	names grade stopped $at --set road.grade_sigma=0.15
	names mu stopped $at --set road.mu_sigma=0.3 --set road.grade_sigma=0
done
# the lead brakes, from 20 s on
for at in 20.8 20.9 21; do
	names lead_accel brake $at
	names lead_accel brake $at --future driver
done
names lead_accel brake 20.5 # no sample collides yet: of the gap
json "where none collides the gap is explained" "$tmp/out" 'j["variance_of"] == "gap" and j["p"] == 0'
# not knowing what is there at all
ok "explain a ghost" "$AEBMC" explain --config $car --json --at 8.4 --future nobody --set perception.existence=0.6 \
	"$tmp/stopped.log"
json "a ghost: which object is met comes first" "$tmp/out" 'j["inputs"][0]["name"] == "met" and j["inputs"][0]["share"] > 0.9'
json "its risk if it were known to be there is higher" "$tmp/out" \
	'[i for i in j["inputs"] if i["name"] == "met"][0]["p_known"] > j["hi"]'

ok "explain --json" "$AEBMC" explain --config $car --at 20.9 --worst 5 --json "$tmp/brake.log"
cp "$tmp/out" "$tmp/brake.json"
json "the agreed keys" "$tmp/out" \
	'j["schema"] == "aebmc.explain.1" and j["time_s"] <= 20.9 and j["time_s"] > 20.8 and j["samples"] == 16384 and len(j["inputs"]) == 12 and len(j["worst"]) == 5 and j["future"] == "defer" and j["lo"] < j["p"] < j["hi"] and len(j["config_hash"]) == 16'
json "shares fall and lie within 0 and 1" "$tmp/out" \
	'all(1 >= a["share"] >= b["share"] >= 0 for a, b in zip(j["inputs"], j["inputs"][1:]))'
json "an input that is known explains nothing" "$tmp/out" \
	'[i for i in j["inputs"] if i["name"] == "tau"][0]["share"] == 0 and [i for i in j["inputs"] if i["name"] == "tau"][0]["sd"] == 0'
json "worst comes first" "$tmp/out" \
	'all(a["impact_mps"] >= b["impact_mps"] > 0 and a["gap_m"] <= 0 for a, b in zip(j["worst"], j["worst"][1:]))'
"$AEBMC" replay --config $car --csv "$tmp/brake.csv" "$tmp/brake.log" >"$tmp/words"
ok "the risk is the one that replay had" python3 -c 'import csv, json, sys
j = json.load(open(sys.argv[1]))
row = [r for r in csv.DictReader(open(sys.argv[2])) if int(r["evaluation"]) == j["evaluation"]][0]
assert abs(float(row["p_defer"]) - j["p"]) < 1e-8 and abs(float(row["impact_defer_mps"]) - j["impact_mps"]) < 1e-6
assert row["level_name"] == j["level"]' "$tmp/brake.json" "$tmp/brake.csv"

# samples as requests
ok "explain --requests" "$AEBMC" explain --config $car --at 20.9 --worst 20 --requests "$tmp/worst.requests" "$tmp/brake.log"
like "and in words" "$tmp/out" '^sample [0-9]*: impact at'
ok "they run again" "$AEBMC" replay --requests "$tmp/worst.requests" --config $car --json
json "all twenty, bit for bit" "$tmp/out" 'j["requests"] == 20 and j["equal"] == 20'
ok "--requests -" "$AEBMC" explain --config $car --at 20.9 --requests - "$tmp/brake.log"
like "a file of requests alone" "$tmp/out" '^# aebmc requests 1:'
is "three unless told" "$(grep -c '^(' "$tmp/out")" 3
ok "of a wide grade, worst samples within what the model is good for" "$AEBMC" explain --config $car --json \
	--set road.grade_sigma=0.2 --at 8 --worst 20 "$tmp/stopped.log"
json "no grade beyond 0.5 rad" "$tmp/out" 'len(j["worst"]) == 20 and all(abs(w["inputs"]["grade"]) <= 0.5 for w in j["worst"])'
ok "before the cut-in" "$AEBMC" explain --config $toyota --future driver --at 8.6 "$tmp/cutin.log"
like "the object that cuts in is met" "$tmp/out" 'a nearer object is met$'
ok "--worst 0" "$AEBMC" explain --config $car --at 20.9 --worst 0 "$tmp/brake.log"
is "shows none" "$(grep -c '^sample' "$tmp/out")" 0
ok "from standard input" sh -c "$AEBMC explain --config $car --at 20.9 - <$tmp/brake.log"

refuses 2 "$AEBMC" explain --config $car --at 1
refuses 2 "$AEBMC" explain --config $car "$tmp/brake.log"
like "it says what is needed" "$tmp/err" '\-\-at S is needed'
refuses 2 "$AEBMC" explain --at 1 "$tmp/brake.log"
refuses 2 "$AEBMC" explain --config $car --at x "$tmp/brake.log"
refuses 2 "$AEBMC" explain --config $car --at 1 --worst 101 "$tmp/brake.log"
refuses 2 "$AEBMC" explain --config $car --at 1 --future later "$tmp/brake.log"
refuses 2 "$AEBMC" explain --config $car --at 1 "$tmp/brake.log" "$tmp/stopped.log"
refuses 2 "$AEBMC" explain --config $car --at 1 --json --requests - "$tmp/brake.log"
refuses 2 "$AEBMC" explain --config $car --at 1 --requests "$tmp/brake.log" "$tmp/brake.log"
refuses 78 "$AEBMC" explain --config $car --set road.mu=9 --at 1 "$tmp/brake.log"
refuses 1 "$AEBMC" explain --config $car --at 1 "$tmp/none.log"
refuses 1 "$AEBMC" explain --config $car --at 0 "$tmp/brake.log"
like "it says when the first evaluation is" "$tmp/err" 'no evaluation by 0 s; the first is at'
refuses 1 "$AEBMC" explain --config $car --at 20.9 --requests "$tmp/no/such" "$tmp/brake.log"
head -n 5 "$tmp/brake.log" >"$tmp/short.log"
refuses 1 "$AEBMC" explain --config $car --at 20.9 "$tmp/short.log"
for out in "" --json "--requests -"; do
	# shellcheck disable=SC2086
	"$AEBMC" explain --config $car --at 20.9 $out "$tmp/brake.log" >/dev/full 2>"$tmp/err"
	is "a full disk is told in one line, exit 1 $out" "$? $(wc -l <"$tmp/err")" "1 1"
done
done_testing
