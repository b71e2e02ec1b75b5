#!/bin/sh
# aebmc inputs: a car that nobody has seen, read right and wrong in one way each; a recorded drive; bad arguments. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
car=can-dbc/vehicles/generic.conf
toyota=can-dbc/vehicles/toyota-tss-p.conf
recording=../shared/canlog/comma2k19-rav4-seg40-speed-radar.log.xz
python=build/venv/bin/python

# arguments, configurations, logs
refuses 2 "$AEBMC" inputs
refuses 2 "$AEBMC" inputs drive.log
like "it says where a configuration comes from" "$tmp/err" "aebmc map"
refuses 2 "$AEBMC" inputs --config $car
refuses 2 "$AEBMC" inputs --config $car a.log b.log
refuses 2 "$AEBMC" inputs --config $car --seconds 0 a.log
refuses 78 "$AEBMC" inputs --config "$tmp/nosuch.conf" a.log
refuses 1 "$AEBMC" inputs --config $car "$tmp/nosuch.log"
like "it names the mapping's interfaces" "$tmp/err" "nosuch.log: no such file, and not one of bus.interfaces: can0$"
refuses 1 "$AEBMC" inputs --config $car can9
refuses 1 "$AEBMC" inputs --config $car "$tmp"
refuses 1 "$AEBMC" inputs --config $car /dev/null
like "there is no frame in it" "$tmp/err" "/dev/null: no frame in it"
head -c 100000 /dev/urandom >"$tmp/random.log"
refuses 1 "$AEBMC" inputs --config $car "$tmp/random.log"
if ! grep -q '^can ' /proc/net/protocols 2>/dev/null && ! [ -d /proc/net/can ]; then
	refuses 1 "$AEBMC" inputs --config $car can0
	like "an interface where the kernel has no CAN" "$tmp/err" "modprobe"
fi

# a made-up drive: nothing is wrong
ok "generate a drive" "$AEBMC" generate --drive cutin --out "$tmp/cutin.log"
ok "its own mapping is right" "$AEBMC" inputs --config $car "$tmp/cutin.log"
is "and nothing is called wrong" "$(grep -c '^WRONG' "$tmp/out")" 0
like "the relative speed is compared with the distance" "$tmp/out" '^good +LEAD\.REL_SPEED: .*change of the distance'
like "every message has a row" "$tmp/out" '^LEAD +110 can0 +600 +20\.0 +20\.0 .*e2e-p2 0 bad +0 jumps$'
like "every signal has a row" "$tmp/out" '^LEAD\.DIST_LONG +distance +[0-9.]+ m .* \.\. '
like "what cannot be told is not told" "$tmp/out" '^unknown +EGO\.SPEED: not enough data'
ok "the same as JSON" "$AEBMC" inputs --config $car --json "$tmp/cutin.log"
json "with its schema" "$tmp/out" \
	'j["schema"] == "aebmc.inputs.1" and j["wrong"] is False and j["frames"] == 3600 and j["interrupted"] is False'
json "messages" "$tmp/out" \
	'[m["name"] for m in j["messages"]] == ["EGO", "DRIVER", "LEAD"] and all(abs(m["rate_hz"] / m["should_hz"] - 1) < 0.01 and m["wrong_checksum"] == 0 for m in j["messages"])'
json "signals" "$tmp/out" \
	'{s["role"] for s in j["signals"]} == {"ego_speed", "yaw_rate", "driver_brake", "driver_accel", "distance", "rel_speed", "lateral", "valid", "existence"} and all(s["min"] <= s["value"] <= s["max"] for s in j["signals"])'
json "verdicts" "$tmp/out" \
	'all(v["level"] in ("WRONG", "doubt", "unknown", "good") and v["what"] for v in j["verdicts"])'
ok "from standard input, and not to its end" sh -c "\"$AEBMC\" inputs --config $car --seconds 5 --json - <\"$tmp/cutin.log\""
json "5 s of it" "$tmp/out" '5 <= j["seconds"] < 5.1'

