#!/bin/sh
# SPDX-License-Identifier: MIT
# aebmcd from outside: shipped cars pass, bad files and arguments are refused with one line and the agreed exit code, what
# --print-config says loads again. TAP.
. "$(dirname "$0")/tap.sh"
d=$O/aebmcd
cars=can-dbc/vehicles
c=$tmp/car.conf
cp $cars/*.dbc $cars/*.conf "$tmp"

# spoilt NAME SED-SCRIPT WANT: the Toyota file after the edit is refused, and the line says WANT
spoilt() {
	sed "$2" $cars/toyota-tss-p.conf >"$c"
	refuses 78 "$d" --check-config "$c"
	like "$1: named with file and line" "$tmp/err" "^aebmcd: $c:$3"
}

for car in generic toyota-tss-p; do
	exits "$car is good" 0 "$d" --check-config $cars/$car.conf
	like "$car: one line says so" "$tmp/out" "^$cars/$car.conf: good; .*; hash [0-9a-f]{16}$"
	is "$car: nothing on standard error" "$(cat "$tmp/err")" ""

	"$d" --print-config --config $cars/$car.conf >"$tmp/first.conf" 2>"$tmp/err"
	"$d" --print-config --config "$tmp/first.conf" >"$tmp/second.conf" 2>>"$tmp/err"
	ok "$car: what is printed loads and prints the same" cmp "$tmp/first.conf" "$tmp/second.conf"
	is "$car: and has the same hash" "$("$d" --check-config "$tmp/second.conf" | sed 's/.*hash//')" \
		"$("$d" --check-config $cars/$car.conf | sed 's/.*hash//')"
done

# no such file, or no such kind of file
refuses 78 "$d" --check-config "$tmp/nosuch.conf"
refuses 78 "$d" --check-config "$tmp"
refuses 78 "$d" --check-config /dev/null
refuses 78 "$d" --check-config /dev/zero
refuses 78 "$d" --check-config "$d"
refuses 78 "$d" --check-config ""
head -c 1000000 /dev/zero | tr '\0' x >"$c"
refuses 78 "$d" --check-config "$c"
like "a line of 1 MB: named" "$tmp/err" "^aebmcd: $c:1: line longer than 1000 characters"
{ cat $cars/generic.conf; printf '\0'; } >"$c"
refuses 78 "$d" --check-config "$c"
like "a NUL byte: named" "$tmp/err" "^aebmcd: $c:[0-9]+: .*byte 0x00"

spoilt "unknown key" '/^mass =/s/mass/mas/' '[0-9]+: vehicle.mas: .*nearest: vehicle.mass'
spoilt "unknown section" 's/^.radar.$/[rader]/' '[0-9]+: .rader.: .*nearest: radar'
spoilt "duplicate key" '/^mass =/p' '[0-9]+: vehicle.mass: given twice, first in line'
spoilt "duplicate section" "\$a[dbc]" '[0-9]+: .dbc.: given twice, first in line'
spoilt "out of range" '/^corridor/s/=.*/= 40/' "[0-9]+: radar.corridor: '40' is out of range; allowed: 0.5 to 4 m"
spoilt "NaN" '/^mass =/s/=.*/= nan/' "[0-9]+: vehicle.mass: 'nan' is not finite"
spoilt "no value" '/^mass =/s/=.*/=/' "[0-9]+: vehicle.mass: '' is not a number"
spoilt "unknown signal" 's/LONG_DIST/LONG_DST/' '[0-9]+: signal distance.from: .*nearest: LONG_DIST'
spoilt "unknown message" 's/TRACK_A_{/TRACK_B_{/' '[0-9]+: signal distance.from: .*TRACK_B_0.*nearest: TRACK_A_0'
spoilt "unknown database" '/^file/s/toyota/tayota/' '[0-9]+: dbc.file: cannot open'

