#!/bin/sh
# rt-config/: its scripts on a made-up machine, and the checks of aebmc doctor that verify what they did. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
root=$tmp/root
export AEBMC_ROOT="$root"

put() {
	mkdir -p "$root/${1%/*}"
	printf '%s\n' "$2" >"$root/$1"
}

# verdict CHECK: what aebmc doctor says of the made-up machine
verdict() {
	"$AEBMC" doctor --root "$root" --seconds 0 --json >"$tmp/doctor"
	python3 -c 'import json, sys
print([c["verdict"] for c in json.load(open(sys.argv[1]))["checks"] if c["name"] == sys.argv[2]][0])' "$tmp/doctor" "$1"
}

# Stand-ins that change the made-up machine as the real ones change theirs.
mkdir "$tmp/bin"
cat >"$tmp/bin/chrt" <<'EOP'
#!/bin/sh
if [ "$1" = -f ]; then
	[ -e "$AEBMC_ROOT/refuse" ] && exit 1
	echo "$4 (irq/x) S 2 $(seq -s ' ' 5 39) $3 1 0 0" >"$AEBMC_ROOT/proc/$4/stat"
else
	echo "pid $2's current scheduling priority: $(cut -d' ' -f40 "$AEBMC_ROOT/proc/$2/stat")"
fi
EOP
cat >"$tmp/bin/nvpmodel" <<'EOP'
#!/bin/sh
mkdir -p "$AEBMC_ROOT/var/lib/nvpmodel"
printf 'pmode:%04d\n' "$2" >"$AEBMC_ROOT/var/lib/nvpmodel/status"
EOP
cat >"$tmp/bin/jetson_clocks" <<'EOP'
#!/bin/sh
cp "$AEBMC_ROOT/sys/class/devfreq/1.gpu/max_freq" "$AEBMC_ROOT/sys/class/devfreq/1.gpu/min_freq"
EOP
chmod +x "$tmp/bin"/*
PATH=$tmp/bin:$PATH

put proc/77/comm irq/24-can0
put proc/77/stat "77 (irq/24-can0) S 2 $(seq -s ' ' 5 39) 50 1 0 0"
put proc/78/comm irq/25-eth0
put proc/78/stat "78 (irq/25-eth0) S 2 $(seq -s ' ' 5 39) 50 1 0 0"
put proc/irq/24/smp_affinity_list 0-3
is "before: the CAN interrupt thread is below the compute thread" "$(verdict can_irq)" advice
ok "aebmc-irq" env IRQ_CPUS=0-1 rt-config/aebmc-irq
is "after: it is above" "$(verdict can_irq)" good
is "its interrupt goes to the other processors" "$(cat "$root/proc/irq/24/smp_affinity_list")" 0-1
is "other interrupts are left alone" "$(cut -d' ' -f40 "$root/proc/78/stat")" 50
touch "$root/refuse"
refuses 1 rt-config/aebmc-irq
like "a refusal is told" "$tmp/err" 'irq/24-can0 .*refused'
rm -r "$root/proc/77"
refuses 1 rt-config/aebmc-irq
like "no CAN interrupt thread is told" "$tmp/err" 'no CAN interrupt thread'

put etc/nv_tegra_release R36
put sys/devices/system/cpu/cpu0/cpufreq/scaling_governor schedutil
put sys/class/devfreq/1.gpu/min_freq 1
put sys/class/devfreq/1.gpu/max_freq 2
put var/lib/nvpmodel/status pmode:0002
for check in governor jetson_power jetson_clocks; do
	is "before: $check" "$(verdict $check)" advice
done
ok "aebmc-clocks" rt-config/aebmc-clocks
for check in governor jetson_power jetson_clocks; do
	is "after: $check" "$(verdict $check)" good
done

# What the files say, as the kernel would show it.
# shellcheck disable=SC2016 # it is not ours to expand
words=$(sed -n 's/^GRUB_CMDLINE_LINUX="$GRUB_CMDLINE_LINUX \(.*\)"$/\1/p' rt-config/60-aebmc.cfg)
put proc/cmdline "quiet $words"
isolated=$(echo "$words" | sed 's/.*isolcpus=[a-z_,]*\([0-9-]*\).*/\1/')
put sys/devices/system/cpu/isolated "$isolated"
put sys/devices/system/cpu/nohz_full "$(echo "$words" | sed 's/.*nohz_full=\([0-9-]*\).*/\1/')"
put proc/sys/kernel/sched_rt_runtime_us "$(sed -n 's/^kernel.sched_rt_runtime_us = //p' rt-config/60-aebmc.conf)"
put sys/fs/cgroup/system.slice/cpuset.cpus.effective "$(sed -n 's/^AllowedCPUs=//p' rt-config/cpuset-others.conf)"
for check in isolated nohz_full rcu_nocbs irq_affinity throttling cpuset; do
	is "$check: good with the file of rt-config" "$(verdict $check)" good
done

"$AEBMC" doctor --root "$root" --seconds 0 --json >"$tmp/doctor"
# shellcheck disable=SC2016 # code in Markdown
is "the table names only checks that there are" "$(grep '^| ' rt-config/README.md | sed 's/.*| \([^|]*\) |$/\1/' |
	grep -oE '`[a-z_]+`' | tr -d '`' | sort -u | while read -r name; do
	grep -q "\"name\":\"$name\"" "$tmp/doctor" || echo "$name"
done)" ""
if command -v shellcheck >/dev/null; then
	ok "shellcheck" shellcheck rt-config/aebmc-irq rt-config/aebmc-clocks tools/aebmc.bash
else
	skip "shellcheck" shellcheck
fi
done_testing
