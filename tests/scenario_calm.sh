#!/bin/sh
# Closed loops that call for nothing: no request, with the configuration that brakes in scenario_fmvss127.sh; the bundled
# drives and the recorded one with it too; what faulty sensors cost is told. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
objects=can-dbc/vehicles/generic-objects.conf
toyota=can-dbc/vehicles/toyota-tss-p.conf
settings="--set brake.accel=-9.5 --set vehicle.bound=friction --set road.mu=1.02"
recording=../shared/canlog/comma2k19-rav4-seg40-speed-radar.log.xz

ok "false-activation --short" "$AEBMC" scenario false-activation --short --json
cp "$tmp/out" "$tmp/calm.json"
json "no partial and no full request" "$tmp/calm.json" \
	'len(j["runs"]) >= 12 and not any(r["partial"] or r["full"] for r in j["runs"] if r["goal"] == "no request")'
json "none missed its goal" "$tmp/calm.json" 'j["sum"]["failed"] == 0 and j["sum"]["judged"] == len(j["runs"]) - 1'
json "where nobody brakes the car does not, whatever was asked for" "$tmp/calm.json" \
	'(lambda d: len(d) >= 6 and max(d) < 0.25 * 9.81)([max(r["peak_before_mps2"], r["peak_after_mps2"]) for r in j["runs"] if r["goal"] == "no request" and r["row"].split("-")[0] in ("plate", "parked", "overtake", "swerve", "curve")])'
json "no contact" "$tmp/calm.json" 'not any(r["contact"] for r in j["runs"])'
json "a plate that the radar calls a car is told as not passed" "$tmp/calm.json" \
	'[(r["goal"], r["passed"], r["full"] > 0) for r in j["runs"] if r["row"] == "plate-without-existence"] == [("unknowable", False, True)]'
json "runs that could request are told from those that could not" "$tmp/calm.json" \
	'{r["row"] for r in j["runs"] if not r["evaluations"]} == {"plate", "parked-pair", "curve-neighbour-60"}'
json "and judged by themselves too" "$tmp/calm.json" \
	'(lambda s: s["runs_evaluated"] == s["runs"] - 3 and s["judged_evaluated"] == s["judged"] - 3 and s["failed_evaluated_hi"] > s["failed_hi"] > 0)(j["sum"])'
ok "the rows" "$AEBMC" scenario false-activation --list
like "and the picture that they rest on" "$tmp/out" \
	"^plate-flickers +the radar's target: existence 0.45, from 80 m to 12 m, missed in 40 % of the scans$"
ok "plates that reach the evaluation" "$AEBMC" scenario false-activation --only plate --set radar.existence_min=0 --json
json "no request either" "$tmp/out" \
	'{r["row"]: (r["evaluations"] > 30, r["partial"] + r["full"], r["peak_after_mps2"]) for r in j["runs"] if r["goal"] == "no request"} == dict.fromkeys(("plate", "plate-flickers"), (True, 0, 0))'
exits "were they taken for what is followed" 1 "$AEBMC" scenario false-activation --only plate --set radar.existence_min=0 \
	--set perception.ghosts=no --json
json "they would be braked for" "$tmp/out" \
	'all(r["full"] for r in j["runs"]) and j["sum"]["failed"] == 2 and j["sum"]["added_deceleration_mps2"] > 9'
ok "in words" "$AEBMC" scenario false-activation --only plate
like "which rows could not" "$tmp/out" '^plate-flickers .* passed, never evaluated$'
like "and how many could" "$tmp/out" '^3 runs, 0 with contact, 1 with a request, 1 with an evaluation$'
like "what was added, and how much may be" "$tmp/out" '^deceleration that requests added .*: 0.00 m/s2 .*FMVSS 127: below 2.45'
like "nothing is said of none" "$tmp/out" '^0 of 0 with a goal and an evaluation missed it: 95 % interval 0 .. 100 %$'
like "not passed, and why" "$tmp/out" 'plate-without-existence .* not passed: the sensors say it is a car'
ok "drawn cars" "$AEBMC" scenario false-activation --only overtake --vehicles 3 --json
json "no request either" "$tmp/out" 'len(j["runs"]) == 9 and not any(r["full"] for r in j["runs"])'

ok "traffic --short" "$AEBMC" scenario traffic --short --json
json "braked for, what is no more than three scans is not" "$tmp/out" \
	'{r["row"]: (r["contact"], r["full"]) for r in j["runs"]} == {"cut-out-70-2s": (False, 1), "cut-in-50-20-1.5s": (False, 1), "ghost-follow-80-20m": (False, 0), "ghost-brake-80-20m-0.5g": (False, 1)}'
ok "were three scans enough" "$AEBMC" scenario traffic --only ghost-follow --set radar.confirm_scans=3 --json
json "it would be braked for" "$tmp/out" 'j["runs"][0]["full"] > 0 and j["runs"][0]["passed"] is False'

