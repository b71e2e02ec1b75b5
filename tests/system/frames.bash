# SPDX-License-Identifier: MIT
# System tests: frames that are late, missing, repeated, out of order, damaged, forged or too many.

# ---- a gateway: traffic on vcan1 arrives on vcan0 as from another controller ------------------------------------

# What cangw needs to sign anew (AUTOSAR E2E Profile 2): the table of CRC-8 0x2F and a message's DataIDList.
crc_table() {
	local i b c
	for ((i = 0; i < 256; i++)); do
		for ((c = i, b = 0; b < 8; b++)); do
			((c = c & 128 ? (c << 1 ^ 0x2F) & 255 : c << 1))
		done
		printf %02X $c
	done
}
data_ids() {
	sed -n "s/^BA_ \"E2EDataIDList\" BO_ $((16#$1)) \"\(.*\)\";/\1/p" /usr/share/aebmc/vehicles/generic.dbc | tr -d ' '
}

# gateway [ID MODIFICATION [resign]]: everything passes; from now on frames of ID are modified. Without a gap.
gateway() {
	local sign=
	if [ $# -eq 0 ]; then
		cangw -A -s vcan1 -d vcan0 -e
		return
	fi
	[ "${3:-}" = resign ] && sign="-c 1:7:0:FF:FF:$(crc_table) -p 2:$(data_ids "$1")"
	# shellcheck disable=SC2086 # two options and their values
	cangw -A -s vcan1 -d vcan0 -e -f "$1:7FF" -m "$2" $sign && cangw -A -s vcan1 -d vcan0 -e -f "$1~7FF" &&
		cangw -D -s vcan1 -d vcan0 -e
}
gateway_off() { cangw -F; }

# through COMMAND...: armed on traffic through the plain gateway with frames of this machine refused, as in a car; then
# COMMAND; the gateway and what netem does to vcan1 end with it
through() {
	local ok
	if ! runs_with bus.allow_local=no; then
		stop
		start bus.allow_local=no || return 1
	fi
	gateway_off
	gateway && traffic follow.log vcan1 && armed && "$@"
	ok=$?
	tc qdisc del dev vcan1 root 2>/dev/null
	gateway_off
	traffic_stop
	return $ok
}
netem() { tc qdisc replace dev vcan1 root netem "$@"; }
calm() { tc qdisc del dev vcan1 root; }
grows() {
	local was
	was=$(field "$1") || return 1
	within 3 is "$1 > $((was + $2))"
}

repeated() { netem duplicate 100% && grows rejected.counter 100 && state_is ARMED; }
repeated_frames_are_not_used() { through repeated; }

delayed() {
	netem delay 400ms && within 1 state_is INHIBIT && has_reason EGO_STALE && armed && calm && armed
}
delayed_frames_inhibit_and_pass() { through delayed; }

reordered() { netem delay 70ms reorder 40% && grows rejected.counter 20 && calm && armed && is 'counters.warn == 0'; }
reordered_frames_are_not_used() { through reordered; }

corrupted() { netem corrupt 30% && grows rejected.crc 20 && calm && armed && is 'counters.warn == 0'; }
corrupted_frames_are_not_used() { through corrupted; }

# falsified REASON ID MODIFICATION [resign]
falsified() {
	gateway "${@:2}" || return 1
	within 2 has_reason "$1" && state_is INHIBIT && return
	cangw -L | cut -c 1-80
	ask status | grep -oE '"(counters|rejected|scene)":\{[^}]*\}'
	return 1
}
falsified_frames_inhibit() { through falsified INPUT_CHECK 100 XOR:D:100.8.0000001000000000 && is 'rejected.crc > 2'; }
resigned() {
	local crc
	crc=$(field rejected.crc) && falsified IMPLAUSIBLE 100 XOR:D:100.8.0000001000000000 resign &&
		is "rejected.crc == $crc and rejected.implausible > 2"
}
resigned_frames_are_implausible() {
	stop
	through resigned
}
# A counter that stands still, signed: a controller that repeats itself.
signed_frames_with_a_frozen_counter_are_stale() {
	through falsified RADAR_STALE 110 AND:D:110.8.FFF0FFFFFFFFFFFF resign && is 'rejected.counter > 2 and rejected.crc == 0'
}

# ---- other senders ------------------------------------------------------------------------------------------------

stale_input_inhibits_within_3_periods() {
	good || return 1
	listen vcan0
	pause 0.3
	traffic_stop
	pause 0.3
	heard
	at_most 61 "$(first_after "$(last_of 100)" 'AEB_REQUEST: state INHIBIT')" "3 periods of 20 ms and a wake-up: INHIBIT after" &&
		has_reason EGO_STALE
}
good_traffic_arms_within_1_s() {
	good && traffic_stop && within 2 state_is INHIBIT && pause 2 || return 1
	listen vcan0
	traffic follow.log
	armed
	heard
	local first
	first=$(awk '/ 110#/ { gsub(/[()]/, "", $1); print $1; exit }' /tmp/bus.log)
	at_most 1000 "$(first_after "$first" 'AEB_REQUEST: state ARMED')" "ARMED after"
}
foreign_sender_inhibits() {
	good && cansend vcan0 2A0#0000000000000000 && within 1 has_reason FOREIGN_ID && state_is INHIBIT &&
		is 'counters.foreign >= 1' && within 5 lacks_reason FOREIGN_ID && armed
}
local_frames_are_refused() {
	stop
	start bus.allow_local=no || return 1
	traffic follow.log
	within 3 is 'counters.rx_local > 50' && state_is INIT && is 'counters.frames == 0'
}

# ---- error frames, overflow ---------------------------------------------------------------------------------------

bus_off_inhibits() {
	good && cansend vcan0 20000040#0000000000000000 && within 1 has_reason BUS_OFF && state_is INHIBIT &&
		is 'counters.error_frames >= 1' || return 1
	cansend vcan0 20000100#0000000000000000 # restarted
	within 3 lacks_reason BUS_OFF && armed
}
bus_off_lasts_until_restarted() {
	good bus.transmit=none && traffic_stop && cansend vcan0 20000040#0000000000000000 && within 1 has_reason BUS_OFF &&
		pause 2 && has_reason BUS_OFF && cansend vcan0 20000100#0000000000000000 && within 3 lacks_reason BUS_OFF
}
error_passive_degrades_until_it_is_over() {
	good && cansend vcan0 20000004#0020000000000000 && within 1 has_reason BUS_PASSIVE && pause 2 && has_reason BUS_PASSIVE &&
		state_is DEGRADED && cansend vcan0 20000004#0040000000000000 && within 2 lacks_reason BUS_PASSIVE && armed
}
error_flood_is_survived() {
	good || return 1
	local misses
	misses=$(field counters.period_misses)
	awk 'BEGIN { for (i = 0; i < 20000; i++) { print "(0.000000) can0 20000004#0004000000000000" } }' >/tmp/flood.log
	canplayer -t -I /tmp/flood.log vcan0=can0
	is "counters.error_frames > 10000" && within 5 state_is ARMED && echo "said: $(field counters.error_frames) error frames" || return 1
	[ $TIMED = no ] || is "counters.period_misses == $misses"
}
receive_overflow_is_counted() {
	good || return 1
	local p
	p=$(pid) || return 1
	kill -STOP "$p"
	canplayer -t -I $LOGS/brake-end.log vcan0=can0
	kill -CONT "$p"
	within 1 has_reason RX_LOST && is 'counters.rx_dropped > 100' && echo "said: $(field counters.rx_dropped) lost" &&
		state_is INHIBIT && armed
}

# Unknown identifiers, and those of ours in the other format or as remote frames, do not even wake the daemon.
unmapped_frames_are_filtered_out() {
	local frames frame
	good && traffic_stop && pause 0.3 && frames=$(field counters.frames) || return 1
	for frame in 7A5#0000000000000000 00000100#0000000000000000 100#R8; do
		cansend vcan0 $frame || return 1
	done
	pause 0.3
	is "counters.frames == $frames" && cansend vcan0 100#0000000000000000 && within 1 is "counters.frames == $((frames + 1))"
}
