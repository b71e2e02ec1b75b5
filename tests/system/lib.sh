# SPDX-License-Identifier: MIT
# What the system tests share: TAP, waiting with a limit, the daemon's status, its configuration, traffic.
# Sourced by guest (bash).

n=0 failed=0
CONF=/etc/aebmc/test.conf
SOCKET=/run/aebmc/test/status.sock
LOGS=/payload/logs

# t NAME COMMAND...: one test; it passes if the command does
t() {
	local name=$1 start=$SECONDS
	shift
	n=$((n + 1))
	if "$@" >/tmp/test.log 2>&1; then
		echo "ok $n - $name ($((SECONDS - start)) s)"
	else
		echo "not ok $n - $name ($((SECONDS - start)) s)"
		failed=$((failed + 1))
		sed 's/^/# /' /tmp/test.log | tail -n 12
		journalctl -u aebmcd@test -n 12 --no-pager -o short-monotonic 2>/dev/null | sed 's/^/# /'
	fi
}

# within SECONDS COMMAND...: until the command succeeds, at most that long
within() {
	local end=$(($(date +%s%N) / 1000000 + $1 * 1000))
	shift
	until "$@" >/dev/null 2>&1; do
		if [ $(($(date +%s%N) / 1000000)) -ge $end ]; then
			echo "not within its time: $*"
			return 1
		fi
		sleep 0.05
	done
}

# ask COMMAND: one line to the status socket, one line back
ask() {
	python3 -c 'import socket, sys
s = socket.socket(socket.AF_UNIX); s.settimeout(2); s.connect(sys.argv[1]); s.sendall(sys.argv[2].encode() + b"\n")
b = b""
while not b.endswith(b"\n"):
    d = s.recv(65536)
    if not d: break
    b += d
sys.stdout.write(b.decode())' "$SOCKET" "$1"
}

# is JQ-EXPRESSION: true of the daemon's status?
is() { ask status | jq -e "$1" >/dev/null; }
field() { ask status | jq -r "$1"; }
state_is() { is ".state == \"$1\""; }
has_reason() { is ".reasons | index(\"$1\")"; }
lacks_reason() { is ".reasons | index(\"$1\") | not"; }

# configure [section.key=value ...]: the generic car on vcan0, frames of this machine allowed, sent as shadow. A long
# period and few samples, because an emulated processor on a busy host is late by more than 20 ms now and then.
configure() {
	sed 's/^interfaces = .*/interfaces = vcan0/' /usr/share/aebmc/vehicles/generic.conf >/etc/aebmc/test.conf
	cp /usr/share/aebmc/vehicles/generic.dbc /etc/aebmc/
	local o
	for o in bus.allow_local=yes bus.transmit=shadow bus.period=100 bus.result_ttl=1000 bus.stale_periods=20 mc.samples=256 "$@"; do
		python3 - "$CONF" "$o" <<'P'
import re, sys
path, (name, value) = sys.argv[1], sys.argv[2].split("=", 1)
section, key = name.split(".")
text = open(path).read()
if not re.search(r"(?m)^\[%s\]" % section, text):
    text += "\n[%s]\n" % section
text = re.sub(r"(?m)^(\[%s\][^\[]*?)^%s\s*=.*$" % (section, key), r"\1#", text)
text = re.sub(r"(?m)^\[%s\].*$" % section, "[%s]\n%s = %s" % (section, key, value), text)
open(path, "w").write(text)
P
	done
}

start() {
	configure "$@"
	systemctl reset-failed aebmcd@test 2>/dev/null
	systemctl start aebmcd@test
}

stop() {
	systemctl stop aebmcd@test
	traffic_stop
}

# traffic LOG: play it onto vcan0 again and again
traffic() {
	canplayer -l i -I "$LOGS/$1" vcan0=can0 >/dev/null 2>&1 &
	echo $! >/tmp/traffic.pid
}

traffic_stop() {
	[ -e /tmp/traffic.pid ] && kill "$(cat /tmp/traffic.pid)" 2>/dev/null
	rm -f /tmp/traffic.pid
	wait 2>/dev/null
	return 0
}

armed() { within 10 state_is ARMED; }

pid() { systemctl show -p MainPID --value aebmcd@test; }

journal_since() { journalctl -u aebmcd@test --since "$1" -o cat --no-pager; }

now() { date '+%F %T.%N'; }
