#!/bin/sh
# aebmc generate: drives by name, reproducible, through any mapping; another lead in a recorded drive. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
toyota=can-dbc/vehicles/toyota-tss-p.conf
drives="brake follow stopped cutin cutout light"

# arguments
refuses 2 "$AEBMC" generate
refuses 2 "$AEBMC" generate --drive brak
like "it names the nearest drive" "$tmp/err" "nearest is 'brake'"
refuses 2 "$AEBMC" generate --drive ''
refuses 2 "$AEBMC" generate --drive brake extra
refuses 2 "$AEBMC" generate --drive brake --seed -1
refuses 2 "$AEBMC" generate --drive brake --seed x
refuses 2 "$AEBMC" generate --drive brake --dropout 1.1
refuses 2 "$AEBMC" generate --drive brake --dropout nan
refuses 2 "$AEBMC" generate --drive brake --at 3
refuses 2 "$AEBMC" generate --drive brake --splice x --at 3
refuses 2 "$AEBMC" generate --splice x
refuses 2 "$AEBMC" generate --splice x --at -1
refuses 78 "$AEBMC" generate --drive brake --config "$tmp/none.conf"
refuses 78 "$AEBMC" generate --drive brake --set radar.latency=9
refuses 1 "$AEBMC" generate --drive brake --out "$tmp"
refuses 1 "$AEBMC" generate --drive brake --out "$tmp/none/x.log"
refuses 1 "$AEBMC" generate --drive brake --out /dev/full

# drives
ok "the drives are listed" "$AEBMC" generate --list
for drive in $drives; do
	like "$drive is listed" "$tmp/out" "^$drive  *[^ ]"
done
is "no other drive is" "$(wc -l <"$tmp/out")" "$(echo "$drives" | wc -w)"
ok "to standard output" "$AEBMC" generate --drive brake
is "only candump lines" "$(grep -cvE '^\([0-9]{10}\.[0-9]{6}\) can0 [0-9A-F]{3}#[0-9A-F]{16}$' "$tmp/out")" 0
cp "$tmp/out" "$tmp/brake.log"
ok "to a file" "$AEBMC" generate --drive brake --seed 1 --out "$tmp/again.log"
ok "the same every time" cmp "$tmp/brake.log" "$tmp/again.log"
ok "another seed" "$AEBMC" generate --drive brake --seed 2 --out "$tmp/other.log"
exits "is another drive" 1 cmp -s "$tmp/brake.log" "$tmp/other.log"
ok "through another mapping" "$AEBMC" generate --drive follow --config $toyota --out "$tmp/follow.log"
is "sixteen tracks on the radar's bus" "$(awk '$2 == "can1" { print substr($3, 1, 3) }' "$tmp/follow.log" | sort -u | wc -l)" 16
for drive in $drives; do
	"$AEBMC" generate --drive "$drive" --dropout 0.1 --out "$tmp/x.log"
	ok "$drive can be replayed" "$AEBMC" replay --config can-dbc/vehicles/generic.conf --set mc.samples=256 --out /dev/null "$tmp/x.log"
done

# another lead
refuses 1 "$AEBMC" generate --splice "$tmp/none.log" --at 5
refuses 1 "$AEBMC" generate --splice "$tmp" --at 5
ln -s brake.log "$tmp/link.log"
refuses 2 "$AEBMC" generate --splice "$tmp/brake.log" --at 5 --out "$tmp/link.log"
refuses 2 "$AEBMC" generate --splice "$tmp/brake.log" --at 5 --out "$tmp/brake.log"
ok "which leaves the log as it was" cmp "$tmp/brake.log" "$tmp/again.log"
refuses 1 "$AEBMC" generate --splice /dev/null --at 5
like "there is no lead to replace" "$tmp/err" "no lead"
refuses 1 "$AEBMC" generate --splice "$tmp/follow.log" --config $toyota --at 5 --out /dev/full
exits "a time past the end" 1 "$AEBMC" generate --splice "$tmp/follow.log" --config $toyota --at 500 --out "$tmp/x.log"
refuses 78 "$AEBMC" generate --splice "$tmp/follow.log" --config can-dbc/vehicles/ars408.conf --at 5
like "a list has no slots" "$tmp/err" "sends a list"
ok "a lead that brakes" "$AEBMC" generate --splice "$tmp/follow.log" --config $toyota --at 5 --out "$tmp/spliced.log"
"$AEBMC" generate --splice - --config $toyota --at 5 <"$tmp/follow.log" >"$tmp/piped.log"
ok "from standard input to standard output" cmp "$tmp/piped.log" "$tmp/spliced.log"
ok "is warned of" "$AEBMC" replay --json --config $toyota --set mc.samples=4096 --out /dev/null "$tmp/spliced.log"
cp "$tmp/out" "$tmp/spliced.json"
json "and braked for" "$tmp/spliced.json" 'j["warn"] >= 1 and j["full"] >= 1'
ok "the same drive without it" "$AEBMC" replay --json --config $toyota --set mc.samples=4096 --out /dev/null "$tmp/follow.log"
cp "$tmp/out" "$tmp/follow.json"
json "is not" "$tmp/follow.json" 'j["full"] == 0 and j["partial"] == 0'
done_testing
