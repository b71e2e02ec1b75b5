#!/bin/sh
# What aebmc prints: valid JSON with the agreed keys, nothing lost without a word, a clean end on Ctrl-C. TAP.
# shellcheck disable=SC2086,SC2016 # $car and $sub are words
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
car="can-dbc/vehicles/generic.conf --set mc.samples=1024" # few, for the sanitizers
drive=$tmp/brake.log
ours=$tmp/ours.log

# full COMMAND...: standard output cannot take it
full() {
	"$@" >/dev/full 2>"$tmp/err" </dev/null
	tap_got=$?
	[ $tap_got -eq 1 ] && [ "$(wc -l <"$tmp/err")" -eq 1 ]
	tap_status=$?
	report $tap_status "$1 $2: a full disk is told in one line, exit 1"
	[ $tap_status -eq 0 ] || { echo "# exit $tap_got"; show "$tmp/err"; }
}

# gone COMMAND...: whoever read standard output is gone
gone() {
	python3 - "$@" 2>"$tmp/err" <<-'EOF'
		import os, subprocess, sys
		r, w = os.pipe()
		os.close(r)
		sys.exit(subprocess.call(sys.argv[1:], stdout=w, stdin=subprocess.DEVNULL))
	EOF
	tap_got=$?
	[ $tap_got -eq 1 ] && [ "$(wc -l <"$tmp/err")" -eq 1 ]
	tap_status=$?
	report $tap_status "$1 $2: a closed pipe is told in one line, exit 1"
	[ $tap_status -eq 0 ] || { echo "# exit $tap_got"; show "$tmp/err"; }
}

ok "generate a drive" "$AEBMC" generate --drive brake --out "$drive"

# every subcommand with --json
ok "curve --json" "$AEBMC" curve --samples 5000 --json
is "no progress without a terminal" "$(cat "$tmp/err")" ""
json "curve: one object with the agreed keys" "$tmp/out" \
	'j["samples"] == 5000 and j["mean_m"] > 0 and j["sd_m"] > 0 and list(j["headway_m"]) == ["0.05", "0.01", "0.001"]'
json "curve: schema, version, seed, machine" "$tmp/out" \
	'j["schema"] == "aebmc.curve.1" and j["version"] and j["seed"] == 1 and j["cpu"] and j["variant"]'
json "curve: risk falls with the headway, inside its interval" "$tmp/out" \
	'all(a["risk"] >= b["risk"] and a["headway_m"] < b["headway_m"] for a, b in zip(j["curve"], j["curve"][1:])) and all(r["lo"] <= r["risk"] <= r["hi"] for r in j["curve"])'
json "curve: no hit is below 3/N, not 0" "$tmp/out" \
	'j["curve"][-1]["below_hi"] and abs(j["curve"][-1]["hi"] - 3 / 5000) < 1e-12'
ok "curve of a configured scene, --json" "$AEBMC" curve --config $car --future driver --lead-speed 20 \
	--lead-accel -3 --lead-accel-sigma 0.5 --samples 4096 --json
json "a moving lead has a time to collision of its own" "$tmp/out" \
	'abs(j["ttc_s"]["0.05"] - j["headway_m"]["0.05"] / 10) < 1e-9'
ok "curve --csv -" "$AEBMC" curve --samples 5000 --csv -
like "CSV with units in the header" "$tmp/out" '^headway_m,risk,risk_lo,risk_hi,below_hi$'
cp "$tmp/out" "$tmp/curve.csv"
ok "CSV reads as numbers" python3 -c 'import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert len(rows) > 20 and all(0 <= float(r["risk"]) <= 1 for r in rows)' "$tmp/curve.csv"
ok "converge --json" "$AEBMC" converge --json
json "converge: ten rows of Table I" "$tmp/out" \
	'[r["samples"] for r in j["rows"]] == [1000, 4000, 8000, 12000, 25000, 37000, 65000, 100000, 150000, 350000]'
json "converge: every row within 4 standard errors of the paper's mean" "$tmp/out" \
	'all(abs(r["mean_z"]) < 4 for r in j["rows"])'
json "converge: standard errors as of independent samples" "$tmp/out" \
	'all(abs(r["mean_se_m"] - r["sd_m"] / math.sqrt(r["samples"])) < 1e-12 and r["sd_se_m"] > 0 for r in j["rows"])'
