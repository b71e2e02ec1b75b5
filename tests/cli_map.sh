#!/bin/sh
# aebmc map: the shipped cars' roles from their DBC alone, a strange car and a recorded drive with their logs, never a guess
# without a word; bad arguments. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
cars=can-dbc/vehicles
recording=../shared/canlog/comma2k19-rav4-seg40-speed-radar.log.xz
python=build/venv/bin/python
d=$O/aebmcd

# arguments
refuses 2 "$AEBMC" map
refuses 2 "$AEBMC" map a.dbc b.log c.log
refuses 2 "$AEBMC" map $cars/generic.dbc -
refuses 2 "$AEBMC" map $cars/generic.dbc --role ego_sped=EGO.SPEED
like "it names the nearest role" "$tmp/err" "nearest name is 'ego_speed'"
refuses 2 "$AEBMC" map $cars/generic.dbc --role ego_speed
refuses 1 "$AEBMC" map "$tmp/nosuch.dbc"
refuses 1 "$AEBMC" map "$tmp"
refuses 1 "$AEBMC" map /dev/null
refuses 1 "$AEBMC" map $cars/generic.dbc "$tmp/nosuch.log"
refuses 1 "$AEBMC" map $cars/generic.dbc /dev/null
like "there is no frame in it" "$tmp/err" "/dev/null: no frame in it"
refuses 1 "$AEBMC" map $cars/generic.dbc --role ego_speed=EGO.SPED
like "it names the nearest signal" "$tmp/err" "message EGO has no signal 'SPED'; nearest is 'SPEED'"
refuses 1 "$AEBMC" map $cars/generic.dbc --role ego_speed=EGOS.SPEED
like "it names the nearest message" "$tmp/err" "no message 'EGOS'; nearest is 'EGO'"
refuses 1 "$AEBMC" map $cars/generic.dbc --role ego_speed=EGO
for role in ego_speed distance rel_speed; do
	refuses 1 "$AEBMC" map $cars/generic.dbc --role $role=none --out -
	like "$role cannot be none" "$tmp/err" "map: $role: cannot be none: "
done
refuses 1 "$AEBMC" map $cars/generic.dbc --role ego_speed=EGO.SPEED:furlong
like "it lists the units" "$tmp/err" "m/s, km/h"

# taken CONF ROLE SPEC: the configuration takes it
taken() {
	is "$2 is $3" "$(sed -n "/^\[signal $2\]/,/^\$/s/^from = \(.*[^ ]\) *#.*/\1/p" "$1" | sed 's/ *$//')" "$3"
}

# the shipped cars, from their DBC alone
for car in generic toyota-tss-p hyundai-kia-scc11 generic-objects ars408; do
	exits "$car" 0 "$AEBMC" map $cars/$car.dbc --out "$tmp/$car.conf" </dev/null
	ok "$car: aebmcd takes it" "$d" --check-config "$tmp/$car.conf"
	for role in ego_speed distance rel_speed lateral object_id object_count yaw_rate driver_brake; do
		want=$(sed -n "/^\[signal $role\]/,/^\$/s/^from = \([^#]*[^# ]\).*/\1/p" $cars/$car.conf)
		[ -z "$want" ] || taken "$tmp/$car.conf" $role "$want"
	done
done
like "generic: a DataIDList needs no words" "$tmp/generic.conf" '^\[message EGO\]$'
refuses 1 "$AEBMC" map $cars/aebmc.dbc

