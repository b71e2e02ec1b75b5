#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes tests/kat/sobol.txt: points of the Sobol sequence in natural order, 12 dimensions of 32 bits, unscrambled.

Usage: tests/oracle/sobol.py > tests/kat/sobol.txt      (needs scipy, whose table is new-joe-kuo-6.21201 too)
"""
import random
from scipy.stats import qmc


def gray_inverse(g):
    """Position in Gray-code order, which scipy walks, of the point with natural index g."""
    n = 0
    while g:
        n ^= g
        g >>= 1
    return n


def point(index):
    engine = qmc.Sobol(12, scramble=False, bits=32)
    if index:  # scipy cannot go forward by nothing
        engine.fast_forward(gray_inverse(index))
    return [int(u * 2**32) for u in engine.random(1)[0]]


def main():
    random.seed(1)
    print("# index  the 12 Sobol dimensions in their own order; made by tests/oracle/sobol.py")
    some = sorted(set(random.getrandbits(22) for _ in range(20)))
    for index in list(range(17)) + [1 << k for k in range(5, 25)] + some:
        print(index, " ".join(f"{u:08x}" for u in point(index)))


main()