ok "degraded --short" "$AEBMC" scenario degraded --short --json
json "each fault" "$tmp/out" \
	'{r["row"].split("/")[0] for r in j["runs"]} == {"10Hz", "noise-told", "noise-untold", "dropouts", "latency", "rate-lag"}'

json "with what the daemon is told of it, and the hash of that" "$tmp/out" \
	'j["faults"][0]["set"] == ["radar.period=100"] and [f["fault"] for f in j["faults"] if f["config_hash"] == j["config_hash"]] == ["noise-untold", "dropouts", "latency", "rate-lag"]'
ok "in words" "$AEBMC" scenario degraded --only 10Hz/plate
like "a line for the fault" "$tmp/out" '^10Hz: 10 scans a second; radar.period=100, configuration [0-9a-f]{16}$'
hash=$(sed -n 's/^10Hz: .* //p' "$tmp/out")
ok "the same settings by hand" "$AEBMC" scenario false-activation --only plate --set radar.period=100
like "have that hash" "$tmp/out" "configuration $hash;"

"$AEBMC" generate --config $objects --drive follow --out "$tmp/drive.log"
ok "a log as a row, by every rule" "$AEBMC" scenario false-activation --only recorded-drive --log "$tmp/drive.log" --compare --json
json "the rules differ on it" "$tmp/out" \
	'{r["rule"]: (r["runs"], r["early_requests"]) for r in j["rules"]} == {"ttc": (1, 0), "autoware": (1, 0), "ad-rss": (1, 1), "paper": (1, 1), "aebmc": (1, 0)}'
"$AEBMC" generate --config $objects --drive brake --out "$tmp/drive.log"
"$AEBMC" scenario false-activation --only recorded-drive --log "$tmp/drive.log" --json >"$tmp/ours.json"
ok "one where braking is right, by time to collision" "$AEBMC" scenario false-activation --only recorded-drive \
	--log "$tmp/drive.log" --rule ttc --json
cp "$tmp/out" "$tmp/ttc.json"
ok "warns as ever and brakes at another time" python3 -c '
import json, sys
ours, ttc = (json.load(open(f))["runs"][0] for f in sys.argv[1:])
assert ours["full"] == ttc["full"] == 1 and ours["warn_s"] == ttc["warn_s"] and ours["full_s"] != ttc["full_s"], (ours, ttc)
' "$tmp/ours.json" "$tmp/ttc.json"

for drive in brake follow; do
	"$AEBMC" generate --config $objects --drive $drive --out "$tmp/drive.log"
	# shellcheck disable=SC2086 # several words
	ok "the drive $drive with the same configuration" "$AEBMC" replay --config $objects $settings --json "$tmp/drive.log"
	[ $drive = brake ] && full=1 || full=0
	json "$drive: $full full request" "$tmp/out" "j['full'] == $full and j['partial'] == 0"
done
if [ -r $recording ]; then
	xz -dc $recording >"$tmp/drive.log"
	# shellcheck disable=SC2086 # several words
	ok "the recorded drive with these settings" "$AEBMC" replay --config $toyota $settings --json "$tmp/drive.log"
	json "the recorded drive: no partial or full request" "$tmp/out" 'j["full"] == 0 and j["partial"] == 0 and j["evaluations"] > 1000'
	ok "as a row of the suite, through the recorded car's frames" "$AEBMC" scenario false-activation --config $toyota \
		--log "$tmp/drive.log" --short --json
	json "the same, warned once as in replay" "$tmp/out" \
		'[(r["warn"], r["partial"], r["full"]) for r in j["runs"] if r["row"] == "recorded-drive"] == [(1, 0, 0)]'
	json "plates are not passed by a radar that does not say how sure it is" "$tmp/out" \
		'{r["row"]: r["goal"] for r in j["runs"]}["plate"] == "unknowable" and j["sum"]["failed"] == 0'
else
	skip "the recorded drive" shared
	: >"$tmp/drive.log"
fi

"$AEBMC" scenario fmvss127 --live nosuch0 --only stopped-80 >"$tmp/out" 2>"$tmp/err"
is "live without CAN or its interface: one line" "$(wc -l <"$tmp/err")" 1
refuses 1 "$AEBMC" scenario false-activation --short --log "$tmp/nosuch.log"
refuses 2 "$AEBMC" scenario fmvss127 --log "$tmp/drive.log"
refuses 2 "$AEBMC" scenario false-activation --log "$tmp/drive.log" --vehicles 2
refuses 2 "$AEBMC" scenario fmvss127 --live vcan0 --compare
refuses 2 "$AEBMC" scenario fmvss127 --live "0123456789012345678901234567890123456789012345678901234567890123"
done_testing
