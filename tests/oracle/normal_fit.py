#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints the outer rational of normal_quantile(): z - sqrt(2) r over r = sqrt(-log p), degree 3 over 2 in r - 1.6.

Least squares on Chebyshev nodes, reweighted by its own error (Lawson) until it is minimax.
Usage: tests/oracle/normal_fit.py      (needs mpmath and numpy)
"""
import numpy as np
from mpmath import mp, mpf, erfc, sqrt, log, findroot

mp.dps = 40
NODES, NUM, DEN, BASE = 400, 3, 2, 1.6


def excess(r):
    """What sqrt(2) r has to be corrected by; sqrt(2) as the f32 that the code multiplies with."""
    z = findroot(lambda y: log(erfc(y / sqrt(2)) / 2) + r * r, sqrt(2) * r - mpf("0.4"))
    return float(z - mpf(float(np.float32(2**0.5))) * r)


def main():
    lo, hi = sqrt(-log(mpf("0.075"))), sqrt(-log(mpf(2) ** -33))
    r = [(lo + hi) / 2 + (hi - lo) / 2 * mp.cos(mp.pi * (2 * i + 1) / (2 * NODES)) for i in range(NODES)]
    y = np.array([excess(x) for x in r])
    x = np.array([float(v) for v in r]) - BASE
    weight, den, best = np.ones(NODES), np.ones(NODES), (np.inf, None)
    for _ in range(400):
        rows = [x**k for k in range(NUM + 1)] + [-y * x**k for k in range(1, DEN + 1)]
        w = np.sqrt(weight) / np.abs(den)
        c = np.linalg.lstsq(np.array(rows).T * w[:, None], y * w, rcond=None)[0]
        den = 1 + sum(c[NUM + k] * x**k for k in range(1, DEN + 1))
        err = np.abs(sum(c[k] * x**k for k in range(NUM + 1)) / den - y)
        best = min(best, (err.max(), tuple(c)))
        weight = weight * np.sqrt(np.maximum(err, 1e-12))
        weight /= weight.sum()
    print("largest error", best[0])
    print("numerator    ", *best[1][: NUM + 1])
    print("denominator  ", 1, *best[1][NUM + 1 :])


main()
