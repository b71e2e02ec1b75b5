#!/bin/sh
# SPDX-License-Identifier: MIT
# usage: tests/system/payload.sh DIR GUEST
# What the virtual machine boots with: the build O (default build) installed below DIR/root, drives in DIR/logs, what the
# guests share, and the script tests/system/GUEST as DIR/guest. ONLY: names of its tests to run instead of all.
set -eu
dir=$(realpath -m "$1") guest=$2
O=$(realpath -m "${O:-build}")
cd "$(dirname "$0")/../.."
rm -rf "$dir"
mkdir -p "$dir/root" "$dir/logs"

flock "$O/system.lock" make --no-print-directory -s O="$O" DESTDIR="$dir/root" PREFIX=/usr install >&2
# Debian's merged /usr: a payload must not replace the guest's /lib link by a folder.
if [ -d "$dir/root/lib" ] && [ ! -L "$dir/root/lib" ]; then
	cp -a "$dir/root/lib/." "$dir/root/usr/lib/" && rm -rf "$dir/root/lib"
fi
for drive in brake follow stopped; do
	"$O/aebmc" generate --drive $drive --out "$dir/logs/$drive.log" >&2
done
awk '{ t = substr($1, 2) + 0 } NR == 1 { start = t } t >= start + 17' "$dir/logs/brake.log" >"$dir/logs/brake-end.log"
recorded=../shared/canlog/comma2k19-rav4-seg40-speed-radar.log.xz
[ ! -r $recorded ] || xz -dc $recorded >"$dir/logs/recorded.log"
cp tests/system/lib.sh tests/system/*.bash "$O/tests/system/stall" "$O/tests/system/trap" "$dir/"
cp "tests/system/$guest" "$dir/guest"
# shellcheck disable=SC2086 # a list
[ -z "${ONLY:-}" ] || printf '%s\n' $ONLY >"$dir/only"
