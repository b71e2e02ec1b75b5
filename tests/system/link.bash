# SPDX-License-Identifier: MIT
# System tests: interfaces that go and come, and real controllers (two emulated kvaser ones on one bus).

TWO=('bus.interfaces=vcan0 vcan2' bus.out_interface=vcan2 'message EGO.interface=vcan0' 'message DRIVER.interface=vcan0'
	'message LEAD.interface=vcan0')

# When the interface went down, as a socket on it learns it: `ip` itself takes longer than a period.
note_down() {
	python3 -c 'import os, socket, sys, time
s = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
s.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, b"")
s.bind((sys.argv[1],))
os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(90))
try:
    s.recv(16)
except OSError:
    at = time.time()
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    print("%.6f" % at)' "$1" >/tmp/down &
	watcher=$!
	pause 1
}
link_loss_is_said_on_every_other_bus_within_a_period() {
	good "${TWO[@]}" || return 1
	listen any$OURS
	note_down vcan0
	ip link set vcan0 down
	wait $watcher
	pause 0.1
	heard
	grep -C 3 -m 1 INHIBIT /tmp/words
	cat /tmp/down
	has_reason BUS_DOWN && state_is INHIBIT &&
		at_most 20 "$(first_after "$(cat /tmp/down)" 'vcan2 +AEB_REQUEST: state INHIBIT')" "INHIBIT on the other bus after"
	local ok=$?
	traffic_stop
	ip link set vcan0 up
	return $ok
}
first_on() { awk -v on="$1" '$2 == on && /AEB_REQUEST/ { print; exit }' /tmp/words; }
lost_output_is_said_in_the_status() {
	good "${TWO[@]}" && ip link set vcan2 down && within 1 has_reason BUS_DOWN && state_is INHIBIT || return 1
	listen any$OURS
	ip link set vcan2 up
	armed
	heard
	first_on vcan2
	[[ $(first_on vcan2) == *"state INHIBIT"* ]]
}
buffers_full_inhibits() {
	good "${TWO[@]}" && tc qdisc add dev vcan2 root tbf rate 8kbit burst 64 limit 64 &&
		within 2 is 'state == INHIBIT and counters.tx_refused > 5' && has_reason TX_REFUSED
	local ok=$?
	tc qdisc del dev vcan2 root
	[ $ok = 0 ] && within 5 lacks_reason TX_REFUSED && armed
}
link_down_inhibits_up_arms_again() {
	good && ip link set vcan0 down && within 1 has_reason BUS_DOWN && state_is INHIBIT && traffic_stop || return 1
	pause 1
	listen any
	ip link set vcan0 up
	traffic follow.log
	armed
	heard
	first_on vcan0
	[[ $(first_on vcan0) == *"state INHIBIT"* ]] || return 1
	local first
	first=$(awk '/ 110#/ { gsub(/[()]/, "", $1); print $1; exit }' /tmp/bus.log)
	at_most 1000 "$(first_after "$first" 'AEB_REQUEST: state ARMED')" "ARMED after good traffic began by"
}
deleted_and_created_again() {
	good && ip link del vcan0 && within 1 has_reason BUS_DOWN && state_is INHIBIT || return 1
	traffic_stop
	pause 0.5
	create vcan0
	good && within 2 is 'counters.confirmed > 0'
}
missing_at_start() {
	stop
	ip link del vcan0
	start && within 1 has_reason BUS_DOWN && active || return 1
	create vcan0
	good
}
create() { ip link add dev "$1" type vcan && ip link set up "$1"; }

controllers_up() {
	ip link set can0 up type can bitrate 500000 sample-point 0.875 restart-ms 100 && ip link set can1 up type can bitrate 500000
}
kvaser_state_is_known() {
	is 'links.0.name == can0 and links.0.known == true and links.0.bitrate == 500000 and links.0.restart_ms == 100' &&
		is 'links.0.state == error-active and links.0.tx_errors == 0 and links.0.rx_errors == 0 and links.0.sample_point > 0.8'
}
frames_cross_real_controllers_and_arm() {
	stop
	controllers_up && start bus.interfaces=can0 bus.allow_local=no || return 1
	traffic follow.log can1
	armed && is 'counters.confirmed > 20 and counters.rx_local == 0' && kvaser_state_is_known || return 1
	listen can1$OURS
	pause 1
	heard
	[ "$(grep -c 'AEB_REQUEST: state ARMED' /tmp/words)" -ge 40 ]
}
controller_down_is_seen() {
	ip link set can0 down && within 1 has_reason BUS_DOWN && state_is INHIBIT && within 1 is 'links.0.state == stopped' &&
		is 'links.0.up == false' || return 1
	ip link set can0 up && armed && is 'links.0.state == error-active'
}
# The frame says error-passive, the controller itself that it is not: drivers do not always say the end of it by a frame.
recovered_controller_is_asked() {
	cansend can0 20000004#0020000000000000 && within 1 has_reason BUS_PASSIVE && within 3 lacks_reason BUS_PASSIVE && armed
}
# controller_rows VERDICT NAME...: what the doctor says of can0
controller_rows() {
	local row
	for row in "${@:2}"; do
		grep -qE "^$1 +can0 $row" /tmp/doctor || return 1
	done
}
wrong_bit_rate_is_seen() {
	aebmc doctor --config $CONF >/tmp/doctor
	grep can0 /tmp/doctor
	controller_rows good up frames acknowledged bit_rate sample_point restart_ms || return 1
	ip link set can0 down && ip link set can0 up type can bitrate 250000 && within 1 is 'links.0.bitrate == 250000' || return 1
	aebmc doctor --config $CONF >/tmp/doctor
	grep can0 /tmp/doctor
	controller_rows MISSING bit_rate && controller_rows good restart_ms
}

# On vcan2 there are our frames alone, and none of them leaves: as in a parked car, where nobody acknowledges.
bus_that_takes_nothing_is_no_hang() {
	local p
	stop
	tc qdisc add dev vcan2 root netem delay 200s limit 4
	start "${TWO[@]}" && p=$(pid) && pause 5 && [ "$(pid)" = "$p" ] && has_reason TX_REFUSED
	local ok=$?
	tc qdisc del dev vcan2 root
	[ $ok = 0 ] && good "${TWO[@]}" && [ "$(pid)" = "$p" ]
}
echo_that_stays_away_restarts() {
	local p since ok
	good "${TWO[@]}" && p=$(pid) || return 1
	since=$(now)
	tc qdisc add dev vcan2 root netem loss 100%
	pause 0.5
	lacks_reason TX_REFUSED && within 3 another_pid "$p" && said "$since" 'Watchdog timeout'
	ok=$?
	tc qdisc del dev vcan2 root
	[ $ok = 0 ] && armed
}

journal_has_the_reason_as_a_field() {
	local since
	good && traffic_stop && since=$(now) && ip link set vcan0 down && within 2 journal_field "$since" AEBMC_REASON=BUS_DOWN PRIORITY=4
	local ok=$?
	ip link set vcan0 up
	[ $ok = 0 ] && ! journal_field "$since" AEBMC_REASON=BUS_OFF
}
# journal_field SINCE FIELD=VALUE...: is there an entry with these?
journal_field() { journalctl --since "$1" -o cat --no-pager "${@:2}" _SYSTEMD_UNIT=aebmcd@test.service | grep -q .; }