# too little data: no verdict on it
head -n 100 "$tmp/cutin.log" >"$tmp/short.log"
ok "a short log" "$AEBMC" inputs --config $car "$tmp/short.log"
is "lets nothing be called wrong" "$(grep -c '^WRONG' "$tmp/out")" 0
like "nor good" "$tmp/out" '^unknown +LEAD\.REL_SPEED: not enough data'

# wrong LEVEL NAME WHAT CHANGE LOG OPTION...: one mistake in the mapping is named, with what to change
wrong() {
	level=$1 name=$2 what=$3 change=$4 log=$5
	shift 5
	exits "$name" "$([ "$level" = WRONG ] && echo 1 || echo 0)" "$AEBMC" inputs "$log" "$@"
	like "$name: named" "$tmp/out" "^$level +$what"
	like "$name: what to change" "$tmp/out" "^ +change: .*$change"
}
wrong WRONG "a sign" 'LEAD\.REL_SPEED: the relative speed has the wrong sign: where the distance (shrinks|grows) by [0-9.]+ m/s, the signal says' \
	'rel_speed. negate = yes' "$tmp/cutin.log" --config $car --set 'signal rel_speed.negate=yes'
wrong WRONG "distances turned round" 'LEAD\.DIST_LONG: 100 % of the distances are negative' 'negate' \
	"$tmp/cutin.log" --config $car --set 'signal distance.negate=yes'
wrong WRONG "centimetres" 'LEAD\.REL_SPEED: in [0-9]+ stretches .* 0\.01 times' 'unit' \
	"$tmp/cutin.log" --config $car --set 'signal distance.unit=cm' --set 'radar.range_max=300'
wrong doubt "a period" 'EGO: a frame every 20 ms, the mapping says 25' 'message EGO. period = 20' \
	"$tmp/cutin.log" --config $car --set 'message EGO.period=25'
wrong WRONG "a period far off" 'EGO: a frame every 20 ms, the mapping says 5 ms' 'message EGO. period = 20' \
	"$tmp/cutin.log" --config $car --set 'message EGO.period=5'
wrong WRONG "a check" 'EGO: its checksum is wrong in 149[0-9] of 1500 frames, and right as often as by chance \(check toyota\)' 'message EGO. check = e2e-p2' \
	"$tmp/cutin.log" --config $car --set 'message EGO.check=toyota'
wrong doubt "no check" 'LEAD: is not checked, but all 600 frames would pass check e2e-p2' 'message LEAD. check = e2e-p2' \
	"$tmp/cutin.log" --config $car --set 'message LEAD.check=none'
wrong WRONG "an interface" 'EGO: 0x100 does not come on can1, but 1500 times on can0' 'interface = can0' "$tmp/cutin.log" \
	--config $car --set 'bus.interfaces=can0 can1' --set 'message EGO.interface=can1' --set 'message DRIVER.interface=can0' \
	--set 'message LEAD.interface=can0'
wrong WRONG "an interface that is not listed" 'EGO: 0x100 does not come on can4, but 1500 times on can0' 'bus.interfaces' \
	"$tmp/cutin.log" --config $car --set bus.interfaces=can4

# logs that are wrong in one way
spoilt() { # SED-SCRIPT
	sed -E "$1" "$tmp/cutin.log" >"$tmp/spoilt.log"
}
spoilt '/ 100#/p'
wrong WRONG "sent twice" 'EGO: its counter repeats in 50 % of the frames: sent twice' 'second sender' \
	"$tmp/spoilt.log" --config $car
wrong WRONG "sent twice, without a counter" 'EGO: 50 % of the frames repeat the one just before: sent twice' 'second sender' \
	"$tmp/spoilt.log" --config $car --set 'message EGO.check=none'
