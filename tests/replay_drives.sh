#!/bin/sh
# Made-up drives through aebmc replay: the same bytes with any number of threads and every time; the brakes are asked
# for where they must be and left alone where they must not. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
generic=can-dbc/vehicles/generic.conf
toyota=can-dbc/vehicles/toyota-tss-p.conf

# replay NAME CONFIG [OPTION...]: $tmp/NAME.log to .out, .json, .csv
replay() {
	name=$1 config=$2
	shift 2
	"$AEBMC" replay --config "$config" --out "$tmp/$name.out" --csv "$tmp/$name.csv" --json "$@" "$tmp/$name.log" \
		>"$tmp/$name.json" 2>"$tmp/err"
}

for config in $generic $toyota; do
	car=$(basename "$config" .conf)
	for drive in brake stopped follow cutin; do
		name=$drive-$car
		ok "generate $name" "$AEBMC" generate --config "$config" --drive $drive --out "$tmp/$name.log"
		ok "replay $name" replay "$name" "$config"
	done
	for drive in brake stopped; do
		json "$drive-$car: a warning, then a full request, once each" "$tmp/$drive-$car.json" \
			'j["warn"] == 1 and j["full"] == 1 and [e["level"] for e in j["events"] if e["level"] != "none"][0] == "warn" and j["events"][-1]["level"] == "full"'
		json "$drive-$car: the request asks for the configured deceleration" "$tmp/$drive-$car.json" \
			'j["events"][-1]["accel_mps2"] == -6'
		json "$drive-$car: the request comes with room to stop" "$tmp/$drive-$car.json" \
			'j["events"][-1]["headway_m"] > 15'
	done
	for drive in follow cutin; do
		json "$drive-$car: no request" "$tmp/$drive-$car.json" 'j["partial"] == 0 and j["full"] == 0'
	done
	json "stopped-$car: nothing was rejected" "$tmp/stopped-$car.json" 'not any(j["rejected"].values())'
	json "stopped-$car: every scan was evaluated" "$tmp/stopped-$car.json" 'j["evaluations"] > 0.95 * j["log_s"] * 20'
	# At the end the lead is hit if it is there. With quiet sensors what is left of a drop is the sampling: the later interval must not lie below the earlier one.
	for drive in brake stopped; do
		name=quiet-$drive-$car
		"$AEBMC" generate --config "$config" --set radar.range_sigma=0.01 --set radar.rate_sigma=0.01 \
			--set filter.ego_sigma=0.001 --drive $drive --out "$tmp/$name.log"
		ok "replay $name" replay "$name" "$config"
		ok "$name: the risk of braking now, later or by the driver only rises" python3 -c 'import csv, sys
rows = [r for r in csv.DictReader(open(sys.argv[1])) if r["p_defer"]]
last = rows[-1]
assert len(rows) > 100 and abs(float(last["p_defer"]) - float(last["p_lead"])) < 1e-4 < float(last["p_lead"]) - 0.98
for p in ("p_now", "p_defer", "p_driver"):
    drops = [b["time_s"] for a, b in zip(rows, rows[1:]) if float(b[p + "_hi"]) < float(a[p + "_lo"])]
    assert not drops, (p, drops)' "$tmp/$name.csv"
	done
done

name=brake-generic
cp "$tmp/$name.out" "$tmp/first.out"
cp "$tmp/$name.csv" "$tmp/first.csv"
for threads in 1 1 2 4; do
	replay "$name" $generic --threads $threads
	ok "the same frames again, $threads threads" cmp "$tmp/first.out" "$tmp/$name.out"
	ok "the same evaluations again, $threads threads" cmp "$tmp/first.csv" "$tmp/$name.csv"
done
"$AEBMC" replay --config $generic --out "$tmp/$name.out" - <"$tmp/$name.log" >"$tmp/words"
ok "the same frames from standard input" cmp "$tmp/first.out" "$tmp/$name.out"
replay "$name" $generic --set mc.seed=2
ok "another seed gives other frames" sh -c "! cmp -s $tmp/first.out $tmp/$name.out"

# requests on the bus as decoded: level and deceleration as the events say
"$AEBMC" decode --json "$tmp/first.out" >"$tmp/decoded"
json "the frames decode and their protection is good" "$tmp/decoded" 'j["bad"] == 0 and j["ours"] > 1000'
json "a full request is on the bus" "$tmp/decoded" 'any("full" in f["words"] for f in j["frames"])'
done_testing
