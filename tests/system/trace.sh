#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the build into a payload and boots the virtual machine with it for guest-trace. TAP on standard output.
# O: the build (default build); the console's whole log is kept in $O/system/.
set -eu
O=$(realpath -m "${O:-build}")
cd "$(dirname "$0")/../.."
if [ ! -e "$O/trace-lttng.so" ]; then
	echo '1..0 # SKIP needs liblttng-ust-dev'
	exit
fi
payload=$O/system/trace
rm -rf "$payload"
mkdir -p "$payload/root" "$payload/logs"
make --no-print-directory -s O="$O" DESTDIR="$payload/root" PREFIX=/usr install >&2
# Debian's merged /usr: a payload must not replace the guest's /lib link by a folder.
if [ -d "$payload/root/lib" ] && [ ! -L "$payload/root/lib" ]; then
	cp -a "$payload/root/lib/." "$payload/root/usr/lib/" && rm -rf "$payload/root/lib"
fi
for drive in brake follow; do
	"$O/aebmc" generate --drive $drive --out "$payload/logs/$drive.log"
done
cp tests/system/lib.sh "$O/tests/system/stall" "$O/tests/system/trap" "$payload/"
cp tests/system/guest-trace "$payload/guest"

if ! tests/system/boot.sh timing "$payload" 900 >"$O/system/trace.console" 2>&1; then
	echo "# the virtual machine did not power off by itself"
fi
tr -d '\r' <"$O/system/trace.console" | sed -n '/^\(not \)\{0,1\}ok \|^1\.\.\|^# /p'
