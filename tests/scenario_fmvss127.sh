#!/bin/sh
# Closed loops that call for braking: no contact, a warning first, the same results with any number of threads and when
# the log of a run is replayed. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
objects=can-dbc/vehicles/generic-objects.conf
toyota=can-dbc/vehicles/toyota-tss-p.conf
settings="--set brake.accel=-9.5 --set vehicle.bound=friction --set road.mu=1.02"

ok "fmvss127 --short" "$AEBMC" scenario fmvss127 --short --json
cp "$tmp/out" "$tmp/short.json"
json "no contact" "$tmp/short.json" 'len(j["runs"]) >= 16 and not any(r["contact"] or r["impact_mps"] for r in j["runs"])'
json "a warning before every request" "$tmp/short.json" \
	'sum(r["full"] for r in j["runs"]) >= 12 and all(r["warn_s"] < r["full_s"] for r in j["runs"] if r["full"])'
json "by a median of 0.7 s at least" "$tmp/short.json" \
	'sorted(r["full_s"] - r["warn_s"] for r in j["runs"] if r["full"])[sum(r["full"] > 0 for r in j["runs"]) // 2] >= 0.7'
json "a driver who brakes when he is warned makes the difference" "$tmp/short.json" \
	'[r["full"] for r in j["runs"] if r["row"] == "stopped-100-driver"] == [0]'
json "every run says what it is asked for" "$tmp/short.json" \
	'all({"row", "contact", "impact_mps", "closest_m", "warn_s", "partial_s", "full_s", "warn", "partial", "full"} <= set(r) for r in j["runs"])'
json "no request beyond the physical limit" "$tmp/short.json" \
	'all(r["full_s"] - r["onset_s"] < r["latest_s"] for r in j["runs"] if r["onset_s"] and r["full"] and "driver" not in r["row"])'
is "the hash of the configuration is replay's" \
	"$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["config_hash"])' "$tmp/short.json")" \
	"$("$AEBMC" generate --config $objects --drive follow | "$AEBMC" replay --config $objects $settings --json - |
		python3 -c 'import json, sys; print(json.load(sys.stdin)["config_hash"])')"
"$AEBMC" scenario fmvss127 --short --json --threads 1 >"$tmp/one.json"
ok "the same bytes from one thread" cmp "$tmp/short.json" "$tmp/one.json"
ok "drawn cars" "$AEBMC" scenario fmvss127 --only brake-80-12m-0.5g --vehicles 3 --json
json "three of each, none the same, no contact" "$tmp/out" \
	'len(j["runs"]) == 12 and len({r["full_s"] for r in j["runs"]}) > 3 and not any(r["contact"] for r in j["runs"]) and j["sum"]["failed_hi"] == 0.25'
ok "in words" "$AEBMC" scenario fmvss127 --only brake-80-12m-0.5g-ramp
like "the table has the row" "$tmp/out" '^brake-80-12m-0.5g-ramp  .* passed$'
ok "as CSV" "$AEBMC" scenario fmvss127 --only brake-80-12m-0.5g-ramp --csv -
is "a line for each run and one of names" "$(wc -l <"$tmp/out")" 3
ok "as a page" "$AEBMC" scenario fmvss127 --only brake-80-12m --html "$tmp/page.html"
ok "it is well-formed, with a picture and a row each" python3 -c '
import html.parser, sys
class P(html.parser.HTMLParser):
    n = {}
    def handle_starttag(self, tag, attrs):
        self.n[tag] = self.n.get(tag, 0) + 1
p = P()
p.feed(open(sys.argv[1]).read())
assert p.n["svg"] >= 1 and p.n["tr"] == 13 and p.n["th"] == 12, p.n
' "$tmp/page.html"
ok "at -6 m/s2, with the configuration as it is" "$AEBMC" scenario fmvss127 --only brake-80-12m-0.5g-ramp --preset none
ok "through the frames of another car" "$AEBMC" scenario fmvss127 --only brake-80-12m-0.5g --config $toyota
ok "ncap-ccr --short" "$AEBMC" scenario ncap-ccr --short --json
json "ncap-ccr: no contact" "$tmp/out" 'len(j["runs"]) >= 8 and not any(r["contact"] for r in j["runs"])'

