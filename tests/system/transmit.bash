# SPDX-License-Identifier: MIT
# System tests: bus.transmit = none, shadow and armed, each with the ways in which it ends.

# hear_drive [COMMAND...]: the end of the bundled drive, in which a request is due; COMMAND runs as soon as it is
hear_drive() {
	traffic_stop
	listen any
	chrt -f 40 canplayer -g 2 -I $LOGS/brake-end.log vcan0=can0 >/dev/null &
	local player=$!
	within 15 is 'level == full' || { kill $player; heard; return 1; }
	"${@:-true}"
	wait $player
	heard
}
asked() { grep -q 'request brake' /tmp/words; }

none_is_silent() {
	good bus.transmit=none || return 1
	hear_drive
	[ ! -s /tmp/words ] && is 'counters.sent == 0 and counters.full >= 1'
}
none_and_shadow_cannot_be_armed() {
	good bus.transmit=none && ! asked_for arm && [[ $reply == *'bus.transmit is not armed'* ]] || return 1
	good && ! asked_for arm && [[ $reply == *'bus.transmit is not armed'* ]] && is 'armed == false'
}
shadow_never_asks() {
	good && hear_drive && grep -q 'stage full, request none' /tmp/words && ! asked
}
armed_asks_nothing_before_the_command() {
	good bus.transmit=armed && hear_drive && grep -q 'stage full, request none' /tmp/words && ! asked
}
armed_asks_after_the_command() {
	good bus.transmit=armed && ask arm && hear_drive && asked && is 'armed == true'
}

# Each of these begins with a request on the bus.
requesting() {
	good bus.transmit=armed && ask arm && hear_drive "$@"
}
# ended_within MS TIME: requests end by then, and none follows
ended_within() {
	asked || return 1
	at_most "$1" "$(first_after "$2" 'AEB_REQUEST.*request none')" "no request after" || return 1
	! awk -v t="$2" -v ms="$1" '($1 - t) * 1000 > ms && /request brake/ { found = 1 } END { exit !found }' /tmp/words
}
stamped() {
	at=$EPOCHREALTIME
	"$@"
}
stamped_kill() {
	local p
	p=$(pid) && stamped kill "$@" "$p"
}
# next_request: the first request frame after $at
next_request() { awk -v t="$at" '$1 > t && /AEB_REQUEST/ { print; exit }' /tmp/words; }

disarm_ends_a_request() { requesting stamped ask disarm && ended_within 40 "$at" && is 'armed == false'; }
term_ends_a_request_with_a_clean_last_frame() {
	requesting stamped_kill || return 1
	within 5 gone || return 1
	running=
	tail -n 3 /tmp/words
	[[ $(grep AEB_REQUEST /tmp/words | tail -n 1) == *"state INHIBIT"*"request none"* ]] && ended_within 200 "$at" &&
		at_most 200 "$(awk -v t="$at" 'END { print ($1 - t) * 1000 }' /tmp/words)" "last frame after"
}
gone() { ! active; }
kill_ends_a_request_and_the_arming() {
	requesting stamped_kill -KILL || return 1
	running=
	asked && within 5 is 'armed == false' || return 1
	next_request
	[[ $(next_request) == *"state INIT"*"request none"* ]] && ! awk -v t="$at" '$1 > t' /tmp/words | grep 'request brake'
}
restart_ends_the_arming() {
	good bus.transmit=armed && ask arm && within 1 is 'armed == true' && systemctl restart aebmcd@test && is 'armed == false'
}
silence_ends_a_request() {
	requesting traffic_ends || return 1
	ended_within 80 "$(last_of 100)" && grep -q 'state INHIBIT.*request none' /tmp/words
}
# The player of hear_drive.
traffic_ends() {
	pkill -KILL -x canplayer
	pause 0.2
}
link_loss_ends_a_request() {
	requesting lose_the_link || return 1
	next_request
	asked && [[ $(next_request) == *"state INHIBIT"*"request none"* ]]
}
lose_the_link() {
	traffic_ends
	ip link set vcan0 down
	pause 0.3
	stamped ip link set vcan0 up
	pause 1
}
driver_ends_a_request() {
	good bus.transmit=armed && ask arm && gateway || return 1
	listen vcan0
	traffic_stop
	chrt -f 40 canplayer -g 2 -I $LOGS/brake-end.log vcan1=can0 >/dev/null &
	local player=$!
	within 15 is 'level == full' || { kill $player; heard; gateway_off; return 1; }
	gateway 101 OR:D:101.8.000000FA00000000 resign # the accelerator at 100 %
	at=$EPOCHREALTIME
	wait $player
	heard
	gateway_off
	ended_within 100 "$at" && is 'rejected.crc == 0'
}

# The driver's braking, as the stack of the daemon has it (driver.accel), becomes another number: memory that fails.
spoil() {
	local p
	p=$(pid) && python3 - "$p" <<'P'
import struct, sys
was, now, spoiled = struct.pack("<d", -3.92), struct.pack("<d", -3.93), 0
with open("/proc/%s/maps" % sys.argv[1]) as maps, open("/proc/%s/mem" % sys.argv[1], "r+b", 0) as memory:
    begin, end = [[int(x, 16) for x in line.split()[0].split("-")] for line in maps if "[stack]" in line][0]
    memory.seek(begin)
    stack = memory.read(end - begin)
    at = stack.find(was)
    while at >= 0:
        memory.seek(begin + at)
        spoiled += memory.write(now) == 8
        at = stack.find(was, at + 8)
sys.exit(not spoiled)
P
	at=$EPOCHREALTIME
}
fault_ends_a_request_and_the_arming() {
	requesting spoil && ended_within 300 "$at" && grep 'state FAULT.*request none' /tmp/words | head -n 1 | grep . &&
		has_reason CONFIG && is 'state == FAULT and armed == false' && ! asked_for arm && [[ $reply == *'the state is FAULT'* ]]
	local ok=$?
	stop
	return $ok
}
