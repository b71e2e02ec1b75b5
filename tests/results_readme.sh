#!/bin/sh
# The README's figures of the closed loops are those of the tables in tests/results/. Nothing is run. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
ok "the README's closed loops are tests/results/" python3 tests/results_readme.py
ok "another figure in one of its tables is noticed, whichever" python3 tests/results_readme.py --plant
done_testing
