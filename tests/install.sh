#!/bin/sh
# make install, uninstall and dist: what lies where, that it works from there, and that nothing is left behind. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
dest=$tmp/dest
prefix=$dest/opt/aebmc

# mk TARGET: with the programs as they are built
mk() {
	make -s -o all -o "$O/aebmcd" O="$O" DESTDIR="$dest" PREFIX=/opt/aebmc "$1"
}

ok "make install" mk install
is "nothing outside the prefix" "$(find "$dest" -type f | grep -vc "^$prefix/")" 0
ok "both programs run from there" sh -c "$prefix/sbin/aebmcd --version && $prefix/bin/aebmc --version"
for car in "$prefix"/share/aebmc/vehicles/*.conf; do
	ok "${car##*/} is good from there" "$prefix/sbin/aebmcd" --check-config "$car"
done
"$AEBMC" generate --drive follow >"$tmp/follow.log"
# elsewhere PROGRAM ARGUMENT...: from a folder that has nothing of ours
elsewhere() {
	(cd "$tmp/empty" && "$@")
}
mkdir -p "$tmp/empty" "$tmp/tree/build"
cp "$AEBMC" "$tmp/tree/build"
refuses 78 elsewhere "$tmp/tree/build/aebmc" generate --drive follow
like "a program without vehicles says where it looked" "$tmp/err" 'share/aebmc/vehicles/generic\.conf: cannot open'
ln -s "$PWD/can-dbc" "$tmp/tree"
for program in "$tmp/tree/build/aebmc" "$prefix/bin/aebmc"; do
	where=$(dirname "${program#"$tmp/"}")
	ok "$where: generate without --config from elsewhere" elsewhere "$program" generate --drive follow --out "$tmp/x.log"
	ok "$where: the drive is the source tree's" cmp "$tmp/x.log" "$tmp/follow.log"
	ok "$where: scenario without --config from elsewhere" elsewhere "$program" scenario fmvss127 --only stopped-10 \
		--samples 1024
	like "$where: by the bundled car" "$tmp/out" '^stopped-10 .* passed$'
done
unit=$prefix/lib/systemd/system/aebmcd@.service
like "the unit starts the daemon from there" "$unit" '^ExecStart=/opt/aebmc/sbin/aebmcd --config /etc/aebmc/%i.conf$'
for f in aebmc-irq aebmc-clocks; do
	like "$f.service starts its script from there" "$prefix/lib/systemd/system/$f.service" \
		"^ExecStart=/opt/aebmc/share/aebmc/rt-config/$f( follow)?\$"
	ok "which can be run" test -x "$prefix/share/aebmc/rt-config/$f"
done
for f in lib/sysusers.d/aebmc.conf lib/tmpfiles.d/aebmc.conf lib/udev/rules.d/60-aebmc.rules; do
	ok "$f" test -s "$prefix/$f"
done

if command -v scdoc >/dev/null; then
	for page in man8/aebmcd.8 man1/aebmc.1 man5/aebmcd.conf.5; do
		ok "$page" test -s "$prefix/share/man/$page"
	done
	"$O/aebmcd" --print-config | sed -n 's/^\[\(.*\)\]$/\1/p' | sort -u >"$tmp/sections"
	is "aebmcd.conf(5) has every section" "$(while read -r s; do
		grep -q "$s\\." "$prefix/share/man/man5/aebmcd.conf.5" || echo "$s"
	done <"$tmp/sections")" ""
	is "aebmc(1) has every subcommand" "$("$O/aebmc" help | sed -n 's/^  \([a-z]*\) .*/\1/p' | while read -r s; do
		grep -qF "\\fB$s\\fR" "$prefix/share/man/man1/aebmc.1" || echo "$s"
	done)" ""
else
	skip "man pages" scdoc
fi

# completion WORD...: what bash proposes for the last word
completion() {
	PATH=$prefix/bin:$PATH bash -c '. "$0"; COMP_WORDS=(aebmc "$@"); COMP_CWORD=$#; _aebmc aebmc; echo "${COMPREPLY[@]}"' \
		"$prefix/share/bash-completion/completions/aebmc" "$@"
}
is "completion of a subcommand" "$(completion doc)" doctor
is "completion of an option" "$(completion replay --req)" --requests
is "completion of a kind of picture" "$(completion plot ti)" "time timeline"
is "completion of help" "$(completion help conv)" converge

ok "make uninstall" mk uninstall
is "leaves no file" "$(find "$dest" -type f)" ""

if git rev-parse HEAD >/dev/null 2>&1; then
	ok "make dist" make -s O="$O" dist
	tar -tzf "$O"/aebmc-*.tar.gz | sed 's|^[^/]*/||' >"$tmp/files"
	git ls-tree -r --name-only HEAD >"$tmp/committed"
	is "the tarball has what is committed" "$(grep -vxFf "$tmp/files" "$tmp/committed")" ""
	is "and commit and packages" "$(grep -cxE '\.commit|packages\.txt' "$tmp/files")" 2
	tar -xzOf "$O"/aebmc-*.tar.gz --wildcards '*/packages.txt' >"$tmp/packages"
	like "the packages to build" "$tmp/packages" '^gcc$'
	like "the packages to run" "$tmp/packages" '^libsystemd-dev$'
else
	skip "make dist" git
fi
done_testing
