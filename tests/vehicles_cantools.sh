#!/bin/sh
# What the daemon reads in a log of each shipped radar, against an independent decode by cantools. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
python=build/venv/bin/python
if ! "$python" -c 'import cantools' 2>/dev/null; then
	skip "same as cantools" cantools
	done_testing
	exit 0
fi
for car in hyundai-kia-scc11 ars408 generic-objects; do
	"$AEBMC" generate --config can-dbc/vehicles/$car.conf --drive cutin --dropout 0.1 --out "$tmp/$car.log"
	ok "$car: speeds and targets as cantools reads them" \
		"$python" tests/vehicles_cantools.py --driver "$O/tests/test_scan" $car "$tmp/$car.log"
done
exits "a planted difference is found" 1 \
	"$python" tests/vehicles_cantools.py --driver "$O/tests/test_scan" --plant ars408 "$tmp/ars408.log"
like "and named" "$tmp/out" "ours .* cantools"
done_testing
