#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Reads a car's log with cantools, by the notes in can-dbc/vehicles/NAME.md and not by NAME.conf, and holds
`test_scan --driver` against it: ego speeds, and targets scan by scan.
"""
import argparse
import math
import os
import subprocess
import sys

import cantools

# The ARS 408's standard deviations, index 31 is invalid.
RMS = (0.005, 0.006, 0.008, 0.011, 0.014, 0.018, 0.023, 0.029, 0.038, 0.049, 0.063, 0.081, 0.105, 0.135, 0.174, 0.224,
       0.288, 0.371, 0.478, 0.616, 0.794, 1.023, 1.317, 1.697, 2.187, 2.817, 3.630, 4.676, 6.025, 7.762, 10.0, 0.0)
SETTLED_NS = 200000000  # by then every counter is trusted
PROBABILITY = (0, 0, 0.25, 0.5, 0.75, 0.9, 0.99, 0.999)


def frames(path):
    with open(path) as f:
        for line in f:
            if line.startswith("#"):
                continue
            stamp, _, data = line.split()
            number, payload = data.split("#")
            yield round(float(stamp[1:-1]) * 1e6) * 1000, int(number, 16), bytes.fromhex(payload)


def sigma(index, step):
    """The radar's own, and what rounding to steps adds."""
    return math.sqrt(RMS[index] ** 2 + step ** 2 / 12) if RMS[index] else 0.0


def generic_objects(messages):
    out, objects, left, start = [], [], 0, 0
    for t, name, m in messages:
        if name == "EGO":
            out.append(("ego", t, m["SPEED"]))
        elif name == "LIST":
            left, start, objects = m["OBJECTS"], t, []
        elif name == "OBJECT":
            objects.append((m["ID"], m["DIST_LONG"], m["REL_SPEED"], m["DIST_LAT"], m["EXIST_PROB"], 0.0, 0.0))
            left -= 1
        if name != "EGO" and left == 0:
            out.append(("scan", start, objects))
    return out


def ars408(messages):
    out, objects, left, start = [], {}, 0, 0
    for t, name, m in messages:
        if name == "SpeedInformation":
            out.append(("ego", t, m["RadarDevice_Speed"]))
        elif name == "Obj_0_Status":
            left, start, objects = 2 * m["Obj_NofObjects"], t, {}
        elif name == "Obj_1_General":
            objects[m["Obj_ID"]] = [m["Obj_ID"], m["Obj_DistLong"], m["Obj_VrelLong"], m["Obj_DistLat"]]
            left -= 1
        elif name == "Obj_2_Quality":
            objects[m["Obj_ID"]] += [PROBABILITY[m["Obj_ProbOfExist"]], sigma(m["Obj_DistLong_rms"], 0.2),
                                     sigma(m["Obj_VrelLong_rms"], 0.25)]
            left -= 1
        if name.startswith("Obj") and left == 0:
            out.append(("scan", start, [tuple(o) for o in objects.values()]))
    return out


def hyundai_kia_scc11(messages):
    out = []
    for t, name, m in messages:
        if name == "WHL_SPD11":
            out.append(("ego", t, sum(m["WHL_SPD_" + w] for w in ("FL", "FR", "RL", "RR")) / 4 / 3.6))
        elif name == "SCC11":
            lead = (0, m["ACC_ObjDist"], m["ACC_ObjRelSpd"], -m["ACC_ObjLatPos"], 1.0, 0.0, 0.0)
            out.append(("scan", t, [lead] if m["ObjValid"] else []))
    return out


CARS = {"generic-objects": generic_objects, "ars408": ars408, "hyundai-kia-scc11": hyundai_kia_scc11}


def ours(program, conf, log):
    out = []
    for line in subprocess.run([program, "--driver", conf, log], check=True, stdout=subprocess.PIPE,
                               encoding="ascii").stdout.splitlines():
        word = line.split()
        if word[0] == "ego":
            out.append(("ego", int(word[1]), float(word[2])))
        elif word[0] == "scan":
            out.append(("scan", int(word[1]), []))
        else:
            out[-1][2].append(tuple(float(w) for w in word[1:]))
    return out


def same(a, b):
    if a[:2] != b[:2]:
        return False
    if a[0] == "ego":
        return math.isclose(a[2], float(b[2]), rel_tol=1e-8)
    return len(a[2]) == len(b[2]) and all(
        math.isclose(x, float(y), rel_tol=1e-8, abs_tol=1e-8) for p, q in zip(a[2], b[2]) for x, y in zip(p, q))


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--driver", required=True)
    p.add_argument("--plant", action="store_true", help="disagree about one value, to show that it is seen")
    p.add_argument("car", choices=sorted(CARS))
    p.add_argument("log")
    a = p.parse_args()
    folder = "can-dbc/vehicles"
    db = cantools.database.load_file(os.path.join(folder, a.car + ".dbc"))
    messages = []
    for t, number, data in frames(a.log):
        m = db.get_message_by_frame_id(number)
        messages.append((t, m.name, m.decode(data, decode_choices=False)))
    first = messages[0][0] + SETTLED_NS
    theirs = [x for x in CARS[a.car](messages) if x[1] >= first]
    if a.plant:
        theirs[-1] = theirs[-1][:1] + (theirs[-1][1] + 1,) + theirs[-1][2:]
    mine = [x for x in ours(a.driver, os.path.join(folder, a.car + ".conf"), a.log) if x[1] >= first]
    for x, y in zip(mine, theirs):
        if not same(x, y):
            print("ours %r, cantools %r" % (x, y))
            return 1
    if len(mine) != len(theirs):
        print("ours has %d lines, cantools %d" % (len(mine), len(theirs)))
        return 1
    scans = [x for x in mine if x[0] == "scan"]
    targets = sum(len(x[2]) for x in scans)
    print("%d speeds, %d scans, %d targets agree" % (len(mine) - len(scans), len(scans), targets))
    return 0 if targets else 1


if __name__ == "__main__":
    sys.exit(main())
