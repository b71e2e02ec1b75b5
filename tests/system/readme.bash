# SPDX-License-Identifier: MIT
# System tests: the way from a fresh machine to a running service as the documents tell it.

# The commands of the section "From a flashed Jetson to a running service", wherever it stands; without those marked as
# Jetson's, or as of the source folder.
readme_commands() {
	awk '/^#+ / { inside = /From a flashed Jetson to a running service/ } /^```/ { block = inside && !block; next }
	     block && !/# (Jetson|source)/' /payload/documents.md
}
# Not as documented, so that what is documented has something to do; can1 is the rest of the bus.
controllers_otherwise() {
	ip link set can0 down
	ip link set can0 type can bitrate 250000 sample-point 0.75 restart-ms 0 && ! can0_is_as_documented && ip link set can0 up
}
can0_is_as_documented() {
	ip -details link show can0 >/tmp/can0
	cat /tmp/can0
	grep -q 'state UP' /tmp/can0 && grep -q 'bitrate 500000 sample-point 0.875' /tmp/can0 && grep -q 'restart-ms 100\b' /tmp/can0
}
# around COMMAND: what the machine, or somebody there, does before it
around() {
	case $1 in
	'ip link set can0 up'*) ip link set can0 down ;;
	cp*80-aebmc-can.network) can0_is_as_documented && controllers_otherwise ;;
	candump*) within 5 can0_is_as_documented && traffic follow.log can1 ;;
	esac
}
documented_way_leads_to_a_running_service() {
	local command
	stop
	ip link set can1 down
	ip link set can1 up type can bitrate 500000 && controllers_otherwise || return 1
	readme_commands >/tmp/commands
	[ "$(wc -l </tmp/commands)" -ge 30 ] || return 1
	while read -r command; do
		echo "\$ $command"
		around "$command" || return 1
		timeout 20 bash -c "$command" </dev/null || case $command in
		'aebmc doctor'*) ;; # exit 1: it names what this machine lacks
		*) return 1 ;;
		esac
		# 16,384 samples take the emulation longer to compute than the rest of this test
		case $command in cp*car.conf) printf '\n[mc]\nsamples = 256\n' >>/etc/aebmc/car.conf ;; esac
	done </tmp/commands
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
