# SPDX-License-Identifier: MIT
# What the system tests share: TAP, waiting with a limit, the daemon's status, its configuration, traffic.
# Sourced by guest and guest-timing (bash). No answer is never the answer hoped for: without a daemon every question
# below fails (see nothing_passes_without_a_daemon).

n=0 failed=0
CONF=/etc/aebmc/test.conf
SOCKET=/run/aebmc/test/status.sock
LOGS=/payload/logs
OURS=,2A0:7F8 # candump's filter for our frames

# t NAME COMMAND...: one test; it passes if the command does
t() {
	local name=$1 start
	shift
	n=$((n + 1))
	clock && start=$now_ms
	if "$@" >/tmp/test.log 2>&1; then
		clock
		echo "ok $n - $name$(sed -n 's/^said: / : /p' /tmp/test.log | tr '\n' ' ') ($((now_ms - start)) ms)"
	else
		clock
		echo "not ok $n - $name ($((now_ms - start)) ms)"
		failed=$((failed + 1))
		running= # whatever runs is not trusted
		tail -n 12 /tmp/test.log | cut -c 1-300 | sed 's/^/# /'
		journalctl -u aebmcd@test -n 12 --no-pager -o short-monotonic 2>/dev/null | cut -c 1-200 | sed 's/^/# /'
	fi
}

# skip NAME WHAT: a test that needs WHAT (see tests/run)
skip() {
	n=$((n + 1))
	echo "ok $n - $1 # SKIP needs $2"
}

