# SPDX-License-Identifier: MIT
# System tests: what the service is once it runs.

# Every question must be able to fail: here none of them may pass.
nothing_passes_without_a_daemon() {
	local passed=
	rm -f /tmp/bus.log /tmp/words
	: >/tmp/bus.log
	: >/tmp/words
	for question in pid active "state_is INIT" "state_is ARMED" "has_reason STARTING" "lacks_reason BUS_DOWN" \
		"is state==INIT" "is .counters.warn >= 0" "is armed == false" "field state" "ask mark" "ask disarm" \
		"another_pid 1" two_fifo_threads memory_is_locked no_capability own_user init_before_traffic \
		second_instance_is_refused "at_most 1000 '' nothing" "first_after 0 state" "last_of 100" "armed 0.1" \
		no_fifo_thread "processors 80" "journal_field 2000-01-01 AEBMC_REASON=BUS_DOWN" "controller_rows good up" \
		requests_reproduce kvaser_state_is_known "said 2000-01-01 READY"; do
		if $question; then
			passed="$passed, $question"
		fi
	done
	echo "passed with nothing there: ${passed#, }"
	[ -z "$passed" ]
}

becomes_ready() { start && active && state_is INIT; }

two_fifo_threads() {
	local p
	p=$(pid) || return 1
	ps -L -o cls,rtprio,comm -p "$p"
	[ "$(ps -L -o cls=,rtprio= -p "$p" | awk '$1 == "FF" { print $2 }' | sort | tr '\n' ' ')" = "60 80 " ]
}
memory_is_locked() {
	local p
	p=$(pid) && awk '/VmLck/ { print "said: " $2, $3; kb = $2 } END { exit !(kb >= 20000) }' "/proc/$p/status"
}
no_capability() {
	local p
	p=$(pid) || return 1
	awk '/^Cap(Inh|Prm|Eff|Bnd|Amb):/ { print; n++; bad += $2 !~ /^0+$/ } END { exit !(n == 5 && !bad) }' "/proc/$p/status"
}
own_user() {
	local p
	p=$(pid) && [ "$(ps -o user= -p "$p")" = aebmc ]
}
init_before_traffic() { state_is INIT && has_reason STARTING; }

exec_time() {
	date -d "$(systemctl show -p ExecMainStartTimestamp --value --timestamp=us aebmcd@test)" +%s.%6N
}
# Both starts with as many samples as shipped. By hand: the service manager takes longer to confine the unit than the
# daemon to speak.
SHIPPED=mc.samples=16384
says_INIT_within_200_ms_of_exec() {
	stop
	configure $SHIPPED
	listen vcan0$OURS
	at=$EPOCHREALTIME
	aebmcd --config $CONF &
	pause 1
	kill $! && wait $!
	heard
	at_most 200 "$(first_after "$at" 'AEB_REQUEST: state INIT')" "first frame after"
}
is_ARMED_within_3_s_of_its_start() {
	stop
	traffic follow.log
	listen vcan0$OURS
	start $SHIPPED && armed
	heard
	at_most 3000 "$(first_after "$(exec_time)" 'AEB_REQUEST: state ARMED')" "ARMED after"
}
requests_every_20_ms() {
	good || return 1
	listen vcan0,2A0:7FF
	pause 3
	heard
	awk '{ gsub(/[()]/, "", $1); if (NR > 1) { d = ($1 - t) * 1000; if (d > most) { most = d } } t = $1 }
	     END { printf "said: %d frames, largest gap %.2f ms\n", NR, most; exit !(NR >= 145 && NR <= 160 && most > 0) }' \
		/tmp/bus.log || return 1
	[ $TIMED = no ] || is 'counters.period_misses == 0'
}
second_instance_is_refused() {
	RUNTIME_DIRECTORY=/run/aebmc/test aebmcd --config $CONF 2>/tmp/second && return 1
	cat /tmp/second
	grep -q 'another aebmcd' /tmp/second
}
default_samples_carried() {
	good $SHIPPED || return 1
	pause 0.6
	echo "said: $(field samples) samples in $(field last_ms.mc) ms of the emulation"
	is 'counters.evaluations > 10 and samples == 16384'
}
doctor_knows_the_machine() {
	aebmc doctor --config $CONF >/tmp/doctor
	cat /tmp/doctor
	grep -qE '^good +rt_kernel' /tmp/doctor && grep -qE '^good +vcan0 frames' /tmp/doctor
}