spoilt '1~7{/ 110#/s/.$/F/}'
wrong WRONG "checksums that fail" 'LEAD: its checksum is wrong in [0-9]+ of 600 frames' 'disturbed' "$tmp/spoilt.log" --config $car
spoilt '/ 100#/s/..$//'
wrong WRONG "a length" 'EGO: 1500 of 1500 frames have 7 bytes, the database says 8' 'BO_' "$tmp/spoilt.log" --config $car
spoilt 's/ 100#/ 102#/'
wrong WRONG "an identifier" 'EGO: 0x100 does not come; nearest on can0 is 0x10[12]' 'BO_ 256' "$tmp/spoilt.log" --config $car
spoilt 's/( 110#....)..../\100E0/'
"$AEBMC" inputs --config $car --set 'message LEAD.check=none' "$tmp/spoilt.log" >"$tmp/out"
like "a slot without a target is no mistake" "$tmp/out" '^(doubt|good) +LEAD\.VALID'

# a terminal's end
"$AEBMC" inputs --config $car "$tmp/cutin.log" >/dev/full 2>"$tmp/err"
is "a full disk: exit 1" $? 1
is "in one line" "$(wc -l <"$tmp/err")" 1

# a car that nobody has seen
if "$python" -c 'import cantools' 2>/dev/null; then
	strange() { # PLANT: its DBC or log, wrong in one way
		"$python" tests/strange_car.py --dbc "$tmp/car.dbc" --log "$tmp/car.log" --plant "$1"
	}
	ok "a strange car" strange none
	ok "map writes its configuration" "$AEBMC" map "$tmp/car.dbc" "$tmp/car.log" --out "$tmp/car.conf"
	ok "which is right" "$AEBMC" inputs "$tmp/car.log" --config "$tmp/car.conf"
	is "and leaves nothing in doubt" "$(grep -cE '^(WRONG|doubt|unknown)' "$tmp/out")" 0
	like "standing objects drift as its yaw rate says" "$tmp/out" '^good +FAHRDYNAMIK\.GIERRATE: standing objects drift (1\.0|0\.9)[0-9] times'
	strange alone
	ok "a single target" "$AEBMC" inputs "$tmp/car.log" --config "$tmp/car.conf"
	like "the yaw rate is one of bends" "$tmp/out" '^good +FAHRDYNAMIK\.GIERRATE: times the speed up to [0-9.]+ m/s2'
	"$python" tests/strange_car.py --dbc "$tmp/car.dbc" --log "$tmp/car.log" --plant alone --seconds 3
	wrong doubt "a single target, km/h read as m/s" 'FAHRDYNAMIK\.FAHRZEUG_GESCHW: up to 6[0-9]\.[0-9] m/s \(23[0-9] km/h\)' 'unit = km/h or mph' \
		"$tmp/car.log" --config "$tmp/car.conf" --set 'signal ego_speed.unit=m/s'
	strange yaw_small
	ok "rad/s read as deg/s" "$AEBMC" inputs "$tmp/car.log" --config "$tmp/car.conf"
	like "is not called good" "$tmp/out" '^unknown +FAHRDYNAMIK\.GIERRATE: not enough data .* up to 0\.1[0-9] deg/s, 0\.0[0-9]+ m/s2'
	# planted PLANT WHAT CHANGE
	planted() {
		strange "$1"
		wrong WRONG "planted: $1" "$2" "$3" "$tmp/car.log" --config "$tmp/car.conf"
		is "planted: $1: nothing else is wrong" "$(grep '^WRONG' "$tmp/out" | grep -cvE "$2")" "${4:-0}"
	}
	planted sign 'ZIEL_00\.RELATIV_GESCHW and 3 more: .*wrong sign: where the distance shrinks by 22\.[0-9] m/s, the signal says \+22\.[0-9]' 'negate = yes'
	planted rel_unit 'ZIEL_00\.RELATIV_GESCHW and 3 more: .*looks like m/s read as km/h' 'unit = m/s'
	planted scale 'ZIEL_00\.RELATIV_GESCHW and 3 more: .*off by a factor: .*ratio 0\.78' 'scale'
	planted geschw_unit 'FAHRDYNAMIK\.FAHRZEUG_GESCHW: looks like km/h read as m/s' 'ego_speed. unit = km/h'
	planted order 'FAHRDYNAMIK\.FAHRZEUG_GESCHW: leaps by .* read with the other byte order' 'FAHRZEUG_GESCHW : 15.13@0' 1
	planted lateral 'ZIEL_00\.QUER_ABSTAND and 3 more: in bends standing objects drift to the wrong side' 'lateral'
	planted yaw_unit 'FAHRDYNAMIK\.GIERRATE: .*deg/s read as rad/s' 'yaw_rate. unit = deg/s'
	planted id 'FAHRDYNAMIK: 0x18FEF118 does not come; nearest on can3 is 0x18FEF117' 'BO_ 2566844696'
	planted twice 'FAHRDYNAMIK: its counter repeats in 50 %' 'second sender'
	planted frozen 'FAHRDYNAMIK\.FAHRZEUG_GESCHW: stays at exactly 13\.8' 'ego_speed'
	planted radar_frozen 'ZIEL_00 \(0x3A1\): its target stays at exactly 33\.3 m for 90 s, though the car drives.* \(and so: ZIEL_01 \(0x3A2\)\)$' 'radar or a gateway'
	is "planted: radar_frozen: nothing good, and no doubt, is said of targets" \
		"$(grep -cE '^(good|doubt) .*(ABSTAND|RELATIV_GESCHW|GUELTIG)' "$tmp/out")" 0
	planted slots_frozen 'ZIEL_00 \(0x3A1\): its target stays at exactly .* \(and so: ZIEL_01 \(0x3A2\)\)$' 'radar or a gateway'
	is "planted: slots_frozen: nothing good is said of distances" "$(grep -cE '^good .*(\.ABSTAND|GUELTIG)' "$tmp/out")" 0
	strange parked
	ok "a parked car is no mistake" "$AEBMC" inputs "$tmp/car.log" --config "$tmp/car.conf"
	like "but in doubt" "$tmp/out" '^doubt .*ZIEL_00\.ABSTAND and 3 more'
	is "parked: nothing good is said of distances" "$(grep -c '^good .*\.ABSTAND' "$tmp/out")" 0
	planted invalid 'ZIEL_00\.GUELTIG and 3 more: .*turned round' 'valid. negate'