# clock: sets now_ms, a time that no step of the clock changes
clock() {
	local up
	read -r up _ </proc/uptime
	now_ms=${up%.*}${up#*.}0
}

# Every program that is started costs the emulation about as much as a second of the daemon's work: what is asked again
# and again is asked of one process, and waiting is a read of a pipe that never gives anything.
rm -f /tmp/ask.in /tmp/ask.out /tmp/never
mkfifo /tmp/ask.in /tmp/ask.out /tmp/never
exec 7<>/tmp/ask.in 8<>/tmp/ask.out 9<>/tmp/never
python3 -uc 'import socket, sys
while True:
    try:
        command = sys.stdin.readline()
        with socket.socket(socket.AF_UNIX) as s:
            s.settimeout(2)
            s.connect("/run/aebmc/test/status.sock")
            s.sendall(command.encode())
            print(s.makefile().readline().strip(), flush=True)
    except OSError as e:
        print("no answer:", e, flush=True)
' <&7 >&8 9>&- &
asker=$!
pause() { read -rt "$1" <&9; true; }

# within SECONDS COMMAND...: until the command succeeds, at most that long (0.5 is fine)
within() {
	local limit=$1 end step
	shift
	[[ $limit == *.* ]] && limit=${limit/./}00 || limit=${limit}000
	limit=$((10#$limit)) step=$((10#$limit / 100))
	[ $step -ge 30 ] || step=30
	printf -v step 0.%03d $step
	clock && end=$((now_ms + limit))
	until "$@" >/dev/null 2>&1; do
		clock
		if [ "$now_ms" -ge $end ]; then
			echo "not within $limit ms: $*"
			return 1
		fi
		pause $step
	done
}

# ---- what the daemon says -------------------------------------------------------------------------------------

# ask COMMAND: one line to the status socket, one line back; fails on no answer and on a refusal
ask() { asked_for "$1" && echo "$reply"; }
# The same into $reply, without a process of its own.
asked_for() {
	reply=
	echo "$1" >&7
	read -rt 5 reply <&8 && [[ $reply == {* && $reply != {\"error\"* ]]
}

# value JSON PATH: sets $got to what stands at a path such as counters.warn or links.0.state; fails if there is nothing
value() {
	local rest=$1 key
	for key in ${2//./ }; do
		if [[ $key =~ ^[0-9]+$ ]]; then
			while [ "$key" -gt 0 ]; do
				[[ $rest == *"},{"* ]] || return 1
				rest=${rest#*"},{"} key=$((key - 1))
			done
			continue
		fi
		[[ $rest == *"\"$key\":"* ]] || return 1
		rest=${rest#*"\"$key\":"}
	done
	[[ $rest == '['* || $rest == '{'* ]] && got=${rest%%[\]\}]*} || got=${rest%%[,\}\]]*}
	got=${got//\"/}
	[ -n "$got" ] && [ "$got" != null ]
}

# field PATH: of the daemon's status
field() {
	local got
	asked_for status && value "$reply" "${1#.}" && echo "$got"
}

# is 'PATH OP VALUE [and PATH OP VALUE]...': true of one and the same status? OP: == != > >= < <=
is() {
	local got path op want rest="$1 and "
	asked_for status || return 1
	while [ -n "$rest" ]; do
		read -r path op want <<<"${rest%% and *}"
		rest=${rest#* and } want=${want//\"/}
		value "$reply" "${path#.}" || { echo "there is no $path" && return 1; }
		case $op in
		==) [ "$got" = "$want" ] ;;
		!=) [ "$got" != "$want" ] ;;
		*)
			if [[ $got$want =~ ^[0-9]+$ ]]; then
				(("$got" $op "$want"))
			else
				awk -v a="$got" -v b="$want" "BEGIN { exit !(a $op b) }"
			fi
			;;
		esac || { echo "$path is $got, not $op $want" && return 1; }
	done
}

state_is() { is "state == $1"; }
armed() { within "${1:-10}" state_is ARMED; }
# Sets $why to ",REASON,REASON,".
reasons() { asked_for status && [[ $reply =~ \"reasons\":\[([^]]*)\] ]] && why=",${BASH_REMATCH[1]//\"/},"; }
has_reason() { reasons && [[ $why == *",$1,"* ]]; }
lacks_reason() { reasons && [[ $why != *",$1,"* ]]; }

pid() {
	local p
	p=$(systemctl show -p MainPID --value aebmcd@test) && [ "${p:-0}" -gt 0 ] && echo "$p"
}
active() { [ "$(systemctl is-active aebmcd@test)" = active ]; }
another_pid() {
	local p
	p=$(pid) && [ "$p" != "$1" ] && active
}

now() { date '+%F %T.%6N'; }
journal_since() { journalctl -u aebmcd@test --since "$1" -o cat --no-pager; }
# said SINCE REGEX: in the journal
said() { journal_since "$1" | grep -E -- "$2"; }

# ---- starting and stopping --------------------------------------------------------------------------------------

# configure [section.key=value ...]: the generic car on vcan0, frames of this machine allowed, sent as shadow, few
# samples; everything else as shipped. CAR takes another car.
CAR=generic
SAMPLES=256
SLACK= # what a machine needs whose time means nothing
configure() {
	local from=/usr/share/aebmc/vehicles/$CAR
	cp $from.dbc /etc/aebmc/
	# shellcheck disable=SC2086 # SLACK is a list
	printf '%s\n' bus.interfaces=vcan0 bus.allow_local=yes bus.transmit=shadow mc.samples=$SAMPLES $SLACK "$@" |
		awk -v from=$from.conf '
		function section_of(name) { sub(/\.[^.]*$/, "", name); return name }
		function row(name) { done[name]; return substr(name, length(section_of(name)) + 2) " = " set[name] }
		{ name = $0; sub(/=.*/, "", name); sub(/^[^=]*=/, ""); set[name] = $0 } # of the same name the last
		END {
			while ((getline line <from) > 0) {
				key = line; sub(/[ =].*/, "", key)
				if (line ~ /^\[/) {
					section = substr(line, 2); sub(/\].*/, "", section)
					print line
					for (name in set) { if (section_of(name) == section) { print row(name) } }
				} else if (!((section "." key) in set)) {
					print line
				}
			}
			for (name in set) { # sections that the file does not have
				if (!(name in done)) {
					print "[" section_of(name) "]"
					for (other in set) { if (section_of(other) == section_of(name)) { print row(other) } }
				}
			}
		}' >$CONF
}

running= # the options that aebmcd@test runs with
start() {
	configure "$@"
	systemctl reset-failed aebmcd@test 2>/dev/null
	systemctl start aebmcd@test && running="with $*"
}

stop() {
	running=
	systemctl stop aebmcd@test
	traffic_stop
}

# runs_with [section.key=value ...]: the daemon runs with these options; one that is watched runs with `any` (guest-timing)
runs_with() { [[ $running == any || $running == "with $*" ]] && active; }

# good [section.key=value ...]: the daemon runs with these options, on traffic, and is ARMED
good() {
	if ! runs_with "$@"; then
		stop
		start "$@" || return 1
	fi
	[ "$playing" = follow.log ] || traffic follow.log
	armed
}

# ---- traffic ----------------------------------------------------------------------------------------------------

# traffic LOG [INTERFACE]: plays it again and again, as punctual as a car
playing=
traffic() {
	traffic_stop
	[ -r "$LOGS/$1" ] || return 1
	chrt -f 40 canplayer -l i -g 2 -I "$LOGS/$1" "${2:-vcan0}=can0" >/dev/null 2>&1 &
	traffic_pid=$! playing=$1
}

traffic_stop() {
	[ -z "$playing" ] && return 0
	kill "$traffic_pid" 2>/dev/null
	wait "$traffic_pid" 2>/dev/null
	playing=
}

# play LOG [ARGUMENT...]: once, to its end
play() {
	traffic_stop
	chrt -f 40 canplayer -g 1 -I "$LOGS/$1" "${@:2}" >/dev/null
}

# ---- what is on the bus ---------------------------------------------------------------------------------------------

# listen INTERFACE[FILTER]...: from now on into /tmp/bus.log, until heard. On an interface that goes down candump would
# end, on `any` it does not.
listen() {
	chrt -f 30 candump -L "$@" >/tmp/bus.log &
	listener=$!
	pause 0.1
}

# heard: stop listening; our frames in words go to /tmp/words
heard() {
	pause 0.05
	kill $listener
	wait $listener 2>/dev/null
	aebmc decode --config $CONF /tmp/bus.log >/tmp/words
}

# first_after TIME REGEX: when the first of our frames after TIME (in s) matches, in ms after it
first_after() {
	awk -v t="$1" -v re="$2" '$1 >= t && $0 ~ re { printf "%.1f\n", ($1 - t) * 1000; found = 1; exit } END { exit !found }' \
		/tmp/words
}

# last_of ID: time of the last frame of that identifier
last_of() { awk -v id=" $1#" 'index($0, id) { t = $1 } END { if (!t) { exit 1 } gsub(/[()]/, "", t); print t }' /tmp/bus.log; }

# at_most MS VALUE WORDS: a duration, printed beside the test's name; not judged on a machine whose time means nothing
TIMED=yes
at_most() {
	[ -n "$2" ] || return 1
	echo "said: $3 $2 ms"
	[ $TIMED = no ] || awk "BEGIN { exit !($2 <= $1) }"
}
