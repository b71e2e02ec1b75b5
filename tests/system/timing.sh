#!/bin/sh
# SPDX-License-Identifier: MIT
# Boots the virtual machine for guest-timing. TAP on standard output. O: the build (default build); ONLY: see payload.sh.
set -eu
export O="${O:-build}"
O=$(realpath -m "$O")
cd "$(dirname "$0")/../.."
tests/system/payload.sh "$O/system/timing" guest-timing
if ! tests/system/boot.sh timing "$O/system/timing" 1800 >"$O/system/timing.console" 2>&1; then
	echo "# the virtual machine did not power off by itself"
fi
tr -d '\r' <"$O/system/timing.console" | sed -n '/^\(not \)\{0,1\}ok \|^1\.\.\|^# /p'