else
	skip "a car that nobody has seen" cantools
fi

# a real one
if [ -r $recording ]; then
	xz -dc $recording >"$tmp/drive.log"
	ok "a recorded drive, read right" "$AEBMC" inputs --config $toyota "$tmp/drive.log"
	is "no false verdict" "$(grep -cE '^(WRONG|doubt)' "$tmp/out")" 0
	like "its relative speed is the change of its distance" "$tmp/out" '^good +TRACK_A_0\.REL_SPEED and 15 more: .*ratio 0\.9[0-9]|1\.0'
	like "standing objects confirm its speed" "$tmp/out" '^good +SPEED\.SPEED: [0-9]+ stretches of standing objects'
	wrong WRONG "recorded: a sign" 'TRACK_A_0\.REL_SPEED and 15 more: .*wrong sign: where the distance shrinks by 2\.[0-9] m/s, the signal says \+2' \
		'negate' "$tmp/drive.log" --config $toyota --set 'signal rel_speed.negate=yes'
	wrong WRONG "recorded: km/h" 'SPEED\.SPEED: looks like km/h read as m/s: .*WHEEL_SPEEDS' 'unit = km/h' "$tmp/drive.log" \
		--config $toyota --set 'signal ego_speed.unit=m/s'
	wrong WRONG "recorded: mph" 'SPEED\.SPEED: looks like another unit' 'unit' "$tmp/drive.log" \
		--config $toyota --set 'signal ego_speed.unit=mph'
	wrong WRONG "recorded: validity turned round" 'TRACK_A_0\.VALID and 15 more: .*turned round' 'negate' "$tmp/drive.log" \
		--config $toyota --set 'signal valid.negate=yes'
else
	skip "a recorded drive" shared
fi
done_testing
