#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes tests/kat/wilson.txt: two-sided 95 % Wilson intervals as the roots of the score equation, to 50 digits.

Usage: tests/oracle/wilson.py > tests/kat/wilson.txt      (needs mpmath)
"""
from mpmath import mp, mpf, erfinv, sqrt

mp.dps = 50
Z2 = 2 * erfinv(mpf("0.95")) ** 2


def interval(k, n):
    """Both p with (k/n - p)^2 = z^2 p (1 - p) / n."""
    p = mpf(k) / n
    a, b, c = 1 + Z2 / n, -(2 * p + Z2 / n), p * p
    root = sqrt(b * b - 4 * a * c)
    return (-b - root) / (2 * a), (-b + root) / (2 * a)


def main():
    print("# k n  lower  upper; made by tests/oracle/wilson.py")
    for n in (2, 10, 100, 12000, 16384, 10**6, 2**32 - 1, 4 * (2**32 - 1)):
        for k in sorted({1, 2, n // 1000, n // 100, n // 20, n // 2, n - 1} - {0, n}):
            lo, hi = interval(k, n)
            print(k, n, float(lo).hex(), float(hi).hex())


main()
