#!/bin/sh
# SPDX-License-Identifier: MIT
# Every lane loop of kernels/lanes.c is vectorised in every vector variant: nothing but speed would tell. The loops are
# the LANE_STAGE lines and every for in a LANE_LOOP function; gcc reports on them when it builds the variant with the
# Makefile's own flags. clang 14 vectorises most of them and is asked about nothing here. TAP.
# shellcheck source=tests/tap.sh disable=SC2034
. "$(dirname "$0")/tap.sh"
SRC=kernels/lanes.c

# loops: line numbers of the lane loops
loops() {
	awk '/^LANE_STAGE\(/ { print NR }
	     /^LANE_LOOP .* lane_[a-z_]*\(/ { inside = 1 }
	     /^}/ { inside = 0 }
	     inside && /^\t+for \(/ { print NR }' $SRC
}

# scalar VARIANT CC FLAGS: builds the variant, prints the lane loops that the compiler left as they are
scalar() {
	rm -rf "$tmp/o" "$tmp/vec"
	: >"$tmp/vec"
	make -s O="$tmp/o" CC="$2" WITH_CUDA=no EXTRA_CFLAGS="-fopt-info-vec-all=$tmp/vec $3" "$tmp/o/kernels/lanes_$1.o" \
		>"$tmp/out" 2>&1 || { show "$tmp/out"; echo "does not build"; return; }
	loops | while read -r line; do
		grep -qE "lanes\.c:$line:[0-9]+: optimized: loop vectorized" "$tmp/vec" &&
			! grep -qE "lanes\.c:$line:[0-9]+: missed: couldn't vectorize loop" "$tmp/vec" ||
			sed -n "${line}s/^[[:space:]]*/line $line: /p" $SRC
	done
}

# variant NAME CC
variant() {
	found=$(scalar "$1" "$2" "")
	is "$1: $(loops | wc -l) lane loops are vectorised" "$found" ""
}

CC=${CC:-gcc}
case $($CC -dumpmachine) in
x86_64*) native="avx2 avx512" ;;
aarch64*) native=neon ;;
*) native= ;;
esac
if $CC --version | grep -q clang; then
	skip "lane loops are vectorised" gcc
	done_testing
	exit
fi
[ "$(loops | wc -l)" -gt 20 ]
report $? "the lane loops are found"
for v in $native; do
	variant "$v" "$CC"
done
case " $native " in
*" neon "*) ;;
*)
	if command -v aarch64-linux-gnu-gcc >/dev/null; then
		variant neon aarch64-linux-gnu-gcc
	else
		skip "neon: lane loops are vectorised" aarch64-linux-gnu-gcc
	fi
	;;
esac
first=${native%% *}
[ -z "$first" ] || [ -n "$(scalar "$first" "$CC" -fno-tree-vectorize)" ]
report $? "$first: a build without the vectoriser is found out"
done_testing
