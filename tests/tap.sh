# SPDX-License-Identifier: MIT
# shellcheck shell=sh
# TAP for shell scripts: source it, call the functions below, end with done_testing. Runs in the repository's root with
# the binaries in $O; $tmp is a directory of its own; the last command's output lies in $tmp/out and $tmp/err.
cd "$(dirname "$0")/.." || exit 1
O=${O:-build}
# shellcheck disable=SC2034 # used by the scripts
AEBMC=$O/aebmc
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
trap 'exit 1' INT TERM
tap_n=0

# report STATUS NAME: one test point
report() {
	tap_n=$((tap_n + 1))
	if [ "$1" -eq 0 ]; then
		echo "ok $tap_n - $2"
	else
		echo "not ok $tap_n - $2"
	fi
}

# show FILE...: for the reader of a failure
show() {
	head -n 20 "$@" 2>/dev/null | cut -c1-300 | sed 's/^/# /'
}

# skip NAME WHAT: a test point that needs WHAT (one word, see tests/run)
skip() {
	tap_n=$((tap_n + 1))
	echo "ok $tap_n - $1 # SKIP needs $2"
}

# ok NAME COMMAND...: the command succeeds
ok() {
	tap_name=$1
	shift
	"$@" >"$tmp/out" 2>"$tmp/err"
	tap_status=$?
	report $tap_status "$tap_name"
	[ $tap_status -eq 0 ] || show "$tmp/out" "$tmp/err"
}

# is NAME GOT WANTED
is() {
	[ "$2" = "$3" ]
	tap_status=$?
	report $tap_status "$1"
	[ $tap_status -eq 0 ] || printf '# got    %s\n# wanted %s\n' "$2" "$3"
}

# like NAME FILE REGEX: a line of the file matches
like() {
	grep -qE -- "$3" "$2"
	tap_status=$?
	report $tap_status "$1"
	[ $tap_status -eq 0 ] || { echo "# no match for $3 in"; show "$2"; }
}

# exits NAME CODE COMMAND...: the command ends with this code
exits() {
	tap_name=$1 tap_want=$2
	shift 2
	"$@" >"$tmp/out" 2>"$tmp/err"
	tap_got=$?
	[ $tap_got -eq "$tap_want" ]
	tap_status=$?
	report $tap_status "$tap_name: exit $tap_want"
	[ $tap_status -eq 0 ] || { echo "# exit $tap_got"; show "$tmp/out" "$tmp/err"; }
}

# refuses CODE COMMAND...: ends with this code, one line on standard error and none on standard output
refuses() {
	tap_want=$1
	shift
	"$@" >"$tmp/out" 2>"$tmp/err" </dev/null
	tap_got=$?
	[ "$tap_got" -eq "$tap_want" ] && [ "$(wc -l <"$tmp/err")" -eq 1 ] && [ ! -s "$tmp/out" ]
	tap_status=$?
	tap_name=$(printf '%s ' "$@" | sed "s|$tmp|TMP|g; s|$O/||")
	report $tap_status "${tap_name% } is refused with $tap_want and one line"
	[ $tap_status -eq 0 ] || { echo "# exit $tap_got"; show "$tmp/out" "$tmp/err"; }
}

# json NAME FILE EXPRESSION: the file is one JSON object, j, of which the Python expression holds
json() {
	python3 - "$2" "$3" >"$tmp/json" 2>&1 <<-'EOF'
		import json, math, sys
		j = json.load(open(sys.argv[1]), parse_constant=lambda c: sys.exit("not JSON: " + c))
		sys.exit(0 if eval(sys.argv[2]) else "false: " + sys.argv[2])
	EOF
	tap_status=$?
	report $tap_status "$1"
	[ $tap_status -eq 0 ] || show "$tmp/json" "$2"
}

# interrupt PID SECONDS: Ctrl-C, so long after the program began to listen for it (a job in the background ignores it
# before); at once if it does not within a minute
interrupt() {
	tap_tenths=0
	while [ $tap_tenths -lt 600 ]; do
		tap_caught=$(sed -n 's/^SigCgt:[[:space:]]*//p' "/proc/$1/status" 2>/dev/null)
		[ $((0x${tap_caught:-2} & 2)) -eq 0 ] || break
		sleep 0.1
		tap_tenths=$((tap_tenths + 1))
	done
	sleep "$2"
	kill -INT "$1"
}

done_testing() {
	echo "1..$tap_n"
}
