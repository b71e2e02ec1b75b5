# SPDX-License-Identifier: MIT
# System tests: real-time settings that the kernel refuses, and the processor that a thread is given.

# rtprio LIMIT: what the service may ask for
rtprio() {
	mkdir -p /run/systemd/system/aebmcd@test.service.d
	printf '[Service]\nLimitRTPRIO=%s\n' "$1" >/run/systemd/system/aebmcd@test.service.d/rtprio.conf
	systemctl daemon-reload
}
rtprio_as_shipped() {
	stop
	rm -f /run/systemd/system/aebmcd@test.service.d/rtprio.conf
	systemctl daemon-reload
}
no_fifo_thread() {
	local p
	p=$(pid) && [ "$(ps -L -o cls= -p "$p" | sort -u | tr -d ' ')" = TS ]
}

refused_priority_is_degraded_where_optional() {
	local since
	stop
	rtprio 0
	since=$(now)
	start && traffic follow.log && within 5 state_is DEGRADED && has_reason RT_REFUSED && no_fifo_thread &&
		said "$since" 'RT_REFUSED: real-time thread: SCHED_FIFO 80 refused: .*: set LimitRTPRIO=80 in the unit' &&
		is 'counters.evaluations > 0'
	local ok=$?
	rtprio_as_shipped
	return $ok
}
refused_priority_ends_the_start_where_required() {
	local since
	stop
	rtprio 0
	since=$(now)
	configure rt.policy=required
	systemctl start --no-block aebmcd@test
	within 5 said "$since" 'status=1/FAILURE' && said "$since" 'SCHED_FIFO 60 refused: .*: set LimitRTPRIO=60 in the unit' &&
		! said "$since" '^Started'
	local ok=$?
	rtprio_as_shipped
	[ $ok = 0 ] && good rt.policy=required && two_fifo_threads # what is granted starts
}

# processors PRIORITY: that the thread of this priority may run on
processors() {
	local p tid
	p=$(pid) && tid=$(ps -L -o tid=,rtprio= -p "$p" | awk -v priority="$1" '$2 == priority { print $1 }') && [ -n "$tid" ] &&
		sed -n 's/^Cpus_allowed_list:\t//p' "/proc/$p/task/$tid/status"
}
# The machine has only processor 0 where time counts instructions: that another is refused shows that it was asked for.
processor_is_given_or_refused() {
	local since
	good rt.cpu=0 rt.compute_cpu=0 && [ "$(processors 80)" = 0 ] && [ "$(processors 60)" = 0 ] && lacks_reason RT_REFUSED ||
		return 1
	stop
	since=$(now)
	start rt.cpu=99 && traffic follow.log && within 5 state_is DEGRADED && has_reason RT_REFUSED && two_fifo_threads &&
		said "$since" 'RT_REFUSED: real-time thread: processor 99 refused: .*: choose one that is online'
}
