# SPDX-License-Identifier: MIT
# System tests: the process stopped, killed, misconfigured, reloaded, and a machine that misbehaves around it.

watchdog() {
	mkdir -p /run/systemd/system/aebmcd@test.service.d
	printf '[Service]\nWatchdogSec=%s\n' "$1" >/run/systemd/system/aebmcd@test.service.d/watchdog.conf
	systemctl daemon-reload
}
watchdog_as_shipped() {
	rm -f /run/systemd/system/aebmcd@test.service.d/watchdog.conf
	systemctl daemon-reload
}

# evaluated_since TIME SPEED: what the recorder's events hold from TIME (in s) on is enough, and all of it at SPEED (in m/s)
evaluated_since() {
	python3 - "$@" /var/lib/aebmc/test/event-*.requests <<'P'
import struct, sys
since, speed = float(sys.argv[1]), float(sys.argv[2])
seen = {} # ego speed (the eighth word of struct mc_request) by time: events may overlap
for path in sys.argv[3:]:
    for line in open(path):
        if line.startswith("("):
            words = line.split()
            seen[float(words[0][1:-1])] = struct.unpack("<f", struct.pack("<I", int(words[10], 16)))[0]
seen = {t: v for t, v in seen.items() if t >= since}
print("said: %d evaluations, from %.1f to %.1f m/s" % (len(seen), min(seen.values()), max(seen.values())))
sys.exit(len(seen) < 20 or any(abs(v - speed) > 1 for v in seen.values()))
P
}
# 100 km/h before, 80 into the queue while it is stopped, 50 once it goes on: then it must have evaluated nothing but 50.
stopped_and_continued() {
	local p
	p=$(pid) || return 1
	rm -f /var/lib/aebmc/test/event-*
	kill -STOP "$p"
	traffic brake-end.log && pause 2 && traffic stopped.log || return 1
	pause 0.2 # the queue is full by now: these are lost, or thrown away
	at=$EPOCHREALTIME
	kill -CONT "$p"
	within 1 has_reason CLOCK_STEP && state_is INHIBIT && armed || return 1
	within 8 sh -c 'ls /var/lib/aebmc/test/event-*.requests' && evaluated_since "$at" 13.9
}
stopped_for_2_s_and_continued_trusts_nothing_old() {
	stop
	watchdog 0
	good recorder.before=1 recorder.after=3 && stopped_and_continued
	local ok=$?
	watchdog_as_shipped
	return $ok
}
watchdog_restarts_a_stopped_daemon() {
	local p
	good || return 1
	p=$(pid) && kill -STOP "$p" && within 5 another_pid "$p" && armed
}
killed_is_restarted() {
	local p
	good && p=$(pid) && kill -KILL "$p" && within 3 another_pid "$p" && armed
}
term_ends_within_200_ms_with_a_clean_last_frame() {
	good || return 1
	listen vcan0$OURS
	pause 0.2
	stamped_kill || return 1
	within 2 gone || return 1
	running=
	heard
	tail -n 2 /tmp/words
	[[ $(grep AEB_REQUEST /tmp/words | tail -n 1) == *"state INHIBIT"*"request none"* ]] &&
		at_most 200 "$(first_after "$at" 'AEB_REQUEST: state INHIBIT')" "last frame after"
}
bad_configuration_is_78_and_no_loop() {
	stop
	configure
	echo 'nonsense = 1' >>$CONF
	systemctl start aebmcd@test
	pause 1
	systemctl show -p ExecMainStatus -p NRestarts aebmcd@test >/tmp/show
	cat /tmp/show
	grep -qx ExecMainStatus=78 /tmp/show && grep -qx NRestarts=0 /tmp/show
}
refused_mappings() { [ "$(said "$1" 'RELOAD_REFUSED: the mapping .* restart' | wc -l)" = "$2" ]; }
reload_takes_thresholds_and_refuses_the_rest() {
	local since
	good || return 1
	since=$(now)
	configure decision.p_warn=0.2
	systemctl reload aebmcd@test
	within 3 said "$since" RELOADED: || return 1
	configure decision.p_warn=0.2 mc.samples=2048
	systemctl reload aebmcd@test
	within 3 said "$since" 'mc.samples.*takes a restart' || return 1
	configure decision.p_warn=0.2 'signal rel_speed.negate=yes'
	systemctl reload aebmcd@test
	within 3 refused_mappings "$since" 1 || return 1
	configure decision.p_warn=0.2
	sed -i '/DIST_LONG : /s/(0.02,0)/(0.04,0)/' /etc/aebmc/generic.dbc
	systemctl reload aebmcd@test
	within 3 refused_mappings "$since" 2 || return 1
	echo 'nonsense = 1' >>$CONF
	systemctl reload aebmcd@test
	within 3 said "$since" nonsense && state_is ARMED && configure && [ "$(said "$since" RELOADED: | wc -l)" = 1 ]
}
# canplayer would wait until the clock is again where it was.
play_by_monotonic_clock() {
	chrt -f 40 python3 -c 'import socket, sys, time
s = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
s.bind(("vcan0",))
start = time.monotonic()
for line in open(sys.argv[1]):
    t, _, frame = line.split()[:3]
    i, data = frame.split("#")
    wait = float(t[1:-1]) - 100 - (time.monotonic() - start)
    if wait > 0:
        time.sleep(wait)
    s.send(int(i, 16).to_bytes(4, "little") + bytes([len(data) // 2, 0, 0, 0]) + bytes.fromhex(data).ljust(8, b"\0"))
' $LOGS/follow.log &
	traffic_pid=$! playing=python
}
clock_step_is_survived() {
	local misses evaluations ok
	good && traffic_stop && play_by_monotonic_clock && pause 2 && armed && misses=$(field counters.period_misses) &&
		evaluations=$(field counters.evaluations) || return 1
	date -s @$((EPOCHSECONDS - 10))
	pause 2
	is "state == ARMED and counters.period_misses == $misses and counters.evaluations > $((evaluations + 20))" &&
		is 'scene.input_age_ms < 120'
	ok=$?
	date -s @$((EPOCHSECONDS + 10))
	pause 1
	[ $ok = 0 ] && is "state == ARMED and counters.period_misses == $misses"
}
journald_stopped_changes_nothing() {
	local misses
	good && misses=$(field counters.period_misses) || return 1
	systemctl stop systemd-journald.socket systemd-journald-dev-log.socket systemd-journald
	traffic_stop
	within 2 state_is INHIBIT && good && is "counters.period_misses == $misses"
	local ok=$?
	systemctl start systemd-journald.socket systemd-journald
	return $ok
}
client_that_never_reads_is_dropped() {
	good || return 1
	python3 - <<'P'
import socket
s = socket.socket(socket.AF_UNIX)
s.connect("/run/aebmc/test/status.sock")
s.settimeout(10)
try:
    for i in range(20000):
        s.sendall(b"status\n")
    raise SystemExit("never dropped")
except (BrokenPipeError, ConnectionResetError):
    pass
P
	[ $? = 0 ] && state_is ARMED
}
full_disk_is_said_and_survived() {
	local since
	stop
	mkdir -p /tmp/small
	mount -t tmpfs -o size=16k tmpfs /tmp/small
	mkdir -p /var/lib/aebmc/test && mount --bind /tmp/small /var/lib/aebmc/test && chown aebmc /var/lib/aebmc/test
	head -c 16000 /dev/zero >/tmp/small/full
	since=$(now)
	good recorder.after=1 && ask mark && within 5 said "$since" 'could not be written' && state_is ARMED
	local ok=$?
	stop
	umount /var/lib/aebmc/test /tmp/small
	return $ok
}
