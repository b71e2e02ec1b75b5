#!/bin/sh
# Arguments of aebmc: what is wrong is refused with one line and the agreed exit code. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
car=can-dbc/vehicles/generic.conf
subs="replay explain decode map inputs generate scenario curve converge verify bench plot paper doctor top arm disarm mark"

refuses 2 "$AEBMC"
refuses 2 "$AEBMC" curv
like "it names the nearest subcommand" "$tmp/err" "nearest is 'curve'"
refuses 2 "$AEBMC" ""
refuses 2 "$AEBMC" help nosuch
is "version is the Makefile's" "$("$AEBMC" --version | head -n 1)" "aebmc $(sed -n 's/^VERSION := //p' Makefile)"
for what in commit compiler cuda contract; do
	is "--version: both programs name the same $what" "$("$AEBMC" --version | grep "^$what  *[^ ]")" \
		"$("$O/aebmcd" --version | grep "^$what  *[^ ]" || echo none)"
done
exits "help help" 0 "$AEBMC" help help
exits "help" 0 "$AEBMC" help
for sub in $subs; do
	like "help lists $sub" "$tmp/out" "^  $sub "
done
for sub in $subs; do
	refuses 2 "$AEBMC" "$sub" --no-such-option
	exits "help $sub" 0 "$AEBMC" help "$sub"
	like "help $sub shows how to call it" "$tmp/out" "^Usage: aebmc $sub "
	is "help $sub names each operand once a line" "$(awk '/^(Usage|  or):/ {
		split("", seen)
		for (i = 1; i <= NF; i++) if (seen[$i]++) print
	}' "$tmp/out")" ""
done

# numbers and names
for bad in 0 -1 1e3 nan '' 12x 4294967296; do
	refuses 2 "$AEBMC" curve --samples "$bad"
done
for bad in nan inf -1 1000 '' 3m; do
	refuses 2 "$AEBMC" curve --speed "$bad"
done
refuses 2 "$AEBMC" curve --speed-sigma -1
refuses 2 "$AEBMC" curve --preset papr
like "it names the nearest preset" "$tmp/err" "nearest is 'paper'"
refuses 2 "$AEBMC" curve --preset paper --set road.mu=0.5
refuses 2 "$AEBMC" curve --future driver
refuses 2 "$AEBMC" curve --future drver --set road.mu=0.5
refuses 2 "$AEBMC" curve extra
refuses 2 "$AEBMC" curve --json --csv -
refuses 2 "$AEBMC" curve --draws halton
for sub in curve converge verify; do
	refuses 2 "$AEBMC" $sub --threads 0
	refuses 2 "$AEBMC" $sub --threads 65
	refuses 2 "$AEBMC" $sub --seed -1
	refuses 2 "$AEBMC" $sub --variant sse9
	refuses 2 "$AEBMC" $sub --backend tpu
	refuses 77 "$AEBMC" $sub --backend cuda
done
refuses 2 "$AEBMC" bench --threads 2
refuses 2 "$AEBMC" bench --rounds 0
refuses 2 "$AEBMC" verify --samples 0
refuses 2 "$AEBMC" converge 12000

# configurations
refuses 78 "$AEBMC" curve --set road.mew=0.5
like "it names the nearest option" "$tmp/err" "road[. ]*mu"
refuses 78 "$AEBMC" curve --set road.mu=nan
refuses 78 "$AEBMC" curve --config "$tmp/nosuch.conf"
refuses 78 "$AEBMC" curve --config "$tmp"
refuses 78 "$AEBMC" replay --config "$tmp/nosuch.conf" -
refuses 78 "$AEBMC" replay --config "$car" --set mc.samples=0 -
refuses 78 "$AEBMC" decode --set bus.request_id=-5 -

# logs
refuses 2 "$AEBMC" replay --config "$car"
refuses 2 "$AEBMC" replay -
refuses 2 "$AEBMC" replay --config "$car" a.log b.log
refuses 2 "$AEBMC" replay --config "$car" --threads 0 -
refuses 2 "$AEBMC" replay --config "$car" --json --csv - -
refuses 2 "$AEBMC" replay --config "$car" --csv - --out - -
refuses 2 "$AEBMC" replay --config "$car" --requests a.requests b.log
refuses 2 "$AEBMC" replay --config "$car" --requests a.requests --csv -
refuses 1 "$AEBMC" replay --config "$car" --requests "$tmp/nosuch.requests"
refuses 1 "$AEBMC" replay --config "$car" --requests "$tmp"
like "it is a directory" "$tmp/err" "Is a directory"
refuses 1 "$AEBMC" replay --config "$car" "$tmp/nosuch.log"
refuses 1 "$AEBMC" replay --config "$car" "$tmp"
refuses 1 "$AEBMC" replay --config "$car" --out "$tmp/no/such/dir" -
refuses 1 "$AEBMC" replay --config "$car" --csv "$tmp/no/such/dir" -
refuses 2 "$AEBMC" decode
refuses 2 "$AEBMC" decode a.log b.log
refuses 1 "$AEBMC" decode "$tmp/nosuch.log"
refuses 1 "$AEBMC" decode "$tmp"
refuses 1 "$AEBMC" decode -
printf '\3757zXZ\n' >"$tmp/a.log.xz"
refuses 1 "$AEBMC" decode "$tmp/a.log.xz"
like "it says how to unpack" "$tmp/err" "xz -dc"
done_testing
