#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes tests/kat/normal.txt: what 32 bits are worth as a standard normal, cut at +-limit or not, to 50 digits.

Usage: tests/oracle/normal.py > tests/kat/normal.txt      (needs mpmath)
"""
import random
from mpmath import mp, mpf, erfc, erfinv, findroot, sqrt, log

mp.dps = 50


def tail(z):
    return erfc(z / sqrt(2)) / 2


def quantile(p):
    """z >= 0 with tail probability p."""
    if p > mpf("0.3"):
        return sqrt(2) * erfinv(1 - 2 * p)
    start = sqrt(-2 * log(p)) - mpf("0.5")
    return findroot(lambda z: log(tail(z)) - log(p), start)


def value(x, limit):
    upper = x >> 31
    t = x ^ 0xFFFFFFFF if upper else x
    p = (t + mpf("0.5")) / 2**32
    if limit:
        beyond = tail(mpf(limit))
        p = beyond + p * (1 - 2 * beyond)
    z = quantile(p)
    return z if upper else -z


def main():
    random.seed(1)
    edges = [0, 1, 2, 3, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFFE]
    switch = int(mpf("0.075") * 2**32)  # between the central and the outer rational
    edges += [switch - 200, switch - 1, switch, switch + 1, switch + 200, 2**32 - switch]
    edges += [1 << k for k in range(2, 31)] + [0xFFFFFFFF ^ 1 << k for k in range(2, 31)]
    cases = [(x, 0.0) for x in edges + [random.getrandbits(32) for _ in range(100)]]
    for limit in (2.0**-7, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.25):
        some = [0, 1, 1000, 1 << 20, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF]
        cases += [(x, limit) for x in some + [random.getrandbits(32) for _ in range(10)]]
    print("# bits  limit [sigma], 0 = none  standard normal; made by tests/oracle/normal.py")
    for x, limit in cases:
        print(f"{x:08x} {float(limit).hex()} {float(value(x, limit)).hex()}")


main()
