#!/bin/sh
# aebmc doctor on made-up machines: one on which everything is as it should be, and for each point one on which it is
# not. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
root=$tmp/root

# put FILE TEXT: a file of the made-up machine
put() {
	mkdir -p "$root/${1%/*}"
	printf '%s\n' "$2" >"$root/$1"
}

# irq PRIORITY POLICY: the interrupt thread of can0, its name with a blank in it
irq() {
	put proc/77/comm "irq/24-can0 rx"
	put proc/77/stat "77 (irq/24-can0 rx) S 2 $(seq -s ' ' 5 39) $1 $2 0 0"
}

good_machine() {
	rm -rf "$root"
	put proc/version 'Linux version 6.1.0-rt SMP PREEMPT_RT'
	put sys/kernel/realtime 1
	put proc/sys/kernel/osrelease 6.1.0-rt
	put boot/config-6.1.0-rt '# CONFIG_RT_GROUP_SCHED is not set'
	put proc/sys/kernel/sched_rt_runtime_us -1
	put sys/devices/system/cpu/isolated 2-3
	put sys/devices/system/cpu/nohz_full 2-3
	put proc/cmdline 'quiet isolcpus=managed_irq,domain,2-3 nohz_full=2-3 rcu_nocbs=2-3 irqaffinity=0-1'
	put sys/fs/cgroup/system.slice/cpuset.cpus.effective 0-1
	irq 70 1
	for cpu in 0 1 2 3; do
		put sys/devices/system/cpu/cpu$cpu/cpufreq/scaling_governor performance
	done
	put etc/nv_tegra_release '# R36'
	put var/lib/nvpmodel/status 'pmode:0000'
	put sys/class/devfreq/17000000.gpu/min_freq 1300500000
	put sys/class/devfreq/17000000.gpu/max_freq 1300500000
	put sys/kernel/debug/bpmp/debug/clk/emc/rate 3199000000
	put sys/kernel/debug/bpmp/debug/clk/emc/max_rate 3199000000
	put proc/self/limits 'Max locked memory  unlimited  unlimited  bytes
Max realtime priority  80  80  '
	put dev/cpu_dma_latency ''
	chmod 660 "$root/dev/cpu_dma_latency"
	put etc/group "root:x:0:
aebmc:x:$(stat -c %g "$root/dev/cpu_dma_latency"):"
	put lib/modules/6.1.0-rt/modules.dep 'kernel/net/can/can-raw.ko: kernel/net/can/can.ko
kernel/drivers/net/can/vcan.ko:
kernel/net/can/can-gw.ko.xz: kernel/net/can/can.ko'
	put usr/lib/x86_64-linux-gnu/liblttng-ust.so.1 ''
	put usr/bin/lttng ''
	put dev/nvidiactl ''
	put sys/class/net/can0/type 280
	put sys/class/net/can0/flags 0x40041
	put sys/class/net/can0/statistics/rx_packets 1000
	put sys/class/net/eth0/type 1
}

doctor() {
	"$AEBMC" doctor --root "$root" --seconds 0 --json "$@" >"$tmp/out" 2>"$tmp/err"
}

# verdict NAME [OPTION...]: of one check
verdict() {
	check=$1
	shift
	doctor "$@"
	python3 -c 'import json, sys
print([c["verdict"] for c in json.load(open(sys.argv[1]))["checks"] if c["name"] == sys.argv[2]][0])' "$tmp/out" "$check"
}

good_machine
exits "a machine as it should be" 0 "$AEBMC" doctor --root "$root" --seconds 0 --json
json "schema; ready; nothing is missing or advised" "$tmp/out" \
	'j["schema"] == "aebmc.doctor.1" and j["ready"] is True and {c["verdict"] for c in j["checks"]} == {"good", "none"}'
json "each point says what is, what should be and what mends it" "$tmp/out" \
	'all(c["is"] and c["should"] and c["mend"] for c in j["checks"]) and len(j["checks"]) == 27'
json "the only CAN interface is looked at; every machine check but none is good" "$tmp/out" \
	'all(c["verdict"] == "good" for c in j["checks"] if not c["interface"]) and {c["interface"] for c in j["checks"]} == {None, "can0"}'

# spoil NAME VERDICT FILE TEXT: with this file the check comes to this
spoil() {
	good_machine
	put "$3" "$4"
	is "$1: '$(printf '%s' "$4" | head -n 1 | cut -c1-50)' is $2" "$(verdict "$1")" "$2"
}

# without NAME VERDICT FILE: without this file or folder the check comes to this
without() {
	good_machine
	rm -rf "${root:?}/$3"
	is "$1 without ${3##*/} is $2" "$(verdict "$1")" "$2"
}