ok "verify --json" "$AEBMC" verify --samples 500 --resident 512 --json
json "verify: the agreed keys" "$tmp/out" \
	'j["max_stop_dev_m"] < 5e-4 and j["verdict_mismatches"] == 0 and j["bits_equal"] is True and j["threads_used"] == [1, 2, 4] and len(j["variants"]) > 0'
ok "bench --json" "$AEBMC" bench --rounds 2 --json
json "bench: the agreed keys" "$tmp/out" \
	'all(j[k] > 0 for k in ("reference_ns", "paper_ns", "moving_ns", "futures_ns", "perception_ns", "evaluation_ms", "paper_ratio", "moving_ratio", "plain_loop_ns"))'
json "bench: the plain loop computes what the reference does" "$tmp/out" 'j["plain_loop_dev_m"] < 1e-4'
ok "replay --json" "$AEBMC" replay --config $car --out "$ours" --json "$drive"
json "replay: the agreed keys" "$tmp/out" \
	'all(type(j[k]) is int for k in ("frames", "evaluations", "warn", "partial", "full")) and 0 < j["risk_max"] <= 1 and "crc" in j["rejected"] and j["realtime_factor"] > 0 and len(j["config_hash"]) == 16'
ok "decode --json" "$AEBMC" decode --json "$ours"
json "decode: every frame is ours and good" "$tmp/out" \
	'j["ours"] == len(j["frames"]) > 0 and j["bad"] == j["others"] == j["malformed_lines"] == 0 and all(f["good"] and f["words"] for f in j["frames"])'

# words
ok "curve in words" "$AEBMC" curve --samples 5000
like "curve: safe headways with their time to collision" "$tmp/out" '5\.0 % risk from +[0-9.]+ m +\([0-9.]+ s to collision\)'
like "curve: below 3/N" "$tmp/out" 'below 0\.06'
ok "replay in words" "$AEBMC" replay --config $car "$drive"
like "replay: the warning" "$tmp/out" '^ +[0-9.]+ s  WARNING'
like "replay: the brake request" "$tmp/out" '^ +[0-9.]+ s  FULL BRAKING requested, -6\.0 m/s2'
ok "decode in words" "$AEBMC" decode "$ours"
like "decode: time, interface, words" "$tmp/out" '^[0-9]+\.[0-9]{6}  can[0-9]  '
ok "replay --csv -" "$AEBMC" replay --config $car --csv - "$drive"
is "and nothing else anywhere" "$(grep -vE '^(time_s|[0-9]+\.[0-9]{6}),' "$tmp/out" "$tmp/err")" ""
cp "$tmp/out" "$tmp/replay.csv"
ok "CSV: one row per evaluation, units in the names" python3 -c 'import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert len(rows) > 50 and float(rows[-1]["time_s"]) > float(rows[0]["time_s"])
for key in ("headway_m", "ego_speed_mps", "p_defer", "p_defer_lo", "p_defer_hi", "level", "state", "cause", "accel_request_mps2"):
    assert key in rows[0], key' "$tmp/replay.csv"
ok "replay --out -" "$AEBMC" replay --config $car --out - "$drive"
cp "$tmp/out" "$tmp/stdout.log"
ok "the same frames as into a file" cmp "$tmp/stdout.log" "$ours"

# an output that is the input, or the other output
cp "$drive" "$tmp/y.log"
ln -s y.log "$tmp/link.log"
for to in y.log link.log; do
	for option in --csv --out; do
		refuses 2 "$AEBMC" replay --config $car $option "$tmp/$to" "$tmp/y.log"
		like "which names it" "$tmp/err" "y.log: is the input as well"
	done
done
exits "standard input is the output" 2 "$AEBMC" replay --config $car --csv "$tmp/y.log" - <"$tmp/y.log"
ok "the log is as it was" cmp "$tmp/y.log" "$drive"
refuses 2 "$AEBMC" replay --config $car --csv "$tmp/new" --out "$tmp/./new" "$drive"
refuses 2 "$AEBMC" replay --config $car --csv "$tmp/y.log" --out "$tmp/link.log" "$drive"
ok "and still is" cmp "$tmp/y.log" "$drive"
ok "nowhere may be given twice" "$AEBMC" replay --config $car --csv /dev/null --out /dev/null "$drive"

