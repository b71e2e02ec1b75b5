#!/bin/sh
# Our DBC loader and codec against cantools, on the shipped files and on random ones. TAP.
. "$(dirname "$0")/tap.sh"
python=build/venv/bin/python
if ! "$python" -c 'import cantools' 2>/dev/null; then
	skip "same as cantools" cantools
	done_testing
	exit 0
fi
for file in can-dbc/*.dbc can-dbc/vehicles/*.dbc; do
	ok "$file: same layout, same values as cantools" \
		"$python" tests/dbc_cantools.py --driver "$O/tests/test_dbc" --file "$file"
done
ok "random databases: same layout, same values as cantools" \
	"$python" tests/dbc_cantools.py --driver "$O/tests/test_dbc" --random 60 --dir "$tmp"
exits "a planted difference is found" 1 \
	"$python" tests/dbc_cantools.py --driver "$O/tests/test_dbc" --random 1 --dir "$tmp" --plant
like "and named" "$tmp/out" "ours .* cantools"
done_testing
