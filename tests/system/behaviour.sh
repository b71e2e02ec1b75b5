#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the build into a payload, boots the virtual machine with it and runs its tests. TAP on standard output.
# O: the build (default build); the console's whole log is kept in $O/system/. ONLY: names of tests (tests/system/guest)
# to run instead of all. MODE=multi: two processors in the host's time, see boot.sh.
set -eu
mode=${MODE:-behaviour}
O=$(realpath -m "${O:-build}")
cd "$(dirname "$0")/../.."
payload=$O/system/$mode
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
awk '{ t = substr($1, 2) + 0 } NR == 1 { start = t } t >= start + 17' "$payload/logs/brake.log" >"$payload/logs/brake-end.log"
recorded=../shared/canlog/comma2k19-rav4-seg40-speed-radar.log.xz
[ ! -r $recorded ] || xz -dc $recorded >"$payload/logs/recorded.log"
cp tests/system/guest tests/system/*.bash tests/system/lib.sh tests/system/scenes.py "$payload/"
cat README.md systemd/README.md >"$payload/documents.md"
[ -z "${ONLY:-}" ] || printf '%s\n' $ONLY >"$payload/only"
[ "$mode" = behaviour ] || : >"$payload/untimed"

if ! tests/system/boot.sh "$mode" "$payload" 1100 >"$O/system/$mode.console" 2>&1; then
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
