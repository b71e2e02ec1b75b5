#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds the Debian package, boots the virtual machine and runs guest-deb there: installed, used, removed. TAP.
# O: the build (default build); the console's whole log is kept in $O/system/.
set -eu
O=$(realpath -m "${O:-build}")
cd "$(dirname "$0")/../.."
payload=$O/system/deb
rm -rf "$payload"
mkdir -p "$payload/logs"
flock "$O/system.lock" make --no-print-directory -s O="$O" WITH_CUDA=no deb >&2
cp "$O"/deb/aebmc_*.deb "$payload/aebmc.deb"
"$O/aebmc" generate --drive follow --out "$payload/logs/follow.log"
"$O/aebmc" generate --drive brake --config can-dbc/vehicles/ars408.conf --out "$payload/logs/ars408.log"
build/venv/bin/python tests/strange_car.py --plant sign --dbc "$payload/logs/strange.dbc" --log "$payload/logs/strange.log" ||
	echo "# no strange car: cantools is missing"
cp tests/system/lib.sh "$payload/"
cp tests/system/guest-deb "$payload/guest"

if ! tests/system/boot.sh behaviour "$payload" 1800 >"$O/system/deb.console" 2>&1; then
	echo "# the virtual machine did not power off by itself"
fi
tr -d '\r' <"$O/system/deb.console" | sed -n '/^\(not \)\{0,1\}ok \|^1\.\.\|^# /p'
