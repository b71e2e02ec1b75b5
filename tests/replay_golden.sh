#!/bin/sh
# Golden replays: golden/x.log through aebmc replay gives golden/x.log.chk, byte for byte: our frames, then the figures.
# The first line of a log names its configuration. tests/replay_golden.sh --update writes the .chk files anew. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"

# golden LOG: what its .chk must hold
golden() {
	config=$(sed -n '1s/^# config //p' "$1")
	"$AEBMC" replay --config "$config" --out - "$1" 2>/dev/null
	"$AEBMC" replay --config "$config" --json "$1" | python3 -c '
import json, sys
j = json.load(sys.stdin)
for key in ("version", "realtime_factor"):
    del j[key]
print(json.dumps(j, indent=1))'
}

for log in tests/golden/*.log; do
	golden "$log" >"$tmp/chk"
	[ "${1:-}" = --update ] && cp "$tmp/chk" "$log.chk"
	ok "$log" diff "$log.chk" "$tmp/chk"
done
done_testing