# files
exits "an existing file is left alone" 1 "$AEBMC" map $cars/generic.dbc --out "$tmp/generic.conf"
like "and says how to mend that" "$tmp/err" "generic.conf: File exists; --force writes over it"
ok "but not with --force" "$AEBMC" map $cars/generic.dbc --out "$tmp/generic.conf" --force --interface vcan9
like "interfaces of messages in no log" "$tmp/generic.conf" '^interfaces = vcan9$'
ok "to standard output" "$AEBMC" map $cars/generic.dbc --out -
cp "$tmp/out" "$tmp/stdout.conf"
ok "the configuration alone" "$d" --check-config "$tmp/stdout.conf"
cp $cars/generic.dbc "$tmp"
ok "beside its DBC" "$AEBMC" map "$tmp/generic.dbc" --out "$tmp/beside.conf"
like "it names the file alone" "$tmp/beside.conf" '^file = generic\.dbc$'
refuses 2 "$AEBMC" map "$tmp/generic.dbc" --out "$tmp/generic.dbc" --force
ok "which leaves it as it was" cmp "$tmp/generic.dbc" $cars/generic.dbc
exits "a full disk" 1 "$AEBMC" map $cars/generic.dbc --out /dev/full --force
is "in one line" "$(cat "$tmp/err")" "aebmc map: /dev/full: No space left on device"
exits "nowhere" 1 "$AEBMC" map $cars/generic.dbc --out "$tmp/no/such.conf"
ok "without --out nothing is written" "$AEBMC" map $cars/generic.dbc
like "but told" "$tmp/out" '^  taken  LEAD\.DIST_LONG '

# what is not clear is not guessed
sed 's/ ACCEL : 32|12@1+ (0.01,-20) .-20|20. "m.s2"/ VEH_SPEED : 32|12@1+ (0.01,0) [0|40] "m\/s"/; s/ 256 ACCEL / 256 VEH_SPEED /' \
	$cars/generic.dbc >"$tmp/two.dbc"
exits "two speeds" 1 "$AEBMC" map "$tmp/two.dbc" --out "$tmp/two.conf" </dev/null
like "both are listed" "$tmp/out" '^  2 +EGO\.'
like "it says what to decide" "$tmp/out" '^  not clear: --role ego_speed=MESSAGE.SIGNAL$'
is "one line says so" "$(cat "$tmp/err")" "aebmc map: 1 role is not clear: decide with --role, or give a LOG as well"
exits "nothing is written" 1 test -e "$tmp/two.conf"
ok "told which" "$AEBMC" map "$tmp/two.dbc" --role ego_speed=EGO.VEH_SPEED --out "$tmp/two.conf"
taken "$tmp/two.conf" ego_speed EGO.VEH_SPEED
ok "told that there is none" "$AEBMC" map "$tmp/two.dbc" --role ego_speed=EGO.SPEED:km/h --role yaw_rate=none \
	--out "$tmp/two.conf" --force
like "which leaves it unmapped" "$tmp/two.conf" '^# \[signal yaw_rate\]: not mapped'
like "and a unit as told" "$tmp/two.conf" '^unit = km/h$'
sed '/DIST_LONG/s/"m"/"dm"/' $cars/generic.dbc >"$tmp/dm.dbc"
exits "a unit that is not known" 1 "$AEBMC" map "$tmp/dm.dbc" --out "$tmp/dm.conf"
like "is said to be the cause" "$tmp/out" "^  LEAD\.DIST_LONG is named so, but its unit 'dm' is not known; --role distance=LEAD\.DIST_LONG:UNIT with one of: m, .*cm, mm$"
ok "which helps" "$AEBMC" map "$tmp/dm.dbc" --out "$tmp/dm.conf" --role distance=LEAD.DIST_LONG:cm
sed '/GenMsgCycleTime/d' $cars/generic.dbc >"$tmp/timeless.dbc"
exits "no cycle times and no log" 1 "$AEBMC" map "$tmp/timeless.dbc" --out "$tmp/timeless.conf"
like "says what is missing" "$tmp/err" 'period = MS'

# on a terminal it asks
if command -v script >/dev/null; then
	printf '9\n2\n' | script -qec "$AEBMC map $tmp/two.dbc --out $tmp/asked.conf" /dev/null >"$tmp/out" 2>&1
	like "it asks" "$tmp/out" 'which\? a number, MESSAGE.SIGNAL'
	ok "and writes what was answered" "$d" --check-config "$tmp/asked.conf"
	printf '\004' | script -qec "$AEBMC map $tmp/two.dbc --out $tmp/silent.conf" /dev/null >"$tmp/out" 2>&1
	like "without an answer it ends" "$tmp/out" 'no answer'
