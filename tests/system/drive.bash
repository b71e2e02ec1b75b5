# SPDX-License-Identifier: MIT
# System tests: drives, what is decided on them, what the recorder keeps of them.

warns_and_asks_on_the_bundled_drive() {
	local since
	stop
	rm -f /var/lib/aebmc/test/*
	start || return 1
	since=$(now)
	play brake-end.log vcan0=can0
	said "$since" 'warn \(risk\)' && said "$since" 'full \(risk\)' && is 'counters.warn >= 1 and counters.full >= 1'
}

newest() { ls -t /var/lib/aebmc/test/event-*"$1" 2>/dev/null | head -n 1; }
requests_reproduce() {
	local file
	file=$(newest .requests) && [ -n "$file" ] || return 1
	aebmc replay --config $CONF --requests "$file" | tee /tmp/equal
	grep -qE '^[1-9][0-9]* requests .* 0 differ' /tmp/equal
}
event_is_recorded_and_reproduces() {
	within 45 sh -c 'ls /var/lib/aebmc/test/event-*-warn.requests' || return 1
	requests_reproduce && aebmc replay --config $CONF "$(newest .log)"
}

# as_replayed LOG SECONDS: what the daemon made of LOG live, from a mark before its first frame on, against its replay
as_replayed() {
	local log=$LOGS/$1 event
	ask mark || return 1
	play "$1" "${@:3}"
	# An event lasts at most 30 s longer than recorder.after, which is the drive.
	within 35 sh -c 'ls /var/lib/aebmc/test/event-*-mark.requests' || return 1
	event=$(newest -mark.requests)
	requests_reproduce || return 1
	sed 's/ can\([01]\) / vcan\1 /' "$log" >/tmp/drive.log
	aebmc replay --config $CONF --csv /tmp/drive.csv /tmp/drive.log >/dev/null || return 1
	python3 /payload/scenes.py "$event" "${event%.requests}.log" /tmp/drive.log /tmp/drive.csv
}
bundled_drive_as_in_its_replay() {
	stop
	rm -f /var/lib/aebmc/test/*
	start recorder.before=0 recorder.after=24 && as_replayed brake.log 24 vcan0=can0 && is 'counters.skipped_scans == 0'
}
recorded_drive_as_in_its_replay() {
	stop
	rm -f /var/lib/aebmc/test/*
	CAR=toyota-tss-p start 'bus.interfaces=vcan0 vcan1' bus.out_interface=vcan0 'message SPEED.interface=vcan0' \
		'message WHEEL_SPEEDS.interface=vcan0' 'message TRACK_A_{0..15}.interface=vcan1' \
		recorder.before=0 recorder.after=50 || return 1
	listen vcan0$OURS
	as_replayed recorded.log 50 vcan0=can0 vcan1=can1 || return 1
	heard
	is 'counters.full == 0 and counters.partial == 0 and counters.evaluations >= 1150 and counters.skipped_scans == 0'
}

candump_decodes_our_frames() {
	good || return 1
	listen vcan0$OURS
	pause 1
	heard
	awk '{ print $3 }' /tmp/words | sort | uniq -c
	[ "$(awk '{ print $3 }' /tmp/words | sort -u | wc -l)" = 5 ] && ! grep -qiE 'checksum|length' /tmp/words &&
		[ "$(wc -l </tmp/words)" = "$(wc -l </tmp/bus.log)" ] || return 1
	head -n 40 /tmp/bus.log | sed 's/^/#frame /' >/dev/ttyS0 # for the other decoder, on the host
}

mark_is_recorded() {
	good recorder.after=1 && rm -f /var/lib/aebmc/test/* || return 1
	ask mark && within 5 sh -c 'ls /var/lib/aebmc/test/event-*-mark.log' && requests_reproduce
}

# loop ROW: a car drives ROW of the regulation on vcan0, in real time, and brakes as this daemon asks; its runs' JSON
loop() {
	chrt -f 40 aebmc scenario fmvss127 --config $CONF --preset none --live vcan0 --only "$1" --json >/tmp/loop.json
	grep -oE '"row":"[^"]*"|"contact":(true|false)|"full_s":[^,]*' /tmp/loop.json
}
closed_loop_over_the_bus_avoids_the_crash() {
	stop
	start bus.transmit=armed mc.samples=1024 brake.accel=-9.5 vehicle.bound=friction road.mu=1.02 || return 1
	within 5 is 'state == INIT'
	# Not armed: it sees all and asks for nothing, and the car hits.
	loop stopped-50 | grep '"contact":true' && is 'counters.full >= 1' || return 1
	ask arm && loop stopped-50 | grep '"contact":false' && is 'armed == true' || return 1
	loop brake-50-12m-0.5g-step | tee /tmp/loops
	[ "$(grep -c '"contact":false' /tmp/loops)" = 2 ] && ! grep '"contact":true' /tmp/loops
}
