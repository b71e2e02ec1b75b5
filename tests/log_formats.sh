#!/bin/sh
# Logs of other programs: what python-can writes, and the one-line conversions of the README; what PlotJuggler and
# Foxglove read. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
bin=build/venv/bin
conf=can-dbc/vehicles/generic.conf
if ! $bin/python -c 'import can, mcap' 2>/dev/null; then
	skip "logs of python-can" python-can
	done_testing
	exit 0
fi
replay() {
	"$AEBMC" replay --config $conf --set mc.samples=1024 "$@"
}
# today's clock, as a recorder would have it: formats differ in what they keep of 1970
"$AEBMC" generate --drive brake | sed -E 's/^\(0000000/(1700000/' >"$tmp/drive.log"
replay --json "$tmp/drive.log" >"$tmp/drive.json"

# same NAME FILE: the replay's events of the drive, at the same times to 2 ms; the log's words about it beside
same() {
	ok "$1: same events" python3 - "$tmp/drive.json" "$2" <<-'P'
		import json, sys
		a, b = (json.load(open(path)) for path in sys.argv[1:])
		assert a["frames"] == b["frames"] > 2000, (a["frames"], b["frames"])
		assert b["log"]["malformed_lines"] == b["log"]["disorder"] == 0, b["log"]
		assert [e["level"] for e in a["events"]] == [e["level"] for e in b["events"]]
		assert all(abs(x["time_s"] - y["time_s"]) < 0.002 for x, y in zip(a["events"], b["events"]))
	P
}

# advised FORMAT WORDS: not read as it is, but with the line that helps
advised() {
	for command in inputs replay; do
		exits "$1: $command" 1 "$AEBMC" $command --config $conf "$tmp/x.$1"
		is "$1: $command says what helps" "$(sed "s|$tmp/||g" "$tmp/err")" \
			"aebmc $command: x.$1: looks like $2; python-can makes a candump log of it: can_logconvert x.$1 x.$1.log"
	done
	refuses 1 "$AEBMC" map can-dbc/vehicles/generic.dbc "$tmp/x.$1"
	like "$1: map says what helps" "$tmp/err" "looks like $2; .*: can_logconvert "
}

formats="log blf asc trc"
if $bin/python -c 'import asammdf' 2>/dev/null; then
	formats="$formats mf4"
else
	skip "mf4 to candump by can_logconvert" asammdf
fi
for format in $formats; do
	$bin/can_logconvert "$tmp/drive.log" "$tmp/x.$format" >/dev/null 2>&1
	case $format in
	blf) advised blf "Vector BLF" ;;
	asc) advised asc "Vector ASC" ;;
	trc) advised trc "PCAN TRC" ;;
	mf4) advised mf4 "ASAM MDF" ;;
	esac
	ok "$format to candump by can_logconvert" $bin/can_logconvert "$tmp/x.$format" "$tmp/$format.log"
	name=$(awk 'NR == 1 { print $2 }' "$tmp/$format.log")
	replay --set bus.interfaces="$name" --json "$tmp/$format.log" >"$tmp/$format.json" 2>"$tmp/err"
	same "$format" "$tmp/$format.json"
done
exits "another interface's name" 1 replay --set bus.interfaces=can7 "$tmp/log.log"
like "is told with what to do" "$tmp/err" 'no frame on can7, but [0-9]+ on other interfaces; see bus\.interfaces$'

# every kind of frame that its logger writes
$bin/python - "$tmp/kinds.log" <<-'P'
	import sys, can
	log = can.CanutilsLogWriter(sys.argv[1])
	kinds = (dict(arbitration_id=0x100, is_extended_id=False, data=bytes(8)),
	         dict(arbitration_id=0x123, data=b"\1\2\3", is_rx=False),
	         dict(arbitration_id=0x1ABCDEF0, data=bytes(12), is_fd=True, bitrate_switch=True),
	         dict(arbitration_id=0x7FF, is_extended_id=False, data=bytes(64), is_fd=True, error_state_indicator=True),
	         dict(arbitration_id=0x321, is_extended_id=False, is_remote_frame=True, dlc=4),
	         dict(arbitration_id=0x20, is_error_frame=True, data=bytes(8)),
	         dict(arbitration_id=0x124, is_extended_id=False))
	for i, kind in enumerate(kinds):
	    log.on_message_received(can.Message(timestamp=1700000000.25 + i / 10, channel="can0", **kind))
	log.stop()
P
is "seven lines" "$(wc -l <"$tmp/kinds.log")" 7
replay --json "$tmp/kinds.log" >"$tmp/kinds.json" 2>/dev/null
json "all of them are frames" "$tmp/kinds.json" \
	'j["log"]["malformed_lines"] == 0 and j["log"]["error_frames"] == 1 and j["log"]["remote_frames"] == 1'

# and what we write
replay --out "$tmp/ours.log" --csv "$tmp/drive.csv" "$tmp/drive.log" >/dev/null
is "python-can reads our frames" "$($bin/python -c 'import can, sys
print(sum(1 for m in can.LogReader(sys.argv[1])))' "$tmp/ours.log")" "$(wc -l <"$tmp/ours.log")"

# pictures by others
ok "CSV: a time column in seconds first, growing, numbers or nothing elsewhere" python3 - "$tmp/drive.csv" <<-'P'
	import csv, sys
	rows = list(csv.DictReader(open(sys.argv[1])))
	words = {"level_name", "cause", "state"}
	assert list(rows[0])[0] == "time_s" and len(rows) > 400
	assert all(float(a["time_s"]) < float(b["time_s"]) for a, b in zip(rows, rows[1:]))
	for row in rows:
	    for name, text in row.items():
	        assert text is not None, name
	        if name not in words and text:
	            float(text)
P
ok "MCAP for Foxglove" $bin/python tools/csv2mcap --start 1700000100 "$tmp/drive.csv" "$tmp/drive.mcap"
ok "has every evaluation, at its time" $bin/python - "$tmp/drive.csv" "$tmp/drive.mcap" <<-'P'
	import csv, json, sys
	from mcap.reader import make_reader
	rows = list(csv.DictReader(open(sys.argv[1])))
	with open(sys.argv[2], "rb") as f:
	    got = [(c.topic, m.log_time, json.loads(m.data)) for _, c, m in make_reader(f).iter_messages()]
	assert len(got) == len(rows)
	for (topic, at, data), row in zip(got, rows):
	    assert topic == "/aebmc/evaluation" and abs(at / 1e9 - 1700000100 - float(row["time_s"])) < 1e-6
	    assert data["p_defer_hi"] == float(row["p_defer_hi"]) and data["state"] == row["state"]
P
exits "what is no such CSV" 1 $bin/python tools/csv2mcap "$tmp/drive.log" "$tmp/y.mcap"
like "is told in a line" "$tmp/err" '^csv2mcap: .*no column time_s'
exits "a file that is not there" 1 $bin/python tools/csv2mcap "$tmp/none.csv" "$tmp/y.mcap"
done_testing