# a plant that does not brake touches: the suite can fail
ok "a brake of -0.5 m/s2 is not enough" sh -c \
	"! '$AEBMC' scenario fmvss127 --only stopped-80 --set brake.accel=-0.5 --set brake.accel_partial=-0.5 --json >$tmp/weak.json"
json "and the impact is told" "$tmp/weak.json" \
	'all(r["contact"] and r["closest_m"] == 0 and not r["passed"] and 15 < r["impact_mps"] < 22.3 for r in j["runs"] if r["row"] == "stopped-80")'
ok "and in words, of drawn cars too" sh -c \
	"! '$AEBMC' scenario fmvss127 --only stopped-80 --set brake.accel=-0.5 --set brake.accel_partial=-0.5 --vehicles 2 >$tmp/weak.txt"
like "the worst of two" "$tmp/weak.txt" '^stopped-80 +2/2 .* CONTACT, worst (1[5-9]|2[0-2])\.[0-9]{2} m/s$'

# the run as a log, replayed
row=brake-80-12m-0.5g-ramp
ok "write a run as a log" "$AEBMC" scenario fmvss127 --log-run $row --out "$tmp/run.log"
# shellcheck disable=SC2086 # several words
ok "replay it" "$AEBMC" replay --config $objects $settings --json "$tmp/run.log"
cp "$tmp/out" "$tmp/replay.json"
ok "the same decisions at the same times" python3 -c '
import json, sys
run = [r for r in json.load(open(sys.argv[1]))["runs"] if r["row"] == sys.argv[3]][0]
replay = json.load(open(sys.argv[2]))
first = {}
for e in replay["events"]:
    first.setdefault(e["level"], e["time_s"] + 0.001)
assert [replay[k] for k in ("warn", "partial", "full")] == [run[k] for k in ("warn", "partial", "full")], (replay, run)
assert abs(first["warn"] - run["warn_s"]) < 0.0015 and abs(first["full"] - run["full_s"]) < 0.0015, (first, run)
' "$tmp/short.json" "$tmp/replay.json" $row

# any run of a drawn table
ok "a drawn table" "$AEBMC" scenario fmvss127 --only $row-driver --vehicles 3 --seed 2 --json
cp "$tmp/out" "$tmp/drawn.json"
ok "its third run as a log" "$AEBMC" scenario fmvss127 --log-run $row-driver --car 3 --seed 2 --out "$tmp/third.log"
# shellcheck disable=SC2086 # several words
ok "replay that" "$AEBMC" replay --config $objects $settings --json "$tmp/third.log"
cp "$tmp/out" "$tmp/third.json"
ok "it decides as that run did, not as its neighbours" python3 -c '
import json, sys
runs = {r["car"]: r for r in json.load(open(sys.argv[1]))["runs"]}
first = {}
for e in json.load(open(sys.argv[2]))["events"]:
    first.setdefault(e["level"], e["time_s"] + 0.001)
def same(r):
    return all(abs(first.get(k, -1) - (r[k + "_s"] or -1)) < 0.0015 for k in ("warn", "partial", "full"))
assert [k for k in runs if same(runs[k])] == [3], (first, runs)
' "$tmp/drawn.json" "$tmp/third.json"

cp "$tmp/run.log" "$tmp/before.log"
refuses 1 env CUDA_VISIBLE_DEVICES= "$AEBMC" scenario fmvss127 --log-run $row --set mc.backend=cuda --out "$tmp/run.log"
like "no GPU is there, whatever the machine" "$tmp/err" 'cannot open the cuda backend'
ok "a run that cannot begin leaves the log as it was" cmp "$tmp/run.log" "$tmp/before.log"

# other rules on the same runs
ok "compare" "$AEBMC" scenario fmvss127 --short --only brake-80 --compare --json
json "all of it" "$tmp/out" 'j["interrupted"] is False and j["suite_rows"] == 213'
json "the daemon among five rules, and it alone neither touches nor brakes early" "$tmp/out" \
	'[r["rule"] for r in j["rules"]] == ["ttc", "autoware", "ad-rss", "paper", "aebmc"] and [r["rule"] for r in j["rules"] if r["contacts"] == r["early_requests"] == 0] == ["aebmc"]'