# nowhere to write
for sub in "inputs --config $car $drive" "inputs --config $car --json $drive" "map can-dbc/vehicles/generic.dbc $drive" \
	"map can-dbc/vehicles/generic.dbc --out -" "curve --samples 1000" "curve --samples 1000 --json" "curve --samples 1000 --csv -" "converge" \
	"verify --samples 100 --resident 64" "bench --rounds 1" "decode $ours" "decode --json $ours" "help" "help curve" "--version" \
	"replay --config $car $drive" "replay --config $car --json $drive" "replay --config $car --csv - $drive" \
	"replay --config $car --out - $drive"; do
	full "$AEBMC" $sub
done
for sub in "replay --out" "replay --csv" "curve --csv"; do
	log=$(case $sub in replay*) echo "--config $car $drive" ;; esac)
	exits "$sub into a full disk" 1 "$AEBMC" $sub /dev/full $log
	is "$sub says so in one line" "$(cat "$tmp/err")" "aebmc ${sub% *}: /dev/full: No space left on device"
done
for sub in "curve --samples 1000 --csv -" "decode $ours" "replay --config $car --csv - $drive" \
	"replay --config $car --out - $drive"; do
	gone "$AEBMC" $sub
done

# standard streams that are closed: no file may take their place
exits "replay --out - to a closed standard output" 1 sh -c "\"$AEBMC\" replay --config $car --out - \"$drive\" >&-"
is "one line says so" "$(cat "$tmp/err")" "aebmc replay: standard output: Bad file descriptor"
exits "curve to a closed standard output" 1 sh -c "\"$AEBMC\" curve --samples 1000 >&-"
is "in one line, too" "$(cat "$tmp/err")" "aebmc: standard output: Bad file descriptor"
exits "replay of a closed standard input" 1 sh -c "\"$AEBMC\" replay --config $car --out \"$tmp/x.log\" --csv /dev/null - <&-"
like "one line names it" "$tmp/err" "^aebmc replay: -: Bad file descriptor"
exits "replay without any: its words are lost" 1 sh -c "\"$AEBMC\" replay --config $car --out \"$tmp/x.log\" --csv /dev/null \"$drive\" <&- >&- 2>&-"
ok "not its frames" cmp "$tmp/x.log" "$ours"

# Ctrl-C
"$AEBMC" curve --samples 4000000000 >"$tmp/out" 2>"$tmp/err" &
child=$!
interrupt $child 1
wait $child
is "curve ends on Ctrl-C with what it has" $? 1
like "curve says so" "$tmp/out" '^Interrupted after [0-9]+ of 4000000000 samples'
mkfifo "$tmp/fifo"
timeout 30 sh -c 'exec >"$1"; cat "$2"; sleep 3' sh "$tmp/fifo" "$drive" >/dev/null 2>&1 &
"$AEBMC" replay --config $car --json "$tmp/fifo" >"$tmp/out" 2>"$tmp/err" &
child=$!
interrupt $child 2
wait $child
is "replay ends on Ctrl-C" $? 1
json "replay: with what it has" "$tmp/out" 'j["interrupted"] is True and j["frames"] > 0'
for size in "100000000 64" "1000 400000" "2000000 64"; do # in batches, the resident set, rollouts
	for json in "" --json; do
		"$AEBMC" verify --samples ${size% *} --resident ${size#* } $json >"$tmp/out" 2>"$tmp/err" &
		child=$!
		interrupt $child 2
		wait $child
		is "verify $json of $size ends on Ctrl-C" $? 1
		is "and nothing went wrong" "$(cat "$tmp/err")" ""
		[ "$json" ] || like "which it says" "$tmp/out" "^interrupted, not judged$"
	done
	json "verify: interrupted, not passed" "$tmp/out" 'j["interrupted"] is True and j["passed"] is False'
done

# idle COMMAND...: nothing more comes on standard input
idle() {
	mkfifo "$tmp/idle"
	"$@" <"$tmp/idle" >"$tmp/out" 2>"$tmp/err" &
	child=$!
	exec 3>"$tmp/idle"
	interrupt $child 2
	(sleep 20 && kill -KILL $child) >/dev/null 2>&1 &
	guard=$!
	wait $child
	is "$1 $2 ends on Ctrl-C while its input is idle" $? 1
	kill $guard
	exec 3>&-
	is "and says so" "$(cat "$tmp/err")" "aebmc $2: interrupted"
	rm "$tmp/idle"
}
idle "$AEBMC" replay --config $car -
idle "$AEBMC" decode -
idle "$AEBMC" inputs --config $car -
done_testing
