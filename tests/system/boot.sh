#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/system/boot.sh behaviour|timing|multi PAYLOAD-DIR [SECONDS]
# Boots the virtual machine with PAYLOAD-DIR as a second disk, runs its ./guest, prints the console, powers off.
#
# behaviour, timing: one processor whose time counts instructions (icount), 2 ns or 4 ns each. While it has nothing to do
#   its time leaps to the next timer (sleep=off), so that waiting is free, and however busy the host is, no frame is late
#   for it, while a lock, a page fault or an inversion still makes one late. Limits of the daemon are the shipped ones.
# multi: two processors, each a thread of the host, in the host's time. Real parallelism; but a host that is busy stops
#   them for longer than the daemon allows, so no duration means anything, and `make check-system` does not use it.
#
# Both disks are memory (NVDIMM, private copies of the files): a disk that answers in the host's time would let the
# guest's time leap while it waits.
set -eu
mode=$1 payload=$2 limit=${3:-900}
here=$(cd "$(dirname "$0")" && pwd)
image=$("$here/image.sh")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

case $mode in
behaviour) cpu='-accel tcg -icount shift=1,sleep=off -smp 1' ;;
timing) cpu='-accel tcg -icount shift=2,sleep=off -smp 1' ;;
multi) cpu='-accel tcg,thread=multi -smp 2' ;;
*)
	echo "boot.sh: mode is behaviour, timing or multi, not '$mode'" >&2
	exit 2
	;;
esac
disks='' n=0
# disk FILE MIB
disk() {
	disks="$disks -object memory-backend-file,id=m$n,mem-path=$1,size=$2M,share=off -device nvdimm,id=n$n,memdev=m$n"
	n=$((n + 1))
}
size=$(($(du -sm "$payload" | cut -f1) / 16 * 16 + 64))
mke2fs -q -t ext4 -L payload -d "$payload" "$work/payload.img" "${size}M" >/dev/null
disk "$image/disk.img" 1600
disk "$work/payload.img" $size

# Two emulated kvaser controllers on one bus: a real driver with bit rate, state and error counters.
# shellcheck disable=SC2086 # the option lists are words
timeout --foreground "$limit" qemu-system-x86_64 $cpu -cpu max -machine pc,nvdimm=on \
	-m 1024M,slots=2,maxmem=4G -rtc clock=vm -nodefaults -no-reboot -display none -serial stdio \
	-kernel "$image/vmlinuz" -initrd "$image/initrd" \
	-append "console=ttyS0 quiet loglevel=3 systemd.show_status=no panic=-1 net.ifnames=0 audit=0 mitigations=off" \
	$disks -object can-bus,id=cb0 -device kvaser_pci,canbus=cb0 -device kvaser_pci,canbus=cb0 </dev/null
