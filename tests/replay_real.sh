#!/bin/sh
# A recorded drive of 60 s (commaai/comma2k19, Example_1 segment 40, MIT): nothing in it calls for a brake request. With
# a lead spliced in that brakes at 0.5 g the same binary, thresholds and mapping must warn, then brake. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
config=can-dbc/vehicles/toyota-tss-p.conf
recording=../shared/canlog/comma2k19-rav4-seg40-speed-radar.log.xz

if [ ! -r $recording ]; then
	skip "the recorded drive" shared
	done_testing
	exit 0
fi
xz -dc $recording >"$tmp/drive.log"

# stdin OUT [OPTION...]: the drive through standard input
stdin() {
	out=$1
	shift
	"$AEBMC" replay --config $config --json --out "$out" "$@" - <"$tmp/drive.log"
}

ok "replay from standard input" stdin "$tmp/first.out"
json "every frame was read" "$tmp/out" 'j["frames"] == 26661 and j["log"]["malformed_lines"] == 0'
json "nearly every scan was evaluated" "$tmp/out" 'j["evaluations"] >= 1150'
json "at least 12,000 samples each" "$tmp/out" 'j["samples"] >= 12000'
json "no partial or full request" "$tmp/out" 'j["partial"] == 0 and j["full"] == 0'
json "no warning in the first 55 s" "$tmp/out" \
	'all(e["time_s"] >= 55 for e in j["events"] if e["level"] != "none")'
json "no frame failed its checksum" "$tmp/out" 'j["rejected"]["crc"] == 0 and j["rejected"]["length"] == 0'
python3 -c 'import json, sys; print("# %.1f times real time" % json.load(open(sys.argv[1]))["realtime_factor"])' "$tmp/out"
for threads in 1 2 4; do
	ok "replay with $threads threads" stdin "$tmp/again.out" --threads $threads
	ok "the same frames" cmp "$tmp/first.out" "$tmp/again.out"
done

for at in 15 30 45; do
	ok "splice a braking lead in at $at s" "$AEBMC" generate --config $config --splice "$tmp/drive.log" --at $at \
		--out "$tmp/spliced.log"
	ok "replay it" "$AEBMC" replay --config $config --json "$tmp/spliced.log"
	json "a warning, then a full request, after $at s" "$tmp/out" \
		"[e['level'] for e in j['events'] if e['level'] != 'none'][:2] == ['warn', 'full'] and all(e['time_s'] > $at for e in j['events'] if e['level'] != 'none')"
done
done_testing
