#!/bin/sh
# The Arm build gives the same bits as the native one: per-figure JSON of a batch, and a whole replayed drive. TAP.
# O: the Arm build; HOST_O: the native build.
set -u
cd "$(dirname "$0")/../.." || exit 1
arm="qemu-aarch64-static $O/aebmc"
host="$HOST_O/aebmc"
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
n=0

same() {
	n=$((n + 1))
	if [ -s "$2" ] && cmp -s "$2" "$3"; then echo "ok $n - $1"; else echo "not ok $n - $1"; fi
}

# figures that do not name the machine
figures() {
	python3 -c 'import json,sys; d=json.load(sys.stdin); [print(k, d[k]) for k in ("samples","mean_m","sd_m","headway_m")]'
}

for kind in sobol philox; do
	$host curve --preset paper --samples 40000 --draws $kind --json | figures >"$dir/host.$kind"
	$arm curve --preset paper --samples 40000 --draws $kind --json | figures >"$dir/arm.$kind"
	same "curve, $kind draws" "$dir/host.$kind" "$dir/arm.$kind"
done

$host generate --drive brake --out "$dir/host.log"
$arm generate --drive brake --out "$dir/arm.log"
same "generated drive" "$dir/host.log" "$dir/arm.log"

conf="--config can-dbc/vehicles/generic.conf --set mc.samples=1024"
$host replay $conf --out "$dir/host.out" "$dir/host.log" >/dev/null
$arm replay $conf --out "$dir/arm.out" "$dir/host.log" >/dev/null
same "replayed drive" "$dir/host.out" "$dir/arm.out"

# objects beside and behind the lead, in several slots
conf="--config can-dbc/vehicles/toyota-tss-p.conf --set mc.samples=1024"
$host generate $conf --drive cutin --out "$dir/cutin.log"
$host replay $conf --out "$dir/host.out" "$dir/cutin.log" >/dev/null
$arm replay $conf --out "$dir/arm.out" "$dir/cutin.log" >/dev/null
same "replayed cut-in" "$dir/host.out" "$dir/arm.out"
echo "1..$n"
