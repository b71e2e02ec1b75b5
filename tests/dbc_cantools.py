#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Holds `test_dbc --driver` against cantools: what is in a DBC, and the values of random frames both ways.

Raw values must be equal as integers. Physical ones may differ by 4 units in the last place of their largest term:
cantools multiplies integers exactly where the scale is an integer.
"""
import argparse
import errno
import os
import random
import subprocess
import sys
from decimal import Decimal

import cantools

FRAMES = 40  # random frames a message, each way
FD_SIZES = (12, 16, 20, 24, 32, 48, 64)


class Different(Exception):
    pass


def same(what, ours, theirs):
    if ours != theirs:
        raise Different("%s: ours %r, cantools %r" % (what, ours, theirs))


# ---- random databases ------------------------------------------------------------------------------

def bits_of(start, length, little):
    """Bits of the frame, 8 * byte + bit, that a signal covers."""
    out = []
    for _ in range(length):
        out.append(start)
        start = start + 1 if little else start - 1 if start % 8 else start + 15
    return out


def random_number(rng):
    kind = rng.randrange(4)
    if kind == 0:
        return str(rng.choice((1, 1, 2, 10, 100, -1)))
    if kind == 1:
        return "%g" % rng.choice((0.5, 0.25, 0.01, 0.025, -0.05, 1.5625e-05, 0.001))
    if kind == 2:
        return "%.6g" % (rng.uniform(0.0001, 10) * rng.choice((1, -1)))
    return "%.9E" % (10 ** rng.uniform(-6, 6))


def random_signal(rng, name, size, mux, taken):
    """One SG_ line on free bits, or None where chance found none."""
    for _ in range(20):
        length = rng.choice((1, 2, 4, 8, 12, 16, 32, 64, rng.randint(1, 64)))
        little = rng.random() < 0.5
        start = rng.randrange(8 * size)
        bits = bits_of(start, length, little)
        if max(bits) < 8 * size and not taken.intersection(bits):
            break
    else:
        return None
    taken.update(bits)
    offset = rng.choice(("0", "0", "-40", "1.5", random_number(rng)))
    return ' SG_ %s %s: %d|%d@%d%s (%s,%s) [0|0] "%s" NODE' % (
        name, mux, start, length, little, rng.choice("+-"), random_number(rng), offset, rng.choice(("", "m/s", "%")))


def random_message(rng, number, lines, attributes):
    size = rng.choice((1, 2, 5, 8, 8, 8, 8) + FD_SIZES)
    frame_id = (0x80000000 | rng.getrandbits(29)) if rng.random() < 0.3 else 0x100 + number
    lines.append("BO_ %d M%d: %d NODE" % (frame_id, number, size))
    taken = set()
    groups = [("", taken)]
    if size >= 2 and rng.random() < 0.4:
        taken.update(range(4))
        lines.append(' SG_ PAGE M : 0|4@1+ (1,0) [0|0] "" NODE')
        groups += [("m%d " % page, None) for page in rng.sample(range(16), 3)]
    for index, (mux, group) in enumerate(groups):
        group = group if group is not None else set(taken)
        for k in range(rng.randint(1, 6)):
            line = random_signal(rng, "S%d_%d" % (index, k), size, mux, group)
            if line:
                lines.append(line)
    if size > 8 or rng.random() < 0.2:
        attributes.append('BA_ "VFrameFormat" BO_ %d %d;' % (frame_id, 15 if frame_id >> 31 else 14))
    if rng.random() < 0.5:
        attributes.append('BA_ "GenMsgCycleTime" BO_ %d %d;' % (frame_id, rng.randrange(1, 5000)))


FORMATS = ["StandardCAN", "ExtendedCAN"] + ["reserved"] * 12 + ["StandardCAN_FD", "ExtendedCAN_FD"]


def random_dbc(rng):
    lines = ['VERSION "random"', "", "NS_ :", "", "BS_:", "", "BU_: NODE", ""]
    attributes = ['BA_DEF_ BO_ "VFrameFormat" ENUM %s;' % ",".join('"%s"' % f for f in FORMATS),
                  'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 5000;', 'BA_DEF_DEF_ "VFrameFormat" "StandardCAN";',
                  'BA_DEF_DEF_ "GenMsgCycleTime" 0;']
    for number in range(5):
        random_message(rng, number, lines, attributes)
        lines.append("")
    return "\n".join(lines + attributes) + "\n"


# ---- comparison --------------------------------------------------------------------------------------

class Driver:
    def __init__(self, program, path):
        self.pipe = subprocess.Popen([program, "--driver", path], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                     encoding="latin-1")
        self.listing = []
        for line in self.pipe.stdout:
            if line == "end\n" or line.startswith("error"):
                break
            self.listing.append(line.rstrip("\n").split(" "))
        if not line.startswith("end"):
            raise Different("%s: ours refuses it: %s" % (path, line))

    def ask(self, line):
        self.pipe.stdin.write(line + "\n")
        self.pipe.stdin.flush()
        return self.pipe.stdout.readline().strip()

    def close(self):
        self.pipe.stdin.close()
        same("exit status", self.pipe.wait(), 0)


def listing_of(db):
    """What the driver prints for a database, from cantools."""
    for m in db.messages:
        yield ["message", m.name, m.frame_id | (m.is_extended_frame << 31), m.length, int(m.is_fd), m.cycle_time or 0]
        for s in m.signals:
            mux = 1 if s.is_multiplexer else 2 if s.multiplexer_ids else 0
            yield ["signal", s.name, s.start, s.length, int(s.byte_order == "big_endian"), int(s.is_signed), mux,
                   s.multiplexer_ids[0] if mux == 2 else 0, float(s.scale), float(s.offset), float(s.minimum or 0),
                   float(s.maximum or 0), len(s.choices or ()), s.unit or ""]


def compare_listing(driver, db):
    def key(row):
        return [w if isinstance(w, str) else float(w) for w in row]

    def parsed(row):
        return row[:2] + [float(w) for w in row[2:6 if row[0] == "message" else 13]] + row[13:]

    # cantools sorts signals by place; ours keep the file's order
    def grouped(rows):
        out = []
        for row in rows:
            if row[0] == "message":
                out.append([row])
            else:
                out[-1].append(row)
        return sorted(g[:1] + sorted(g[1:]) for g in out)

    for ours, theirs in zip(grouped(map(parsed, driver.listing)), grouped(map(key, listing_of(db)))):
        same("listing", ours, theirs)
    same("messages", sum(r[0] == "message" for r in driver.listing), len(db.messages))


def close_enough(ours, theirs, raw, s):
    largest = max(abs(float(raw) * float(s.scale)), abs(float(s.offset)))
    return abs(ours - float(theirs)) <= 4 * 2.0 ** -52 * largest


def compare_unpack(driver, m, data):
    answer = dict(w.split("=", 1) for w in driver.ask("unpack %s %s" % (m.name, data.hex())).split())
    raw = m.decode(data, decode_choices=False, scaling=False, allow_truncated=False)
    physical = m.decode(data, decode_choices=False)
    same("%s: signals present" % m.name, sorted(answer), sorted(raw))
    for s in m.signals:
        if s.name in raw:
            ours_raw, ours_physical = answer[s.name].split("=")
            same("%s.%s of %s" % (m.name, s.name, data.hex()), int(ours_raw), raw[s.name])
            if not close_enough(float(ours_physical), physical[s.name], raw[s.name], s):
                raise Different("%s.%s: physical %s, cantools %r" % (m.name, s.name, ours_physical, physical[s.name]))
    return raw


def compare_pack(driver, m, raw, rng):
    """The same raw values, then physical ones a little beside the steps, into frames."""
    theirs = m.encode(raw, scaling=False, strict=False)
    words = " ".join("%s=%d" % item for item in raw.items())
    same("%s packed from %s" % (m.name, words), driver.ask("raw %s %s" % (m.name, words)), theirs.hex())
    if any(s.length > 40 for s in m.signals):
        return  # a double cannot tell their steps apart
    physical = {}
    expected = theirs.hex()
    for name, value in raw.items():
        s = m.get_signal_by_name(name)
        beside = 0 if s.is_multiplexer else rng.uniform(-0.4, 0.4)
        physical[name] = (value + beside) * float(s.scale) + float(s.offset)
        if outside(s, value):
            expected = str(-errno.ERANGE)
    words = " ".join("%s=%.17g" % item for item in physical.items())
    same("%s packed from %s" % (m.name, words), driver.ask("physical %s %s" % (m.name, words)), expected)


def outside(s, raw):
    """Whether a raw value lies outside the range that the file gives, as decimal numbers have it."""
    if not s.minimum and not s.maximum:
        return False
    steps = [(Decimal(str(limit)) - Decimal(str(s.offset))) / Decimal(str(s.scale)) for limit in (s.minimum, s.maximum)]
    return not min(steps) <= raw <= max(steps)


def compare_frames(driver, db, rng):
    for m in db.messages:
        pages = [p for s in m.signals for p in (s.multiplexer_ids or ())]
        for _ in range(FRAMES):
            data = bytearray(rng.getrandbits(8) for _ in range(m.length))
            if pages:  # cantools refuses pages that no signal is on
                selector = next(s for s in m.signals if s.is_multiplexer)
                same("selector is low bits of one byte", (selector.start + selector.length - 1) // 8, selector.start // 8)
                mask = ((1 << selector.length) - 1) << selector.start % 8
                at = selector.start // 8
                data[at] = data[at] & ~mask & 0xFF | rng.choice(pages) << selector.start % 8
            raw = compare_unpack(driver, m, bytes(data))
            compare_pack(driver, m, raw, rng)


def compare(program, path, rng, plant=False):
    db = cantools.database.load_file(path)
    if plant:
        with open(path) as f:
            text = f.read()
        with open(path, "w") as f:
            f.write(text.replace("@1", "@0", 1))
    driver = Driver(program, path)
    compare_listing(driver, db)
    compare_frames(driver, db, rng)
    driver.close()
    return sum(len(m.signals) for m in db.messages)


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--driver", required=True)
    p.add_argument("--file")
    p.add_argument("--random", type=int, default=0)
    p.add_argument("--dir", default=".")
    p.add_argument("--plant", action="store_true", help="make the two disagree, to show that it is seen")
    a = p.parse_args()
    signals = 0
    try:
        if a.file:
            signals += compare(a.driver, a.file, random.Random(1))
        for seed in range(a.random):
            rng = random.Random(seed)
            path = os.path.join(a.dir, "random%d.dbc" % seed)
            with open(path, "w") as f:
                f.write(random_dbc(rng))
            signals += compare(a.driver, path, rng, a.plant)
    except Different as e:
        print(e)
        return 1
    print("%d signals, %d frames of each message agree" % (signals, FRAMES))
    return 0


if __name__ == "__main__":
    sys.exit(main())