good_machine
rm "$root/sys/kernel/realtime"
is "rt_kernel: the version says it too" "$(verdict rt_kernel)" good
put proc/version 'Linux version 6.1.0 SMP PREEMPT_DYNAMIC'
is "rt_kernel: neither says it" "$(verdict rt_kernel)" missing
exits "something missing" 1 "$AEBMC" doctor --root "$root" --seconds 0
like "in words: what is" "$tmp/out" '^MISSING +rt_kernel +not one: Linux version 6\.1\.0 SMP'
like "what should be" "$tmp/out" '^ +should be: a PREEMPT_RT kernel'
like "what mends it" "$tmp/out" '^ +mend it: +apt-get install linux-image-rt'
spoil rt_group missing boot/config-6.1.0-rt CONFIG_RT_GROUP_SCHED=y
spoil rt_group missing sys/fs/cgroup/cpu/cpu.rt_runtime_us 0
without rt_group none boot
good_machine
echo CONFIG_RT_GROUP_SCHED=y | gzip >"$root/proc/config.gz"
is "rt_group: the kernel's own configuration counts" "$(verdict rt_group)" missing
echo '# CONFIG_RT_GROUP_SCHED is not set' | gzip >"$root/proc/config.gz"
rm -r "$root/boot"
is "rt_group: with none beside it, too" "$(verdict rt_group)" good
echo CONFIG_RT_GROUP_SCHED=y >"$root/proc/config.gz"
is "rt_group: what is no gzip says nothing" "$(verdict rt_group)" none
spoil throttling advice proc/sys/kernel/sched_rt_runtime_us 950000
without throttling none proc/sys
spoil isolated advice sys/devices/system/cpu/isolated ''
spoil nohz_full advice sys/devices/system/cpu/nohz_full ' (null)'
spoil nohz_full advice sys/devices/system/cpu/nohz_full 3
spoil rcu_nocbs advice proc/cmdline 'rcu_nocbs=2'
spoil irq_affinity advice proc/cmdline 'quiet'
spoil irq_affinity advice proc/cmdline 'irqaffinity=0-2'
spoil cpuset advice sys/fs/cgroup/system.slice/cpuset.cpus.effective 0-3
spoil cpuset none sys/devices/system/cpu/isolated ''
for bad in "50 1" "60 1" "80 1" "0 0"; do
	good_machine
	# shellcheck disable=SC2086 # words
	irq $bad
	is "can_irq: priority and policy $bad is advice" "$(verdict can_irq)" advice
done
without can_irq none proc/77
spoil governor advice sys/devices/system/cpu/cpu3/cpufreq/scaling_governor schedutil
good_machine
rm -rf "$root"/sys/devices/system/cpu/cpu?
is "governor: a machine that does not change clocks" "$(verdict governor)" none
spoil jetson_power advice var/lib/nvpmodel/status pmode:0002
without jetson_power advice var
without jetson_power none etc
spoil jetson_clocks advice sys/class/devfreq/17000000.gpu/min_freq 306000000
without jetson_clocks none etc
spoil jetson_memory advice sys/kernel/debug/bpmp/debug/clk/emc/rate 2133000000
without jetson_memory none sys/kernel/debug
without jetson_memory none etc
spoil memlock missing proc/self/limits 'Max locked memory  8388608  8388608  bytes'
spoil rtprio missing proc/self/limits 'Max realtime priority  79  80  '
without rtprio missing proc/self
spoil memlock good usr/lib/systemd/system/aebmcd@.service LimitMEMLOCK=infinity
spoil rtprio missing etc/systemd/system/aebmcd@.service LimitRTPRIO=20
good_machine
put usr/lib/systemd/system/aebmcd@.service LimitRTPRIO=80
put proc/123/comm aebmcd
put proc/123/limits 'Max realtime priority  10  80  '
is "rtprio: what the running daemon has counts" "$(verdict rtprio)" missing
good_machine
chmod 600 "$root/dev/cpu_dma_latency"
is "latency: for root alone" "$(verdict latency)" missing
spoil latency missing etc/group 'aebmc:x:65000:'
without latency missing etc/group
without latency missing dev
without can missing lib
spoil can good proc/net/can/version x
spoil can good sys/module/can_raw/refcnt 0
without vcan advice lib
without can_gw advice lib
without lttng advice usr/bin
without lttng advice usr/lib
without cuda advice dev
car=can-dbc/vehicles/generic.conf
is "cuda: missing where the configuration wants it" "$(verdict cuda --config "$car" --set mc.backend=cuda)" missing
good_machine
is "isolated: not the processor that the configuration wants" "$(verdict isolated --set rt.cpu=1)" advice
is "isolated: both that it wants" "$(verdict isolated --set rt.cpu=2 --set rt.compute_cpu=3)" good

# buses
without up missing sys/class/net/can0/flags
spoil up missing sys/class/net/can0/flags 0x40040
good_machine
rm -r "$root/sys/class/net/can0"
is "up: an interface of the configuration that is not there" "$(verdict up --config "$car")" missing
exits "no interface, no configuration" 0 "$AEBMC" doctor --root "$root" --seconds 0 --json
json "then no bus is looked at" "$tmp/out" 'not [c for c in j["checks"] if c["interface"]]'
good_machine
is "frames: no time to look" "$(verdict frames)" none
is "frames: none in a second" "$(verdict frames --seconds 1)" missing
(
	n=1000
	while :; do
		n=$((n + 1))
		put sys/class/net/can0/statistics/new $n
		mv "$root/sys/class/net/can0/statistics/new" "$root/sys/class/net/can0/statistics/rx_packets"
		sleep 0.1
	done
) &
traffic=$!
is "frames: some" "$(verdict frames --seconds 2)" good
kill $traffic

refuses 2 "$AEBMC" doctor --seconds -1
refuses 2 "$AEBMC" doctor --bitrate x
refuses 2 "$AEBMC" doctor --sample-point 1.5
refuses 2 "$AEBMC" doctor extra
refuses 78 "$AEBMC" doctor --config "$tmp/nosuch.conf"
done_testing
