#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# Oracle of both rollouts: 200 scenes in 40 digits, written from the text at the head of kernels/model.h and the paper's
# eq. 1-6 alone. Taylor series of eq. 4 and 6, no closed forms; friction kink, standstill, lead standstill, closest
# approach and first contact are located on the series. Needs python3-mpmath.
#
#   tests/oracle/rollout.py > tests/kat/rollout.txt        (some minutes)
import random
import struct
from mpmath import mp, mpf, sin

mp.dps = 40
ORDER = 30
CONTACT, ROLLING, UNDECIDED = 1, 2, 4
NAMES = ("headway", "v0", "a0", "vl", "al", "mu", "grade", "mass", "drag", "tau", "delay")
RHO, AREA, GRAVITY, CG, BASE = 1.225, 2.2, 9.81, 0.5, 2.7


def f32(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def poly(c, u):
    y = mpf(0)
    for a in reversed(c):
        y = y * u + a
    return y


def bisect(f, lo, hi):
    """Root of f between lo and hi, where its sign changes."""
    below = f(lo) < 0
    for _ in range(120):
        mid = (lo + hi) / 2
        if (f(mid) < 0) == below:
            lo = mid
        else:
            hi = mid
    return (lo + hi) / 2


def sign_changes(f, h, pieces=16):
    at = [h * i / pieces for i in range(pieces + 1)]
    y = [f(u) for u in at]
    return [bisect(f, at[i], at[i + 1]) for i in range(pieces) if y[i] != 0 and (y[i] < 0) != (y[i + 1] < 0)]


class Scene:
    def __init__(self, inputs, cmd, extra, bound, horizon):
        self.inputs = [f32(x) for x in inputs]
        self.cmd, self.extra, self.bound, self.horizon = f32(cmd), f32(extra), bound, f32(horizon)

    def constants(self):
        q = dict(zip(NAMES, map(mpf, self.inputs)))
        g = mpf(f32(GRAVITY))
        over_l = mpf(f32(CG)) / mpf(f32(BASE)) if self.bound == 0 else mpf(0)
        q["k"] = mpf(f32(RHO)) * mpf(f32(AREA)) * q["drag"] / (2 * q["mass"])
        q["g"] = g * sin(q["grade"])
        q["p"] = q["mu"] * g / (1 + q["mu"] * over_l)
        q["lead_stop"] = q["vl"] / -q["al"] if q["al"] < 0 else mpf("inf")
        q["T"], q["cmd"] = mpf(self.horizon), mpf(self.cmd)
        q["onset"] = min(q["delay"] + mpf(self.extra), q["T"])
        return q


class Watch:
    """Follows the gap over pieces on which both motions are polynomials of local time."""

    def __init__(self, q):
        self.q, self.min_rel, self.hit = q, mpf(0), None
        if q["headway"] <= 0:
            self.hit = max(q["v0"] - q["vl"], mpf(0))

    def lead(self, t):
        q = self.q
        tc = min(t, q["lead_stop"])
        x = q["vl"] * tc + q["al"] * tc * tc / 2
        return [x, q["vl"] + q["al"] * t, q["al"] / 2] if t < q["lead_stop"] else [x, mpf(0), mpf(0)]

    def piece(self, t, h, x, v):
        stop = self.q["lead_stop"]
        if t < stop < t + h:  # cut where the lead comes to stand
            u = stop - t
            self.part(t, mpf(0), u, x, v)
            self.part(t, u, h, x, v)
        else:
            self.part(t, mpf(0), h, x, v)

    def part(self, t, u0, u1, x, v):
        lead = self.lead(t + u0)
        rel = lambda u: poly(lead, u - u0) - poly(x, u)
        drel = lambda u: lead[1] + 2 * lead[2] * (u - u0) - poly(v, u)
        marks = [u0] + [u0 + z for z in sign_changes(lambda z: drel(u0 + z), u1 - u0)] + [u1]
        for a, b in zip(marks, marks[1:]):
            gap = lambda u: self.q["headway"] + rel(u)
            if self.hit is None and gap(b) <= 0:
                self.hit = max(-drel(bisect(gap, a, b)), mpf(0))
            self.min_rel = min(self.min_rel, rel(b))


def series(q, x, v, a, sliding):
    """Taylor coefficients of eq. 4 and 6; sliding: the brake force is held at the friction bound."""
    cx, cv, ca = [x], [v], [a]
    for n in range(ORDER):
        drag = q["k"] * sum(cv[i] * cv[n - i] for i in range(n + 1))
        force = ca[n] - (q["g"] if n == 0 else 0)
        cx.append(cv[n] / (n + 1))
        ca.append(mpf(0) if sliding else ((q["cmd"] if n == 0 else 0) - ca[n]) / q["tau"] / (n + 1))
        cv.append((force - drag) / (n + 1))
    return cx, cv, ca


def coast(q, w):
    """Constant acceleration to onset or standstill."""
    stop = q["v0"] / -q["a0"] if q["a0"] < 0 else mpf("inf")
    end = min(stop, q["onset"])
    x, v = [mpf(0), q["v0"], q["a0"] / 2], [q["v0"], q["a0"]]
    if end > 0:
        w.piece(mpf(0), end, x, v)
    return poly(x, end), mpf(0) if stop <= q["onset"] else poly(v, end)


def brake(q, w, x, v):
    t, a = q["onset"], max(q["a0"], -min(-q["cmd"], q["p"]))
    sliding = -q["cmd"] > q["p"] and a <= -q["p"]
    step = min(q["tau"] / 4, mpf("0.05"))
    while v > 0 and t < q["T"]:
        h = min(step if not sliding else mpf("0.1"), q["T"] - t)
        cx, cv, ca = series(q, x, v, a, sliding)
        kink = not sliding and poly(ca, h) < -q["p"]
        if kink:
            h = bisect(lambda u: poly(ca, u) + q["p"], mpf(0), h)
        if poly(cv, h) <= 0:
            h = bisect(lambda u: poly(cv, u), mpf(0), h)
            w.piece(t, h, cx, cv)
            return t + h, poly(cx, h), mpf(0)
        if h > 0:
            w.piece(t, h, cx, cv)
        last = t + h >= q["T"]
        t, x, v, a = t + h, poly(cx, h), poly(cv, h), poly(ca, h)
        if kink:
            sliding, a = True, -q["p"]
        if last:
            break
    return t, x, v


def roll(scene):
    """(stop_m, need_m, impact_mps, flags), or None where an event lies too near the horizon or contact to be judged."""
    q = scene.constants()
    w = Watch(q)
    x, v = coast(q, w)
    t, x, v = brake(q, w, x, v)
    flags = (CONTACT if w.hit is not None else 0) | (ROLLING if v > 0 else 0)
    closing = v - w.lead(q["T"])[1]
    if w.hit is None and v > 0 and closing > 0:
        flags |= UNDECIDED
    if v == 0 and abs(t - q["T"]) < mpf("0.005") or v > 0 and (abs(closing) < mpf("0.02") or v < mpf("0.05")):
        return None
    if abs(q["headway"] + w.min_rel) < mpf("0.001"):
        return None
    return x, -w.min_rel, w.hit or mpf(0), flags


def paper(rng):
    one = rng.gauss
    return Scene([rng.uniform(50, 130), one(30, 2), 0, 0, 0, one(0.8, 0.1), one(0, 0.05), one(1500, 100),
                  one(0.3, 0.05), 0.15, 0], -6, 0, 0, 10)


def moving(rng):
    u = rng.uniform
    v0 = 0 if rng.random() < 0.02 else u(0, 5) if rng.random() < 0.1 else u(0, 60)
    vl = 0 if rng.random() < 0.15 else v0 * u(0.8, 1.2) if rng.random() < 0.4 else u(0, 60)
    cmd = 0 if rng.random() < 0.03 else -u(1, 10)
    al = 0 if rng.random() < 0.2 else cmd + u(-1, 1) if rng.random() < 0.25 else u(-10, 3)
    horizon = 10 if rng.random() < 0.7 else u(2, 15)
    extra = horizon if rng.random() < 0.05 else u(0, 1.5) if rng.random() < 0.3 else 0
    return Scene([u(0, 30) if rng.random() < 0.5 else u(0, 200), v0, 0 if rng.random() < 0.4 else u(-6, 3), vl, al,
                  u(0.1, 1), u(-0.45, 0.45) if rng.random() < 0.15 else u(-0.15, 0.15), u(1000, 3500), u(0.1, 0.7),
                  u(0.05, 0.4), 0 if rng.random() < 0.3 else u(0, 1)], cmd, extra, int(rng.random() < 0.3), horizon)


def grazing(rng):
    scene = moving(rng)
    found = roll(scene)
    if found is not None:
        scene.inputs[0] = f32(max(float(found[1]) + rng.choice((-1, 1)) * rng.uniform(0.002, 0.1), 0))
    return scene


def main():
    rng = random.Random(1)
    print("# Written by tests/oracle/rollout.py. f32 inputs, f64 results:")
    print("# cmd extra bound horizon | " + " ".join(NAMES) + " | stop need impact flags")
    for kind, count in ((paper, 30), (moving, 100), (grazing, 70)):
        done = 0
        while done < count:
            scene = kind(rng)
            found = roll(scene)
            if found is None:
                continue
            done += 1
            head = [scene.cmd.hex(), scene.extra.hex(), str(scene.bound), scene.horizon.hex()]
            tail = [float(found[0]).hex(), float(found[1]).hex(), float(found[2]).hex(), str(found[3])]
            print(" ".join(head + [x.hex() for x in scene.inputs] + tail), flush=True)


main()
