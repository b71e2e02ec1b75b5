#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/system/boot.sh behaviour|timing PAYLOAD-DIR [SECONDS]
# Boots the virtual machine with PAYLOAD-DIR as a second disk, runs its ./guest, prints the console, powers off.
# behaviour: two processors, as fast as the host allows; no latency means anything there.
# timing:    one processor whose time counts instructions (icount), so that a busy host cannot make a frame late while
#            a lock, a page fault or an inversion still does.
set -eu
mode=$1 payload=$2 limit=${3:-900}
here=$(cd "$(dirname "$0")" && pwd)
image=$("$here/image.sh")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

size=$(du -sm "$payload" | cut -f1)
mke2fs -q -t ext4 -L payload -d "$payload" "$work/payload.img" "$((size + 32))M" >/dev/null
qemu-img create -q -f qcow2 -b "$image/disk.img" -F raw "$work/disk.qcow2"

# Two emulated kvaser controllers on one bus: a real driver with bit rate, state and error counters.
case $mode in
behaviour)
	cpu='-accel tcg,thread=multi -smp 2'
	can='-object can-bus,id=cb0 -device kvaser_pci,canbus=cb0 -device kvaser_pci,canbus=cb0'
	;;
timing)
	cpu='-accel tcg -icount shift=2 -smp 1'
	can=
	;;
*)
	echo "boot.sh: mode is behaviour or timing, not '$mode'" >&2
	exit 2
	;;
esac
# shellcheck disable=SC2086 # the option lists are words
timeout --foreground "$limit" qemu-system-x86_64 $cpu -cpu max -m 1024 -nodefaults -no-reboot -display none \
	-serial stdio -kernel "$image/vmlinuz" -initrd "$image/initrd" \
	-append "console=ttyS0 quiet loglevel=3 systemd.show_status=no panic=-1 net.ifnames=0 audit=0 mitigations=off" \
	-drive "file=$work/disk.qcow2,if=virtio,format=qcow2" -drive "file=$work/payload.img,if=virtio,format=raw,readonly=on" \
	$can </dev/null