fi

# hostile files end in one line each, or are taken
ok "a drive to spoil" "$AEBMC" generate --drive brake --out "$tmp/brake.log"
ok "120 spoilt databases, configurations and logs" python3 - "$AEBMC" "$d" "$tmp" <<'EOP'
import random, subprocess, sys
aebmc, daemon, tmp = sys.argv[1:]
rng = random.Random(1)
def spoilt(source, to):
    data = bytearray(open(source, "rb").read())
    for _ in range(rng.randrange(1, 30)):
        at = rng.randrange(len(data))
        data[at:at + rng.randrange(3)] = bytes(rng.getrandbits(8) for _ in range(rng.randrange(3)))
    open(to, "wb").write(data)
def run(codes, *argv):
    p = subprocess.run(argv, stdin=subprocess.DEVNULL, capture_output=True)
    lines = p.stderr.count(b"\n")
    assert p.returncode in codes and lines <= 1, (argv, p.returncode, p.stderr)
    assert p.returncode == 0 or lines == 1 or b"WRONG" in p.stdout, (argv, p.returncode)
    assert b"\x1b" not in p.stderr + p.stdout, argv
for i in range(40):
    dbc, conf, log = tmp + "/generic.dbc", tmp + "/hostile.conf", tmp + "/hostile.log"
    spoilt("can-dbc/vehicles/generic.dbc", dbc)
    run((0, 1), aebmc, "map", dbc, tmp + "/brake.log", "--out", tmp + "/out.conf", "--force")
    spoilt("can-dbc/vehicles/generic.conf", conf)
    run((0, 78), daemon, "--check-config", conf)
    run((0, 1, 78), aebmc, "inputs", tmp + "/brake.log", "--config", conf)
    spoilt(tmp + "/brake.log", log)
    run((0, 1), aebmc, "inputs", log, "--config", "can-dbc/vehicles/generic.conf")
EOP

