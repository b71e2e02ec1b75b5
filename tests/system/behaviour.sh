#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the build into a payload, boots the virtual machine with it and runs its tests. TAP on standard output.
# O: the build (default build); the console's whole log is kept in $O/system/. ONLY: names of tests (tests/system/guest)
# to run instead of all. MODE=multi: two processors in the host's time, see boot.sh.
set -eu
mode=${MODE:-behaviour}
export O="${O:-build}"
O=$(realpath -m "$O")
cd "$(dirname "$0")/../.."
payload=$O/system/$mode
tests/system/payload.sh "$payload" guest
cp tests/system/scenes.py "$payload/"
cat README.md systemd/README.md >"$payload/documents.md"
[ "$mode" = behaviour ] || : >"$payload/untimed"

if ! tests/system/boot.sh "$mode" "$payload" 1800 >"$O/system/$mode.console" 2>&1; then
	echo "# the virtual machine did not power off by itself"
fi
tr -d '\r' <"$O/system/$mode.console" >"$O/system/$mode.log"
sed -n '/^\(not \)\{0,1\}ok \|^# /p' "$O/system/$mode.log"
n=$(sed -n 's/^1\.\.//p' "$O/system/$mode.log")
[ -n "$n" ] || exit 1 # it did not come to its end

# Some of our frames as candump saw them there, to another decoder.
python=build/venv/bin/python
n=$((n + 1)) name="our frames are the same to cantools"
sed -n 's/^#frame //p' "$O/system/$mode.log" >"$O/system/frames.log"
if ! $python -c 'import cantools' 2>/dev/null; then
	echo "ok $n - $name # SKIP needs cantools"
elif "$O/aebmc" decode "$O/system/frames.log" >"$O/system/frames.words" &&
	$python tests/system/frames_cantools.py "$O/system/frames.log" "$O/system/frames.words"; then
	echo "ok $n - $name"
else
	echo "not ok $n - $name"
fi
echo "1..$n"
