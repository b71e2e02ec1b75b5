#!/bin/sh
# SPDX-License-Identifier: MIT
# Interval honesty over 2,000 seeds. TAP, from the test program itself.
cd "$(dirname "$0")/.." || exit 1
O=${O:-build}
INTERVAL_SEEDS=2000 exec "$O/tests/test_interval"
