#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""usage: scenes.py EVENT.requests EVENT.log DRIVE.log REPLAY.csv

The scenes that a live daemon evaluated (its recorder's event, from before the drive's first frame on) against those of
the replay of the same drive: for 99 % of them there must be an evaluation of the replay at most 20 ms earlier, from which
headway and speeds differ by no more than those 20 ms explain, and nearly every scan must have been evaluated.
"""
import csv
import struct
import sys

AGE_S = 0.020     # the live one may be that much later ...
EARLY_S = 0.002   # ... or earlier: stamps of the player's first frame and of the others need not agree better
REST_M, REST_MPS = 0.05, 0.05  # what is left when the age is taken out: the player's frames come up to 1 ms late


def stamp(line):
    return float(line[1:line.index(")")])


def first_stamp(path):
    with open(path) as f:
        return stamp(next(line for line in f if line.startswith("(")))


def live(path):
    """(time, headway, ego speed, lead speed) of each request; words as daemon/recorder.h writes struct mc_request."""
    for line in open(path):
        if line.startswith("("):
            words = [int(w, 16) for w in line.split()[3:]]
            mean = struct.unpack("<5f", struct.pack("<5I", *words[6:11]))
            yield stamp(line), mean[0], mean[1], mean[3], mean[2], mean[4]


requests, event, drive, table = sys.argv[1:]
shift_s = first_stamp(event) - first_stamp(drive)
start_s = first_stamp(drive)
replayed = [(start_s + float(r["time_s"]), float(r["headway_m"]), float(r["ego_speed_mps"]), float(r["lead_speed_mps"]))
            for r in csv.DictReader(open(table))]
good = total = 0
ages = []
worst = (0, 0)
for t, headway, ego, lead, ego_accel, lead_accel in live(requests):
    t -= shift_s
    at, h, v, w = min(replayed, key=lambda r: abs(r[0] - t))
    age = t - at
    total += 1
    ages.append(age)
    fits = -EARLY_S <= age <= AGE_S
    closing = lead - ego
    rest_m = min(abs(headway - h - closing * a) for a in (0, AGE_S / 4, AGE_S / 2, AGE_S * 3 / 4, AGE_S))
    rest_mps = max(min(abs(ego - v - ego_accel * a) for a in (0, AGE_S)), min(abs(lead - w - lead_accel * a) for a in (0, AGE_S)))
    worst = (max(worst[0], rest_m), max(worst[1], rest_mps)) if fits else worst
    good += fits and rest_m <= REST_M and rest_mps <= REST_MPS
ages.sort()
end_s = max((t for t, *_ in live(requests)), default=0) - shift_s
expected = sum(1 for r in replayed if r[0] <= end_s)
print("said: %d of %d scenes, age p50 %.1f p99 %.1f max %.1f ms, rest %.3f m %.3f m/s" % (
    good, total, ages[len(ages) // 2] * 1e3, ages[int(len(ages) * 0.99)] * 1e3, ages[-1] * 1e3, *worst))
if total < 0.99 * expected:
    sys.exit("only %d of %d evaluations" % (total, expected))
sys.exit(0 if total > 100 and good >= 0.99 * total else "too many scenes differ by more than age")