# a bad database is named twice: where it is asked for, and where it is bad
sed '/LONG_DIST : /s/15|13/15|60/' $cars/toyota-tss-p.dbc >"$tmp/toyota-tss-p.dbc"
spoilt "a signal that exceeds its frame" '' '[0-9]+: dbc.file: .*toyota-tss-p.dbc:[0-9]+: .*LONG_DIST'
sed '/REL_SPEED : /s/47|12/31|12/' $cars/toyota-tss-p.dbc >"$tmp/toyota-tss-p.dbc"
spoilt "signals that overlap" '' '[0-9]+: dbc.file: .*toyota-tss-p.dbc:[0-9]+: .*(REL_SPEED|LAT_DIST)'
cp $cars/toyota-tss-p.dbc "$tmp"

# overrides
exits "--set counts" 0 "$d" --check-config $cars/generic.conf --set road.mu=0.5 --set 'signal distance.offset = 1'
refuses 78 "$d" --check-config $cars/generic.conf --set road.mu=5
like "a bad --set is named" "$tmp/err" "^aebmcd: --set: road.mu: '5' is out of range"
refuses 78 "$d" --print-config --set road.mew=5
refuses 78 "$d" --config $cars/generic.conf --set road.mu=5 --log /dev/null
refuses 78 "$d" --config "$tmp/nosuch.conf" --log /dev/null

# arguments
refuses 2 "$d"
refuses 2 "$d" --nosuch
refuses 2 "$d" argument
refuses 2 "$d" --config
refuses 2 "$d" --log /dev/null
refuses 2 "$d" --check-config $cars/generic.conf --print-config
refuses 2 "$d" --check-config $cars/generic.conf --log /dev/null
# shellcheck disable=SC2046 # 65 words
exits "65 times --set" 2 "$d" --print-config $(yes -- --set=road.mu=1 | head -n 65)
exits "--help" 0 "$d" --help
like "--help lists every option" "$tmp/out" "^  decision.p_defer "
like "--help tells exit codes" "$tmp/out" "78 bad configuration"
is "--version is the Makefile's" "$("$d" --version | head -n 1)" "aebmcd $(sed -n 's/^VERSION := //p' Makefile)"

# logs
refuses 1 "$d" --config $cars/generic.conf --log "$tmp/nosuch.log"
refuses 1 "$d" --config $cars/generic.conf --log /dev/null --out "$tmp/no/such/dir"
head -c 100000 /dev/urandom >"$tmp/random.log"
for log in /dev/null "$tmp/random.log"; do
	refuses 1 "$d" --config $cars/generic.conf --log "$log"
	is "there is no frame in it" "$(cat "$tmp/err")" "aebmcd: $log: no frame on the configured interfaces"
done

# an output that nobody takes
exits "standard output closed" 1 sh -c "\"$d\" --print-config >&-"
exits "standard output full" 1 sh -c "\"$d\" --print-config >/dev/full"
like "and one line says so" "$tmp/err" "^aebmcd: cannot write to standard output"
mkfifo "$tmp/pipe"
: <"$tmp/pipe" &
exec 3>"$tmp/pipe"
wait $!
exits "standard output a closed pipe" 1 sh -c "\"$d\" --print-options >&3"

# so for the frames on a log
"$O/aebmc" generate --drive brake --out "$tmp/brake.log"
run="--config $cars/generic.conf --set mc.samples=256 --log $tmp/brake.log"
# shellcheck disable=SC2086 # $run is words
refuses 1 "$d" $run --out /dev/full
is "the output is named" "$(cat "$tmp/err")" "aebmcd: /dev/full: No space left on device"
exits "frames to a closed pipe" 1 sh -c "\"$d\" $run --out - >&3"
is "standard output is named" "$(cat "$tmp/err")" "aebmcd: standard output: Broken pipe"
exec 3>&-
exits "frames to a closed standard output" 1 sh -c "\"$d\" $run --out - >&-"
is "which is named" "$(cat "$tmp/err")" "aebmcd: standard output: Bad file descriptor"
exits "all three closed" 1 sh -c "exec \"$d\" $run --out - <&- >&- 2>&-"
done_testing