ok "one rule" "$AEBMC" scenario false-activation --only follow-80 --rule ad-rss --json
json "which brakes where nothing happens" "$tmp/out" 'j["rule"] == "ad-rss" and j["runs"][0]["full"] > 0'
ok "in words" "$AEBMC" scenario false-activation --only follow-80 --rule ad-rss
like "what it added" "$tmp/out" '^follow-80-12m .* REQUEST, added 9\.[0-9]{2} m/s2$'

# which rows, and of how many
ok "the rows" "$AEBMC" scenario fmvss127 --list
is "one line each" "$(wc -l <"$tmp/out")" 213
ok "as JSON" "$AEBMC" scenario fmvss127 --short --list --json
json "their names and goals" "$tmp/out" \
	'[r["row"] for r in j["rows"]] == [r["row"] for r in json.load(open("'"$tmp/short.json"'"))["runs"]] and {r["goal"] for r in j["rows"]} == {"no contact"}'
json "a part of the suite is told as one" "$tmp/short.json" 'j["rows"] == len(j["runs"]) and j["suite_rows"] == 213'
ok "in words" "$AEBMC" scenario fmvss127 --only stopped-80
like "of how many rows" "$tmp/out" '^2 of 213 rows, 1 nominal car each'
ok "compared" "$AEBMC" scenario fmvss127 --only stopped-10 --compare
like "of how many too" "$tmp/out" '^fmvss127, 2 of 213 rows of 1 cars'

# Ctrl-C
"$AEBMC" scenario fmvss127 --vehicles 1000 --threads 1 --csv "$tmp/cut.csv" --html "$tmp/cut.html" >"$tmp/out" 2>"$tmp/err" &
interrupt $! 0.5
wait $!
is "interrupted: exit 1 and one line" "$? $(cat "$tmp/err")" "1 aebmc scenario: interrupted"
ok "and no file without a figure" sh -c "! ls $tmp/cut.csv $tmp/cut.html"
"$AEBMC" scenario fmvss127 --vehicles 1000 --threads 1 --compare --json >"$tmp/cut.json" 2>"$tmp/err" &
interrupt $! 0.5
wait $!
is "a comparison too" "$? $(cat "$tmp/err")" "1 aebmc scenario: interrupted"
json "which says so" "$tmp/cut.json" 'j["interrupted"] is True and j["rules"] == []'

refuses 2 "$AEBMC" scenario
refuses 2 "$AEBMC" scenario fmvss
like "it names the nearest suite" "$tmp/err" "nearest is 'fmvss127'"
refuses 2 "$AEBMC" scenario fmvss127 ncap-ccr
refuses 2 "$AEBMC" scenario fmvss127 --only nosuchrow
refuses 2 "$AEBMC" scenario fmvss127 --log-run nosuchrow
refuses 2 "$AEBMC" scenario fmvss127 --rule rss
for with in "--rule ttc" --compare --json "--csv $tmp/x" "--html $tmp/x" --list "--vehicles 2" "--live vcan0"; do
	# shellcheck disable=SC2086 # several words
	refuses 2 "$AEBMC" scenario fmvss127 --log-run stopped-80 $with
done
refuses 2 "$AEBMC" scenario false-activation --log-run recorded-drive --log "$tmp/run.log"
refuses 2 "$AEBMC" scenario fmvss127 --only stopped-80 --out "$tmp/x"
refuses 2 "$AEBMC" scenario fmvss127 --only stopped-80 --car 0
refuses 2 "$AEBMC" scenario fmvss127 --log-run stopped-80 --car -1
refuses 2 "$AEBMC" scenario fmvss127 --list --csv -
ok "none of them left a file" sh -c "! ls $tmp/x"
refuses 2 "$AEBMC" scenario fmvss127 --json --csv -
refuses 2 "$AEBMC" scenario fmvss127 --html - --csv -
refuses 2 "$AEBMC" scenario fmvss127 --compare --rule ttc
refuses 2 "$AEBMC" scenario fmvss127 --vehicles 0
refuses 2 "$AEBMC" scenario fmvss127 --preset nosuch
refuses 78 "$AEBMC" scenario fmvss127 --config "$tmp/nosuch.conf"
refuses 78 "$AEBMC" scenario fmvss127 --set brake.accel=1
refuses 1 "$AEBMC" scenario fmvss127 --only stopped-80 --csv "$tmp/nosuch/x.csv"
refuses 1 "$AEBMC" scenario fmvss127 --log-run stopped-80 --out "$tmp/nosuch/x.log"
done_testing
