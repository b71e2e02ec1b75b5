#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the build into a payload, boots the virtual machine with it and runs its tests. TAP on standard output.
# O: the build (default build); the console's whole log is kept in $O/system/.
set -eu
mode=behaviour
O=${O:-build}
cd "$(dirname "$0")/../.."
payload=$O/system/$mode
rm -rf "$payload"
mkdir -p "$payload/root" "$payload/logs"

make --no-print-directory -s O="$O" DESTDIR="$PWD/$payload/root" PREFIX=/usr install >&2
# Debian's merged /usr: a payload must not replace the guest's /lib link by a folder.
if [ -d "$payload/root/lib" ] && [ ! -L "$payload/root/lib" ]; then
	cp -a "$payload/root/lib/." "$payload/root/usr/lib/" && rm -rf "$payload/root/lib"
fi
for drive in brake follow; do
	"$O/aebmc" generate --drive $drive --out "$payload/logs/$drive.log"
done
cp tests/system/lib.sh "$payload/"
cp tests/system/guest "$payload/"

if ! tests/system/boot.sh "$mode" "$payload" 1500 >"$O/system/$mode.console" 2>&1; then
	echo "# the virtual machine did not power off by itself"
fi
tr -d '\r' <"$O/system/$mode.console" | sed -n '/^\(not \)\{0,1\}ok \|^1\.\.\|^# /p'
