#!/bin/sh
# The units are valid and aebmcd's is confined: exposure at most 2.0 of 10 (systemd-analyze security). TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
if ! command -v systemd-analyze >/dev/null; then
	skip "units" systemd-analyze
	done_testing
	exit
fi

# The programs lie elsewhere until they are installed.
daemon=$tmp/aebmcd@test.service
sed "s|/usr/sbin/aebmcd|$(realpath "$O")/aebmcd|" systemd/aebmcd@.service >"$daemon"
ok "aebmcd@.service is valid" systemd-analyze verify --man=no "$daemon"
is "and nothing in it is ignored" "$(cat "$tmp/err")" ""
for unit in rt-config/*.service; do
	sed "s|/usr/share/aebmc|$PWD|" "$unit" >"$tmp/${unit##*/}"
	ok "${unit##*/} is valid" systemd-analyze verify --man=no "$tmp/${unit##*/}"
	is "and nothing in it is ignored" "$(cat "$tmp/err")" ""
done
ok "exposure of aebmcd@.service is at most 2.0" systemd-analyze security --offline=true --threshold=20 --no-pager "$daemon"
sed -n 's/.*\(Overall exposure.*\)/# \1/p' "$tmp/out"
grep -vE '^(Capability|NoNew|Protect|Restrict|SystemCall|DevicePolicy|DeviceAllow)' "$daemon" >"$tmp/bare@test.service"
exits "a bare unit is above" 1 systemd-analyze security --offline=true --threshold=20 --no-pager "$tmp/bare@test.service"
is "no capability" "$(grep -cE '^(CapabilityBoundingSet|AmbientCapabilities)=$' "$daemon")" 2
done_testing
