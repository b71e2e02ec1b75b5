#!/bin/sh
# SPDX-License-Identifier: MIT
# Every loop of kernels/lane_loops.h is vectorised in every vector variant: nothing but speed would tell. The loops are
# the LANE_STAGE and LANE_GROUP lines and every for in a LANE_LOOP function; the compiler reports on them when it builds
# the variant with the Makefile's own flags. gcc 12 and clang 14 both vectorise all of them. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
SRC=kernels/lane_loops.h

# loops: line numbers of the lane loops
loops() {
	awk '/^LANE_(STAGE|GROUP)\(/ { print NR }
	     /^LANE_LOOP .* lane_[a-z_]*\(/ { inside = 1 }
	     /^}/ { inside = 0 }
	     inside && /^\t+for \(/ { print NR }' $SRC
}

# scalar VARIANT CC FLAGS: builds the variant, prints the lane loops that the compiler left as they are
scalar() {
	case $2 in
	*clang*) tell="-Rpass=loop-vectorize -Rpass-missed=loop-vectorize" yes="remark: vectorized loop" no="remark: loop not" ;;
	*) tell=-fopt-info-vec-all yes="optimized: loop vectorized" no="missed: couldn't vectorize loop" ;;
	esac
	rm -rf "$tmp/o"
	MAKEFLAGS='' make -s O="$tmp/o" CC="$2" SAN='' WITH_CUDA=no EXTRA_CFLAGS="$tell $3" "$tmp/o/kernels/lanes_$1.o" \
		>"$tmp/vec" 2>&1 || {
		show "$tmp/vec"
		echo "does not build"
		return
	}
	loops | while read -r line; do
		grep -qE "lane_loops\.h:$line:[0-9]+: $yes" "$tmp/vec" &&
			! grep -qE "lane_loops\.h:$line:[0-9]+: $no" "$tmp/vec" ||
			sed -n "${line}s/^[[:space:]]*/line $line: /p" $SRC
	done
}

# variant NAME CC
variant() {
	if command -v "$2" >/dev/null; then
		is "$1, $2: all lane loops are vectorised" "$(scalar "$1" "$2" "")" ""
	else
		skip "$1, $2: all lane loops are vectorised" "$2"
	fi
}

[ "$(loops | wc -l)" -gt 20 ]
report $? "the lane loops are found"
case $(uname -m) in
x86_64)
	for cc in gcc clang; do
		variant avx2 $cc
		variant avx512 $cc
	done
	variant neon aarch64-linux-gnu-gcc
	first=avx2
	;;
aarch64)
	variant neon gcc
	variant neon clang
	first=neon
	;;
esac
[ -n "$(scalar "${first:-plain}" gcc -fno-tree-vectorize)" ]
report $? "a build without the vectoriser is found out"
done_testing
