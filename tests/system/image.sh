#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/system/image.sh
# Builds, once, the virtual machine of the system tests: Debian 12 with its PREEMPT_RT kernel, systemd, can-utils and
# LTTng. Prints the folder that holds disk.img, vmlinuz and initrd. Cached outside the clone, by the hash of this file.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cache=${AEBMC_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/aebmc}
key=$(cat "$here/image.sh" "$here/init" | sha256sum | cut -c1-12)
image=$cache/image-$key
if [ -e "$image/complete" ]; then
	echo "$image"
	exit 0
fi
work=$image.$$
root=$work/root
rm -rf --one-file-system "$work"
mkdir -p "$work"
trap 'rm -rf --one-file-system "$work"' EXIT

packages=linux-image-rt-amd64,systemd,systemd-sysv,udev,dbus,iproute2,kmod,procps,can-utils,lttng-tools,liblttng-ust1
packages=$packages,babeltrace2,python3,jq,strace,stress-ng,libsystemd0,libsocketcan2,make,xz-utils
mmdebstrap --quiet --variant=minbase --include="$packages" \
	--dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-exclude=/usr/share/man/*' \
	--dpkgopt='path-exclude=/usr/share/locale/*' bookworm "$root" >&2

# One unit runs what the payload disk brings, with its output on the serial console, then powers off.
mkdir -p "$root/payload"
cat >"$root/etc/systemd/system/payload.service" <<'U'
[Unit]
Description=System tests from the payload disk
After=multi-user.target systemd-udevd.service
[Service]
Type=oneshot
ExecStart=/bin/sh -c 'mount -o ro LABEL=payload /payload && exec /payload/guest'
ExecStopPost=/bin/systemctl --no-block poweroff
StandardOutput=tty
StandardError=tty
TTYPath=/dev/ttyS0
U
mkdir -p "$root/etc/systemd/system/multi-user.target.wants"
ln -s ../payload.service "$root/etc/systemd/system/multi-user.target.wants/payload.service"
for unit in getty@tty1 serial-getty@ttyS0 systemd-timesyncd apt-daily.timer e2scrub_all.timer e2scrub_reap fstrim.timer; do
	ln -sf /dev/null "$root/etc/systemd/system/${unit%.timer}$(case $unit in *.timer) echo .timer ;; *) echo .service ;; esac)"
done
echo aebmc-test >"$root/etc/hostname"
passwd --root "$root" -d root >&2 2>/dev/null || true

# initramfs: busybox and the drivers that find the root disk
kernel=$(ls "$root/lib/modules")
init=$work/initramfs
mkdir -p "$init/bin" "$init/dev" "$init/proc" "$init/sys" "$init/root"
cp /bin/busybox "$init/bin/busybox"
cp "$here/init" "$init/init"
i=0
for driver in crc32c_generic nfit nd_pmem ext4; do
	modprobe -S "$kernel" -d "$root" --show-depends $driver
done | awk '$1 == "insmod" && !seen[$2]++ { print $2 }' | while read -r m; do
	i=$((i + 1))
	cp "$m" "$init/$(printf '%03d' $i).ko"
done
(cd "$init" && find . | cpio --quiet -o -H newc | gzip -1) >"$work/initrd"
cp "$root"/boot/vmlinuz-* "$work/vmlinuz"
rm -rf "${root:?}/boot" "$root/var/cache/apt"/* "$root/var/lib/apt/lists"/*
mke2fs -q -t ext4 -L root -d "$root" "$work/disk.img" 1600M >&2
rm -rf --one-file-system "$root" "$init"
: >"$work/complete"
find "$cache" -maxdepth 1 -name 'image-????????????' -exec rm -rf --one-file-system {} + # older ones
mv "$work" "$image"
trap - EXIT
echo "$image"
