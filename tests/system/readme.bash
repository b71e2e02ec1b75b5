# SPDX-License-Identifier: MIT
# System tests: the way from a fresh machine to a running service as the documents tell it.

# The commands of the section "From a flashed Jetson to a running service", wherever it stands; without those marked as
# Jetson's.
readme_commands() {
	awk '/^#+ / { inside = /From a flashed Jetson to a running service/ } /^```/ { block = inside && !block; next }
	     block && !/# Jetson/' /payload/documents.md
}
documented_way_leads_to_a_running_service() {
	local command
	stop
	ip link set can0 down
	ip link set can1 down
	controllers_up && ip link set can0 down || return 1
	readme_commands >/tmp/commands
	[ "$(wc -l </tmp/commands)" -ge 20 ] || return 1
	while read -r command; do
		echo "\$ $command"
		case $command in candump*) within 5 sh -c 'ip -br link show can0 | grep UP' && traffic follow.log can1 ;; esac
		timeout 20 bash -c "$command" </dev/null || case $command in
		'aebmc doctor'*) ;; # exit 1: it names what this machine lacks
		*) return 1 ;;
		esac
		# 16,384 samples take the emulation longer to compute than the rest of this test
		case $command in cp*car.conf) printf '\n[mc]\nsamples = 256\n' >>/etc/aebmc/car.conf ;; esac
	done </tmp/commands
	grep -q RestartSec /etc/systemd/network/80-aebmc-can.network && ip -details link show can0 | grep 'bitrate 500000' &&
		[ "$(systemctl is-active aebmcd@car)" = active ] && ls /var/lib/aebmc/car && within 5 car_is_armed || return 1
	listen can1$OURS
	pause 1
	heard
	systemctl disable --now aebmcd@car
	systemctl stop aebmc-irq
	grep -q 'AEB_REQUEST: state ARMED' /tmp/words
}
car_is_armed() { aebmc top --once car | grep -q '^state *ARMED'; }
interrupt_thread_is_raised_each_time_the_interface_comes_up() {
	ip link set can0 down
	ip link set can1 down
	systemctl start aebmc-irq && controllers_up || return 1
	within 5 irq_raised || return 1
	ip link set can0 down
	pause 0.5
	ip link set can0 up
	within 5 irq_raised
	local ok=$?
	systemctl stop aebmc-irq
	return $ok
}
irq_raised() {
	ps -e -o rtprio=,comm= | grep 'irq/.*can0' | grep '^ *70 '
}
