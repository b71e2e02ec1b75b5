#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the build into a payload and boots the virtual machine with it for guest-trace. TAP on standard output.
# O: the build (default build); the console's whole log is kept in $O/system/.
set -eu
export O="${O:-build}"
O=$(realpath -m "$O")
cd "$(dirname "$0")/../.."
if [ ! -e "$O/trace-lttng.so" ]; then
	echo '1..0 # SKIP needs liblttng-ust-dev'
	exit
fi
payload=$O/system/trace
tests/system/payload.sh "$payload" guest-trace
if ! tests/system/boot.sh timing "$payload" 1800 >"$O/system/trace.console" 2>&1; then
	echo "# the virtual machine did not power off by itself"
fi
tr -d '\r' <"$O/system/trace.console" | sed -n '/^\(not \)\{0,1\}ok \|^1\.\.\|^# /p'