# a car that nobody has seen
if "$python" -c 'import cantools' 2>/dev/null; then
	strange() { # PLANT
		"$python" tests/strange_car.py --dbc "$tmp/car.dbc" --log "$tmp/car.log" --plant "$1"
		rm -f "$tmp/car.conf"
	}
	strange none
	ok "a strange car" "$AEBMC" map "$tmp/car.dbc" "$tmp/car.log" --out "$tmp/car.conf"
	ok "aebmcd takes it" "$d" --check-config "$tmp/car.conf"
	taken "$tmp/car.conf" ego_speed FAHRDYNAMIK.FAHRZEUG_GESCHW
	taken "$tmp/car.conf" distance 'ZIEL_{00..03}.ABSTAND'
	taken "$tmp/car.conf" rel_speed 'ZIEL_{00..03}.RELATIV_GESCHW'
	taken "$tmp/car.conf" lateral 'ZIEL_{00..03}.QUER_ABSTAND'
	taken "$tmp/car.conf" valid 'ZIEL_{00..03}.GUELTIG'
	taken "$tmp/car.conf" yaw_rate FAHRDYNAMIK.GIERRATE
	taken "$tmp/car.conf" driver_brake PEDALE.BREMSE_Pedal
	taken "$tmp/car.conf" driver_accel PEDALE.FAHRPEDAL_Position
	like "interfaces are the log's" "$tmp/car.conf" '^interfaces = can3 can7$'
	like "periods too" "$tmp/car.conf" '^period = 25 +# ms, as in the log$'
	like "and counters" "$tmp/car.conf" '^counter = ZAEHLER '
	is "of which none is odd" "$(grep -c 'counter:' "$tmp/out" "$tmp/car.conf" | cut -d: -f2 | tr '\n' ' ')" "0 0 "
	ok "a shadow run" "$AEBMC" replay --config "$tmp/car.conf" --set bus.transmit=shadow --set mc.samples=256 "$tmp/car.log"
	is "scans need no gap of their own" "$(grep -c scan_gap "$tmp/car.conf")" 0
	"$python" tests/strange_car.py --dbc "$tmp/car.dbc" --log "$tmp/car.log" --spread 13
	ok "slots far apart" "$AEBMC" map "$tmp/car.dbc" "$tmp/car.log" --out "$tmp/car.conf" --force
	like "set the silence that ends a scan" "$tmp/car.conf" '^scan_gap = 1[67] +# ms: silences are up to 1[34] ms within scans, from 2[01] ms'
	"$python" tests/strange_car.py --dbc "$tmp/car.dbc" --log "$tmp/car.log" --spread 15
	ok "slots as far apart as scans" "$AEBMC" map "$tmp/car.dbc" "$tmp/car.log" --out "$tmp/car.conf" --force
	like "do not" "$tmp/car.conf" '^# scan_gap: .* cannot be told apart'
	strange sign
	ok "a planted sign" "$AEBMC" map "$tmp/car.dbc" "$tmp/car.log" --out "$tmp/car.conf"
	like "is named" "$tmp/out" 'RELATIV_GESCHW .*is the change of ABSTAND, but for the sign: negate'
	like "and mended" "$tmp/car.conf" '^negate = yes '
	ok "so that inputs finds nothing wrong" "$AEBMC" inputs "$tmp/car.log" --config "$tmp/car.conf"
	# counted PLANT WHAT: a counter that does not count is not taken, and said
	counted() {
		strange "counter_$1"
		ok "planted: a counter that $1" "$AEBMC" map "$tmp/car.dbc" "$tmp/car.log" --out "$tmp/car.conf"
		like "a counter that $1: told" "$tmp/out" "^counter: FAHRDYNAMIK\.ZAEHLER $2, not taken\$"
		like "a counter that $1: written" "$tmp/car.conf" "^# counter: ZAEHLER $2, not taken\$"
		is "a counter that $1: not mapped" "$(grep -c '^counter = ' "$tmp/car.conf")" 0
	}
	counted repeats 'repeats in 50 % of the frames'
	counted still 'never changes'
	counted skips 'goes up by one in 0 % of the frames only'
	for plant in scale geschw_unit frozen id; do
		strange $plant
		exits "planted: $plant: no guess" 1 "$AEBMC" map "$tmp/car.dbc" "$tmp/car.log" --out "$tmp/car.conf"
		exits "planted: $plant: nothing written" 1 test -e "$tmp/car.conf"
	done
else
	skip "a car that nobody has seen" cantools
fi

# a real one
if [ -r $recording ]; then
	xz -dc $recording >"$tmp/drive.log"
	ok "a recorded drive" "$AEBMC" map $cars/toyota-tss-p.dbc "$tmp/drive.log" --out "$tmp/drive.conf"
	ok "aebmcd takes it" "$d" --check-config "$tmp/drive.conf"
	for role in ego_speed distance rel_speed lateral valid fresh; do
		taken "$tmp/drive.conf" $role "$(sed -n "/^\[signal $role\]/,/^\$/s/^from = \([^#]*[^# ]\).*/\1/p" $cars/toyota-tss-p.conf)"
	done
	is "every message is checked" "$(grep -c '^check = toyota' "$tmp/drive.conf")" 2
	like "tracks are counted" "$tmp/drive.conf" '^counter = COUNTER '
	ok "inputs finds nothing wrong" "$AEBMC" inputs "$tmp/drive.log" --config "$tmp/drive.conf"
	is "and nothing in doubt" "$(grep -cE '^(WRONG|doubt)' "$tmp/out")" 0
else
	skip "a recorded drive" shared
fi
done_testing
