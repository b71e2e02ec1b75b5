#!/bin/sh
# SPDX-License-Identifier: MIT
# make deb: builds, lintian has nothing to say, everything is in it and works from there. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"

if ! git rev-parse HEAD >/dev/null 2>&1; then
	skip "make deb" git
	done_testing
	exit 0
fi
ok "make deb" make -s O="$O" WITH_CUDA=no deb
deb=$(ls "$O"/deb/aebmc_*.deb)
is "its version is the program's" "$(dpkg-deb -f "$deb" Version | cut -d- -f1)" \
	"$("$AEBMC" --version | sed -n '1s/^aebmc \([0-9.]*\).*/\1/p')"
exits "lintian" 0 lintian --fail-on error,warning "$deb"
is "says nothing" "$(grep -v 'root privileges' "$tmp/out" "$tmp/err" | sed 's/^[^:]*://')" ""
for library in libsystemd0 libsocketcan2 libc6 liblttng-ust1 libbabeltrace2-0; do
	like "it depends on $library" /dev/stdin "(^|[ ,])$library" <<-D
		$(dpkg-deb -f "$deb" Depends)
	D
done
for program in can-utils librsvg2-bin lttng-tools; do
	like "it recommends $program" /dev/stdin "(^|[ ,])$program" <<-D
		$(dpkg-deb -f "$deb" Recommends)
	D
done
is "whatever it is built with is asked of the builder" \
	"$(grep -oE 'lib[a-z0-9-]+-dev' systemd/debian/control | sort | tr '\n' ' ')" \
	"libbabeltrace2-dev liblttng-ust-dev libsocketcan-dev libsystemd-dev "

# what is in it, beside what make install brings
dpkg-deb -x "$deb" "$tmp/root"
make -s -o all -o "$O/aebmcd" O="$O" WITH_CUDA=no DESTDIR="$tmp/dest" PREFIX=/usr install >/dev/null 2>&1
(cd "$tmp/dest" && find . -type f | sed 's/\.gz$//' | sort) >"$tmp/wanted"
(cd "$tmp/root" && find . -type f | sed 's/\.gz$//' | sort) >"$tmp/packed"
is "everything that make install brings is in it" "$(comm -23 "$tmp/wanted" "$tmp/packed")" ""
is "and documents" "$(comm -13 "$tmp/wanted" "$tmp/packed" | grep -v '^\./usr/share/doc/aebmc/')" ""
for page in man1/aebmc.1 man5/aebmcd.conf.5 man8/aebmcd.8; do
	ok "$page" gzip -t "$tmp/root/usr/share/man/$page.gz"
done
ok "the programs run" sh -c "$tmp/root/usr/bin/aebmc --version && $tmp/root/usr/sbin/aebmcd --version"
ok "the provider for LTTng is there" test -s "$tmp/root/usr/lib/aebmc/trace-lttng.so"
exits "a report of what is no trace" 1 "$tmp/root/usr/bin/aebmc" report "$tmp/control"
is "fails by the trace, not for want of babeltrace" "$(grep -c 'built without' "$tmp/err")" 0
for car in "$tmp"/root/usr/share/aebmc/vehicles/*.conf; do
	ok "${car##*/} is good from there" "$tmp/root/usr/sbin/aebmcd" --check-config "$car"
done

# maintainer scripts
dpkg-deb -e "$deb" "$tmp/control"
is "the scripts are shell without errors" "$(for s in postinst prerm; do sh -n "$tmp/control/$s" || echo $s; done)" ""
like "the account is made" "$tmp/control/postinst" '^ *systemd-sysusers .*aebmc\.conf$'
is "nothing is enabled or started" "$(cat "$tmp"/control/p* | grep -cE 'deb-systemd-helper enable|invoke start')" 0
done_testing
