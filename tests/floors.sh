#!/bin/sh
# Nothing includes upward: kernels < can-dbc < daemon < tools, tests. TAP.
# Shows that it can fail by running itself on a planted violation first.
set -u
cd "$(dirname "$0")/.." || exit 1

floor_of() {
	case $1 in
	kernels) echo 0 ;; can-dbc) echo 1 ;; daemon) echo 2 ;; tools | tests) echo 3 ;; *) echo 9 ;;
	esac
}

# violations DIR...: prints "FILE includes HEADER" for each include from a lower floor of a header on a higher one
violations() {
	for dir in kernels can-dbc daemon tools tests; do
		here=$(floor_of "$dir")
		grep -HoE '^[[:space:]]*#[[:space:]]*include[[:space:]]+"[^"]+"' "$1/$dir"/*.[ch] "$1/$dir"/*.cu \
			"$1/$dir"/*.def 2>/dev/null |
			sed -E 's/^([^:]+):.*"([^"]+)"$/\1 \2/' |
			while read -r file header; do
				for above in kernels can-dbc daemon tools tests; do
					[ -e "$1/$above/$(basename "$header")" ] || continue
					[ -e "$1/$dir/$(basename "$header")" ] && continue
					[ "$(floor_of "$above")" -gt "$here" ] && echo "$file includes $above/$header"
				done
			done
	done
}

echo 1..2
planted=$(mktemp -d)
mkdir "$planted/kernels" "$planted/daemon"
echo '#include "bus.h"' >"$planted/kernels/a.c"
: >"$planted/daemon/bus.h"
if [ -n "$(violations "$planted")" ]; then echo "ok 1 - a planted upward include is found"; else echo "not ok 1 - a planted upward include is found"; fi
rm -rf "$planted"

found=$(violations .)
if [ -z "$found" ]; then
	echo "ok 2 - nothing includes upward"
else
	echo "not ok 2 - nothing includes upward"
	echo "$found" | sed 's/^/# /'
fi
