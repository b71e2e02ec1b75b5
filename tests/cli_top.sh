#!/bin/sh
# aebmc top, arm, disarm, mark against a status socket that answers as the daemon does. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
sock=$tmp/status.sock

# serve: a daemon that has answers for status, arm and mark and hangs up on anything else
cat >"$tmp/serve.py" <<'EOP'
import os, socket, sys
STATUS = ('{"schema":"aebmc.status.1","state":"ARMED","reasons":["MC_LATE"],"level":"none","cause":"none","accel_mps2":0,'
          '"risk":{"defer":{"p":0.0123456,"lo":0.01,"hi":0.02}},"scene":{"ego_speed_mps":13.9,"headway_m":null},'
          '"counters":{"frames":12345678,"period_misses":7},"links":[{"name":"vcan0","up":true,"known":false},'
          '{"name":"can1","up":false,"known":true,"state":"bus-off","tx_errors":248,"restart_ms":0}]}')
ANSWER = {"status": STATUS, "arm": '{"ok":"armed"}', "mark": '{"error":"no recorder"}'}
s = socket.socket(socket.AF_UNIX)
s.bind(sys.argv[1])
s.listen(8)
print("listening", flush=True)
while True:
    c, _ = s.accept()
    for line in c.makefile("r"):
        answer = ANSWER.get(line.strip())
        if answer is None:
            c.shutdown(socket.SHUT_RDWR)
            break
        c.sendall(answer[:20].encode())
        c.sendall(answer[20:].encode() + b"\n")
    c.close()
EOP
python3 "$tmp/serve.py" "$sock" >"$tmp/ready" &
server=$!
until [ -s "$tmp/ready" ]; do sleep 0.05; done

ok "top --once" "$AEBMC" top --once --socket "$sock"
like "state" "$tmp/out" '^state +ARMED'
like "reasons" "$tmp/out" '^reasons +MC_LATE$'
like "risk with its interval" "$tmp/out" '^P\(defer\) +0\.01235  0\.01 \.\. 0\.02'
like "what is not known is a dash" "$tmp/out" '^headway +- m'
like "counters stay whole" "$tmp/out" '^frames +12345678 in'
like "a virtual interface" "$tmp/out" '^vcan0 +up$'
like "a controller" "$tmp/out" '^can1 +down, bus-off.*248 errors.*restart 0 ms'
ok "top --once --json" "$AEBMC" top --once --json --socket "$sock"
json "is what the daemon said" "$tmp/out" 'j["schema"] == "aebmc.status.1" and j["counters"]["period_misses"] == 7'

timeout --foreground --preserve-status -s INT 3 "$AEBMC" top --socket "$sock" >"$tmp/out"
is "not on a terminal: ends on Ctrl-C" $? 0
like "one line each time, no control characters" "$tmp/out" \
	'^ARMED, none, ego 13.9 m/s, headway - m, P\(defer\) 0.01235, .*7 missed periods.*; MC_LATE$'
is "and nothing else" "$(grep -cv '^ARMED, ' "$tmp/out")" 0

ok "arm" "$AEBMC" arm --socket "$sock"
is "arm says what was done" "$(cat "$tmp/out")" "armed"
refuses 1 "$AEBMC" mark --socket "$sock"
is "the daemon's refusal" "$(cat "$tmp/err")" "aebmc mark: no recorder"
refuses 1 "$AEBMC" disarm --socket "$sock"
like "a daemon that hangs up" "$tmp/err" "does not answer"
kill -STOP $server
refuses 1 "$AEBMC" top --once --socket "$sock"
like "a daemon that hangs" "$tmp/err" "nothing for 2 s"
kill -KILL $server
refuses 1 "$AEBMC" top --once --socket "$sock"
refuses 1 "$AEBMC" top nosuch
refuses 2 "$AEBMC" top a b
refuses 2 "$AEBMC" top car --socket "$sock"
refuses 2 "$AEBMC" top --socket "/$(printf '%0200d' 0)"
refuses 2 "$AEBMC" arm a b
done_testing
