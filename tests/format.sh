#!/bin/sh
# clang-format decides layout. TAP.
set -u
cd "$(dirname "$0")/.." || exit 1
echo 1..1
if ! command -v clang-format >/dev/null; then
	echo "ok 1 - layout # SKIP needs clang-format"
	exit 0
fi
bad=$(find kernels can-dbc daemon tools tests -name '*.[ch]' -o -name '*.cu' | sort |
	while read -r f; do clang-format "$f" | cmp -s - "$f" || echo "$f"; done)
if [ -z "$bad" ]; then
	echo "ok 1 - layout"
else
	echo "not ok 1 - layout: run make format"
	echo "$bad" | sed 's/^/# /'
fi
